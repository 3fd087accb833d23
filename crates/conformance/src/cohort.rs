//! Coverage of stated intervals over a cohort of simulated envelopes.

use crate::calibration::{Calibration, level};
use crate::{Subject, query_times, scattered};
use rand_distr::{Distribution, Normal};
use seed::Seed;

/// Coverage: count of stated 95 % intervals that hold the true value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Coverage {
    /// Number of intervals tried.
    pub tried: u64,
    /// Number of intervals that held the truth.
    pub held: u64,
}

impl Coverage {
    /// Returns the share of intervals that held the truth.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.held as f64 / self.tried as f64
    }

    /// Returns `true` if the share lies within `bar` of 95 %, or within three binomial standard errors if
    /// that is wider, since a few envelopes determine the share poorly.
    #[must_use]
    pub fn is_within(&self, bar: f64) -> bool {
        let standard_error = (0.95 * 0.05 / self.tried as f64).sqrt();
        (self.share() - 0.95).abs() <= bar.max(3.0 * standard_error)
    }

    fn count(&mut self, held: bool) {
        self.tried += 1;
        self.held += u64::from(held);
    }
}

/// Result of [`coverage`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cohort {
    /// Coverage of the intervals of λ.
    pub rates: Coverage,
    /// Coverage of the predictive intervals of one fresh peak per envelope; none tried if the method states
    /// no standard deviation of its predictions.
    pub fresh_peaks: Coverage,
    /// Levels of the true λ in the stated posteriors.
    pub calibration: Calibration,
}

/// Quantile of the normal distribution at 97.5 %. The quantile of Student's t with 67 degrees of freedom is 2
/// % larger, which is half a percent of coverage.
const QUANTILE_975: f64 = 1.959_963_984_540_054;

/// Fits simulated envelopes of 69 peaks with λ = 0.19 1/s and a scatter of 0.1 on ln A, each a new draw.
/// Counts the intervals that hold λ, and the predictive intervals that hold a freshly drawn peak within the
/// envelope or a tenth of its length beyond.
///
/// # Errors
/// A sentence, if a fit fails, states no interval of λ, or states one that fits no distribution.
pub fn coverage(subject: &Subject<'_>, envelopes: u64) -> Result<Cohort, String> {
    const RATE: f64 = 0.19;
    const SCATTER: f64 = 0.1;
    // Level used by `scattered`.
    const LEVEL: f64 = -0.6;
    let normal = Normal::new(0.0, SCATTER).map_err(|error| error.to_string())?;
    let mut cohort = Cohort::default();
    for draw in 0..envelopes {
        let seed = Seed::new(draw).child("coverage");
        let envelope = scattered(69, RATE, SCATTER, &seed)
            .ok_or_else(|| "the battery's own envelope is unusable".to_owned())?;
        let estimate =
            subject.read(&envelope, subject.seed_of_draw(draw), None).map_err(|error| error.to_string())?;
        let known = estimate.uncertainty.ok_or_else(|| format!("draw {draw}: no interval"))?;
        let [low, high] = known.interval_95;
        let level = level(&known, estimate.decay_rate, RATE)
            .ok_or_else(|| format!("draw {draw}: no distribution has {known:?}"))?;
        cohort.calibration.levels.push(level);
        cohort.rates.count((low..=high).contains(&RATE));
        let asked: Vec<_> = query_times(&envelope).into_iter().zip(&estimate.predictions).collect();
        // Another place in every envelope, so that the peaks are independent.
        let place = (draw as usize * 41 + 136) % asked.len().max(1);
        if let Some((time, prediction)) = asked.get(place)
            && let Some(std_error) = prediction.std_error
        {
            let peak = LEVEL - RATE * time + normal.sample(&mut seed.child("fresh peak").generator());
            cohort.fresh_peaks.count((peak - prediction.log_amplitude).abs() <= QUANTILE_975 * std_error);
        }
    }
    cohort.calibration.levels.sort_by(f64::total_cmp);
    Ok(cohort)
}

#[cfg(test)]
mod tests {
    use super::coverage;
    use crate::Subject;
    use envelope::Envelope;
    use estimator::{
        Entry, Estimate, Estimator, FitContext, FitError, Prediction, Reached, Stop, Uncertainty,
    };

    /// Estimator that states the right rate and an interval of half-width 0.5 with the given standard error.
    struct Stating(f64);

    impl Estimator for Stating {
        fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
            Ok(Estimate {
                decay_rate: 0.19,
                log_amplitude: -0.6,
                uncertainty: Some(Uncertainty { std_error: self.0, interval_95: [-0.31, 0.69] }),
                stop: Stop { reached: Reached::Converged, because: String::new() },
                steps: 1,
                parameters: 2,
                fitted_log_amplitudes: envelope.log_amplitudes().to_vec(),
                predictions: context.query_times().iter().map(|_| Prediction::new(-0.6, None)).collect(),
                equation: None,
                model: None,
            })
        }
    }

    #[test]
    fn a_posterior_that_no_distribution_has_is_said() {
        let entry = |build| Entry {
            id: "stating",
            paper_number: None,
            title: "",
            summary: "",
            tags: &[],
            citations: &[],
            fields: &[],
            build,
        };
        let sound = entry(|_| Ok(Box::new(Stating(0.25))));
        let found = coverage(&Subject::new(&sound).unwrap(), 3).unwrap();
        assert_eq!((found.rates.held, found.calibration.levels.len()), (3, 3));
        let unsound = entry(|_| Ok(Box::new(Stating(0.0))));
        let refused = coverage(&Subject::new(&unsound).unwrap(), 3).unwrap_err();
        assert!(refused.contains("draw 0: no distribution has"), "{refused}");
    }
}
