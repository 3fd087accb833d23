//! Least-squares line by the textbook formula, for tests to compare with.

use envelope::Envelope;

/// Decay rate and its standard error, by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Minus the slope of ln A, in 1/s.
    pub decay_rate: f64,
    /// Standard error of the decay rate, in 1/s, for independent residuals with peaks − 2 degrees of freedom.
    pub std_error: f64,
}

/// Fits the least-squares line to an envelope by the textbook formula, accurate to ten digits on the
/// battery's envelopes.
#[must_use]
pub fn least_squares(envelope: &Envelope) -> Line {
    let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
    let count = times.len() as f64;
    let mean_time = times.iter().sum::<f64>() / count;
    let mean_log = logs.iter().sum::<f64>() / count;
    let product: f64 = times.iter().zip(logs).map(|(t, y)| (t - mean_time) * (y - mean_log)).sum();
    let square: f64 = times.iter().map(|t| (t - mean_time).powi(2)).sum();
    let slope = product / square;
    let residual = |(t, y): (&f64, &f64)| y - mean_log - slope * (t - mean_time);
    let residuals: f64 = times.iter().zip(logs).map(|pair| residual(pair).powi(2)).sum();
    Line { decay_rate: -slope, std_error: (residuals / (count - 2.0) / square).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::least_squares;
    use envelope::Envelope;

    /// Residuals 1, −2, 1 about slope −3 (orthogonal to 1 and t), Σ(t − t̄)² = 2: √(6/1/2).
    #[test]
    fn it_is_the_line_by_hand() {
        let envelope = Envelope::new(vec![0.0, 1.0, 2.0], vec![11.0, 5.0, 5.0], 1.0).unwrap();
        let line = least_squares(&envelope);
        assert!((line.decay_rate - 3.0).abs() < 1e-14 && (line.std_error - 3_f64.sqrt()).abs() < 1e-14);
    }
}
