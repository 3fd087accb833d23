//! Banks that need something from outside: residuals of measured records, records of a physics engine.

use super::case::{ATTEMPTS, Case, Job, Setup, described, hide};
use super::error::TrialError;
use super::hiding::RESIDUALS;
use super::plan::TrialPlan;
use super::situation::{Motions, Nuisances, Situation};
use crate::{Bank, HIDDEN_SCHEMA, Hidden};
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Coordinate, Effect, Nominal, System};
use record::{CsvColumns, Quantity, ReadOptions, Record, read_file};
use simulator::{csv_text, nominal_text};
use std::path::{Path, PathBuf};
use truth::{Draws as Branch, Sampling, TRUTH_SCHEMA, Truth};

/// A file with what a diagnosis left over of a measured record.
pub(crate) type ResidualFile = PathBuf;

/// A case that a physics engine made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct EngineCase {
    /// Folder with records and nominal.toml.
    folder: PathBuf,
    /// The hidden truth.
    hidden: PathBuf,
}

/// Entries of a folder in the order of their names.
pub(crate) fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let listing = std::fs::read_dir(folder).map_err(|error| format!("cannot be read: {error}"))?;
    let mut paths: Vec<PathBuf> = listing.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    Ok(paths)
}

pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The residual files of a folder.
pub(crate) fn residual_files(folder: &Path) -> Result<Vec<ResidualFile>, String> {
    let named = |path: &PathBuf| {
        let name = file_name(path);
        name.starts_with("residual-") && name.ends_with(".csv")
    };
    let files: Vec<ResidualFile> = entries(folder)?.into_iter().filter(named).collect();
    if files.is_empty() { Err("holds no residual-*.csv".to_owned()) } else { Ok(files) }
}

/// The cases of a folder that a physics engine's script made.
pub(crate) fn engine_cases(folder: &Path) -> Result<Vec<EngineCase>, String> {
    let cases: Vec<EngineCase> = entries(folder)?
        .into_iter()
        .map(|path| {
            let hidden = folder.join("hidden").join(format!("{}.json", file_name(&path)));
            EngineCase { folder: path, hidden }
        })
        .filter(|case| case.hidden.is_file() && case.folder.join("nominal.toml").is_file())
        .collect();
    if cases.is_empty() {
        Err("holds no folder with nominal.toml that hidden/ has a truth for".to_owned())
    } else {
        Ok(cases)
    }
}

/// A residual with its times.
struct Residual {
    stamps: Vec<f64>,
    values: Vec<f64>,
    rate_hz: f64,
    /// Standard deviation of its white part.
    white: f64,
    /// Whether samples share stamps.
    bursts: bool,
}

impl Residual {
    fn read(path: &Path) -> Result<Self, TrialError> {
        let columns = CsvColumns { value: Some("residual".to_owned()), ..CsvColumns::default() };
        let (record, _) = read_file(path, &ReadOptions { columns, ..ReadOptions::default() })?;
        let (stamps, values) = (record.stamps_s().to_vec(), record.values().to_vec());
        let refused = |problem: String, remedy| TrialError::Outside {
            path: path.display().to_string(),
            problem,
            remedy,
        };
        let (Some(first), Some(last)) = (stamps.first(), stamps.last()) else {
            return Err(refused("no samples".to_owned(), "write columns time_s and residual"));
        };
        let period = (last - first) / (stamps.len().max(2) - 1) as f64;
        if period <= 0.0 {
            return Err(refused("no time passes".to_owned(), "write times in seconds"));
        }
        let bursts = stamps.iter().zip(stamps.iter().skip(1)).any(|(one, next)| one == next);
        let off =
            stamps.iter().enumerate().map(|(index, stamp)| (stamp - first - index as f64 * period).abs());
        let off = off.fold(0.0, f64::max);
        // Bursts of a host come up to a tenth of a second apart.
        if off > 0.1_f64.max(3.0 * period) {
            let problem = format!("stamps are up to {off:.3} s off a uniform rate: samples are missing");
            return Err(refused(problem, "write a stretch without gaps"));
        }
        let second = values.windows(3).map(|three| match three {
            [before, now, after] => (before - 2.0 * now + after).powi(2),
            _ => 0.0,
        });
        let white = (second.sum::<f64>() / (6.0 * values.len().max(3) as f64)).sqrt();
        if white == 0.0 {
            return Err(refused("it is smooth: no noise".to_owned(), "write what a fit left over"));
        }
        Ok(Self { rate_hz: 1.0 / period, white, bursts, stamps, values })
    }
}

