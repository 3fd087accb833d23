//! What a configuration says of the trials, and which case has which number.

use super::case::{Case, Job};
use super::draws::Draws;
use super::error::TrialError;
use super::hiding::{INPUTS, PAIRS, RELEASES, RESIDUALS, SINGLE, UNNAMED};
use super::outside::{self, EngineCase, ResidualFile};
use super::ranges::Ranges;
use super::rigs::{self, RigCase};
use super::schema::SECTIONS;
use super::{foreign, stressed};
use crate::Bank;
use seed::Seed;
use serde::Deserialize;
use settings::{Document, Resolved, SettingsError};
use std::path::Path;
use truth::Sampling;

/// Trials as configured: how many cases of which bank, from which systems.
#[derive(Debug, Clone)]
pub struct TrialPlan {
    /// Start of the run folder's name.
    pub name: String,
    /// Root of every random draw.
    pub seed: u64,
    /// Every value in force.
    pub resolved: Resolved,
    pub(crate) ranges: Ranges,
    pub(crate) sampling: Sampling,
    pub(crate) detectabilities: Vec<f64>,
    pub(crate) residuals: Vec<ResidualFile>,
    pub(crate) engine: Vec<EngineCase>,
    pub(crate) rigs: Vec<RigCase>,
    /// Every case, in an order that tells nothing.
    jobs: Vec<Job>,
    left_out_banks: Vec<LeftOutBank>,
}

/// A bank that was asked for and cannot be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOutBank {
    /// The bank.
    pub bank: Bank,
    /// How many cases were asked for.
    pub cases: usize,
    /// Why it is left out, and what to do.
    pub reason: String,
}

#[derive(Deserialize)]
struct Top {
    name: String,
    seed: u64,
}

#[derive(Deserialize)]
struct TrialKeys {
    none: usize,
    calibration: usize,
    single: usize,
    pair: usize,
    left_out: usize,
    foreign: usize,
    releases: usize,
    driven: usize,
    stressed: usize,
    measured_cases: usize,
    engine_cases: usize,
    composite: usize,
    rigs_cases: usize,
    rigs: Option<String>,
    measured: Option<String>,
    engine: Option<String>,
    detectabilities: Vec<f64>,
}

#[derive(Deserialize)]
struct RecordKeys {
    rate_hz: f64,
    seconds: f64,
    smallest_release_deg: f64,
    largest_release_deg: f64,
}

#[derive(Deserialize)]
struct SystemKeys {
    lowest_frequency_hz: f64,
    highest_frequency_hz: f64,
    smallest_damping_ratio: f64,
    largest_damping_ratio: f64,
}

#[derive(Deserialize)]
struct SensorKeys {
    smallest_noise: f64,
    largest_noise: f64,
}

/// Decimals of a file: microseconds, and far below any sensor's noise.
const STAMP_DECIMALS: u8 = 6;
const VALUE_DECIMALS: u8 = 9;

impl TrialPlan {
    /// Checks a document, overrides applied, and looks into the folders that it names.
    ///
    /// A bank from outside whose folder is not there, or holds nothing, is left out:
    /// [`TrialPlan::left_out_banks`] says so.
    ///
    /// # Errors
    /// [`SettingsError`], with file, line and column or the override that caused it.
    pub fn resolve(document: &Document) -> Result<Self, SettingsError> {
        let resolved = Resolved::new(document, SECTIONS)?;
        let top: Top = resolved.section("")?;
        let trials: TrialKeys = resolved.section("trials")?;
        let record: RecordKeys = resolved.section("record")?;
        let system: SystemKeys = resolved.section("system")?;
        let sensor: SensorKeys = resolved.section("sensor")?;
        let ranges = ranges(document, &record, &system, &sensor)?;
        let sampling = Sampling {
            rate_hz: record.rate_hz,
            samples: (record.rate_hz * record.seconds).round() as usize,
            first_stamp_s: 0.0,
            stamp_decimals: STAMP_DECIMALS,
            value_decimals: VALUE_DECIMALS,
        };
        let mut left_out_banks = Vec::new();
        let residuals = available(
            Bank::Measured,
            trials.measured_cases,
            trials.measured.as_deref(),
            "trials.measured",
            outside::residual_files,
            &mut left_out_banks,
        );
        let engine = available(
            Bank::Engine,
            trials.engine_cases,
            trials.engine.as_deref(),
            "trials.engine",
            outside::engine_cases,
            &mut left_out_banks,
        );
        let rigs = available(
            Bank::Rigs,
            trials.rigs_cases,
            trials.rigs.as_deref(),
            "trials.rigs",
            rigs::rig_cases,
            &mut left_out_banks,
        );
        let measured = if residuals.is_empty() { 0 } else { trials.measured_cases };
        let counts = [
            (Bank::None, trials.none),
            (Bank::Calibration, trials.calibration),
            (Bank::Single, trials.single),
            (Bank::Pair, trials.pair),
            (Bank::LeftOut, trials.left_out),
            (Bank::Foreign, trials.foreign),
            (Bank::Releases, trials.releases),
            (Bank::Driven, trials.driven),
            (Bank::Stressed, trials.stressed),
            (Bank::Measured, measured),
            (Bank::Engine, trials.engine_cases.min(engine.len())),
            (Bank::Composite, trials.composite),
            (Bank::Rigs, trials.rigs_cases.min(rigs.len())),
        ];
        let jobs =
            counts.iter().flat_map(|&(bank, count)| (0..count).map(move |number| Job { bank, number }));
        Ok(Self {
            jobs: shuffled(jobs.collect(), top.seed),
            name: top.name,
            seed: top.seed,
            ranges,
            sampling,
            detectabilities: trials.detectabilities,
            residuals,
            engine,
            rigs,
            left_out_banks,
            resolved,
        })
    }

