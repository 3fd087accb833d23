//! Confidence interval of a ratio of two sums that come in blocks.
//!
//! A bootstrap over a dozen segments mistook the decay of the motion for noise, or had too few segments.

use crate::noise::statistics::student_above;

/// Sums of a block: numerator and denominator.
pub(crate) type Block = [f64; 2];

/// Returns the 95 % interval of Σa/Σb, for sums that come in blocks, and blocks that come in runs of
/// neighbors. `None` if the data cannot distinguish Σb from zero or less, so that every ratio is possible.
///
/// A ratio R is in the interval if Σ(a − R·b) differs from zero by no more than t standard errors, which is a
/// quadratic condition on R. Variances come from differences of neighbors, cov(Σa, Σb) =
/// n·Σ(aⱼ₊₁ − aⱼ)(bⱼ₊₁ − bⱼ)/(2m) over the m pairs of n blocks: slow changes from block to block, such as a
/// simulator's error along a decay, are not noise.
/// # Reference
/// Fieller, Journal of the Royal Statistical Society B 16 (1954) 175; von Neumann, Kent, Bellinson, Hart, Annals of
/// Mathematical Statistics 12 (1941) 153, for variances from successive differences.
pub(crate) fn ratio_interval(runs: &[Vec<Block>]) -> Option<[f64; 2]> {
    let blocks = runs.iter().map(Vec::len).sum::<usize>() as f64;
    let [a, b] = runs.iter().flatten().fold([0.0; 2], |[a, b], block| [a + block[0], b + block[1]]);
    let pairs = runs.iter().flat_map(|run| run.iter().zip(run.iter().skip(1)));
    let (mut aa, mut ab, mut bb, mut count) = (0.0, 0.0, 0.0, 0.0_f64);
    for (one, next) in pairs {
        let [x, y] = [next[0] - one[0], next[1] - one[1]];
        (aa, ab, bb, count) = (aa + x * x, ab + x * y, bb + y * y, count + 1.0);
    }
    if count < 1.0 {
        return None;
    }
    // A variance from n − 1 successive differences of white noise is worth two thirds of as many degrees of
    // freedom.
    let t = student_above(0.025, (2.0 / 3.0 * count).max(1.0));
    let scale = t * t * blocks / (2.0 * count);
    let [square, product, constant] = [b * b - scale * bb, a * b - scale * ab, a * a - scale * aa];
    let under = product * product - square * constant;
    (b > 0.0 && square > 0.0 && under >= 0.0)
        .then(|| [(product - under.sqrt()) / square, (product + under.sqrt()) / square])
}

#[cfg(test)]
mod tests {
    use super::ratio_interval;
    use rand_distr::{Distribution, StandardNormal};

    /// Intervals of a known ratio hold it in 95 % of draws, with noise in both sums and a decaying
    /// denominator.
    #[test]
    fn intervals_hold() {
        let mut generator = seed::Seed::new(3).child("ratio").generator();
        let mut draw = || -> f64 { StandardNormal.sample(&mut generator) };
        for (ratio, noise) in [(0.0, 0.1), (0.3, 0.1), (0.3, 0.5)] {
            let held = (0..2000)
                .filter(|_| {
                    let block = |at: usize| {
                        let size = (-0.04 * at as f64).exp();
                        let common = noise * draw();
                        [ratio * size + common, size + 0.5 * common + 0.2 * noise * draw()]
                    };
                    let all: Vec<_> = (0..60).map(block).collect();
                    let runs: Vec<_> = all.chunks(6).map(<[_]>::to_vec).collect();
                    ratio_interval(&runs).is_some_and(|[low, high]| (low..=high).contains(&ratio))
                })
                .count();
            let share = held as f64 / 2000.0;
            assert!((share - 0.95).abs() < 0.015, "{ratio} {noise}: {share}");
        }
    }

    #[test]
    fn where_nothing_is_below_the_line_every_ratio_is_possible() {
        let blocks =
            |sign: f64| (0..40).map(move |at| [1.0, if at % 2 == 0 { sign } else { -1.0 }]).collect();
        assert_eq!(ratio_interval(&[blocks(1.0)]), None);
        // A positive sum that noise has made clearly negative is no better.
        assert_eq!(ratio_interval(&[vec![[1.0, -1.0]; 40]]), None);
        assert_eq!(ratio_interval(&[]), None);
        assert_eq!(ratio_interval(&[vec![[1.0, 1.0]]]), None);
    }
}
