//! The null estimator: no decay at all. The floor row of every table and the file a new author copies.
//!
//! It answers λ = 0 and the mean of ln A, whatever the envelope. An estimator that does not beat it has
//! learned nothing.

use envelope::Envelope;
use estimator::{Entry, Estimate, Estimator, FitContext, FitError, Reached, Stop, Tag};

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "baseline",
    paper_number: None,
    title: "Null estimator",
    summary: "Answers that nothing decays: the floor that every estimator has to beat.",
    tags: &[Tag::Null],
    citations: &[],
    fields: &[],
    build: |_settings| Ok(Box::new(Baseline)),
};

/// The null estimator. It has no settings.
#[derive(Debug, Clone, Copy)]
pub struct Baseline;

impl Estimator for Baseline {
    fn fit(&self, envelope: &Envelope, _context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let logs = envelope.log_amplitudes();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        Ok(Estimate {
            decay_rate: 0.0,
            log_amplitude: mean,
            uncertainty: None,
            stop: Stop { reached: Reached::Converged, because: "there is nothing to train".to_owned() },
            steps: 0,
            parameters: 1,
            fitted_log_amplitudes: vec![mean; logs.len()],
            predictions: Vec::new(),
            equation: None,
            model: None,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::Baseline;
    use envelope::Envelope;
    use estimator::{Cancel, Estimator, FitContext, Silent};
    use seed::Seed;

    #[test]
    fn it_sees_no_decay() {
        let envelope = Envelope::new(vec![0.0, 1.0, 2.0], vec![3.0, 2.0, 1.0], 6.0).unwrap();
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
        let estimate = Baseline.fit(&envelope, &context).unwrap();
        assert_eq!(estimate.decay_rate.to_bits(), 0.0_f64.to_bits());
        assert!((estimate.log_amplitude - 2.0).abs() < 1e-15);
    }
}
