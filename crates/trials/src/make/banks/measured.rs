//! Effects in simulated records, combined with residuals that a diagnosis left of measured ones.

use crate::effects::hidden_in;
use crate::make::case::Case;
use crate::make::error::TrialError;
use crate::make::folders::file_name;
use crate::make::job::Job;
use crate::make::nuisances::{BATCHING, Nuisances};
use crate::make::plan::TrialPlan;
use crate::make::setup::{ATTEMPTS, Setup};
use crate::make::situation::{Motions, Situation};
use crate::{Bank, Hidden, HiddenEffect};
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Coordinate, Effect, System};
use record::{CsvColumns, Quantity, ReadOptions, Record, read_file};
use simulator::{csv_text, nominal_text};
use std::path::Path;
use truth::{Draws as Branch, Sampling, TRUTH_SCHEMA, Truth};

/// Residual of a measured record, with its times.
struct Residual {
    stamps: Vec<f64>,
    first_stamp: f64,
    values: Vec<f64>,
    rate_hz: f64,
    /// Standard deviation of the white part.
    white: f64,
    /// `true` if samples share timestamps.
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
        let (Some(&first), Some(&last)) = (stamps.first(), stamps.last()) else {
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
        // Bursts of a host arrive up to a tenth of a second apart.
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
        Ok(Self { rate_hz: 1.0 / period, white, bursts, first_stamp: first, stamps, values })
    }
}

/// Makes a case of the bank: an effect's simulated record plus a measured record's residual.
///
/// Noise, rounding and timestamps are those of the residual; none of them is drawn. The effect's size is in
/// units of the residual's white part, estimated from second differences. Samples are taken at a uniform
/// rate, by their index.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let (effect, wanted) = plan.turn(job.number, &hidden_in(Bank::Measured))?;
    let path = plan.residuals.get(job.number % plan.residuals.len().max(1));
    let Some(path) = path else {
        return Err(TrialError::NoSuchCase { index: job.number, cases: 0 });
    };
    let residual = Residual::read(path)?;
    let sampling = Sampling {
        rate_hz: residual.rate_hz,
        samples: residual.values.len(),
        first_stamp_s: residual.first_stamp,
        ..plan.sampling
    };
    for attempt in 0..ATTEMPTS {
        let mut setup = Setup::draw(plan, job, attempt, Motions::Release, &[effect])?;
        setup.situation = Situation { sampling, noise: residual.white, ..setup.situation };
        setup.nuisances = Nuisances::default();
        setup.white = residual.white;
        let Some(hidden) = setup.hide(effect, wanted)? else { continue };
        let (records, truths) = under(&residual, &setup, hidden.0, plan.seed)?;
        let (nominal, miscalibrated) = job.believed(plan.seed, &setup.situation.nominal, &[effect])?;
        let made = format!(
            "{}; on the residual {}; noise by second differences",
            job.in_words(plan.seed),
            file_name(path)
        );
        let hidden = Hidden {
            effects: HiddenEffect::by_the_vocabulary(&[hidden]),
            nuisances: residual.bursts.then(|| BATCHING.id().to_owned()).into_iter().collect(),
            miscalibrated,
            records: truths,
            ..Hidden::nothing(job.bank, residual.white, made)
        };
        return Ok(Case { id, without: None, records, nominal: nominal_text(&nominal), hidden });
    }
    Err(TrialError::OutOfReach { effect: effect.id().to_owned(), wanted, attempts: ATTEMPTS })
}

/// Returns the records of an effect with a residual added, as texts, and their truths.
fn under(
    residual: &Residual,
    setup: &Setup,
    hidden: Active,
    seed: u64,
) -> Result<(Vec<String>, Vec<Truth>), TrialError> {
    let situation = &setup.situation;
    let (acting, sensing) = match hidden.effect() {
        Effect::System(_) => (vec![hidden], Vec::new()),
        Effect::MeasuringChain(_) => (Vec::new(), vec![hidden]),
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
            sampling,
            draws: Branch { seed, branch: setup.branch.clone() },
        });
    }
    Ok((records, truths))
}
