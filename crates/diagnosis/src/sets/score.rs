//! Score of a fit: how well the data support its set of effects.

use crate::fit::fitted::Fit;

/// Returns the tempered log evidence S = −(N/2τ)·ln(SS/N) − (p/2)·ln(N/τ), up to a constant common to all
/// hypotheses on the same data.
///
/// N samples whose residual has the integrated autocorrelation time τ carry the information of N/τ: white
/// residuals get full weight, a misfit common to all hypotheses is discounted. All hypotheses have the same
/// number of start states, except those with a second body, whose additional ones count as parameters.
pub(crate) fn score(fit: &Fit, autocorrelation_time: f64) -> f64 {
    score_with(fit, fit.squares, 0, autocorrelation_time)
}

/// Returns the [`score`] of a fit with `further` more parameters and the given sum of squares.
pub(crate) fn score_with(fit: &Fit, squares: f64, further: usize, autocorrelation_time: f64) -> f64 {
    let samples = fit.samples() as f64;
    let worth = samples / autocorrelation_time;
    let mean = (squares / samples).max(f64::MIN_POSITIVE);
    -0.5 * worth * libm::log(mean) - parameter_price(fit.globals() + further_starts(fit) + further, worth)
}

/// Returns the number of start values that a hypothesis has beyond those common to all.
pub(crate) fn further_starts(fit: &Fit) -> usize {
    let common = fit.hypothesis.least_start_length();
    fit.point.starts.iter().map(|start| start.len().saturating_sub(common)).sum()
}

/// Returns the price of parameters in nats, (p/2)·ln(worth); `worth` is the number of independent samples.
pub(crate) fn parameter_price(parameters: usize, worth: f64) -> f64 {
    0.5 * parameters as f64 * libm::log(worth.max(2.0))
}

/// Returns the sum of squares at which that many samples and parameters have a given [`score`].
pub(crate) fn squares_at(score: f64, samples: usize, parameters: usize, autocorrelation_time: f64) -> f64 {
    let samples = samples as f64;
    let worth = samples / autocorrelation_time;
    samples * libm::exp(-2.0 * (score + parameter_price(parameters, worth)) / worth)
}

/// A decaying swing of 1000 samples, and the recalibrated simulator fitted to it.
#[cfg(test)]
pub(crate) fn calibrated_swing() -> (crate::data::segments::Data, Fit) {
    use record::{Clock, ClockChoice, Quantity, Record};
    let times: Vec<f64> = (0..1000).map(|at| 0.01 * f64::from(at)).collect();
    let values = times.iter().map(|time| 0.3 * libm::exp(-0.1 * time) * libm::cos(20.0 * time)).collect();
    let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
    let clock = Clock::new(&record, ClockChoice::Host).unwrap();
    let nominal = dynamics::Nominal::new(1.0, 0.2, 400.0, 0.0).unwrap();
    let observations = crate::Observations::new(&record, &clock);
    let data = crate::data::segments::cut(&[observations], &[vec![true; 1000]], &(&nominal).into()).unwrap();
    let calibrated = crate::fit::calibrate::baseline(&data, &(&nominal).into()).unwrap().calibrated;
    (data, calibrated)
}

#[cfg(test)]
mod tests {
    use super::{calibrated_swing, score, squares_at};

    #[test]
    fn squares_and_score_go_together() {
        let (_, found) = calibrated_swing();
        for time in [1.0, 7.0] {
            let squares = squares_at(score(&found, time), found.samples(), found.globals(), time);
            assert!((squares / found.squares - 1.0).abs() < 1e-9, "{time}: {squares} {}", found.squares);
        }
    }
}
