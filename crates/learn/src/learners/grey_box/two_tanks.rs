//! Two tanks in cascade, with overflow and a sensor that reads along a curve.

use super::curve::increasing;
use super::law::{Guess, Law, State};
use crate::data::{DataSet, Trajectory};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Levels y of the lower tank and x of the upper one, in units in which both tanks hold the same volume:
/// ẋ = p·u − q₁(x) − w, ẏ = q₁(x) + s·w − q₂(y), with the outflows q = k·√level of Torricelli's law. The upper level stays
/// below its rim; what the pump delivers beyond that, w, leaves it, and the share s of it falls into the lower tank, whose
/// level stays below its own rim.
///
/// The lower level is observed by a sensor whose reading increases with it along a curve that is fitted with the tanks:
/// the levels are free at readings that divide the training samples into equal parts. The level at the highest reading
/// is that reading, which sets the unit.
///
/// Schoukens, Mattsson, Wigren, Noël, Cascaded tanks benchmark combining soft and hard nonlinearities, Workshop
/// on Nonlinear System Identification Benchmarks (2016).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct TwoTanks {
    /// Readings at which the curve's levels are free, in increasing order.
    readings: Vec<f64>,
}

/// Most pieces of the sensor's curve.
const PIECES: usize = 5;

/// Rims of the upper tank that a search starts from, in mean levels of the lower one.
const RIMS: [f64; 7] = [0.5, 0.7, 1.0, 1.4, 1.8, 2.4, 3.6];

/// Typical size of the logarithm of a step of the curve.
const BENT: f64 = 0.3;

/// Parameters as the rates need them.
struct Tanks<'a> {
    pump: f64,
    upper_root: f64,
    lower_root: f64,
    upper_rim: f64,
    share: f64,
    lower_rim: f64,
    /// Logarithms of the curve's steps of level from reading to reading.
    steps: &'a [f64],
}

/// Takes a law's parameters apart; `None` for a list that is too short.
fn tanks(parameters: &[f64]) -> Option<Tanks<'_>> {
    let &[pump, upper_root, lower_root, upper_rim, share, lower_rim, ref steps @ ..] = parameters else {
        return None;
    };
    Some(Tanks { pump, upper_root, lower_root, upper_rim, share, lower_rim, steps })
}

