//! Envelopes that the battery fits.

use envelope::Envelope;
use rand_distr::{Distribution, Normal};
use seed::Seed;

const PERIOD_S: f64 = 0.288;
const OMEGA_RAD_S: f64 = 21.8;

fn times(peaks: usize) -> Vec<f64> {
    (0..peaks).map(|i| PERIOD_S * i as f64).collect()
}

/// Creates an envelope from a function of time; `None` if the function is not finite.
fn envelope(peaks: usize, log_amplitude: impl Fn(f64) -> f64) -> Option<Envelope> {
    let times = times(peaks);
    let logs = times.iter().map(|&time| log_amplitude(time)).collect();
    Envelope::new(times, logs, OMEGA_RAD_S).ok()
}

/// Creates a noise-free exponential: ln A = `log_amplitude` − `decay_rate`·t, with peaks 0.288 s apart.
///
/// `None` for fewer than three peaks or numbers that are not finite.
#[must_use]
pub fn exponential(peaks: usize, log_amplitude: f64, decay_rate: f64) -> Option<Envelope> {
    envelope(peaks, |time| log_amplitude - decay_rate * time)
}

/// Creates an exponential that starts at ln A = −0.6, with Gaussian scatter of standard deviation `scatter`
/// on ln A, drawn from `seed`.
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

/// Creates an envelope that is no exponential: 69 peaks that bend as under dry friction and scatter as
/// measured ones do. The scatter is a fixed pattern, the same for every estimator.
#[must_use]
pub fn bent() -> Option<Envelope> {
    let scatter = |time: f64| 0.03 * (37.0 * time).sin() + 0.02 * (91.0 * time + 1.0).cos();
    envelope(69, |time| -0.6 - 0.15 * time - 0.003 * time * time + scatter(time))
}

#[cfg(test)]
mod tests {
    use envelope::{Envelope, EnvelopeError};

    /// Envelopes that no estimator can receive: the type refuses them with a typed error.
    #[test]
    fn peaks_out_of_order_twice_not_finite_or_too_few_are_no_envelope() {
        let logs = [0.0, -0.1, -0.3, -0.4];
        let rows = |order: &[usize]| -> (Vec<f64>, Vec<f64>) {
            order.iter().map(|&at| (at as f64, logs[at])).unzip()
        };
        let with = |time: f64, log: f64| {
            let (mut times, mut logs) = rows(&[0, 1, 2, 3]);
            (times[2], logs[2]) = (time, log);
            (times, logs)
        };
        let (times, _) = rows(&[0, 1, 2, 3]);
        for (name, (times, logs)) in [
            ("another order", rows(&[0, 2, 1, 3])),
            ("backward", rows(&[3, 2, 1, 0])),
            ("twice", rows(&[0, 1, 1, 2, 3])),
            ("a time that is no number", with(f64::NAN, -0.3)),
            ("an infinite time", with(f64::INFINITY, -0.3)),
            ("a logarithm that is no number", with(2.0, f64::NAN)),
            ("the logarithm of zero", with(2.0, f64::NEG_INFINITY)),
            ("none", rows(&[])),
            ("one", rows(&[0])),
            ("two", rows(&[0, 1])),
            ("more times than logarithms", (times.clone(), vec![0.0; 3])),
        ] {
            let refused = Envelope::new(times, logs, 21.8);
            assert!(matches!(refused, Err(EnvelopeError::TooFewPeaks { .. })), "{name}: {refused:?}");
        }
        for omega in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = Envelope::new(times.clone(), logs.to_vec(), omega);
            assert!(matches!(refused, Err(EnvelopeError::TooFewPeaks { .. })), "{omega}: {refused:?}");
        }
        assert!(Envelope::new(times, logs.to_vec(), 21.8).is_ok());
    }
}
