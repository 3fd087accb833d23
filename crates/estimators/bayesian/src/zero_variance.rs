//! Means of draws, with most of their Monte-Carlo error removed by means of the gradients that the sampler
//! computes anyway.
//!
//! Let g be the gradient of the log density. Every gⱼ, and xᵢgⱼ + xⱼgᵢ + 2δᵢⱼ for every pair i ≤ j, has a
//! mean of exactly zero under the density. So the part of a quantity's draws that is a linear combination of
//! these nine is noise, and is subtracted. The coefficients of the regression are estimated from the same
//! draws, which biases the mean by a share of its own error that falls as one over the number of draws.
//!
//! Only the gradient of the model is used; the closed-form posterior is not. (The other textbook remedy, the
//! average over the draws of σ of the mean of λ given σ, would use it: with the conjugate prior that mean
//! does not depend on σ, so that the result would be the closed form for any sample.)
//!
//! Reference: Mira, Solgi, Imparato, Stat. Comput. 23 (2013) 653, second-degree polynomials.

use crate::diagnostics::{effective_draws, split};
use crate::nuts::Point;
use nalgebra::{Cholesky, SMatrix, SVector, Vector3};

/// Mean with its Monte-Carlo standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mean {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

const CONTROLS: usize = 9;

type Controls = SVector<f64, CONTROLS>;

/// Fewest draws from which the regression's nine coefficients are estimated.
const FEWEST_DRAWS: usize = 50 * CONTROLS;

/// Returns the mean of a linear quantity w·position over the chains' draws; the plain mean if there are too
/// few draws for a regression.
pub(crate) fn mean(chains: &[Vec<Point>], weights: &Vector3<f64>) -> Mean {
    let plain: Vec<Vec<f64>> = values(chains, weights);
    let reduced = without_noise(chains, &plain).unwrap_or_else(|| plain.clone());
    summarize(&reduced)
}

/// Returns the plain mean with its error.
pub(crate) fn plain_mean(chains: &[Vec<Point>], weights: &Vector3<f64>) -> Mean {
    summarize(&values(chains, weights))
}

/// Returns the quantity's draws, chain by chain.
pub(crate) fn values(chains: &[Vec<Point>], weights: &Vector3<f64>) -> Vec<Vec<f64>> {
    chains.iter().map(|chain| chain.iter().map(|draw| draw.position.dot(weights)).collect()).collect()
}

fn summarize(chains: &[Vec<f64>]) -> Mean {
    let count = chains.iter().map(Vec::len).sum::<usize>() as f64;
    let value = chains.iter().flatten().sum::<f64>() / count;
    let squares: f64 = chains.iter().flatten().map(|draw| (draw - value).powi(2)).sum();
    let error = (squares / count / effective_draws(&split(chains))).sqrt();
    Mean { value, error }
}

fn without_noise(chains: &[Vec<Point>], plain: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let draws = || chains.iter().flatten();
    let count = draws().count();
    if count < FEWEST_DRAWS {
        return None;
    }
    // Centered and scaled by the draws themselves, so that the nine controls are of similar size.
    let center: Vector3<f64> = draws().map(|draw| draw.position).sum::<Vector3<f64>>() / count as f64;
    let squares: Vector3<f64> =
        draws().map(|draw| (draw.position - center).map(|x| x * x)).sum::<Vector3<f64>>() / count as f64;
    let scale = squares.map(f64::sqrt);
    let controls = |draw: &Point| {
        let x = (draw.position - center).component_div(&scale);
        let g = draw.gradient.component_mul(&scale);
        Controls::from([
            g.x,
            g.y,
            g.z,
            2.0 + 2.0 * x.x * g.x,
            2.0 + 2.0 * x.y * g.y,
            2.0 + 2.0 * x.z * g.z,
            x.x * g.y + x.y * g.x,
            x.x * g.z + x.z * g.x,
            x.y * g.z + x.z * g.y,
        ])
    };
    let average = draws().map(controls).sum::<Controls>() / count as f64;
    let typical = plain.iter().flatten().sum::<f64>() / count as f64;
    let mut matrix = SMatrix::<f64, CONTROLS, CONTROLS>::zeros();
    let mut right = Controls::zeros();
    for (draw, value) in draws().zip(plain.iter().flatten()) {
        let control = controls(draw) - average;
        matrix.ger(1.0, &control, &control, 1.0);
        right += control * (value - typical);
    }
    let coefficients = Cholesky::new(matrix)?.solve(&right);
    let finite = coefficients.iter().all(|coefficient| coefficient.is_finite());
    let reduced = |chain: &Vec<Point>, values: &Vec<f64>| {
        chain.iter().zip(values).map(|(draw, value)| value - coefficients.dot(&controls(draw))).collect()
    };
    finite.then(|| chains.iter().zip(plain).map(|(chain, values)| reduced(chain, values)).collect())
}

#[cfg(test)]
mod tests {
    use super::{mean, plain_mean};
    use crate::nuts::Point;
    use nalgebra::Vector3;
    use rand::RngExt;
    use rand_distr::StandardNormal;
    use seed::Seed;

    #[test]
    fn a_normal_posterior_leaves_no_noise_at_all() {
        // Independent draws of a normal about (1, 2, 3): its gradient is linear, and the remainder is
        // constant.
        let mut generator = Seed::new(2).generator();
        let chains: Vec<Vec<Point>> = (0..4)
            .map(|_| {
                let draw = |_| {
                    let noise = Vector3::from_fn(|_, _| generator.sample::<f64, _>(StandardNormal));
                    Point {
                        position: Vector3::new(1.0, 2.0, 3.0) + noise * 0.5,
                        log_density: -0.5 * noise.norm_squared(),
                        gradient: -noise / 0.5,
                    }
                };
                (0..500).map(draw).collect()
            })
            .collect();
        let second = Vector3::new(0.0, 1.0, 0.0);
        let (plain, reduced) = (plain_mean(&chains, &second), mean(&chains, &second));
        assert!((plain.value - 2.0).abs() > 1e-4 && plain.error > 5e-3, "{plain:?}");
        assert!((reduced.value - 2.0).abs() < 1e-12, "{reduced:?}");
    }
}
