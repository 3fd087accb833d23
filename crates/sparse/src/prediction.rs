//! Predictions of a law for ln A at any time.

use crate::flow::State;
use crate::law::Law;
use crate::scaled::Scaled;
use estimator::Prediction;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Predicts ln A by the law at times in seconds after the first peak, one prediction per time.
///
/// Between two peaks the prediction is the cubic with the trajectory's values and the law's rates at both.
/// After the last peak and before the first the law is integrated from the trajectory's end. At the peaks it
/// is the trajectory itself.
///
/// `instruments` Z, peaks by parameters, are the weights in the regression's condition on the residuals r:
/// Zᵀr = 0. Let J be the derivatives of the law's ln A at the peaks by its initial value and its
/// coefficients. To first order and with fixed instruments, a scatter ε moves the parameters by (ZᵀJ)⁻¹Zᵀε.
/// So ln A at a time where its derivatives are g has the variance σ²·‖Z(ZᵀJ)⁻ᵀg‖², and a measured peak there
/// has σ² more. σ² is the sum of squares over the number of peaks minus the number of parameters. Without
/// instruments, or without a degree of freedom, no standard deviation is stated.
///
/// Reference: Sargan, Econometrica 26 (1958) 393, for the covariance under instruments that are not the
/// derivatives themselves.
#[must_use]
pub(crate) fn predictions(
    law: &Law,
    scaled: &Scaled,
    instruments: Option<DMatrix<f64>>,
    times_s: &[f64],
) -> Vec<Prediction> {
    if times_s.is_empty() {
        return Vec::new();
    }
    let times: Vec<f64> = times_s.iter().map(|time| time / scaled.span_s).collect();
    let scatter = instruments.and_then(|instruments| Scatter::about(law, scaled, instruments));
    let start = State::start(law.start(), law);
    let derivatives = scatter.as_ref().map(|_| followed(law, &start, &times));
    let logs = logs(law, scaled, &times);
    let predict = |(at, log): (usize, f64)| {
        let gradient = derivatives.as_ref().and_then(|all| all.get(at));
        let variance = scatter.as_ref().zip(gradient).map(|(scatter, state)| scatter.variance(state));
        Prediction::new(log + scaled.mean, variance.map(f64::sqrt))
    };
    logs.into_iter().enumerate().map(predict).collect()
}

/// Returns x of the law's function at scaled times.
fn logs(law: &Law, scaled: &Scaled, times: &[f64]) -> Vec<f64> {
    let end = scaled.times.last().zip(law.trajectory.last()).map_or((1.0, 0.0), |(time, log)| (*time, *log));
    let start = law.start();
    let beyond = order(times, |time| time > end.0, false);
    let before = order(times, |time| time < 0.0, true);
    let mut logs: Vec<f64> = times.iter().map(|&time| within(law, scaled, time)).collect();
    for (places, from, log) in [(beyond, end.0, end.1), (before, 0.0, start)] {
        let asked: Vec<f64> = places.iter().filter_map(|&place| times.get(place).copied()).collect();
        let found = law.follow(&State::start(log, law), from, &asked);
        for (place, state) in places.iter().zip(found) {
            if let Some(log) = logs.get_mut(*place) {
                *log = state.log;
            }
        }
    }
    logs
}

/// Returns the indices of the selected times, sorted by time.
fn order(times: &[f64], asked: impl Fn(f64) -> bool, backward: bool) -> Vec<usize> {
    let mut places: Vec<(usize, f64)> =
        times.iter().copied().enumerate().filter(|(_, time)| asked(*time)).collect();
    places.sort_by(|(_, one), (_, other)| if backward { other.total_cmp(one) } else { one.total_cmp(other) });
    places.into_iter().map(|(place, _)| place).collect()
}

/// Interpolates the trajectory between the peaks.
fn within(law: &Law, scaled: &Scaled, time: f64) -> f64 {
    let after = scaled.times.partition_point(|peak| *peak <= time);
    let peak = |at: usize| scaled.times.get(at).copied().zip(law.trajectory.get(at).copied());
    let Some((from, low)) = after.checked_sub(1).and_then(peak) else { return f64::NAN };
    let Some((to, high)) = peak(after).filter(|_| time > from) else { return low };
    let step = to - from;
    let x = (time - from) / step;
    let (near, far) = (1.0 - x, x);
    let slopes = near * law.rate(low, from) - far * law.rate(high, to);
    (1.0 + 2.0 * far) * near * near * low + (1.0 + 2.0 * near) * far * far * high + step * near * far * slopes
}

