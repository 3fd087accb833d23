//! Shares, quantiles and areas with their intervals.

use results::{Proportion, Quantiles, WithInterval};
use scoring::binomial_interval;
use statrs::distribution::{Binomial, DiscreteCDF};

/// Returns a share of independent cases.
pub(crate) fn proportion(outcomes: impl IntoIterator<Item = bool>) -> Proportion {
    let (mut count, mut of) = (0_u64, 0_u64);
    for outcome in outcomes {
        count += u64::from(outcome);
        of += 1;
    }
    let share = if of == 0 { f64::NAN } else { count as f64 / of as f64 };
    Proportion { count, of, share, interval_95: binomial_interval(count as f64, of as f64) }
}

/// Value of a quantity that could not be measured.
pub(crate) const NO_NUMBER: WithInterval =
    WithInterval { value: f64::NAN, interval_95: [f64::NAN, f64::NAN] };

/// Returns a quantile of sorted values by linear interpolation; NaN without values.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let at = |index: usize| sorted.get(index.min(last)).copied().unwrap_or(f64::NAN);
    at(below) + (place - below as f64) * (at(below + 1) - at(below))
}

/// Returns the median with its interval by order statistics, the 95 % quantile, and the largest of the finite
/// values.
pub(crate) fn quantiles(values: impl IntoIterator<Item = f64>) -> Quantiles {
    let mut sorted: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    let at = |rank: usize| sorted.get(rank).copied().unwrap_or(f64::NAN);
    // The median lies between these order statistics with 95 % probability, whatever the distribution. With
    // fewer than six values, not even the smallest and the largest suffice.
    let rank = Binomial::new(0.5, count as u64).ok().filter(|_| count > 5);
    let low = rank.and_then(|binomial| usize::try_from(binomial.inverse_cdf(0.025)).ok()?.checked_sub(1));
    let interval_95 = low.map_or([f64::NAN; 2], |low| [at(low), at(count - 1 - low)]);
    let median = WithInterval { value: quantile(&sorted, 0.5), interval_95 };
    Quantiles {
        count: count as u64,
        median,
        quantile_95: quantile(&sorted, 0.95),
        worst: sorted.last().copied().unwrap_or(f64::NAN),
    }
}

/// Returns the area under the receiver operating characteristic: the probability that a positive scores above
/// a negative, with ties counted half, and DeLong's interval on the logistic scale. `None` unless there are
/// both.
///
/// An area of exactly 0 or 1 has no variance. Its interval is then that of a binomial share with as many
/// trials as the smaller group has cases, all failures or all successes.
///
/// # Reference
/// E. R. DeLong, D. M. DeLong, D. L. Clarke-Pearson, Biometrics 44 (1988) 837–845.
pub(crate) fn area(positives: &[f64], negatives: &[f64]) -> Option<WithInterval> {
    let (m, n) = (positives.len() as f64, negatives.len() as f64);
    if m == 0.0 || n == 0.0 {
        return None;
    }
    let above = |one: f64, other: f64| {
        if one > other {
            1.0
        } else if one == other {
            0.5
        } else {
            0.0
        }
    };
    let of_positive: Vec<f64> =
        positives.iter().map(|p| negatives.iter().map(|q| above(*p, *q)).sum::<f64>() / n).collect();
    let of_negative: Vec<f64> =
        negatives.iter().map(|q| positives.iter().map(|p| above(*p, *q)).sum::<f64>() / m).collect();
    let value = of_positive.iter().sum::<f64>() / m;
    let spread = |values: &[f64]| {
        let count = values.len() as f64;
        if count < 2.0 {
            return 0.0;
        }
        values.iter().map(|own| (own - value).powi(2)).sum::<f64>() / (count - 1.0) / count
    };
    let error = (spread(&of_positive) + spread(&of_negative)).sqrt();
    let interval_95 = if error > 0.0 && value > 0.0 && value < 1.0 {
        let logit = (value / (1.0 - value)).ln();
        let half = 1.96 * error / (value * (1.0 - value));
        [logit - half, logit + half].map(|logit| 1.0 / (1.0 + (-logit).exp()))
    } else {
        binomial_interval(value * m.min(n), m.min(n))
    };
    Some(WithInterval { value, interval_95 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_known_values() {
        let found = quantiles((1..=101).rev().map(f64::from).chain([f64::NAN]));
        assert_eq!(
            (found.count, found.median.value, found.quantile_95, found.worst),
            (101, 51.0, 96.0, 101.0)
        );
        // For 101 values, the median lies between the 41st and the 61st with at least 95 % (David and
        // Nagaraja, table 7.1).
        assert_eq!(found.median.interval_95, [41.0, 61.0]);
        let few = quantiles([1.0, 2.0, 3.0]).median;
        assert!(few.value == 2.0 && few.interval_95[0].is_nan());
        assert!(quantiles([]).median.value.is_nan());
    }

    #[test]
    fn area_of_a_known_sample() {
        let found = area(&[0.9, 0.8, 0.4], &[0.5, 0.3, 0.2, 0.1]).unwrap();
        assert!((found.value - 11.0 / 12.0).abs() < 1e-15);
        let [low, high] = found.interval_95;
        assert!(low < found.value && found.value < high && high < 1.0);
        assert_eq!(area(&[0.5; 4], &[0.5; 3]).unwrap().value, 0.5);
        let sure = area(&[2.0; 20], &[1.0; 30]).unwrap();
        assert!(sure.value == 1.0 && (sure.interval_95[0] - 0.025_f64.powf(1.0 / 20.0)).abs() < 1e-9);
        assert!(area(&[], &[1.0]).is_none());
    }

    /// Checks against the exact area for two normal samples: about 95 % of the intervals of many draws must
    /// contain it.
    #[test]
    fn intervals_of_areas_hold() {
        use rand::RngExt;
        let mut generator = seed::Seed::new(3).generator();
        let mut held = 0;
        for _ in 0..400 {
            let mut draw = |shift: f64, count: usize| -> Vec<f64> {
                (0..count)
                    .map(|_| shift + (0..12).map(|_| generator.random::<f64>()).sum::<f64>() - 6.0)
                    .collect()
            };
            let (positives, negatives) = (draw(2.0_f64.sqrt(), 60), draw(0.0, 80));
            // Φ(1), the probability that a standard normal variable shifted by √2 exceeds another one.
            let [low, high] = area(&positives, &negatives).unwrap().interval_95;
            held += usize::from(low <= 0.841_345 && 0.841_345 <= high);
        }
        assert!((364..=396).contains(&held), "{held}");
    }
}
