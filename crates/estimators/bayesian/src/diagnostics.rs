//! Convergence diagnostics: agreement of chains, and effective number of independent draws.
//!
//! Reference: Vehtari, Gelman, Simpson, Carpenter, Bürkner, Bayesian Anal. 16 (2021) 667.

#![allow(clippy::indexing_slicing, reason = "callers give at least one chain")]

use statrs::distribution::{ContinuousCDF, Normal};

/// Diagnostics of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Diagnostics {
    /// Rank-normalized split R̂: the larger one of the R̂ of the draws and the R̂ of their distances from the
    /// median.
    pub(crate) r_hat: f64,
    /// Bulk effective sample size, which applies to the center.
    pub(crate) bulk: f64,
    /// Tail effective sample size: the smaller one of those for the 5 % and the 95 % quantile.
    pub(crate) tail: f64,
}

impl Diagnostics {
    /// Computes the diagnostics of chains of equal length. With fewer than four draws each they are unknown:
    /// R̂ is infinite, and there are no effective draws.
    pub(crate) fn of(chains: &[Vec<f64>]) -> Self {
        let split = split(chains);
        if split.is_empty() || split.iter().any(|chain| chain.len() < 2) {
            return Self { r_hat: f64::INFINITY, bulk: 0.0, tail: 0.0 };
        }
        let ranked = rank_normalized(&split);
        let center = quantile(&split.concat(), 0.5);
        let folded = map(&split, |draw| (draw - center).abs());
        let all = split.concat();
        let tail = |share: f64| {
            let bound = quantile(&all, share);
            effective_draws(&map(&split, |draw| f64::from(u8::from(draw <= bound))))
        };
        Self {
            r_hat: r_hat(&ranked).max(r_hat(&rank_normalized(&folded))),
            bulk: effective_draws(&ranked),
            tail: tail(0.05).min(tail(0.95)),
        }
    }
}

/// Splits every chain into halves; the middle draw of an odd number is left out.
pub(crate) fn split(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    chains
        .iter()
        .flat_map(|chain| {
            let half = chain.len() / 2;
            let first = chain.iter().take(half).copied().collect();
            let second = chain.iter().skip(chain.len() - half).copied().collect();
            [first, second]
        })
        .collect()
}

fn map(chains: &[Vec<f64>], by: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
    chains.iter().map(|chain| chain.iter().map(|&draw| by(draw)).collect()).collect()
}

/// Returns the quantile by linear interpolation between the order statistics (type 7 of Hyndman and Fan).
pub(crate) fn quantile(draws: &[f64], share: f64) -> f64 {
    let mut sorted = draws.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = share * (sorted.len().saturating_sub(1)) as f64;
    let below = sorted.get(place.floor() as usize).copied().unwrap_or(f64::NAN);
    let above = sorted.get(place.ceil() as usize).copied().unwrap_or(below);
    below + (above - below) * place.fract()
}

