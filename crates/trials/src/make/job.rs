//! Jobs: a bank and a number in it, and everything that follows from these and the seed alone.

use super::draws::Draws;
use super::error::TrialError;
use super::situation::{Motions, believed};
use crate::Bank;
use crate::effects::TrialEffect;
use dynamics::Nominal;
use seed::Seed;

/// Share of cases with a measured input, in banks that may choose.
const DRIVEN_SHARE: f64 = 0.15;

/// Largest relative errors of nominal coefficients, in cases about such errors and in other cases.
const OFF_AS_SUBJECT: f64 = 0.3;
const OFF_BESIDES: f64 = 0.1;

/// A bank and a number in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Job {
    pub(crate) bank: Bank,
    pub(crate) number: usize,
}

impl Job {
    /// Returns the case's branch of the seed tree, and the names along the path from the root.
    pub(crate) fn seed(&self, root: u64) -> (Seed, Vec<String>) {
        let branch = vec!["trials".to_owned(), format!("{:?}", self.bank), format!("case {}", self.number)];
        (branch.iter().fold(Seed::new(root), |node, name| node.child(name)), branch)
    }

    /// Returns the nominal simulator of `nominal.toml`, and `true` if its coefficients are wrong. They are
    /// exact, wrong as the subject of the case, or, with a probability of one half, slightly wrong besides.
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
            // A moved rest angle would be one more wrong coefficient beside others.
            _ if hidden.iter().any(|effect| effect.moves_rest_angle) => None,
            _ => Draws::new(&seed.child("miscalibration")).chance(0.5).then_some(OFF_BESIDES),
        };
        Ok((believed(nominal, off, &seed)?, off.is_some()))
    }

    /// Draws the motions of a case in a bank that may choose: with or without a measured input.
    pub(crate) fn free_motions(&self, root: u64) -> Motions {
        let (seed, _) = self.seed(root);
        let driven = Draws::new(&seed.child("input")).chance(DRIVEN_SHARE);
        if driven { Motions::Driven } else { Motions::Release }
    }

    /// Returns seed, bank and number in words, for repeating the case.
    pub(crate) fn in_words(&self, seed: u64) -> String {
        format!("seed {seed}, {:?} {}", self.bank, self.number)
    }
}
