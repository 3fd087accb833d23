//! Two tanks in cascade, with overflow.

use super::law::{Guess, Law, State};
use crate::data::{DataSet, Trajectory};
use crate::learners::library::weighted;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Levels y of the lower tank, which is observed, and x of the upper one, in units in which both tanks hold the
/// same volume: ẋ = p·u − q₁(x) − w, ẏ = q₁(x) + s·w − q₂(y). The outflows are q = k·√level + l·level: Torricelli's law
/// and a loss in the outlet. The upper level stays below its rim; what the pump delivers beyond that, w, leaves
/// it, and the share s of it falls into the lower tank, whose level stays below its own rim.
///
/// Schoukens, Mattsson, Wigren, Noël, Cascaded tanks benchmark combining soft and hard nonlinearities, Workshop
/// on Nonlinear System Identification Benchmarks (2016).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct TwoTanks {}

/// Rims of the upper tank that a search starts from, in mean levels of the lower one.
const RIMS: [f64; 7] = [0.5, 0.7, 1.0, 1.4, 1.8, 2.4, 3.6];

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
        [
            ("pump", format!("{unit}/s per unit of u")),
            ("upper.root", per_root.clone()),
            ("upper.linear", "1/s".to_owned()),
            ("lower.root", per_root),
            ("lower.linear", "1/s".to_owned()),
            ("upper.rim", unit.to_owned()),
            ("overflow.share", String::new()),
            ("lower.rim", unit.to_owned()),
        ]
        .map(|(name, unit)| (name.to_owned(), unit))
        .to_vec()
    }

    /// Returns tanks whose time constant is that of the typical period, with the upper rim at several heights.
    fn guesses(&self, data: &DataSet) -> Vec<Guess> {
        // Without an input no tank is filled.
        let input = mean(&data.train, |part| part.input().unwrap_or_default().to_vec());
        let level = mean(&data.train, |part| part.values().to_vec());
        let most = data.train.iter().flat_map(|part| part.values().iter().copied()).fold(0.0, f64::max);
        if !(data.is_driven() && input > 0.0 && level > 0.0) {
            return Vec::new();
        }
        let rate = TAU / data.period_s;
        let guess = |rim: f64| {
            let outflow = rate * level.sqrt();
            let parameters = vec![rate * level / input, outflow, 0.0, outflow, 0.0, rim * level, 0.5, most];
            let sizes = vec![rate * level / input, outflow, rate, outflow, rate, level, 1.0, level];
            Guess { parameters, sizes, hidden: level, first: vec![0, 1, 3] }
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
        let [pump, by_root, linear, lower_root, lower_linear, rim, share, lower_rim] = parameters else {
            return [f64::NAN; 3];
        };
        let (inflow, outflow) = (pump * input, by_root * root(upper) + linear * upper);
        let over = if upper >= *rim { (inflow - outflow).max(0.0) } else { 0.0 };
        let net = outflow + share * over - lower_root * root(lower) - lower_linear * lower;
        let is_full = lower >= *lower_rim && net > 0.0;
        [if is_full { 0.0 } else { net }, inflow - outflow - over, 0.0]
    }

    fn limited(&self, parameters: &[f64], [lower, upper, rest]: State) -> State {
        let [.., rim, _, lower_rim] = parameters else { return [f64::NAN; 3] };
        [lower.min(*lower_rim).max(0.0), upper.min(*rim).max(0.0), rest]
    }

    fn hidden(&self, [_, upper, _]: State) -> f64 {
        upper
    }

    fn equation(&self, parameters: &[f64]) -> String {
        let [pump, by_root, linear, lower_root, lower_linear, rim, share, lower_rim] = parameters else {
            return String::new();
        };
        let upper = weighted(&[(*by_root, "*sqrt(upper)"), (*linear, "*upper")]);
        let lower = weighted(&[(-lower_root, "*sqrt(lower)"), (-lower_linear, "*lower")]);
        format!(
            "upper_dot = {pump:.5}*u - q - w, lower_dot = q + {share:.4}*w +{lower}, q ={upper}, w = overflow; \
             upper < {rim:.4}, lower < {lower_rim:.4}"
        )
    }
}
