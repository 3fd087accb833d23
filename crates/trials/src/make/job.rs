//! A bank, a number there, and what follows from these and the seed alone.

use super::draws::Draws;
use super::error::TrialError;
use super::situation::{Motions, believed};
use crate::Bank;
use crate::effects::TrialEffect;
use dynamics::Nominal;
use seed::Seed;

/// How much of the cases of banks with a free choice has a measured input.
const DRIVEN_SHARE: f64 = 0.15;

/// How far nominal coefficients are off, at most, where they are the case's subject, and where they are not.
const OFF_AS_SUBJECT: f64 = 0.3;
const OFF_BESIDES: f64 = 0.1;

/// A bank and a number there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Job {
    pub(crate) bank: Bank,
    pub(crate) number: usize,
}

impl Job {
    /// The case's branch of the tree of seeds, and its names from the root.
    pub(crate) fn seed(&self, root: u64) -> (Seed, Vec<String>) {
        let branch = vec!["trials".to_owned(), format!("{:?}", self.bank), format!("case {}", self.number)];
        (branch.iter().fold(Seed::new(root), |node, name| node.child(name)), branch)
    }

    /// What nominal.toml says: exact, off as the case's subject, or, by an even chance, off besides; and whether it is off.
    pub(crate) fn believed(
        &self,
        root: u64,
        nominal: &Nominal,
        hidden: &[&TrialEffect],
    ) -> Result<(Nominal, bool), TrialError> {
        let (seed, _) = self.seed(root);
        let off = match self.bank {
            Bank::None => None,
            Bank::Calibration | Bank::Composite => Some(OFF_AS_SUBJECT),
            // Beside other coefficients that are off a rest angle that moves is one more of these.
            _ if hidden.iter().any(|effect| effect.moves_rest_angle) => None,
            _ => Draws::new(&seed.child("miscalibration")).chance(0.5).then_some(OFF_BESIDES),
        };
        Ok((believed(nominal, off, &seed)?, off.is_some()))
    }

    /// Whether a case of a bank with a free choice has a measured input.
    pub(crate) fn free_motions(&self, root: u64) -> Motions {
        let (seed, _) = self.seed(root);
        let driven = Draws::new(&seed.child("input")).chance(DRIVEN_SHARE);
        if driven { Motions::Driven } else { Motions::Release }
    }

    /// Seed, bank and number, for whoever makes the case again.
    pub(crate) fn in_words(&self, seed: u64) -> String {
        format!("seed {seed}, {:?} {}", self.bank, self.number)
    }
}
