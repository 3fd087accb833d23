//! Data sets: split trajectories with scales computed from the training part only.

use super::period::{noise_floor, period};
use super::split::split;
use super::{Parts, Split, Trajectory, local_states};
use crate::LearnError;
use dynamics::{Hold, NominalSimulator};
use serde::{Deserialize, Serialize};

/// Means and spreads of the models' inputs and outputs, from the training part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scale {
    /// Mean position.
    pub center: f64,
    /// Standard deviation of the position.
    pub position: f64,
    /// Root mean square of the velocity.
    pub velocity: f64,
    /// Mean input; 0 without an input.
    pub input_center: f64,
    /// Standard deviation of the input; 1 without an input.
    pub input: f64,
    /// Root mean square of the acceleration.
    pub acceleration: f64,
}

/// Training, validation and test trajectories of one system.
#[derive(Debug, Clone)]
pub struct DataSet {
    /// Part that models are fitted to.
    pub train: Vec<Trajectory>,
    /// Part that chooses among models; it never scores them.
    pub validation: Vec<Trajectory>,
    /// Part that only scores models.
    pub test: Vec<Trajectory>,
    /// Unit of the positions.
    pub unit: String,
    /// Nominal simulator of the system; `None` if there is none.
    pub nominal: Option<NominalSimulator>,
    /// Interpolation of the input between samples.
    pub hold: Hold,
    /// Length of the past that a model gets at the start of a stretch, in seconds.
    pub warm_up_s: f64,
    /// Typical period of the motion, in seconds.
    pub period_s: f64,
    /// Standard deviation of the sensor's white noise, in the unit of the positions.
    pub noise: f64,
    /// Scales of the training part.
    pub scale: Scale,
}

/// Options for making a data set.
#[derive(Debug, Clone)]
pub struct Making {
    /// Split into training, validation and test part.
    pub split: Split,
    /// Unit of the positions.
    pub unit: String,
    /// Nominal simulator of the system; `None` if there is none.
    pub nominal: Option<NominalSimulator>,
    /// Interpolation of the input between samples; `None` means zero-order hold here, but see
    /// [`crate::data_set`].
    pub hold: Option<Hold>,
    /// Length of the past given to a model, in seconds; `None` means one period.
    pub warm_up_s: Option<f64>,
    /// Typical period in seconds; `None` means estimated from the training part.
    pub period_s: Option<f64>,
    /// Standard deviation of the sensor noise, in the unit of the positions; `None` means estimated from the
    /// training part.
    pub noise: Option<f64>,
}

/// Fewest samples of a past.
pub const LEAST_PAST: usize = 5;

/// Largest ratio of sample rates within a set.
const RATES: f64 = 1.05;

impl DataSet {
    /// Checks and splits records.
    ///
    /// # Errors
    /// [`LearnError`] for a set that cannot be learned from or scored on; the message states the remedy.
    pub fn new(records: &[Trajectory], making: Making) -> Result<Self, LearnError> {
        Self::of_parts(split(records, &making.split)?, making)
    }

    /// Checks parts that are stated, rather than split as `making.split` says.
    ///
    /// # Errors
    /// As [`Self::new`]; [`LearnError::NoPart`] if there is no part to train on, to validate with, or to test on.
    pub fn of_parts(parts: Parts, making: Making) -> Result<Self, LearnError> {
        let uses = [("training", &parts.train), ("validation", &parts.validation), ("test", &parts.test)];
        if let Some((part, _)) = uses.into_iter().find(|(_, own)| own.is_empty()) {
            return Err(LearnError::NoPart { part });
        }
        let all = [parts.train.as_slice(), &parts.validation, &parts.test].concat();
        check_inputs(&all)?;
        check_rates(&all)?;
        let period_s = match making.period_s {
            Some(period) => period,
            None => period(&parts.train).ok_or(LearnError::NoPeriod)?,
        };
        let warm_up_s = making.warm_up_s.unwrap_or(period_s);
        for part in parts.train.iter().chain(&parts.validation).chain(&parts.test) {
            let needed = ((3.0 * warm_up_s * part.rate_hz()).ceil() as usize).max(24);
            if part.len() < needed {
                let record = part.name().to_owned();
                return Err(LearnError::TooShort { record, samples: part.len(), needed, warm_up_s });
            }
        }
        let noise = making.noise.unwrap_or_else(|| noise_floor(&parts.train));
        let scale = scale(&parts.train, period_s);
        Ok(Self {
            train: parts.train,
            validation: parts.validation,
            test: parts.test,
            unit: making.unit,
            nominal: making.nominal,
            hold: making.hold.unwrap_or(Hold::Zero),
            warm_up_s,
            period_s,
            noise,
            scale,
        })
    }

