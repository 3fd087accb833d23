//! Statistics of chance: intervals of shares, and tests of "better more often than not".

use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF, StudentsT};

/// Returns the 95 % interval of a share by Clopper and Pearson, from `successes` of `trials` independent
/// trials.
///
/// Both may be fractional, as an effective number of trials is. `[0, 1]` for no trials.
///
/// # Reference
/// C. J. Clopper, E. S. Pearson, Biometrika 26 (1934) 404–413.
#[must_use]
pub fn binomial_interval(successes: f64, trials: f64) -> [f64; 2] {
    let failures = trials - successes;
    let quantile = |a: f64, b: f64, p: f64| Beta::new(a, b).map(|beta| beta.inverse_cdf(p)).ok();
    // Without successes the lower quantile has no distribution, and the lower end is 0; likewise 1 for the
    // upper end.
    let low = quantile(successes, failures + 1.0, 0.025).unwrap_or(0.0);
    let high = quantile(successes + 1.0, failures, 0.975).unwrap_or(1.0);
    [low, high]
}

/// Returns the 95 % interval of a share whose trials come in clusters, of which only the clusters are
/// independent. `clusters` holds `(successes, trials)` of each; clusters without trials are ignored. `None`
/// for fewer than five clusters.
///
/// The interval is Clopper and Pearson's for an effective number of trials: as many as independent trials
/// would need for the same variance, p(1 − p)/v, where v is the variance of the ratio over clusters,
/// corrected for its degrees of freedom. Where v is 0, as when every trial or none succeeds, each cluster
/// counts as one trial.
///
/// # Reference
/// E. L. Korn, B. I. Graubard, Survey Methodology 24 (1998) 193–201.
#[must_use]
pub fn clustered_interval(clusters: &[(usize, usize)]) -> Option<[f64; 2]> {
    const FEWEST: usize = 5;
    let filled: Vec<(f64, f64)> =
        clusters.iter().filter(|(_, of)| *of > 0).map(|&(held, of)| (held as f64, of as f64)).collect();
    if filled.len() < FEWEST {
        return None;
    }
    let count = filled.len() as f64;
    let trials: f64 = filled.iter().map(|(_, of)| of).sum();
    let share = filled.iter().map(|(held, _)| held).sum::<f64>() / trials;
    let squares: f64 = filled.iter().map(|(held, of)| (held - share * of).powi(2)).sum();
    let variance = count / (count - 1.0) * squares / trials.powi(2);
    let quantile = |degrees: f64| StudentsT::new(0.0, 1.0, degrees).map(|t| t.inverse_cdf(0.975)).ok();
    let effective = if share > 0.0 && share < 1.0 && variance > 0.0 {
        let ratio = quantile(trials - 1.0)? / quantile(count - 1.0)?;
        (share * (1.0 - share) / variance * ratio.powi(2)).min(trials)
    } else {
        count
    };
    Some(binomial_interval(share * effective, effective))
}

/// Returns the two-sided p-value of the sign test: the probability that chance gives a split at least as
/// uneven as `wins` against `losses`. Leave ties out beforehand. 1 for no trials.
///
/// ```
/// // Nine of ten: both tails of a binomial of one half, (1 + 10)/2¹⁰ each.
/// assert!((scoring::sign_test(9, 1) - 22.0 / 1024.0).abs() < 1e-12);
/// ```
///
/// # Reference
/// W. J. Dixon, A. M. Mood, J. Amer. Statist. Assoc. 41 (1946) 557–566.
#[must_use]
pub fn sign_test(wins: usize, losses: usize) -> f64 {
    let trials = (wins + losses) as u64;
    let fewer = wins.min(losses) as u64;
    if trials == 0 {
        return 1.0;
    }
    Binomial::new(0.5, trials).map_or(f64::NAN, |binomial| (2.0 * binomial.cdf(fewer)).min(1.0))
}

