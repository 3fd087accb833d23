//! Sampling of the model by several chains, with summaries of their draws.

use crate::chain::{Chain, Tuning};
use crate::config::BayesianConfig;
use crate::diagnostics::{Diagnostics, quantile};
use crate::model::Model;
use crate::nuts::{LogDensity, Point};
use crate::zero_variance::{self, Mean};
use estimator::FitContext;
use nalgebra::Vector3;
use rand::RngExt;

/// R̂ below which the chains agree.
///
/// Reference: Vehtari, Gelman, Simpson, Carpenter, Bürkner, Bayesian Anal. 16 (2021) 667, section 4.
pub(crate) const LARGEST_R_HAT: f64 = 1.01;

/// Draws of all chains.
pub(crate) struct Sample {
    /// Draws after the warm-up, chain by chain.
    chains: Vec<Vec<Point>>,
    /// Last points of the chains.
    places: Vec<Point>,
    /// Number of transitions of each chain.
    pub(crate) steps: u64,
    /// Number of divergent transitions after the warm-up, over all chains.
    pub(crate) divergences: u64,
    /// `true` if a stop was requested.
    pub(crate) interrupted: bool,
    /// Worst diagnostics among the three quantities.
    pub(crate) diagnostics: Diagnostics,
}

impl Sample {
    /// Draws from the model, with the chains in lockstep. `watch` receives the number of transitions, the
    /// mean of −ln density over the chains, and r, before the first transition and after each one.
    pub(crate) fn draw(
        config: &BayesianConfig,
        model: &Model,
        context: &FitContext<'_>,
        mut watch: impl FnMut(u64, f64, f64),
    ) -> Self {
        let limit = context.step_limit(config.warm_up.saturating_add(config.draws));
        let tuning = Tuning {
            warm_up: config.warm_up,
            target_acceptance: config.target_acceptance,
            deepest: config.deepest_tree,
        };
        let mut chains: Vec<_> = (1..=config.chains)
            .map(|number| {
                let start = config.start(context, number);
                let generator = context.seed(&format!("chain {number}")).generator();
                Chain::new(model, start, tuning, generator)
            })
            .collect();
        let count = chains.len() as f64;
        let mut steps: u64 = 0;
        let mut sum = 0.0;
        let interrupted = loop {
            let places = || chains.iter().map(Chain::point);
            let loss = -places().map(|point| point.log_density).sum::<f64>() / count;
            let here = places().map(|point| point.position.y).sum::<f64>() / count;
            let drawn = steps.saturating_sub(config.warm_up);
            sum += if drawn > 0 { here } else { 0.0 };
            watch(steps, loss, if drawn > 0 { sum / drawn as f64 } else { here });
            if context.is_canceled() {
                break true;
            }
            if steps >= limit {
                break false;
            }
            chains.iter_mut().for_each(Chain::step);
            steps += 1;
        };
        let places = chains.iter().map(|chain| *chain.point()).collect();
        let divergences = chains.iter().map(|chain| chain.divergences).sum();
        let chains: Vec<Vec<Point>> = chains.into_iter().map(|chain| chain.draws).collect();
        let diagnostics = worst(&chains);
        Self { chains, places, steps, divergences, interrupted, diagnostics }
    }

    /// Returns the posterior mean of w·(u, r, ℓ); before the first draw, that of the chains' current points.
    pub(crate) fn mean(&self, weights: &Vector3<f64>) -> Mean {
        if self.is_empty() {
            let total: f64 = self.places.iter().map(|place| place.position.dot(weights)).sum();
            return Mean { value: total / self.places.len() as f64, error: f64::INFINITY };
        }
        zero_variance::mean(&self.chains, weights)
    }

    /// Returns the mean of the draws without control variates, which is used to check the closed form.
    pub(crate) fn plain_mean(&self, weights: &Vector3<f64>) -> Mean {
        zero_variance::plain_mean(&self.chains, weights)
    }

    /// Returns the standard deviation of w·(u, r, ℓ) over the draws, and its quantiles 2.5 % and 97.5 %.
    pub(crate) fn spread(&self, weights: &Vector3<f64>) -> (f64, [f64; 2]) {
        let draws = zero_variance::values(&self.chains, weights).concat();
        let count = draws.len() as f64;
        let center = draws.iter().sum::<f64>() / count;
        let squares: f64 = draws.iter().map(|draw| (draw - center).powi(2)).sum();
        ((squares / (count - 1.0)).sqrt(), [quantile(&draws, 0.025), quantile(&draws, 0.975)])
    }

    /// Returns the standard deviation of a new value at a time τ, by the law of total variance: the mean of
    /// σ² plus the variance of u − rτ over the draws.
    pub(crate) fn predictive_deviation(&self, time: f64) -> f64 {
        let (deviation, _) = self.spread(&Vector3::new(1.0, -time, 0.0));
        let variances = self.chains.iter().flatten().map(|draw| (2.0 * draw.position.z).exp());
        let count = self.chains.iter().map(Vec::len).sum::<usize>() as f64;
        (variances.sum::<f64>() / count + deviation * deviation).sqrt()
    }

    /// Returns the share of draws of w·(u, r, ℓ) below a value.
    #[cfg(test)]
    pub(crate) fn share_below(&self, weights: &Vector3<f64>, value: f64) -> f64 {
        let draws = zero_variance::values(&self.chains, weights).concat();
        draws.iter().filter(|&&draw| draw < value).count() as f64 / draws.len() as f64
    }

    /// Returns `true` if there are no draws yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.chains.iter().all(Vec::is_empty)
    }

    /// Returns `true` if the chains agree, there are enough effective draws and no trajectory diverged.
    pub(crate) fn converged(&self, config: &BayesianConfig) -> bool {
        let Diagnostics { r_hat, bulk, tail } = self.diagnostics;
        r_hat < LARGEST_R_HAT && bulk.min(tail) >= config.least_effective_draws && self.divergences == 0
    }

    /// Returns R̂ and effective draws in words.
    pub(crate) fn in_words(&self) -> String {
        let Diagnostics { r_hat, bulk, tail } = self.diagnostics;
        format!("R-hat {r_hat:.4}, effective draws {bulk:.0} (bulk) and {tail:.0} (tail)")
    }
}

/// Returns the worst diagnostics among the three quantities.
fn worst(chains: &[Vec<Point>]) -> Diagnostics {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    axes.iter().map(|axis| Diagnostics::of(&zero_variance::values(chains, axis))).fold(
        Diagnostics { r_hat: 0.0, bulk: f64::INFINITY, tail: f64::INFINITY },
        |worst, next| Diagnostics {
            r_hat: worst.r_hat.max(next.r_hat),
            bulk: worst.bulk.min(next.bulk),
            tail: worst.tail.min(next.tail),
        },
    )
}

impl BayesianConfig {
    /// Draws the start of a chain: u, r and ℓ uniform in −scale..scale. A steep line has u near 1.7 and r
    /// near 3.5 in these units. The starts are many posterior widths apart, and none is the answer.
    fn start(&self, context: &FitContext<'_>, chain: usize) -> Vector3<f64> {
        let mut generator = context.seed(&format!("start of chain {chain}")).generator();
        Vector3::from_fn(|_, _| self.initial_scale * (2.0 * generator.random::<f64>() - 1.0))
    }
}

/// Returns the sum of −ln density over the starts of the chains; not finite if the density is undefined at a
/// start.
pub(crate) fn loss_at_start(config: &BayesianConfig, model: &Model, context: &FitContext<'_>) -> f64 {
    -(1..=config.chains).map(|number| model.at(config.start(context, number)).log_density).sum::<f64>()
}
