//! The envelopes that estimators are tried on.

use envelope::Envelope;
use rand_distr::{Distribution, Normal};
use seed::Seed;

const PERIOD_S: f64 = 0.288;
const OMEGA_RAD_S: f64 = 21.8;

fn times(peaks: usize) -> Vec<f64> {
    (0..peaks).map(|i| PERIOD_S * i as f64).collect()
}

/// An envelope from its function of time; `None` where that is not finite.
fn envelope(peaks: usize, log_amplitude: impl Fn(f64) -> f64) -> Option<Envelope> {
    let times = times(peaks);
    let logs = times.iter().map(|&time| log_amplitude(time)).collect();
    Envelope::new(times, logs, OMEGA_RAD_S).ok()
}

/// A noise-free exponential: ln A = `log_amplitude` − `decay_rate`·t, peaks 0.288 s apart.
///
/// `None` for fewer than three peaks or numbers that are not finite.
#[must_use]
pub fn exponential(peaks: usize, log_amplitude: f64, decay_rate: f64) -> Option<Envelope> {
    envelope(peaks, |time| log_amplitude - decay_rate * time)
}

/// An exponential with Gaussian scatter of standard deviation `scatter` on ln A, drawn from `seed`.
///
/// `None` as for [`exponential`], or for a negative scatter.
#[must_use]
pub fn scattered(peaks: usize, decay_rate: f64, scatter: f64, seed: &Seed) -> Option<Envelope> {
    let normal = Normal::new(0.0, scatter).ok()?;
    let mut generator = seed.generator();
    let times = times(peaks);
    let logs = times.iter().map(|time| -0.6 - decay_rate * time + normal.sample(&mut generator)).collect();
    Envelope::new(times, logs, OMEGA_RAD_S).ok()
}

/// An envelope that is no exponential: 69 peaks that bend like dry friction's and scatter, as measured
/// ones do. Its scatter is a fixed pattern, the same for everybody.
#[must_use]
pub fn bent() -> Option<Envelope> {
    let scatter = |time: f64| 0.03 * (37.0 * time).sin() + 0.02 * (91.0 * time + 1.0).cos();
    envelope(69, |time| -0.6 - 0.15 * time - 0.003 * time * time + scatter(time))
}
