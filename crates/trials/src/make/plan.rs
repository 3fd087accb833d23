//! Trial plans: the configured trials, and the assignment of numbers to cases.

use super::draws::Draws;
use super::error::TrialError;
use super::folders::{OutsideCase, ResidualFile, engine_cases, residual_files, rig_cases};
use super::job::Job;
use super::pairs::PAIRS;
use super::ranges::Ranges;
use super::schema::SECTIONS;
use super::unlisted;
use crate::Bank;
use crate::effects::hidden_in;
use seed::Seed;
use serde::Deserialize;
use settings::{Document, Resolved, SettingsError};
use std::path::Path;
use truth::Sampling;

/// Configured trials: number of cases of each bank, and the ranges of their systems.
#[derive(Debug, Clone)]
pub struct TrialPlan {
    /// Prefix of the run folder's name.
    pub name: String,
    /// Root seed of every random draw.
    pub seed: u64,
    /// All configuration values in force, defaults included.
    pub resolved: Resolved,
    pub(crate) ranges: Ranges,
    pub(crate) sampling: Sampling,
    pub(crate) detectabilities: Vec<f64>,
    pub(crate) residuals: Vec<ResidualFile>,
    pub(crate) engine: Vec<OutsideCase>,
    pub(crate) rigs: Vec<OutsideCase>,
    /// All cases, in an order that reveals nothing.
    jobs: Vec<Job>,
    left_out_banks: Vec<LeftOutBank>,
}

/// Bank that was requested but cannot be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOutBank {
    /// The bank.
    pub bank: Bank,
    /// Number of requested cases.
    pub cases: usize,
    /// Reason for leaving it out, and the remedy.
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

/// Decimals of a file: microseconds for timestamps, and a resolution far below any sensor's noise for values.
const STAMP_DECIMALS: u8 = 6;
const VALUE_DECIMALS: u8 = 9;

impl TrialPlan {
    /// Checks a document, with overrides applied, and looks into the folders that it names.
    ///
    /// An external bank whose folder is missing or empty is left out; [`TrialPlan::left_out_banks`] lists it.
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
        let measured = (Bank::Measured, trials.measured_cases, "trials.measured", &trials.measured);
        let residuals = available(measured, residual_files, &mut left_out_banks);
        let engine = (Bank::Engine, trials.engine_cases, "trials.engine", &trials.engine);
        let engine = available(engine, engine_cases, &mut left_out_banks);
        let rigs = (Bank::Rigs, trials.rigs_cases, "trials.rigs", &trials.rigs);
        let rigs = available(rigs, rig_cases, &mut left_out_banks);
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
            (Bank::Measured, if residuals.is_empty() { 0 } else { trials.measured_cases }),
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

    /// Returns the number of cases.
    #[must_use]
    pub fn len(&self) -> usize {
        self.jobs.len()
    }

    /// Returns `true` if there are no cases.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.jobs.is_empty()
    }

    /// Returns the banks that were requested but cannot be made because their external files are missing.
    /// Whoever runs the trials should report them.
    #[must_use]
    pub fn left_out_banks(&self) -> &[LeftOutBank] {
        &self.left_out_banks
    }

    /// Returns the job with a number from 0.
    pub(crate) fn job(&self, index: usize) -> Result<Job, TrialError> {
        self.jobs.get(index).copied().ok_or(TrialError::NoSuchCase { index, cases: self.len() })
    }

    /// Returns what the case with a number in its bank hides, and its detectability: each round goes through
    /// everything once, with one detectability per round.
    ///
    /// # Errors
    /// [`TrialError::NothingInTurn`] if there is nothing to hide, or no detectability.
    pub(crate) fn turn<T: Copy>(&self, number: usize, among: &[T]) -> Result<(T, f64), TrialError> {
        let [kinds, sizes] = [among.len(), self.detectabilities.len()];
        let (round, at) = (number.checked_div(kinds), number.checked_rem(kinds));
        let kind = at.and_then(|at| among.get(at).copied());
        let size = round.and_then(|round| self.detectabilities.get(round.checked_rem(sizes)?).copied());
        kind.zip(size).ok_or(TrialError::NothingInTurn { kinds, sizes })
    }

    /// Returns the number of different things that a bank hides, each at every detectability in turn.
    #[must_use]
    pub fn variety(bank: Bank) -> usize {
        match bank {
            Bank::None | Bank::Calibration | Bank::Engine | Bank::Composite | Bank::Rigs => 1,
            Bank::Pair => PAIRS.len(),
            Bank::Foreign => unlisted::alone().len(),
            Bank::Single
            | Bank::LeftOut
            | Bank::Releases
            | Bank::Measured
            | Bank::Driven
            | Bank::Stressed => hidden_in(bank).len(),
        }
    }
}

/// Returns the ranges that systems are drawn from, each with its endpoints in order.
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

/// Shuffles the jobs (Fisher–Yates).
fn shuffled(mut jobs: Vec<Job>, seed: u64) -> Vec<Job> {
    let mut draws = Draws::new(&Seed::new(seed).child("trials").child("order"));
    for last in (1..jobs.len()).rev() {
        jobs.swap(last, draws.below(last + 1));
    }
    jobs
}

/// Lists the contents of a folder named in the configuration. If there are none, it returns an empty list and
/// adds the reason to `left_out`. The tuple holds the bank, the number of its cases, the key that names the
/// folder, and the key's value.
fn available<T>(
    (bank, cases, key, folder): (Bank, usize, &str, &Option<String>),
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
