//! Everything that banks have in common: a system as it is looked at, and how large what is hidden there shows.

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

/// How often a system and a shape are drawn anew where no size is as detectable as wanted.
pub(crate) const ATTEMPTS: usize = 40;

/// Everything that banks have in common.
pub(crate) struct Setup {
    /// The case's branch of the tree of seeds.
    pub(crate) seed: Seed,
    /// Its names, from the root.
    pub(crate) branch: Vec<String>,
    pub(crate) situation: Situation,
    pub(crate) nuisances: Nuisances,
    /// Σθ̇² over all samples of all records, without anything hidden.
    pub(crate) square_velocities: f64,
    /// Standard deviation of all that is white, in rad: the unit of detectability.
    pub(crate) white: f64,
}

impl Setup {
    /// Draws a situation; a later attempt draws another, with the same nuisances.
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

    /// A setup about a situation; `seed` is the case's and `own` the attempt's.
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

    /// The nuisances as effects of the measurement chain.
    pub(crate) fn nuisance_effects(&self) -> Result<Vec<Active>, TrialError> {
        let count = (self.situation.sampling.samples * self.situation.starts.len()) as f64;
        self.nuisances.active(&self.situation, self.square_velocities / count)
    }

    /// The text of a `nominal.toml`; an encoder's step is stated there.
    pub(crate) fn nominal_toml(&self, nominal: Nominal) -> Result<String, TrialError> {
        let stated = match self.nuisances.encoder_step {
            Some(step) => nominal.with_sensor_resolution(step)?,
            None => nominal,
        };
        Ok(nominal_text(&stated))
    }

    /// How detectable noise-free motions are, seen by an ideal sensor.
    pub(crate) fn detectability(&self, motions: Vec<Motion>, absorbed: Absorbed) -> Result<f64, TrialError> {
        let seen: Vec<_> = motions.into_iter().map(Motion::seen).collect();
        Ok(left_over(&self.situation, &seen, absorbed)? / self.white)
    }

    /// How detectable noise-free motions are that a sensor with distortions of its own sees.
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

    /// A law as detectable as wanted beyond what is absorbed; `None` where no size is.
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

    /// An effect as detectable as wanted, alone; `None` where no size is.
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

/// What a recalibration moves beside hidden effects: not the rest angle where one of them does.
pub(crate) fn absorbed_beside<'a>(effects: impl IntoIterator<Item = &'a TrialEffect>) -> Absorbed {
    let moved = effects.into_iter().any(|effect| effect.moves_rest_angle);
    Absorbed { rest_angle: !moved, ..Absorbed::BY_RECALIBRATION }
}
