//! Rigs from a folder that experiments/rigs/records.py wrote: cases below `cases`, their truths separately
//! below `truths`.

use crate::make::case::Case;
use crate::make::error::TrialError;
use crate::make::job::Job;
use crate::make::plan::TrialPlan;
use crate::{Bank, Foreign, Hidden, HiddenEffect, Unlisted};
use dynamics::Effect;
use record::{ReadOptions, read_text};
use serde::Deserialize;
use simulator::nominal_text;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Value of the `schema` field in a rig's truth.
const SCHEMA: &str = "ringdown.rig/1";

/// Limits on what the best effect of a class leaves of a law outside the vocabulary that acts alone, × noise
/// and as a share of the law's size. An answer may name the class if it leaves no more than the larger limit.
const LEFT_FLOORS: f64 = 0.5;
const LEFT_PART: f64 = 0.15;

#[derive(Deserialize)]
pub(crate) struct RigTruth {
    schema: String,
    kind: String,
    effects: Vec<RigEffect>,
    unlisted: Vec<Unlisted>,
    nuisances: Vec<String>,
    nominal_off: BTreeMap<String, f64>,
    chain: RigChain,
    rig: RigSampling,
    integrator: String,
    made: String,
    #[serde(default)]
    resembles: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct RigEffect {
    id: String,
    parameters: Vec<f64>,
    floors: f64,
}

#[derive(Deserialize)]
struct RigChain {
    noise: f64,
}

#[derive(Deserialize)]
struct RigSampling {
    records: usize,
    samples: usize,
}

/// Makes a case from a rig. The texts of its records are kept, because their number of decimals follows from
/// noise and rate.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let Some(case) = plan.rigs.get(job.number) else {
        return Err(TrialError::NoSuchCase { index: job.number, cases: plan.rigs.len() });
    };
    let kept = |path: &PathBuf| {
        let text = case.text(path)?;
        read_text(&path.display().to_string(), text.as_bytes(), &ReadOptions::default())?;
        Ok(text)
    };
    let records = case.records()?.iter().map(kept).collect::<Result<_, TrialError>>()?;
    let nominal = case.nominal()?;
    let refused = |problem| case.refused(&case.truth, problem);
    let truth = serde_json::from_str(&case.text(&case.truth)?).map_err(|error| refused(error.to_string()))?;
    let hidden = hidden(truth).map_err(refused)?;
    Ok(Case { id, without: None, records, nominal: nominal_text(&nominal), hidden })
}

/// Converts a rig's truth to the hidden truth of a case.
pub(crate) fn hidden(truth: RigTruth) -> Result<Hidden, String> {
    if truth.schema != SCHEMA {
        return Err(format!("its schema is {}, not {SCHEMA}", truth.schema));
    }
    if let Some(unknown) = truth.effects.iter().find(|effect| Effect::find(&effect.id).is_err()) {
        return Err(format!("there is no effect {}", unknown.id));
    }
    let root = ((truth.rig.records * truth.rig.samples) as f64).sqrt();
    let effect = |effect: RigEffect| HiddenEffect {
        id: effect.id,
        parameters: effect.parameters,
        law: "vocabulary".to_owned(),
        detectability: effect.floors * root,
        floors: Some(effect.floors),
    };
    let (foreign, allowed, unlisted) = match truth.unlisted.first() {
        Some(law) if truth.effects.is_empty() => {
            let size = LEFT_FLOORS.max(LEFT_PART * law.floors);
            let alike = truth.resembles.iter().filter(|(_, left)| **left <= size).map(|(id, _)| id.clone());
            let allowed = law.class.iter().cloned().chain(alike).collect();
            let foreign = Foreign { law: law.law.clone(), detectability: law.floors * root };
            // A small law is no reason to answer `unknown`.
            match truth.kind.as_str() {
                "unlisted" => (Some(foreign), allowed, Vec::new()),
                _ => (None, allowed, truth.unlisted),
            }
        }
        _ => (None, Vec::new(), truth.unlisted),
    };
    Ok(Hidden {
        effects: truth.effects.into_iter().map(effect).collect(),
        foreign,
        unlisted,
        allowed,
        nuisances: truth.nuisances,
        miscalibrated: truth.nominal_off.values().any(|off| *off != 0.0),
        ..Hidden::nothing(Bank::Rigs, truth.chain.noise, format!("{}; {}", truth.made, truth.integrator))
    })
}
