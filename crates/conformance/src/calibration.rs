//! Simulation-based calibration of stated posteriors.

use crate::{Subject, scattered};
use estimator::Uncertainty;
use rand::RngExt;
use seed::Seed;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Levels of the true decay rate in the stated posteriors, which are uniform if the posteriors are
/// calibrated.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Calibration {
    /// Values of the posterior's distribution function at the truth, one number in 0..1 per envelope with an
    /// interval, in increasing order.
    pub levels: Vec<f64>,
    /// Number of envelopes that the estimator stated no interval for.
    pub without_interval: u64,
}

impl Calibration {
    /// Returns the largest distance between the empirical distribution function of the levels and the uniform
    /// one.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        let count = self.levels.len() as f64;
        let distances = self.levels.iter().enumerate().map(|(at, level)| {
            let (below, above) = (at as f64 / count, (at + 1) as f64 / count);
            f64::max((level - below).abs(), (above - level).abs())
        });
        distances.fold(0.0, f64::max)
    }

    /// Returns the half-width of the band that holds the whole empirical distribution function of n uniform
    /// levels with probability at least 1 − α: √(ln(2/α)/(2n)).
    ///
    /// Reference: Massart, The Annals of Probability 18 (1990) 1269, for any n.
    #[must_use]
    pub fn band(&self, alpha: f64) -> f64 {
        ((2.0 / alpha).ln() / (2.0 * self.levels.len() as f64)).sqrt()
    }
}

/// Fits `envelopes` simulated envelopes and evaluates the distribution function of each stated posterior at
/// the true rate. Each envelope has its own number of peaks (12 to 80), decay rate (0.02 to 2 1/s) and
/// scatter (0.03 to 0.3 on ln A).
///
/// The levels of a calibrated posterior are uniform. The truths are drawn from a population and not from the
/// estimator's prior, which is scaled by the data and broad. This is valid here: for the reference posterior
/// of a line with Gaussian scatter, the level is uniform at every single truth and hence over any population.
///
/// Reference: Talts, Betancourt, Simpson, Vehtari, Gelman, arXiv:1804.06788 (2018).
///
/// # Errors
/// A sentence, if a fit fails or an interval fits no distribution.
pub fn calibration(subject: &Subject<'_>, envelopes: u64) -> Result<Calibration, String> {
    let (mut levels, mut without_interval) = (Vec::new(), 0);
    for draw in 0..envelopes {
        let seed = Seed::new(draw).child("calibration");
        let mut generator = seed.child("truth").generator();
        let mut between = |low: f64, high: f64| low * (high / low).powf(generator.random::<f64>());
        let (peaks, rate, scatter) = (between(12.0, 80.0) as usize, between(0.02, 2.0), between(0.03, 0.3));
        let envelope = scattered(peaks, rate, scatter, &seed)
            .ok_or_else(|| "the battery's own envelope is unusable".to_owned())?;
        let estimate =
            subject.read(&envelope, subject.seed_of_draw(draw), None).map_err(|error| error.to_string())?;
        let Some(known) = estimate.uncertainty else {
            without_interval += 1;
            continue;
        };
        let level = level(&known, estimate.decay_rate, rate)
            .ok_or_else(|| format!("draw {draw}: no distribution has {known:?}"))?;
        levels.push(level);
    }
    levels.sort_by(f64::total_cmp);
    Ok(Calibration { levels, without_interval })
}

/// Returns the distribution function at `truth` of Student's t about `center`. The degrees of freedom follow
/// from standard error and interval.
pub(crate) fn level(known: &Uncertainty, center: f64, truth: f64) -> Option<f64> {
    let [low, high] = known.interval_95;
    let quantile = (high - low) / (2.0 * known.std_error);
    let freedom = degrees_of_freedom(quantile)?;
    Some(StudentsT::new(0.0, 1.0, freedom).ok()?.cdf((truth - center) / known.std_error))
}

/// Returns the degrees of freedom, 1 to 10⁷, at which Student's t has this 97.5 % quantile: by bisection,
/// since the quantile falls with the degrees of freedom.
fn degrees_of_freedom(quantile: f64) -> Option<f64> {
    let quantile_at = |freedom: f64| Some(StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.975));
    let (mut low, mut high) = (0.0_f64, 7.0_f64 * std::f64::consts::LN_10);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if quantile_at(middle.exp())? > quantile { low = middle } else { high = middle }
    }
    quantile.is_finite().then(|| f64::midpoint(low, high).exp())
}

#[cfg(test)]
mod tests {
    use super::{Calibration, degrees_of_freedom, level};
    use estimator::Uncertainty;

    #[test]
    fn the_degrees_of_freedom_come_back() {
        for freedom in [1.5, 10.0, 67.0, 5e3] {
            let known = Uncertainty::students_t(0.2, 0.01, freedom).expect("finite");
            let quantile = (known.interval_95[1] - 0.2) / 0.01;
            let found = degrees_of_freedom(quantile).expect("finite");
            assert!((found / freedom - 1.0).abs() < 1e-4, "{found} for {freedom}");
            let upper = level(&known, 0.2, known.interval_95[1]).expect("finite");
            assert!((upper - 0.975).abs() < 1e-9, "{upper}");
        }
    }

    #[test]
    fn even_levels_lie_within_the_band_and_narrow_ones_do_not() {
        let even: Vec<f64> = (0..1000).map(|at| (f64::from(at) + 0.5) / 1000.0).collect();
        let narrow = even.iter().map(|level| 0.5 + 0.8 * (level - 0.5)).collect();
        let (even, narrow) = (
            Calibration { levels: even, without_interval: 0 },
            Calibration { levels: narrow, without_interval: 0 },
        );
        assert!((even.deviation() - 0.0005).abs() < 1e-12);
        assert!((narrow.deviation() - 0.1).abs() < 1e-3);
        assert!((even.band(0.05) - 0.042_947).abs() < 1e-6);
        assert!(narrow.deviation() > narrow.band(0.001));
    }
}
