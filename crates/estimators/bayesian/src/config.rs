//! Settings of the estimator.

use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Method that gives λ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Posterior mean in closed form.
    Conjugate,
    /// Mean of the no-U-turn sampler's draws.
    Nuts,
}

/// Settings of the Bayesian regression. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct BayesianConfig {
    /// Method that gives λ.
    pub method: Method,
    /// Prior width κ: standard deviation of ln A₀ and λ, in units of the scatter.
    pub prior_width: f64,
    /// Shape a₀ of the prior of the scatter's variance.
    pub prior_noise_shape: f64,
    /// Rate b₀ of the prior of the scatter's variance, in units of the variance of ln A.
    pub prior_noise_rate: f64,
    /// `true` if the sampler checks the closed form.
    pub check_by_sampling: bool,
    /// Number of chains.
    pub chains: usize,
    /// Warm-up transitions of each chain, which tune the sampler and are discarded.
    pub warm_up: u64,
    /// Draws of each chain after the warm-up.
    pub draws: u64,
    /// Acceptance probability that the step size is tuned for.
    pub target_acceptance: f64,
    /// Most doublings of a trajectory.
    pub deepest_tree: u32,
    /// Fewest effective draws, bulk and tail, with which the sampler has converged.
    pub least_effective_draws: f64,
    /// Half-width of the interval that the chains' starts are drawn from, in scaled units.
    pub initial_scale: f64,
}

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    Field::new("method", Kind::Choice(&["conjugate", "nuts"]), Default::Text("conjugate"))
        .meaning("Source of the decay rate: the posterior mean in closed form, or the sampler's draws.")
        .source("both are the same posterior; the closed form has no Monte-Carlo error"),
    Field::new("prior_width", Kind::Float { min: 0.1, max: 1e8 }, Default::Float(1e5))
        .unit("standard deviations of the scatter")
        .meaning(
            "Prior standard deviation of ln A0 about the mean ln A, and of the whole decay about \
                0.",
        )
        .source("pulls the rate of 69 peaks by 0.22 / width^2 of itself: 2e-11; 100 pulls by 2e-5"),
    Field::new("prior_noise_shape", Kind::Float { min: -1.0, max: 1e6 }, Default::Float(-1.0))
        .meaning(
            "Shape of the inverse-gamma prior of the scatter's variance; proper if both are above \
                0.",
        )
        .source(
            "with a wide prior, -1 and rate 0 give the reference posterior (Gelman et al. 2013, \
                14.2)",
        ),
    Field::new("prior_noise_rate", Kind::Float { min: 0.0, max: 1e6 }, Default::Float(0.0))
        .unit("variances of ln A")
        .meaning("Rate of the inverse-gamma prior of the scatter's variance.")
        .source("see prior_noise_shape"),
    Field::new("check_by_sampling", Kind::Boolean, Default::Boolean(true))
        .meaning("Whether the sampler checks the closed form, which it never changes.")
        .source("a few milliseconds"),
    Field::new("chains", Kind::Integer { min: 2, max: 64 }, Default::Integer(4))
        .meaning("Number of chains, each from its own drawn start.")
        .source("Vehtari et al. 2021, section 4"),
    Field::new("warm_up", Kind::Integer { min: 100, max: 1_000_000 }, Default::Integer(500))
        .meaning("Transitions of each chain that tune step size and metric and are thrown away.")
        .source("half of Stan's 1000: three parameters"),
    Field::new("draws", Kind::Integer { min: 4, max: 1_000_000 }, Default::Integer(1000))
        .meaning("Draws of each chain after the warm-up.")
        .source("Stan's default"),
    Field::new("target_acceptance", Kind::Float { min: 0.5, max: 0.99 }, Default::Float(0.8))
        .meaning("Acceptance that the step size is tuned for.")
        .source("Stan's default"),
    Field::new("deepest_tree", Kind::Integer { min: 1, max: 15 }, Default::Integer(10))
        .meaning("Most doublings of a trajectory.")
        .source("Stan's default"),
    Field::new("least_effective_draws", Kind::Float { min: 100.0, max: 1e9 }, Default::Float(400.0))
        .meaning("Fewest effective draws, bulk and tail, for the sampler to have converged.")
        .source("Vehtari et al. 2021, section 4: 400 with four chains"),
    Field::new("initial_scale", Kind::Float { min: 0.01, max: 10.0 }, Default::Float(1.0))
        .meaning("The chains start uniformly within this far from zero, in scaled units.")
        .source(
            "many widths of the posterior apart, and short of any nearly straight envelope's \
                answer",
        ),
];
