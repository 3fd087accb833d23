//! Bayesian regression of the envelope: the posterior of a line with Gaussian scatter, in closed form and
//! by sampling.
//!
//! The model is ln A = ln A₀ − λt + scatter, the scatter normal with unknown σ. Its conjugate prior, the
//! normal–inverse-gamma, has a posterior in closed form: λ is Student's t. The no-U-turn sampler draws from
//! the same posterior in (ln A₀, λ, ln σ), several chains from starts far apart, and knows nothing of the
//! closed form. Either may give λ (`method`); by default the closed form does, and the sampler checks it:
//! a sampler's own Monte-Carlo error of λ is the posterior's standard deviation over √(effective draws),
//! 2.3 % over √4000, hence 4e-4, on a record of 69 peaks with R² = 0.964, which a bar of 1e-3 would catch
//! every few hundred seeds. Where the sampler gives λ, its gradients serve as control variates and take the
//! error to 1e-5.
//!
//! The prior is in units of the data's own range and scatter, so λ follows a change of unit exactly. By
//! default it is so wide that it pulls λ by 2e-11 of itself (0.22/κ² for 69 even peaks and a prior κ = 1e5
//! standard deviations of the scatter wide), and its intervals are those of the reference prior. On a record
//! without any scatter, it is the prior that keeps σ from zero: the stated error is then near 1e-6 of λ.
//!
//! References: Gelman, Carlin, Stern, Dunson, Vehtari, Rubin, Bayesian Data Analysis, 3rd ed. (2013),
//! chapters 3 and 14; Hoffman, Gelman, J. Mach. Learn. Res. 15 (2014) 1593; Vehtari, Gelman, Simpson,
//! Carpenter, Bürkner, Bayesian Anal. 16 (2021) 667.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod chain;
mod config;
mod diagnostics;
mod fit;
mod model;
mod nuts;
mod sampler;
#[cfg(test)]
mod tests;
mod zero_variance;

pub use config::{BayesianConfig, Method};

use estimator::{Entry, Estimator, Tag};

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "bayesian",
    paper_number: Some(18),
    title: "Bayesian regression",
    summary: "Posterior of a line with Gaussian scatter, in closed form, checked by the no-U-turn sampler.",
    tags: &[Tag::Interval],
    citations: &[
        "Gelman, Carlin, Stern, Dunson, Vehtari, Rubin, Bayesian Data Analysis, 3rd ed. (2013)",
        "Hoffman, Gelman, Journal of Machine Learning Research 15 (2014) 1593-1623",
        "Vehtari, Gelman, Simpson, Carpenter, Bürkner, Bayesian Analysis 16 (2021) 667-718",
        "Mira, Solgi, Imparato, Statistics and Computing 23 (2013) 653-662",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: BayesianConfig = settings.section("estimator")?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