impl TwoTanks {
    /// Places the readings of the curve for a data set.
    pub(super) fn new(data: &DataSet) -> Self {
        let mut all: Vec<f64> = data.train.iter().flat_map(|part| part.values().iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        let (Some(low), Some(high)) = (all.first(), all.last()) else { return Self { readings: Vec::new() } };
        // Where a sensor stays at one reading, it fills several parts.
        let least = 0.1 / PIECES as f64 * (high - low);
        let last = all.len() - 1;
        let parts = (0..=PIECES).filter_map(|at| all.get(at * last / PIECES).copied());
        let mut readings: Vec<f64> = parts.collect();
        readings.dedup_by(|next, own| *next - *own <= least);
        Self { readings }
    }

    /// Returns the levels at the readings of the curve.
    fn levels(&self, steps: &[f64]) -> Vec<f64> {
        let mut level = self.readings.last().copied().unwrap_or(f64::NAN);
        let below = steps.iter().rev().map(|step| {
            level -= step.exp();
            level
        });
        let below: Vec<f64> = below.collect();
        below.into_iter().rev().chain(self.readings.last().copied()).collect()
    }
}

/// Returns the mean of values over all parts.
fn mean(parts: &[Trajectory], values: impl Fn(&Trajectory) -> Vec<f64>) -> f64 {
    let all: Vec<f64> = parts.iter().flat_map(values).collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

fn root(level: f64) -> f64 {
    level.max(0.0).sqrt()
}

impl Law for TwoTanks {
    fn states(&self) -> usize {
        2
    }

    fn names(&self, unit: &str) -> Vec<(String, String)> {
        let per_root = format!("{unit}^0.5/s");
        let tanks = [
            ("pump", format!("{unit}/s per unit of u")),
            ("upper.root", per_root.clone()),
            ("lower.root", per_root),
            ("upper.rim", unit.to_owned()),
            ("overflow.share", String::new()),
            ("lower.rim", unit.to_owned()),
        ];
        let levels = self.readings.iter().rev().skip(1).rev();
        let levels = levels.map(|reading| (format!("lower at reading {reading:.4}"), unit.to_owned()));
        tanks.into_iter().map(|(name, unit)| (name.to_owned(), unit)).chain(levels).collect()
    }

    fn stated(&self, parameters: &[f64]) -> Vec<f64> {
        let Some(Tanks { steps, .. }) = tanks(parameters) else { return Vec::new() };
        let count = parameters.len();
        let own = parameters.iter().take(count - steps.len()).copied();
        own.chain(self.levels(steps)).take(count).collect()
    }

    /// Returns tanks whose time constant is that of the typical period, with the upper rim at several heights.
    fn guesses(&self, data: &DataSet) -> Vec<Guess> {
        // Without an input no tank is filled.
        let input = mean(&data.train, |part| part.input().unwrap_or_default().to_vec());
        let level = mean(&data.train, |part| part.values().to_vec());
        let [_, .., most] = self.readings.as_slice() else { return Vec::new() };
        if !(data.is_driven() && input > 0.0 && level > 0.0) {
            return Vec::new();
        }
        let rate = TAU / data.period_s;
        let spans = || self.readings.iter().zip(self.readings.iter().skip(1));
        let guess = |rim: f64| {
            let outflow = rate * level.sqrt();
            let mut parameters = vec![rate * level / input, outflow, outflow, rim * level, 0.5, *most];
            parameters.extend(spans().map(|(low, high)| (high - low).ln()));
            let mut sizes = vec![rate * level / input, outflow, outflow, level, 1.0, level];
            sizes.extend(spans().map(|_| BENT));
            Guess { parameters, sizes, hidden: level, first: vec![0, 1, 2] }
        };
        RIMS.into_iter().map(guess).collect()
    }

    fn start(&self, piece: &Trajectory, _period_s: f64, hidden: f64) -> State {
        // A piece has samples.
        let first = piece.values().first().copied().unwrap_or_default();
        [first, hidden, 0.0]
    }

    fn sizes(&self, data: &DataSet) -> State {
        [data.scale.position, data.scale.position, 1.0]
    }

    fn rate(&self, parameters: &[f64], [lower, upper, _]: State, input: f64) -> State {
        let Some(tanks) = tanks(parameters) else { return [f64::NAN; 3] };
        let (inflow, outflow) = (tanks.pump * input, tanks.upper_root * root(upper));
        let over = if upper >= tanks.upper_rim { (inflow - outflow).max(0.0) } else { 0.0 };
        let net = outflow + tanks.share * over - tanks.lower_root * root(lower);
        let is_full = lower >= tanks.lower_rim && net > 0.0;
        [if is_full { 0.0 } else { net }, inflow - outflow - over, 0.0]
    }

    fn limited(&self, parameters: &[f64], [lower, upper, rest]: State) -> State {
        let Some(tanks) = tanks(parameters) else { return [f64::NAN; 3] };
        [lower.min(tanks.lower_rim).max(0.0), upper.min(tanks.upper_rim).max(0.0), rest]
    }

    fn observed(&self, parameters: &[f64], [lower, ..]: State) -> f64 {
        let Some(tanks) = tanks(parameters) else { return f64::NAN };
        increasing(&self.levels(tanks.steps), &self.readings, lower)
    }

    fn hidden(&self, [_, upper, _]: State) -> f64 {
        upper
    }

    fn equation(&self, parameters: &[f64]) -> String {
        let Some(Tanks { pump, upper_root, lower_root, upper_rim, share, lower_rim, steps }) =
            tanks(parameters)
        else {
            return String::new();
        };
        let points = self.readings.iter().zip(self.levels(steps));
        let curve: Vec<String> =
            points.map(|(reading, level)| format!("{reading:.4} at {level:.4}")).collect();
        let curve = curve.join(", ");
        format!(
            "upper_dot = {pump:.5}*u - q - w, lower_dot = q + {share:.4}*w - {lower_root:.5}*sqrt(lower), \
             q = {upper_root:.5}*sqrt(upper), w = overflow; upper < {upper_rim:.4}, lower < {lower_rim:.4}; \
             observed: {curve}"
        )
    }
}