/// Adjusts p-values for their number by Holm's method: if those below a level are rejected, the probability
/// that any true hypothesis is among them stays below that level. One entry per given p-value, in their
/// order; a NaN entry stays NaN and does not count.
///
/// ```
/// let adjusted = scoring::holm(&[0.01, 0.04, 0.03]);
/// assert!((adjusted[0] - 0.03).abs() < 1e-12 && (adjusted[2] - 0.06).abs() < 1e-12);
/// ```
///
/// # Reference
/// S. Holm, Scand. J. Statist. 6 (1979) 65–70.
#[must_use]
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<(usize, f64)> =
        p_values.iter().copied().enumerate().filter(|(_, p)| !p.is_nan()).collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let count = order.len();
    let mut adjusted = vec![f64::NAN; p_values.len()];
    let mut largest: f64 = 0.0;
    for (rank, (index, p)) in order.into_iter().enumerate() {
        largest = largest.max(((count - rank) as f64 * p).min(1.0));
        if let Some(place) = adjusted.get_mut(index) {
            *place = largest;
        }
    }
    adjusted
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::{binomial_interval, clustered_interval, holm, sign_test};

    #[test]
    fn shares_of_independent_trials() {
        // Clopper and Pearson's table for 10 trials, and the rule of three's exact form.
        let [low, high] = binomial_interval(3.0, 10.0);
        assert!((low - 0.066_739_5).abs() < 1e-6 && (high - 0.652_452_9).abs() < 1e-6, "{low} {high}");
        let [low, high] = binomial_interval(200.0, 200.0);
        assert!((low - 0.025_f64.powf(1.0 / 200.0)).abs() < 1e-9 && high >= 1.0, "{low} {high}");
        assert_eq!(binomial_interval(0.0, 0.0), [0.0, 1.0]);
    }

    #[test]
    fn shares_of_clusters() {
        assert_eq!(clustered_interval(&[(1, 2); 4]), None);
        // Clusters whose trials all succeed or all fail are worth one trial each, less the uncertainty of the
        // variance itself: about n·(1.972/1.985)².
        let torn: Vec<(usize, usize)> = (0..100).map(|i| if i < 90 { (20, 20) } else { (0, 20) }).collect();
        let [low, high] = clustered_interval(&torn).unwrap();
        let [lone_low, lone_high] = binomial_interval(90.0, 100.0);
        assert!((low - lone_low).abs() < 0.003 && (high - lone_high).abs() < 0.003, "{low} {high}");
        // If all clusters have nearly the same share, all trials count.
        let almost: Vec<(usize, usize)> = (0..100).map(|i| (19 - i % 2, 20)).collect();
        assert_eq!(clustered_interval(&almost), Some(binomial_interval(1850.0, 2000.0)));
        // With exactly the same share the variance is zero: each cluster counts as one trial, as if all
        // trials succeeded.
        assert_eq!(clustered_interval(&[(10, 20); 60]), Some(binomial_interval(30.0, 60.0)));
        assert!(clustered_interval(&[(1, 2); 5]).is_some());
        assert_eq!(clustered_interval(&[(20, 20); 60]), Some(binomial_interval(60.0, 60.0)));
    }

    /// Six clusters of ten, computed with 25 digits: variance 6/5·16/60², quantiles of Student's t with 59
    /// and 5 degrees of freedom, 18.178 effective trials, and their interval by the incomplete beta function.
    #[test]
    fn an_interval_of_clusters_by_hand() {
        let clusters = [(8, 10), (9, 10), (10, 10), (7, 10), (5, 10), (9, 10)];
        // An additional empty cluster does not count.
        assert_eq!(clustered_interval(&[&clusters[..], &[(0, 0)]].concat()), clustered_interval(&clusters));
        let [low, high] = clustered_interval(&clusters).unwrap();
        assert!(
            (low - 0.549_484_862_2).abs() < 1e-7 && (high - 0.947_365_500_7).abs() < 1e-7,
            "{low} {high}"
        );
    }

    /// About 95 % of the intervals of simulated clustered trials hold the true share.
    #[test]
    fn clustered_intervals_hold_the_share_as_often_as_they_say() {
        use rand::RngExt;
        let mut generator = seed::Seed::new(5).generator();
        let samples = 2000;
        let held = (0..samples)
            .filter(|_| {
                let clusters: Vec<(usize, usize)> = (0..60)
                    .map(|_| {
                        // Half of the clusters' trials are copies of one draw.
                        let shared = generator.random::<f64>() < 0.9;
                        let own = (0..10).filter(|_| generator.random::<f64>() < 0.9).count();
                        (own + if shared { 10 } else { 0 }, 20)
                    })
                    .collect();
                let [low, high] = clustered_interval(&clusters).unwrap();
                (low..=high).contains(&0.9)
            })
            .count() as f64
            / f64::from(samples);
        assert!((0.94..0.98).contains(&held), "{held}");
    }

    #[test]
    fn signs() {
        assert!((sign_test(9, 1) - 22.0 / 1024.0).abs() < 1e-15);
        assert!((sign_test(1, 9) - sign_test(9, 1)).abs() < 1e-15);
        assert!((sign_test(5, 5) - 1.0).abs() < 1e-15);
        assert!((sign_test(0, 0) - 1.0).abs() < 1e-15);
        assert!((sign_test(20, 0) / 2.0_f64.powi(-19) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn adjusted_for_their_number() {
        let adjusted = holm(&[0.01, 0.04, 0.03, f64::NAN, 0.5]);
        for (found, expected) in adjusted.iter().zip([0.04, 0.09, 0.09, f64::NAN, 0.5]) {
            assert!(found.is_nan() == expected.is_nan());
            assert!(expected.is_nan() || (found - expected).abs() < 1e-15, "{adjusted:?}");
        }
        assert_eq!(holm(&[0.6, 0.7]), [1.0, 1.0]);
    }
}
