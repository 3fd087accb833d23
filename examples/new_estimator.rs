//! Implements an estimator and compares it with least squares: the median of the slopes between all pairs of
//! peaks.
//!
//! Theil, Proceedings of the Royal Netherlands Academy of Sciences 53 (1950) 386; Sen, Journal of the American
//! Statistical Association 63 (1968) 1379.
//!
//!     cargo run -p ringdown-lab --example new_estimator

#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use ringdown_lab::contract::{
    Envelope, Estimate, Estimator, FitContext, FitError, Prediction, Reached, Stop,
};
use ringdown_lab::{Error, EstimateOptions, Nominal, Simulation, estimate, estimate_with};

// ANCHOR: estimator
/// Theil–Sen estimator: the median slope of ln A over all pairs of peaks. Almost a third of the peaks may be
/// wrong.
struct TheilSen;

impl Estimator for TheilSen {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
        let points: Vec<(f64, f64)> = times.iter().copied().zip(logs.iter().copied()).collect();
        let slopes = points.iter().enumerate().flat_map(|(index, (time, log))| {
            points.iter().skip(index + 1).map(move |(later, lower)| (lower - log) / (later - time))
        });
        let slope = median(slopes.collect());
        let start = median(points.iter().map(|(time, log)| log - slope * time).collect());
        let line = |time: &f64| start + slope * time;
        Ok(Estimate {
            decay_rate: -slope,
            log_amplitude: start,
            uncertainty: None,
            stop: Stop { reached: Reached::Converged, because: "a median takes no steps".to_owned() },
            steps: 0,
            parameters: 2,
            fitted_log_amplitudes: times.iter().map(line).collect(),
            predictions: context.query_times().iter().map(|time| Prediction::new(line(time), None)).collect(),
            equation: None,
            model: None,
        })
    }
}

/// Returns the middle value; 0 if there are no values.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
// ANCHOR_END: estimator

// ANCHOR: main
fn main() -> Result<(), Error> {
    let arm = Nominal::swinging(3.5, 0.01)?;
    // Some readings of this encoder are wrong by half a radian.
    let record = Simulation::of(&arm)
        .with_effect("outliers", &[("probability", 0.003), ("size", 0.1)])?
        .released_at(1.0)
        .noise(1e-3)
        .seed(4)
        .run()?;
    let options = EstimateOptions::default();
    let own = estimate_with(&record, "theil-sen", &TheilSen, &options)?;
    let usual = estimate(&record, "ols", &options)?;
    println!("true ζ 0.01000; Theil–Sen {:.5}, least squares {:.5}", own.damping_ratio, usual.damping_ratio);
    Ok(())
}
// ANCHOR_END: main
