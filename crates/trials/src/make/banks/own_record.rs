//! Cases whose motion comes from laws outside the vocabulary and from this crate's own integrator.

use crate::make::case::Case;
use crate::make::error::TrialError;
use crate::make::job::Job;
use crate::make::plan::TrialPlan;
use crate::make::setup::Setup;
use crate::make::situation::Motion;
use crate::{Foreign, Hidden, HiddenEffect, Unlisted};
use dynamics::Coordinate;
use dynamics::chain::{Chain, Observed};
use record::{Quantity, Record};
use simulator::csv_text;

/// Parts of the hidden truth of such a case.
#[derive(Default)]
pub(crate) struct Told {
    pub(crate) effects: Vec<HiddenEffect>,
    pub(crate) foreign: Option<Foreign>,
    pub(crate) unlisted: Vec<Unlisted>,
    pub(crate) made: String,
}

/// Passes motions through the measurement chain and assembles the case.
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
    let (nominal, miscalibrated) = job.believed(plan.seed, &situation.nominal, &[])?;
    let made = format!("{}; {}", job.in_words(plan.seed), told.made);
    let hidden = Hidden {
        effects: told.effects,
        foreign: told.foreign,
        unlisted: told.unlisted,
        nuisances: nuisances.iter().map(|active| active.id().to_owned()).collect(),
        miscalibrated,
        ..Hidden::nothing(job.bank, situation.noise, made)
    };
    Ok(Case { id, without: None, records, nominal: setup.nominal_toml(nominal)?, hidden })
}