/// Returns z = Φ⁻¹((rank − 3/8)/(S + 1/4)) over all chains together, with the mean rank for ties: equation
/// 14.
fn rank_normalized(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut order: Vec<(f64, usize)> =
        chains.iter().flatten().enumerate().map(|(place, &draw)| (draw, place)).collect();
    order.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    let total = order.len() as f64;
    let normal = Normal::standard();
    let mut scores = vec![0.0; order.len()];
    let mut below = 0_usize;
    for ties in order.chunk_by(|one, other| one.0.total_cmp(&other.0).is_eq()) {
        let rank = below as f64 + (ties.len() as f64 + 1.0) / 2.0;
        let score = normal.inverse_cdf((rank - 0.375) / (total + 0.25));
        for &(_, place) in ties {
            if let Some(entry) = scores.get_mut(place) {
                *entry = score;
            }
        }
        below += ties.len();
    }
    let mut scores = scores.into_iter();
    chains.iter().map(|chain| scores.by_ref().take(chain.len()).collect()).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

fn variance(values: &[f64]) -> f64 {
    let center = mean(values.iter().copied());
    values.iter().map(|value| (value - center).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)
}

/// Returns the within-chain variance and the pooled estimate: equations 1 to 3.
fn variances(chains: &[Vec<f64>]) -> (f64, f64) {
    let length = chains[0].len() as f64;
    let within = mean(chains.iter().map(|chain| variance(chain)));
    let means: Vec<f64> = chains.iter().map(|chain| mean(chain.iter().copied())).collect();
    (within, (length - 1.0) / length * within + variance(&means))
}

/// Returns √(pooled/within): equation 4. Infinite for chains that do not move.
fn r_hat(chains: &[Vec<f64>]) -> f64 {
    let (within, pooled) = variances(chains);
    if within > 0.0 { (pooled / within).sqrt() } else { f64::INFINITY }
}

/// Returns the number of draws over the integrated autocorrelation time. Pairs of autocorrelations are summed
/// while they stay positive, and are forced to decrease (Geyer): equations 10 to 13.
pub(crate) fn effective_draws(chains: &[Vec<f64>]) -> f64 {
    let Some(length) = chains.first().map(Vec::len) else { return 0.0 };
    let total = (length * chains.len()) as f64;
    let (within, pooled) = variances(chains);
    if !(pooled > 0.0 && within > 0.0) {
        return 0.0;
    }
    let centered: Vec<Vec<f64>> = chains
        .iter()
        .map(|chain| {
            let center = mean(chain.iter().copied());
            chain.iter().map(|draw| draw - center).collect()
        })
        .collect();
    let correlation = |lag: usize| {
        let products = |chain: &Vec<f64>| {
            let sum: f64 = chain.iter().zip(chain.iter().skip(lag)).map(|(one, later)| one * later).sum();
            sum / length as f64
        };
        1.0 - (within - mean(centered.iter().map(products))) / pooled
    };
    let (mut time, mut last_pair) = (-1.0, f64::INFINITY);
    for lag in (0..length.saturating_sub(2)).step_by(2) {
        let even = if lag == 0 { 1.0 } else { correlation(lag) };
        let pair = even + correlation(lag + 1);
        if pair <= 0.0 {
            // The even lag still counts by itself if it is positive.
            time += even.max(0.0);
            break;
        }
        last_pair = pair.min(last_pair);
        time += 2.0 * last_pair;
    }
    // Antithetic chains may have more effective draws than draws, within a limit.
    total / time.max(1.0 / total.log10())
}

#[cfg(test)]
mod tests {
    use super::{Diagnostics, effective_draws, quantile, rank_normalized, split};
    use rand::RngExt;
    use rand_distr::StandardNormal;
    use seed::Seed;

    /// Chains of an autoregression x ← φx + noise, each about its own center.
    fn chains(correlation: f64, centers: &[f64], draws: usize) -> Vec<Vec<f64>> {
        let mut generator = Seed::new(5).generator();
        let noise = (1.0 - correlation * correlation).sqrt();
        centers
            .iter()
            .map(|center| {
                let mut x: f64 = generator.sample(StandardNormal);
                (0..draws)
                    .map(|_| {
                        x = correlation * x + noise * generator.sample::<f64, _>(StandardNormal);
                        center + x
                    })
                    .collect()
            })
            .collect()
    }

    #[test]
    fn an_autoregression_is_worth_what_theory_says() {
        // The integrated autocorrelation time is (1 + φ)/(1 − φ).
        for correlation in [-0.3, 0.0, 0.5, 0.9] {
            let found = Diagnostics::of(&chains(correlation, &[0.0; 4], 5000));
            let theory = 20_000.0 * (1.0 - correlation) / (1.0 + correlation);
            assert!((found.bulk / theory - 1.0).abs() < 0.15, "{correlation}: {found:?}");
            assert!(found.r_hat < 1.01, "{correlation}: {found:?}");
        }
    }

    #[test]
    fn chains_in_different_places_are_seen() {
        let found = Diagnostics::of(&chains(0.0, &[0.0, 0.0, 0.0, 1.0], 1000));
        assert!(found.r_hat > 1.05, "{found:?}");
        assert!(found.bulk < 100.0, "{found:?}");
    }

    #[test]
    fn chains_of_different_width_are_seen() {
        let mut wide = chains(0.0, &[0.0; 4], 1000);
        wide[0].iter_mut().for_each(|draw| *draw *= 3.0);
        assert!(Diagnostics::of(&wide).r_hat > 1.05);
    }

    #[test]
    fn chains_that_stand_still_and_chains_of_nothing_have_not_converged() {
        for draws in [0, 3, 100] {
            let found = Diagnostics::of(&vec![vec![1.0; draws]; 4]);
            assert!(found.r_hat.is_infinite() && found.bulk < 1.0, "{found:?}");
        }
        assert!(effective_draws(&[]) < 1.0);
    }

    #[test]
    fn ranks_halves_and_quantiles() {
        let scores = rank_normalized(&[vec![5.0, 1.0], vec![1.0, 9.0]]);
        // Ranks 3, 1.5, 1.5, 4 of 4: the two ties share a score.
        assert!((scores[0][1] - scores[1][0]).abs() < 1e-15);
        // Normal quantile at (3 − 3/8)/(4 + 1/4).
        assert!((scores[0][0] - 0.299_307).abs() < 1e-6, "{}", scores[0][0]);
        assert_eq!(split(&[vec![1.0, 2.0, 3.0, 4.0, 5.0]]), [vec![1.0, 2.0], vec![4.0, 5.0]]);
        assert!((quantile(&[4.0, 1.0, 2.0, 3.0], 0.5) - 2.5).abs() < 1e-15);
    }
}