    /// Returns `true` if the records have an input.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        self.train.iter().any(|part| part.input().is_some())
    }

    /// Returns the same set without its test part, as learners get it.
    #[must_use]
    pub fn without_test(&self) -> Self {
        Self { test: Vec::new(), ..self.clone() }
    }

    /// Returns the number of samples at the start of a part from which a model predicts the rest.
    #[must_use]
    pub fn warm_up_samples(&self, part: &Trajectory) -> usize {
        let most = part.len().saturating_sub(1).max(LEAST_PAST);
        part.samples_within(self.warm_up_s).clamp(LEAST_PAST, most)
    }

    /// Returns the number of samples in the training part.
    #[must_use]
    pub fn training_samples(&self) -> usize {
        self.train.iter().map(Trajectory::len).sum()
    }

    /// Returns the longest integration step, in seconds: a sixtieth of a period.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        self.period_s / 60.0
    }

    /// Cuts the training part into pieces of about `seconds`. If they have more than `samples` samples in
    /// total, evenly chosen pieces are kept.
    #[must_use]
    pub fn training_pieces(&self, seconds: f64, samples: usize) -> Vec<Trajectory> {
        let pieces: Vec<Trajectory> = self.train.iter().flat_map(|part| part.pieces(seconds)).collect();
        let all: usize = pieces.iter().map(Trajectory::len).sum();
        let keep = (samples as f64 / all.max(1) as f64).min(1.0);
        // Piece number n is kept if n·keep passes the next whole number there.
        let taken = |number: usize| ((number + 1) as f64 * keep).floor() > (number as f64 * keep).floor();
        let chosen: Vec<Trajectory> = pieces
            .iter()
            .enumerate()
            .filter(|(number, _)| keep >= 1.0 || taken(*number))
            .map(|(_, piece)| piece.clone())
            .collect();
        if chosen.is_empty() {
            let shortened = |piece: &Trajectory| piece.part(0, samples.max(8));
            return pieces.first().map(shortened).into_iter().collect();
        }
        chosen
    }
}

fn check_inputs(records: &[Trajectory]) -> Result<(), LearnError> {
    let with = records.iter().find(|record| record.input().is_some());
    let without = records.iter().find(|record| record.input().is_none());
    match with.zip(without) {
        None => Ok(()),
        Some((with, without)) => {
            Err(LearnError::MissingInput { without: without.name().to_owned(), with: with.name().to_owned() })
        }
    }
}

fn check_rates(records: &[Trajectory]) -> Result<(), LearnError> {
    let by_rate = |a: &&Trajectory, b: &&Trajectory| a.rate_hz().total_cmp(&b.rate_hz());
    let (slow, fast) = (records.iter().min_by(by_rate), records.iter().max_by(by_rate));
    match slow.zip(fast) {
        Some((slow, fast)) if fast.rate_hz() > RATES * slow.rate_hz() => Err(LearnError::MixedRates {
            slow: slow.name().to_owned(),
            slow_hz: slow.rate_hz(),
            fast: fast.name().to_owned(),
            fast_hz: fast.rate_hz(),
        }),
        _ => Ok(()),
    }
}

fn scale(train: &[Trajectory], period_s: f64) -> Scale {
    let values = || train.iter().flat_map(|part| part.values().iter().copied());
    let inputs = || train.iter().filter_map(Trajectory::input).flatten().copied();
    let (center, position) = moments(values);
    let (input_center, input) = moments(inputs);
    let states: Vec<_> = train.iter().flat_map(|part| local_states(part, period_s / 8.0)).collect();
    let rms = |of: &dyn Fn(&super::LocalState) -> f64| {
        let sum: f64 = states.iter().map(|state| of(state).powi(2)).sum();
        (sum / states.len().max(1) as f64).sqrt().max(f64::MIN_POSITIVE)
    };
    Scale {
        center,
        position: position.max(f64::MIN_POSITIVE),
        velocity: rms(&|state| state.velocity),
        input_center: if input > 0.0 { input_center } else { 0.0 },
        input: if input > 0.0 { input } else { 1.0 },
        acceleration: rms(&|state| state.acceleration),
    }
}

/// Returns mean and standard deviation.
fn moments<I: Iterator<Item = f64>>(values: impl Fn() -> I) -> (f64, f64) {
    let count = values().count().max(1) as f64;
    let mean = values().sum::<f64>() / count;
    let square = values().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    (mean, square.sqrt())
}
