//! Common parts of all banks: a system with its measurement, and the detectability of what is hidden in it.

use super::error::TrialError;
use super::job::Job;
use super::nuisances::Nuisances;
use super::open_law::{OpenLaw, SizedLaw};
use super::plan::TrialPlan;
use super::recalibration::{Absorbed, left_over};
use super::situation::{Motion, Motions, Situation};
use super::size::solve;
use crate::effects::{Size, TrialEffect, Wanted};
use crate::make::draws::Draws;
use crate::make::integrator::motions;
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Coordinate, Effect, Nominal};
use seed::Seed;
use simulator::nominal_text;

/// Number of draws of a system and a shape if no size reaches the wanted detectability.
pub(crate) const ATTEMPTS: usize = 40;

/// System, measurement and nuisances of a case.
pub(crate) struct Setup {
    /// The case's branch of the seed tree.
    pub(crate) seed: Seed,
    /// Names along the path of the branch from the root.
    pub(crate) branch: Vec<String>,
    pub(crate) situation: Situation,
    pub(crate) nuisances: Nuisances,
    /// Σθ̇² over all samples of all records, without hidden effects.
    pub(crate) square_velocities: f64,
    /// Standard deviation of all white disturbances, in rad: the unit of detectability.
    pub(crate) white: f64,
}

impl Setup {
    /// Draws a situation; each attempt draws another one, with the same nuisances.
    pub(crate) fn draw(
        plan: &TrialPlan,
        job: Job,
        attempt: usize,
        motions: Motions,
        hidden: &[&TrialEffect],
    ) -> Result<Self, TrialError> {
        let (seed, branch) = job.seed(plan.seed);
        let own = seed.child(&format!("attempt {attempt}"));
        let situation = Situation::draw(&plan.ranges, plan.sampling, &own, motions)?;
        Self::with(situation, seed, own, branch, hidden)
    }

    /// Builds the setup of a situation; `seed` is that of the case and `own` that of the attempt.
    pub(crate) fn with(
        situation: Situation,
        seed: Seed,
        own: Seed,
        branch: Vec<String>,
        hidden: &[&TrialEffect],
    ) -> Result<Self, TrialError> {
        let nuisances = Nuisances::draw(&seed).beside(hidden.iter().filter_map(|effect| effect.nuisance));
        let clean = situation.motions(&[])?;
        let square_velocities: f64 =
            clean.iter().flat_map(|motion| &motion.velocity).map(|velocity| velocity * velocity).sum();
        let count = (situation.sampling.samples * situation.starts.len()) as f64;
        let white = nuisances.white(&situation, square_velocities / count);
        Ok(Self { seed: own, branch, situation, nuisances, square_velocities, white })
    }

    /// Returns the nuisances as effects of the measurement chain.
    pub(crate) fn nuisance_effects(&self) -> Result<Vec<Active>, TrialError> {
        let count = (self.situation.sampling.samples * self.situation.starts.len()) as f64;
        self.nuisances.active(&self.situation, self.square_velocities / count)
    }

    /// Returns the text of a `nominal.toml`, which states an encoder's step.
    pub(crate) fn nominal_toml(&self, nominal: Nominal) -> Result<String, TrialError> {
        let stated = match self.nuisances.encoder_step {
            Some(step) => nominal.with_sensor_resolution(step)?,
            None => nominal,
        };
        Ok(nominal_text(&stated))
    }

    /// Returns the detectability of noise-free motions, observed by an ideal sensor.
    pub(crate) fn detectability(&self, motions: Vec<Motion>, absorbed: Absorbed) -> Result<f64, TrialError> {
        let seen: Vec<_> = motions.into_iter().map(Motion::seen).collect();
        Ok(left_over(&self.situation, &seen, absorbed)? / self.white)
    }

    /// Returns the detectability of noise-free motions, observed by a sensor with its own distortions.
    pub(crate) fn detectability_seen(
        &self,
        motions: &[Motion],
        distortions: impl IntoIterator<Item = Active>,
        absorbed: Absorbed,
    ) -> Result<f64, TrialError> {
        let chain = Chain::new(Observed::Position, 0.0, distortions.into_iter().collect())?;
        let seen = motions
            .iter()
            .map(|motion| {
                let unused = |name: &'static str| self.seed.child(name).generator();
                chain.observe(&motion.sampled(), Coordinate::Angle, unused)
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(left_over(&self.situation, &seen, absorbed)? / self.white)
    }

    /// Returns a law with the wanted detectability beyond what is absorbed; `None` if no size reaches it.
    pub(crate) fn sized(
        &self,
        open: &OpenLaw,
        wanted: f64,
        absorbed: Absorbed,
    ) -> Result<Option<SizedLaw>, TrialError> {
        let detectability = |size: f64| {
            let motions = motions(&self.situation, &[(open.law)(size).as_ref()], &|_| Vec::new())?;
            self.detectability(motions, absorbed)
        };
        let found = solve(wanted, open.guess, open.most, detectability)?;
        Ok(found.map(|found| SizedLaw {
            law: (open.law)(found.size),
            size: found.size,
            detectability: found.detectability,
        }))
    }

    /// Returns an effect alone with the wanted detectability; `None` if no size reaches it.
    pub(crate) fn hide(
        &self,
        effect: &TrialEffect,
        wanted: f64,
    ) -> Result<Option<(Active, f64)>, TrialError> {
        let situation = &self.situation;
        let mut draws = Draws::new(&self.seed.child(effect.id()));
        let shape = match effect.size {
            Size::Solved(draw) => draw(situation, &mut draws),
            Size::Expected(of) => {
                let wanted = Wanted {
                    situation,
                    square_velocities: self.square_velocities,
                    white: self.white,
                    detectability: wanted,
                };
                let found = of(&wanted, &mut draws);
                return Ok(Some((Active::of(effect.effect, &found.values)?, found.detectability)));
            }
        };
        let clean = match effect.effect {
            Effect::MeasuringChain(_) => Some(situation.motions(&[])?),
            Effect::System(_) => None,
        };
        let at = |size: f64| Active::of(effect.effect, &(shape.values)(size));
        let absorbed = absorbed_beside([effect]);
        let detectability = |size: f64| match &clean {
            Some(clean) => self.detectability_seen(clean, [at(size)?], absorbed),
            None => self.detectability_seen(&situation.motions(&[at(size)?])?, [], absorbed),
        };
        let sized = solve(wanted, shape.guess, shape.most, detectability)?;
        sized.map(|sized| Ok((at(sized.size)?, sized.detectability))).transpose()
    }
}

/// Returns what a recalibration adjusts beside hidden effects: everything, except for the rest angle if one
/// of them moves it.
pub(crate) fn absorbed_beside<'a>(effects: impl IntoIterator<Item = &'a TrialEffect>) -> Absorbed {
    let moved = effects.into_iter().any(|effect| effect.moves_rest_angle);
    Absorbed { rest_angle: !moved, ..Absorbed::BY_RECALIBRATION }
}
