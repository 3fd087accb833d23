//! Cases whose motion comes from laws outside the vocabulary and from the integrator beside.

use super::case::{Case, Job, Setup, nominal_toml};
use super::error::TrialError;
use super::integrator::{TorqueLaw, motions};
use super::plan::TrialPlan;
use super::recalibration::Absorbed;
use super::situation::Motion;
use super::size::solve;
use crate::{Foreign, HIDDEN_SCHEMA, Hidden, HiddenEffect, Unlisted};
use dynamics::Coordinate;
use dynamics::chain::{Chain, Observed};
use record::{Quantity, Record};
use simulator::csv_text;

/// Makes the law at a size.
pub(crate) type LawOfSize = Box<dyn Fn(f64) -> Box<dyn TorqueLaw>>;

/// A law whose size is open.
pub(crate) struct OpenLaw {
    /// A size to start from.
    pub(crate) guess: f64,
    /// The largest that makes sense.
    pub(crate) most: f64,
    pub(crate) law: LawOfSize,
}

/// A law of the size found, and how detectable it is.
pub(crate) struct SizedLaw {
    pub(crate) law: Box<dyn TorqueLaw>,
    pub(crate) size: f64,
    pub(crate) detectability: f64,
}

impl OpenLaw {
    /// The law as detectable as wanted beyond what is absorbed; `None` where no size is.
    pub(crate) fn sized(
        &self,
        setup: &Setup,
        wanted: f64,
        absorbed: Absorbed,
    ) -> Result<Option<SizedLaw>, TrialError> {
        let detectability = |size: f64| {
            let motions = motions(&setup.situation, &[(self.law)(size).as_ref()], &|_| Vec::new())?;
            setup.detectability(motions, absorbed)
        };
        let found = solve(wanted, self.guess, self.most, detectability)?;
        Ok(found.map(|found| SizedLaw {
            law: (self.law)(found.size),
            size: found.size,
            detectability: found.detectability,
        }))
    }
}

/// What a case of such a motion says it hides.
#[derive(Default)]
pub(crate) struct Told {
    pub(crate) effects: Vec<HiddenEffect>,
    pub(crate) foreign: Option<Foreign>,
    pub(crate) unlisted: Vec<Unlisted>,
    pub(crate) made: String,
}

/// Sends motions through the measurement chain and puts the case together.
pub(crate) fn written(
    plan: &TrialPlan,
    job: Job,
    id: String,
    setup: &Setup,
    motions: &[Motion],
    told: Told,
) -> Result<Case, TrialError> {
    let situation = &setup.situation;
    let nuisances = setup.nuisance_effects()?;
    let chain = Chain::new(Observed::Position, situation.noise, nuisances.clone())?;
    let input = situation.input()?;
    let sampling = situation.sampling;
    let records = motions
        .iter()
        .enumerate()
        .map(|(number, motion)| {
            let seed = setup.seed.child(&format!("record {number}")).child("measuring chain");
            let samples =
                chain.observe(&motion.sampled(), Coordinate::Angle, |name| seed.child(name).generator())?;
            let input = input.as_ref().map(|input| {
                samples.indices.iter().filter_map(|&index| input.values().get(index).copied()).collect()
            });
            let record = Record::new(samples.stamps_s, samples.values, input, Quantity::Position, "rad")?;
            Ok(csv_text(&record, sampling.stamp_decimals, sampling.value_decimals))
        })
        .collect::<Result<Vec<_>, TrialError>>()?;
    let (nominal, miscalibrated) = job.believed(plan, &situation.nominal)?;
    Ok(Case {
        id,
        without: None,
        records,
        nominal: nominal_toml(nominal, &setup.nuisances)?,
        hidden: Hidden {
            schema: HIDDEN_SCHEMA.to_owned(),
            bank: job.bank,
            effects: told.effects,
            foreign: told.foreign,
            unlisted: told.unlisted,
            allowed: Vec::new(),
            nuisances: nuisances.iter().map(|active| active.id().to_owned()).collect(),
            miscalibrated,
            without: None,
            noise: situation.noise,
            records: Vec::new(),
            made: format!("{}; {}", job.in_words(plan.seed), told.made),
        },
    })
}