/// An effect's simulated record with a measured record's residual on top.
///
/// Noise, rounding and stamps are the residual's: nothing is drawn of them. Its size is in units of the
/// residual's white part, from second differences. The samples are taken at a uniform rate, by their index.
pub(crate) fn measured_case(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let (at, wanted) = plan.turn(job.number, RESIDUALS.len());
    let effect = RESIDUALS.get(at).copied().unwrap_or_default();
    let path = plan.residuals.get(job.number % plan.residuals.len().max(1));
    let Some(path) = path else {
        return Err(TrialError::NoSuchCase { index: job.number, cases: 0 });
    };
    let residual = Residual::read(path)?;
    let sampling = Sampling { rate_hz: residual.rate_hz, samples: residual.values.len(), ..plan.sampling };
    for attempt in 0..ATTEMPTS {
        let mut setup = Setup::draw(plan, job, attempt, Motions::Release, &[effect])?;
        setup.situation = Situation { sampling, noise: residual.white, ..setup.situation };
        setup.nuisances = Nuisances::default();
        setup.white = residual.white;
        let Some(hidden) = hide(&setup, effect, wanted)? else { continue };
        return with_residual(plan, job, id, &setup, hidden, &residual, &file_name(path));
    }
    Err(TrialError::OutOfReach { effect: effect.to_owned(), wanted, attempts: ATTEMPTS })
}

fn with_residual(
    plan: &TrialPlan,
    job: Job,
    id: String,
    setup: &Setup,
    hidden: (Active, f64),
    residual: &Residual,
    name: &str,
) -> Result<Case, TrialError> {
    let situation = &setup.situation;
    let (acting, sensing) = match hidden.0.effect() {
        Effect::System(_) => (vec![hidden.0], Vec::new()),
        Effect::MeasuringChain(_) => (Vec::new(), vec![hidden.0]),
    };
    let silent = Chain::new(Observed::Position, 0.0, sensing.clone())?;
    let sampling = situation.sampling;
    let mut records = Vec::new();
    let mut truths = Vec::new();
    for (motion, &start) in situation.motions(&acting)?.iter().zip(&situation.starts) {
        let unused = |id: &'static str| setup.seed.child(id).generator();
        let samples = silent.observe(&motion.sampled(), Coordinate::Angle, unused)?;
        let values = samples.values.iter().zip(&residual.values).map(|(value, rest)| value + rest).collect();
        let record = Record::new(residual.stamps.clone(), values, None, Quantity::Position, "rad")?;
        records.push(csv_text(&record, sampling.stamp_decimals, sampling.value_decimals));
        truths.push(Truth {
            schema: TRUTH_SCHEMA.to_owned(),
            system: System::new(situation.nominal, acting.clone())?,
            start,
            excitation: None,
            chain: Chain::new(Observed::Position, residual.white, sensing.clone())?,
            sampling: Sampling {
                first_stamp_s: residual.stamps.first().copied().unwrap_or_default(),
                ..sampling
            },
            draws: Branch { seed: plan.seed, branch: setup.branch.clone() },
        });
    }
    let (nominal, miscalibrated) = job.believed(plan, &situation.nominal)?;
    let bursts = residual.bursts.then(|| "timestamp_batching".to_owned());
    Ok(Case {
        id,
        without: None,
        records,
        nominal: nominal_text(&nominal),
        hidden: Hidden {
            schema: HIDDEN_SCHEMA.to_owned(),
            bank: job.bank,
            effects: described(&[hidden], "vocabulary"),
            foreign: None,
            unlisted: Vec::new(),
            allowed: Vec::new(),
            nuisances: bursts.into_iter().collect(),
            miscalibrated,
            without: None,
            noise: residual.white,
            records: truths,
            made: format!("{}; on the residual {name}; noise by second differences", job.in_words(plan.seed)),
        },
    })
}

/// A case of a physics engine, its files written anew so that their notation tells nothing.
pub(crate) fn engine_case(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let Some(case) = plan.engine.get(job.number) else {
        return Err(TrialError::NoSuchCase { index: job.number, cases: plan.engine.len() });
    };
    let refused = |path: &Path, problem: String, remedy| TrialError::Outside {
        path: path.display().to_string(),
        problem,
        remedy,
    };
    let text = |path: &Path| {
        std::fs::read_to_string(path)
            .map_err(|error| refused(path, format!("cannot be read: {error}"), "make the records again"))
    };
    let listing =
        entries(&case.folder).map_err(|problem| refused(&case.folder, problem, "make the records again"))?;
    let mut records = Vec::new();
    for path in listing {
        let name = file_name(&path);
        if name.starts_with("record-") && name.ends_with(".csv") {
            let (record, _) = read_file(&path, &ReadOptions::default())?;
            records.push(csv_text(&record, plan.sampling.stamp_decimals, plan.sampling.value_decimals));
        }
    }
    if records.is_empty() {
        let problem = "holds no record-*.csv".to_owned();
        return Err(refused(&case.folder, problem, "make the records again"));
    }
    let path = case.folder.join("nominal.toml");
    let nominal: Nominal = toml::from_str(&text(&path)?)
        .map_err(|error| refused(&path, error.message().to_owned(), "write a nominal simulator"))?;
    let mut hidden: Hidden = serde_json::from_str(&text(&case.hidden)?).map_err(|error| {
        refused(&case.hidden, error.to_string(), "write a hidden truth (ringdown.trial/1)")
    })?;
    if hidden.schema != HIDDEN_SCHEMA {
        let problem = format!("its schema is {}", hidden.schema);
        return Err(refused(&case.hidden, problem, "make the records again with this version's script"));
    }
    hidden.bank = Bank::Engine;
    Ok(Case { id, without: hidden.without.clone(), records, nominal: nominal_text(&nominal), hidden })
}
