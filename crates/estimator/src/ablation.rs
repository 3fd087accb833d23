//! Ablations: an estimator's learned part is replaced to show what it contributes.
//!
//! The contribution of a learned part is measured: an estimator tagged [`Tag::Ablation`](crate::Tag::Ablation) is
//! fitted again with that part at zero and with noise as its input, and the battery fails if that changes nothing,
//! unless a waiver gives the reason.

use rand::RngExt;
use seed::Seed;

/// Returns white noise, uniform between the least and the largest of `values`, one number for each value.
pub(crate) fn noise_like(values: &[f64], seed: &Seed) -> Vec<f64> {
    let mut generator = seed.generator();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    values.iter().map(|_| least + (most - least) * generator.random::<f64>()).collect()
}

#[cfg(test)]
mod tests {
    use super::noise_like;
    use seed::Seed;

    #[test]
    fn noise_keeps_the_range_and_forgets_the_order() {
        let values: Vec<f64> = (0..1000).map(|at| -1.0 + 0.002 * f64::from(at)).collect();
        let noise = noise_like(&values, &Seed::new(3));
        assert_eq!(noise, noise_like(&values, &Seed::new(3)));
        assert!(noise.iter().all(|value| (-1.0..=0.998).contains(value)));
        let mean = noise.iter().sum::<f64>() / 1000.0;
        let product: f64 = values.iter().zip(&noise).map(|(a, b)| (a + 0.001) * (b - mean)).sum();
        assert!(mean.abs() < 0.1 && (product / 333.0).abs() < 0.15, "{mean} {product}");
        assert!(noise_like(&[], &Seed::new(3)).is_empty());
    }
}
