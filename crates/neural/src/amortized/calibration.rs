//! How far what a network says of its errors is to be believed.

use super::bank::Prior;
use super::training::{Calibration, Training};
use crate::decay::Encoder;
use burn::tensor::Device;
use estimator::{FitContext, FitError};

/// The normal distribution's quantile at 97.5 %.
pub(super) const QUANTILE_975: f64 = 1.959_963_984_540_054;

/// Share of the intervals that are to hold the truth.
const COVERAGE: f64 = 0.95;

impl Training {
    /// The factors with which 95 % intervals hold the truth in 95 % of simulated envelopes, which the
    /// network has not been trained on and reads in batches: each is looked at until the last of its batch is settled, which is
    /// oftener than one read alone. `None` where somebody asked to stop.
    ///
    /// Reference: Papadopoulos, Proedrou, Vovk, Gammerman, Inductive confidence machines for regression,
    /// ECML 2002, normalized by the stated error.
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

/// The factor by which standard errors are too small, from misses in units of them: the
/// ⌈0.95·(n + 1)⌉-th smallest miss over 1.96. 1 where there are too few to tell.
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
        // Of 1..=99 in units of 1/1.96: the 95th smallest.
        let misses = (1..100).rev().map(|miss| QUANTILE_975 * f64::from(miss)).collect();
        assert!((factor(misses) - 95.0).abs() < 1e-12);
        // Nineteen misses tell where the largest one is, eighteen do not.
        assert!((factor((1..20).map(f64::from).collect()) * QUANTILE_975 - 19.0).abs() < 1e-12);
        assert_eq!(factor((1..19).map(f64::from).collect()), 1.0);
        assert_eq!(factor(vec![f64::NAN; 40]), 1.0);
    }
}
