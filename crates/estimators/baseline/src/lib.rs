//! Null estimator: no decay at all. It is the floor row of every table.
//!
//! It returns λ = 0 and the mean of ln A for every envelope. An estimator that does not beat it has learned
//! nothing.

use envelope::Envelope;
use estimator::{Entry, Estimate, Estimator, FitContext, FitError, Prediction, Reached, Stop, Tag};

/// Registry entry of the null estimator.
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

/// Null estimator. It has no settings.
#[derive(Debug, Clone, Copy)]
pub struct Baseline;

impl Estimator for Baseline {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let logs = envelope.log_amplitudes();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        // A measured peak scatters about the mean like the others, and the mean is not known exactly.
        let variance = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let std_error = (variance * (1.0 + 1.0 / count)).sqrt();
        let prediction = Prediction::new(mean, Some(std_error));
        Ok(Estimate {
            decay_rate: 0.0,
            log_amplitude: mean,
            uncertainty: None,
            stop: Stop { reached: Reached::Converged, because: "there is nothing to train".to_owned() },
            steps: 0,
            parameters: 1,
            fitted_log_amplitudes: vec![mean; logs.len()],
            predictions: vec![prediction; context.query_times().len()],
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
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).predicting_at(&[1.0, 50.0]);
        let estimate = Baseline.fit(&envelope, &context).unwrap();
        assert_eq!(estimate.decay_rate.to_bits(), 0.0_f64.to_bits());
        assert!((estimate.log_amplitude - 2.0).abs() < 1e-15);
        // The standard deviation of 3, 2, 1 is 1; about their mean a new value has √(1 + 1/3) of it.
        assert_eq!(estimate.predictions.len(), 2);
        for prediction in estimate.predictions {
            assert!((prediction.log_amplitude - 2.0).abs() < 1e-15);
            assert!((prediction.std_error.unwrap() - (4.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        }
    }
}
