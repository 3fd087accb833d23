//! Calibration of the standard errors that a network states.

use super::bank::Prior;
use super::training::{Calibration, Training};
use crate::decay::Encoder;
use burn::tensor::Device;
use estimator::{FitContext, FitError};

/// 97.5 % quantile of the standard normal distribution.
pub(super) const QUANTILE_975: f64 = 1.959_963_984_540_054;

/// Nominal coverage of the intervals.
const COVERAGE: f64 = 0.95;

impl Training {
    /// Computes the factors on stated standard errors with which 95 % intervals cover the truth in 95 % of
    /// simulated envelopes. `None` if a stop was requested.
    ///
    /// The network has not been trained on these envelopes. It reads them in batches, and looks at all
    /// envelopes of a batch until the last one has settled, so more often than at a single one.
    ///
    /// Reference: Papadopoulos, Proedrou, Vovk, Gammerman, Inductive confidence machines for regression, ECML
    /// 2002, normalized by the stated error.
    pub(super) fn calibrate<E: Encoder>(
        &self,
        prior: &Prior,
        encoder: &E,
        context: &FitContext<'_>,
        device: &Device,
    ) -> Result<Option<Calibration>, FitError> {
        let mut generator = context.seed("calibration").generator();
        let (mut levels, mut rates) = (Vec::new(), Vec::new());
        while rates.len() < self.calibration {
            if context.is_canceled() {
                return Ok(None);
            }
            let (sequences, lines): (Vec<_>, Vec<_>) =
                prior.sequences(self.batch, &mut generator).into_iter().unzip();
            for (reading, [level, rate]) in self.read_all(encoder, &sequences, device)?.iter().zip(lines) {
                levels.push((reading.level - level).abs() / reading.level_std_error);
                rates.push((reading.rate - rate).abs() / reading.rate_std_error);
            }
        }
        Ok(Some(Calibration { level: factor(levels), rate: factor(rates) }))
    }
}

/// Returns the factor by which standard errors are too small, from errors in units of the stated ones: the
/// ⌈0.95·(n + 1)⌉-th smallest over 1.96. Returns 1 if there are too few errors.
fn factor(mut misses: Vec<f64>) -> f64 {
    misses.sort_by(f64::total_cmp);
    let rank = (COVERAGE * (misses.len() + 1) as f64).ceil() as usize;
    let quantile = misses.get(rank.saturating_sub(1)).copied().filter(|miss| miss.is_finite());
    quantile.map_or(1.0, |quantile| quantile / QUANTILE_975)
}

#[cfg(test)]
mod tests {
    use super::{QUANTILE_975, factor};

    #[test]
    fn the_factor_makes_an_interval_hold_what_it_says() {
        // For 1..=99 in units of 1/1.96: the 95th smallest.
        let misses = (1..100).rev().map(|miss| QUANTILE_975 * f64::from(miss)).collect();
        assert!((factor(misses) - 95.0).abs() < 1e-12);
        // With nineteen errors the quantile is the largest one; with eighteen it is undefined.
        assert!((factor((1..20).map(f64::from).collect()) * QUANTILE_975 - 19.0).abs() < 1e-12);
        assert_eq!(factor((1..19).map(f64::from).collect()), 1.0);
        assert_eq!(factor(vec![f64::NAN; 40]), 1.0);
    }
}
