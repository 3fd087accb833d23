//! Rigs of a folder that experiments/rigs/records.py wrote: cases below `cases`, their truths apart below `truths`.

use super::case::{Case, Job};
use super::error::TrialError;
use super::outside::{entries, file_name};
use super::plan::TrialPlan;
use crate::{Bank, Foreign, HIDDEN_SCHEMA, Hidden, HiddenEffect, Unlisted};
use dynamics::{Effect, Nominal};
use record::{ReadOptions, read_text};
use serde::Deserialize;
use simulator::nominal_text;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The `schema` of a rig's truth.
const SCHEMA: &str = "ringdown.rig/1";

/// A class may be named for a law outside the vocabulary that acts alone if the best of the class leaves no more of it: × noise,
/// or as a part of its size.
const LEFT_FLOORS: f64 = 0.5;
const LEFT_PART: f64 = 0.15;

/// What to do about a folder that cannot be used.
const REMEDY: &str = "make the records again with experiments/rigs/records.py";

/// A rig's folder and its truth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct RigCase {
    folder: PathBuf,
    truth: PathBuf,
}

/// The rigs of a folder, by name.
pub(crate) fn rig_cases(folder: &Path) -> Result<Vec<RigCase>, String> {
    let cases: Vec<RigCase> = entries(&folder.join("cases"))?
        .into_iter()
        .map(|path| RigCase {
            truth: folder.join("truths").join(format!("{}.json", file_name(&path))),
            folder: path,
        })
        .filter(|case| case.truth.is_file() && case.folder.join("nominal.toml").is_file())
        .collect();
    if cases.is_empty() {
        Err("holds no cases/ID/nominal.toml that truths/ has a truth for".to_owned())
    } else {
        Ok(cases)
    }
}

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

fn refused(path: &Path, problem: String, remedy: &'static str) -> TrialError {
    TrialError::Outside { path: path.display().to_string(), problem, remedy }
}

fn text(path: &Path) -> Result<String, TrialError> {
    std::fs::read_to_string(path).map_err(|error| refused(path, format!("cannot be read: {error}"), REMEDY))
}

/// A rig as a case. Its records keep their text: how many decimals they have follows from noise and rate.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let Some(case) = plan.rigs.get(job.number) else {
        return Err(TrialError::NoSuchCase { index: job.number, cases: plan.rigs.len() });
    };
    let listing = entries(&case.folder).map_err(|problem| refused(&case.folder, problem, REMEDY))?;
    let mut records = Vec::new();
    for path in listing {
        let name = file_name(&path);
        if name.starts_with("record-") && name.ends_with(".csv") {
            let text = text(&path)?;
            read_text(&path.display().to_string(), text.as_bytes(), &ReadOptions::default())?;
            records.push(text);
        }
    }
    if records.is_empty() {
        return Err(refused(&case.folder, "holds no record-*.csv".to_owned(), REMEDY));
    }
    let path = case.folder.join("nominal.toml");
    let nominal: Nominal = toml::from_str(&text(&path)?)
        .map_err(|error| refused(&path, error.message().to_owned(), "write a nominal simulator"))?;
    let truth: RigTruth = serde_json::from_str(&text(&case.truth)?)
        .map_err(|error| refused(&case.truth, error.to_string(), REMEDY))?;
    let hidden = hidden(truth).map_err(|problem| refused(&case.truth, problem, REMEDY))?;
    Ok(Case { id, without: None, records, nominal: nominal_text(&nominal), hidden })
}

/// The truth as trials hide it.
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
            // A small one is no reason to say `unknown`.
            match truth.kind.as_str() {
                "unlisted" => (Some(foreign), allowed, Vec::new()),
                _ => (None, allowed, truth.unlisted),
            }
        }
        _ => (None, Vec::new(), truth.unlisted),
    };
    Ok(Hidden {
        schema: HIDDEN_SCHEMA.to_owned(),
        bank: Bank::Rigs,
        effects: truth.effects.into_iter().map(effect).collect(),
        foreign,
        unlisted,
        allowed,
        nuisances: truth.nuisances,
        miscalibrated: truth.nominal_off.values().any(|off| *off != 0.0),
        without: None,
        noise: truth.chain.noise,
        records: Vec::new(),
        made: format!("{}; {}", truth.made, truth.integrator),
    })
}
