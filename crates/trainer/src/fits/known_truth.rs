//! Known truth of a simulated record, if a file beside it states one: `NAME.truth.toml` for `NAME.csv`.
//!
//! It is only compared with the answer; no pipeline and no method sees it.

use crate::configured::read_document;
use crate::error::TrainerError;
use crate::fits::input::Input;
use dynamics::reference::{Tolerance, simulate};
use envelope::{Envelope, RatioDefinition, RecommendedPipeline};
use oracle::decay_rate;
use record::{Clock, ClockChoice, Quantity, Record};
use results::TruthComparison;
use serde::Deserialize;
use settings::{Default, Field, Kind, Resolved, Section};
use simulator::Plan;
use std::path::{Path, PathBuf};

const POSITIVE: Kind = Kind::Float { min: f64::MIN_POSITIVE, max: f64::MAX };

/// Keys of the file.
const TRUTH: Section<'static> = Section {
    name: "",
    fields: &[
        Field::new("record", Kind::Text, Default::Required).meaning("Digest of the record file."),
        Field::new("simulation", Kind::Path, Default::Absent)
            .meaning("The configuration that `trainer simulate` made the record with."),
        Field::new("natural_frequency_rad_s", POSITIVE, Default::Absent)
            .unit("rad/s")
            .meaning("Undamped angular frequency."),
        Field::new("damping_ratio", POSITIVE, Default::Absent)
            .meaning("Damping ratio of a decay that is exponential."),
    ],
};

#[derive(Deserialize)]
struct Keys {
    record: String,
    simulation: Option<String>,
    natural_frequency_rad_s: Option<f64>,
    damping_ratio: Option<f64>,
}

/// Truth, as far as it is stated.
struct Known {
    omega_rad_s: Option<f64>,
    zeta: Option<f64>,
    meaning: String,
}

/// Answer that is compared with the truth.
pub(crate) struct Answer {
    pub(crate) zeta: f64,
    pub(crate) zeta_std_error: Option<f64>,
}

/// Compares an answer with the truth in the file beside a record; `None` if there is no such file.
///
/// # Errors
/// A file that cannot be read or belongs to another record, or a simulation that fails.
pub(crate) fn compare(input: &Input, answer: &Answer) -> Result<Option<TruthComparison>, TrainerError> {
    let path = beside(Path::new(&input.source.path));
    if !path.is_file() {
        return Ok(None);
    }
    let document = read_document(&path, &[], None)?;
    let keys: Keys = Resolved::new(&document, &[TRUTH])?.section("")?;
    if keys.record != input.source.digest {
        return Err(TrainerError::OtherTruth {
            file: path.display().to_string(),
            record: input.source.path.clone(),
            stated: keys.record,
            found: input.source.digest.clone(),
        });
    }
    let known = known(keys, input)?;
    let omega = input.extraction.envelope.omega_rad_s();
    let percent = |found: f64, truth: f64| 100.0 * (found / truth - 1.0);
    Ok(Some(TruthComparison {
        file: path.display().to_string(),
        meaning: known.meaning,
        omega_rad_s: known.omega_rad_s,
        omega_off_percent: known.omega_rad_s.map(|truth| percent(omega, truth)),
        zeta: known.zeta,
        zeta_off_percent: known.zeta.map(|truth| percent(answer.zeta, truth)),
        zeta_off_std_errors: known
            .zeta
            .zip(answer.zeta_std_error)
            .map(|(truth, error)| (answer.zeta - truth) / error)
            .filter(|off| off.is_finite()),
    }))
}

fn beside(record: &Path) -> PathBuf {
    record.with_extension("truth.toml")
}

fn known(keys: Keys, input: &Input) -> Result<Known, TrainerError> {
    let Some(simulation) = keys.simulation else {
        return Ok(Known {
            omega_rad_s: keys.natural_frequency_rad_s,
            zeta: keys.damping_ratio,
            meaning: "as stated for the record".to_owned(),
        });
    };
    let plan = Plan::resolve(&read_document(Path::new(&simulation), &[], None)?)?;
    let refused =
        |source| TrainerError::Generation { file: simulation.clone(), system: 0, record: 0, source };
    let drawn = plan.draw(0).map_err(refused)?;
    let Some(truth) = drawn.truths.first() else {
        return Err(refused(simulator::GenerationError::NoSuchRecord { record: 0 }));
    };
    let nominal = truth.system.nominal();
    let omega = (nominal.stiffness() / nominal.inertia()).sqrt();
    let is_free = truth.excitation.is_none() && input.record.quantity() == Quantity::Position;
    let times: Vec<f64> =
        (0..truth.sampling.samples).map(|index| index as f64 / truth.sampling.rate_hz).collect();
    let motion = simulate(&truth.system, truth.start, None, &times, &Tolerance::default())
        .map_err(|error| refused(error.into()))?;
    let zeta = if is_free { equivalent(input, times, motion.position) } else { None };
    Ok(Known {
        omega_rad_s: Some(omega).filter(|omega| *omega > 0.0),
        zeta,
        meaning: format!(
            "ω is √(k/I); ζ is that of the best exponential through the noise-free motion over the same stretch, simulated \
             from {simulation}"
        ),
    })
}

/// Computes the damping ratio of the least-squares line through the turning points of a noise-free motion,
/// over the stretch covered by the record's envelope.
fn equivalent(input: &Input, times: Vec<f64>, positions: Vec<f64>) -> Option<f64> {
    let record = Record::new(times, positions, None, Quantity::Position, input.record.unit()).ok()?;
    let clock = Clock::new(&record, ClockChoice::Host).ok()?;
    let pipeline = RecommendedPipeline::DEFAULT;
    let clean = pipeline.extract(&record, &clock).ok()?;
    // Half of a half-cycle on each side: the same turning points and no others.
    let margin = clean.period_s / 4.0;
    let first = input.extraction.first_peak_s - margin;
    let last = first + input.extraction.envelope.times_s().last()? + 2.0 * margin;
    let within = |time: f64| (first..=last).contains(&(clean.first_peak_s + time));
    let (times, logs) = clean
        .envelope
        .times_s()
        .iter()
        .zip(clean.envelope.log_amplitudes())
        .filter(|(time, _)| within(**time))
        .map(|(&time, &log)| (time, log))
        .unzip();
    let envelope = Envelope::new(times, logs, clean.envelope.omega_rad_s())
        .ok()?
        .with_ratio(RatioDefinition::LogarithmicDecrement);
    Some(decay_rate(&envelope).ok()?.zeta)
}