/// Follows the law from its start to scaled times in any order, forward and backward.
fn followed(law: &Law, start: &State, times: &[f64]) -> Vec<State> {
    let mut found = vec![start.clone(); times.len()];
    for places in [order(times, |time| time >= 0.0, false), order(times, |time| time < 0.0, true)] {
        let asked: Vec<f64> = places.iter().filter_map(|&place| times.get(place).copied()).collect();
        for (place, state) in places.iter().zip(law.follow(start, 0.0, &asked)) {
            if let Some(entry) = found.get_mut(*place) {
                *entry = state;
            }
        }
    }
    found
}

/// Effect of the scatter of the peaks on a law.
struct Scatter {
    variance: f64,
    instruments: DMatrix<f64>,
    /// LU factors of JᵀZ.
    factor: LU<f64, Dyn, Dyn>,
}

impl Scatter {
    fn about(law: &Law, scaled: &Scaled, instruments: DMatrix<f64>) -> Option<Self> {
        let degrees = scaled.peaks().checked_sub(law.parameters()).filter(|degrees| *degrees > 0)?;
        let start = State::start(law.start(), law);
        let states = law.follow(&start, 0.0, &scaled.times);
        let entries = states.iter().flat_map(|state| state.derivatives.iter().copied());
        let transposed = DMatrix::from_iterator(law.parameters(), scaled.peaks(), entries);
        (instruments.shape() == (scaled.peaks(), law.parameters())).then(|| Self {
            variance: law.squares / degrees as f64,
            factor: (transposed * &instruments).lu(),
            instruments,
        })
    }

    /// Returns the variance of a measured ln A about the prediction for a state; NaN if the system is
    /// singular.
    fn variance(&self, state: &State) -> f64 {
        // Solve (JᵀZ)·u = g, that is u = (ZᵀJ)⁻ᵀg.
        let gradient = DVector::from_column_slice(&state.derivatives);
        self.factor
            .solve(&gradient)
            .map_or(f64::NAN, |weights| self.variance * (1.0 + (&self.instruments * weights).norm_squared()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use envelope::Envelope;

    /// Constant law over a scattered line, with the trajectory of least squares.
    fn line() -> (Law, Scaled) {
        let times: Vec<f64> = (0..40).map(|i| 0.5 * f64::from(i)).collect();
        let logs = times.iter().enumerate().map(|(i, t)| 0.3 - 0.2 * t + 0.1 * ((i * 37 % 11) as f64));
        let scaled = Scaled::of(&Envelope::new(times.clone(), logs.collect(), 6.0).unwrap()).unwrap();
        let slope = -scaled.decay_rate(&scaled.logs) * scaled.span_s;
        let mean = scaled.times.iter().sum::<f64>() / 40.0;
        let trajectory = scaled.times.iter().map(|time| slope * (time - mean)).collect();
        (Law::new(slope, Vec::new(), trajectory, &scaled), scaled)
    }

    #[test]
    fn a_constant_law_predicts_as_the_textbook_s_line() {
        let (law, scaled) = line();
        let ones = std::iter::repeat_n(1.0, 40);
        let instruments = DMatrix::from_iterator(40, 2, ones.chain(scaled.times.iter().copied()));
        let asked = [-3.0, 0.0, 0.7, 9.75, 19.5, 60.0, 4.0];
        let found = predictions(&law, &scaled, Some(instruments), &asked);
        let mean = 9.75;
        let spread: f64 = (0..40).map(|i| (0.5 * f64::from(i) - mean).powi(2)).sum();
        for (time, found) in asked.iter().zip(found) {
            let log = scaled.mean - scaled.decay_rate(&scaled.logs) * (time - mean);
            assert!((found.log_amplitude - log).abs() < 1e-12, "{time}: {found:?} {log}");
            let variance = law.squares / 38.0 * (1.0 + 1.0 / 40.0 + (time - mean).powi(2) / spread);
            assert!((found.std_error.unwrap() / variance.sqrt() - 1.0).abs() < 1e-9, "{time}");
        }
    }

    #[test]
    fn without_instruments_no_error_is_stated() {
        let (law, scaled) = line();
        let found = predictions(&law, &scaled, None, &[1.0, 30.0]);
        assert!(found.iter().all(|found| found.std_error.is_none() && found.log_amplitude.is_finite()));
        assert!(predictions(&law, &scaled, None, &[]).is_empty());
    }
}
