//! Basic statistics.

#![allow(clippy::indexing_slicing, reason = "indices are bounded by the last one")]

use rand::RngExt;
use seed::Seed;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Returns the mean; 0 for no values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns the value below which a share of the values lies; 0 for no values.
pub(crate) fn quantile(values: &[f64], share: f64) -> f64 {
    debug_assert!((0.0..=1.0).contains(&share), "{share}");
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let at = share * last as f64;
    let (below, above) = (sorted[(at.floor() as usize).min(last)], sorted[(at.ceil() as usize).min(last)]);
    below + (above - below) * at.fract()
}

/// Returns the time from the first of some times to the last; 0 for fewer than two.
pub(crate) fn duration(times: &[f64]) -> f64 {
    match times {
        [first, .., last] => last - first,
        _ => 0.0,
    }
}

pub(crate) fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Returns the value that a chi-square variable with the given degrees of freedom exceeds with a probability.
pub(crate) fn chi_squared_above(degrees: f64, probability: f64) -> f64 {
    ChiSquared::new(degrees.max(1e-3)).map_or(f64::INFINITY, |d| d.inverse_cdf(1.0 - probability))
}

/// Returns the value that a standard normal variable exceeds with a probability.
pub(crate) fn normal_above(probability: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(f64::INFINITY, |d| -d.inverse_cdf(probability))
}

/// Returns the value that a Student variable with the given degrees of freedom exceeds with a probability.
pub(crate) fn student_above(probability: f64, degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees).map_or(f64::INFINITY, |d| -d.inverse_cdf(probability))
}

/// Computes the integrated autocorrelation time τ = 1 + 2·Σ ρₖ, in samples, of a zero-mean series that comes
/// in pieces. It is at least 1: N samples carry as much information as N/τ independent ones.
///
/// The sum runs over pairs ρ₂ₖ + ρ₂ₖ₊₁ as long as they are positive.
///
/// # Reference
/// Geyer, Statistical Science 7 (1992) 473, initial positive sequence.
pub(crate) fn autocorrelation_time(pieces: &[&[f64]]) -> f64 {
    let square: f64 = pieces.iter().flat_map(|piece| piece.iter()).map(|e| e * e).sum();
    if square <= 0.0 {
        return 1.0;
    }
    let longest = pieces.iter().map(|piece| piece.len()).fold(0, usize::max);
    let at = |lag: usize| -> f64 {
        let products = pieces.iter().flat_map(|p| p.iter().zip(p.iter().skip(lag)));
        products.map(|(a, b)| a * b).sum::<f64>() / square
    };
    let mut sum = -1.0;
    for pair in 0..longest / 2 {
        let two = at(2 * pair) + at(2 * pair + 1);
        if two <= 0.0 {
            break;
        }
        sum += 2.0 * two;
    }
    sum.max(1.0)
}

/// Returns the mean of a list, and its standard error.
pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let center = mean(values);
    let count = values.len() as f64;
    let variance = values.iter().map(|v| (v - center).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    (center, (variance / count.max(1.0)).sqrt())
}

/// Returns, for each sample but the outermost, a sixth of the squared second difference of the errors about
/// it.
pub(crate) fn sixths(errors: &[f64]) -> Vec<Option<f64>> {
    let inner = errors.windows(3).map(|e| match e {
        &[a, b, c] => Some((a - 2.0 * b + c).powi(2) / 6.0),
        _ => None,
    });
    std::iter::once(None).chain(inner).chain([None]).take(errors.len()).collect()
}

/// Returns `draws` draws of `count` indices with replacement, as for a bootstrap.
pub(crate) fn resampled(count: usize, draws: usize, seed: &Seed) -> impl Iterator<Item = Vec<usize>> + use<> {
    let mut generator = seed.generator();
    (0..draws).map(move |_| (0..count).map(|_| generator.random_range(0..count)).collect())
}

#[cfg(test)]
mod tests {
    use super::{autocorrelation_time, chi_squared_above, normal_above, quantile, student_above};
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(quantile(&[0.0, 1.0], 0.25), 0.25);
    }

    #[test]
    fn tails_are_the_tables() {
        assert!((chi_squared_above(1.0, 0.05) - 3.841_458_820_694_124).abs() < 1e-6);
        assert!((normal_above(0.025) - 1.959_963_984_540_054).abs() < 1e-6);
        assert!((student_above(0.025, 10.0) - 2.228_138_85).abs() < 1e-6);
    }

    /// An AR(1) process has τ = (1 + r)/(1 − r).
    #[test]
    fn the_autocorrelation_time_of_a_known_process() {
        let mut generator = seed::Seed::new(1).child("process").generator();
        let (r, mut state): (f64, f64) = (0.8, 0.0);
        let series: Vec<f64> = (0..200_000)
            .map(|_| {
                let step: f64 = StandardNormal.sample(&mut generator);
                state = r * state + step;
                state
            })
            .collect();
        let pieces: Vec<&[f64]> = series.chunks(1000).collect();
        let tau = autocorrelation_time(&pieces);
        assert!((tau / 9.0 - 1.0).abs() < 0.1, "{tau}");
        let white: Vec<f64> = (0..20_000).map(|_| StandardNormal.sample(&mut generator)).collect();
        assert!((autocorrelation_time(&[&white]) - 1.0).abs() < 0.1);
    }
}