    /// Number of cases.
    #[must_use]
    pub fn len(&self) -> usize {
        self.jobs.len()
    }

    /// Whether there are no cases.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.jobs.is_empty()
    }

    /// Banks that were asked for and cannot be made, because what comes from outside is not there. Whoever
    /// runs the trials says so.
    #[must_use]
    pub fn left_out_banks(&self) -> &[LeftOutBank] {
        &self.left_out_banks
    }

    /// The case with a number from 0. It depends on the seed and on its bank and number there alone, and on
    /// no other case.
    ///
    /// # Errors
    /// [`TrialError`]: a number beyond [`TrialPlan::len`]; systems, lengths and detectabilities that do not
    /// go together; files from outside that cannot be read.
    pub fn case(&self, index: usize) -> Result<Case, TrialError> {
        let job = self.jobs.get(index).ok_or(TrialError::NoSuchCase { index, cases: self.len() })?;
        job.make(self, id(index))
    }

    #[cfg(test)]
    pub(crate) fn job(&self, index: usize) -> Option<Job> {
        self.jobs.get(index).copied()
    }

    /// What a bank's case of a number hides, in turn: so many rounds of everything, with a detectability each.
    pub(crate) fn turn(&self, number: usize, among: usize) -> (usize, f64) {
        let rounds = self.detectabilities.len().max(1);
        let wanted = self.detectabilities.get(number / among.max(1) % rounds).copied().unwrap_or_default();
        (number % among.max(1), wanted)
    }

    /// How many different things a bank hides, each at every detectability in turn.
    #[must_use]
    pub fn variety(bank: Bank) -> usize {
        match bank {
            Bank::None | Bank::Calibration | Bank::Engine | Bank::Composite | Bank::Rigs => 1,
            Bank::Single => SINGLE.len(),
            Bank::Pair => PAIRS.len(),
            Bank::LeftOut => UNNAMED.len(),
            Bank::Foreign => foreign::KINDS.len(),
            Bank::Releases => RELEASES.len(),
            Bank::Measured => RESIDUALS.len(),
            Bank::Driven => INPUTS.len(),
            Bank::Stressed => stressed::EFFECTS.len(),
        }
    }
}

/// The ranges that systems are drawn from, each with its ends in order.
fn ranges(
    document: &Document,
    record: &RecordKeys,
    system: &SystemKeys,
    sensor: &SensorKeys,
) -> Result<Ranges, SettingsError> {
    let ordered = |low: (&str, f64), high: (&str, f64)| {
        if low.1 <= high.1 {
            return Ok([low.1, high.1]);
        }
        let origin = |key: &str| document.get(key).map(|leaf| leaf.origin.clone());
        let origin = origin(low.0).or_else(|| origin(high.0)).unwrap_or(settings::Origin::Default);
        Err(SettingsError::BadValue {
            origin,
            key: low.0.to_owned(),
            found: low.1.to_string(),
            expected: format!("at most {}, which is {}", high.0, high.1),
            unit: String::new(),
        })
    };
    Ok(Ranges {
        frequency_hz: ordered(
            ("system.lowest_frequency_hz", system.lowest_frequency_hz),
            ("system.highest_frequency_hz", system.highest_frequency_hz),
        )?,
        damping_ratio: ordered(
            ("system.smallest_damping_ratio", system.smallest_damping_ratio),
            ("system.largest_damping_ratio", system.largest_damping_ratio),
        )?,
        release_deg: ordered(
            ("record.smallest_release_deg", record.smallest_release_deg),
            ("record.largest_release_deg", record.largest_release_deg),
        )?,
        noise: ordered(
            ("sensor.smallest_noise", sensor.smallest_noise),
            ("sensor.largest_noise", sensor.largest_noise),
        )?,
    })
}

/// The name of a case's folder. Numbers are dealt to banks by a shuffle: they betray nothing.
fn id(index: usize) -> String {
    format!("{index:06}")
}

/// Fisher and Yates's shuffle.
fn shuffled(mut jobs: Vec<Job>, seed: u64) -> Vec<Job> {
    let mut draws = Draws::new(&Seed::new(seed).child("trials").child("order"));
    for last in (1..jobs.len()).rev() {
        jobs.swap(last, draws.below(last + 1));
    }
    jobs
}

/// What a folder named in the configuration holds; nothing, with the reason on the list, where there is none.
fn available<T>(
    bank: Bank,
    cases: usize,
    folder: Option<&str>,
    key: &str,
    list: impl Fn(&Path) -> Result<Vec<T>, String>,
    left_out: &mut Vec<LeftOutBank>,
) -> Vec<T> {
    if cases == 0 {
        return Vec::new();
    }
    let found = match folder {
        None => Err(format!("`{key}` names no folder")),
        Some(folder) => list(Path::new(folder)).map_err(|problem| format!("{folder}: {problem}")),
    };
    found.unwrap_or_else(|reason| {
        left_out.push(LeftOutBank { bank, cases, reason });
        Vec::new()
    })
}
