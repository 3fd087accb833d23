//! Physics-informed network: trajectories as networks of time, and the coefficients of a stated law inferred
//! with them.
//!
//! Every window of the training records gets a network θ̂(t) with Fourier features. Weights and coefficients
//! together minimize Σ (θ̂(tᵢ) − yᵢ)²/σ² + Σ (θ̂″ − Σ cⱼ·fⱼ(θ̂, θ̂′, u))²/τ² by Levenberg–Marquardt, with the
//! networks eliminated window by window; τ falls from half the typical acceleration to a thousandth of it.
//! Dry friction jumps at turning points and a network cannot, so the windows of a law with dry friction end
//! there. Standard errors are those of the linearized problem. Predictions come from the law with the
//! inferred coefficients.
//!
//! Raissi, Perdikaris, Karniadakis, Journal of Computational Physics 378 (2019) 686 (inverse problems);
//! Tancik et al., NeurIPS 33 (2020) (Fourier features).

mod trajectory;
mod windows;

use super::library::{LAW, Library, law, restore, thresholded};
use super::sindy::SparseSettings;
use super::weak_sindy;
use crate::data::DataSet;
use crate::flow::{Posterior, Running};
use crate::judge::validation_error;
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner, Step};
use estimator::Reached;
use least_squares::{Descent, Method};
use serde::Deserialize;
use settings::{Default, Field, Kind as Value, Resolved, SettingsError};
use trajectory::Shape;
use windows::{Problem, Sizes, Unknowns, jumps, stretches};

/// Identifier.
const ID: &str = "pinn";

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Physics-informed network",
    summary: "Fits networks of time to windows of the records and infers the coefficients of a stated law with them.",
    reference: "Raissi, Perdikaris, Karniadakis, Journal of Computational Physics 378 (2019) 686-707",
    kind: Kind::Regressor,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(Pinn::read(resolved)?) as Box<dyn Learner>),
    restore: |stored| restore(ID, stored),
};

const FIELDS: &[Field] = &[
    LAW,
    Field::new("window_periods", Value::Float { min: 0.1, max: 100.0 }, Default::Float(1.0))
        .unit("periods")
        .meaning("Length of the window that one network describes."),
    Field::new("frequencies", Value::Integer { min: 1, max: 64 }, Default::Integer(8))
        .meaning("Fourier features: this many frequencies, half a cycle of the window apart.")
        .source("Tancik et al. 2020"),
    Field::new("hidden_units", Value::Integer { min: 0, max: 512 }, Default::Integer(4))
        .meaning("Hidden units of each network."),
    Field::new("samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(6_000))
        .unit("samples")
        .meaning("Most training samples; if there are more, evenly spaced windows are used."),
    Field::new("max_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(20))
        .unit("steps")
        .meaning("Most steps at each weight of the physics."),
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinn {
    library: SparseSettings,
    keys: Keys,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Keys {
    library: Vec<String>,
    window_periods: f64,
    frequencies: usize,
    hidden_units: usize,
    samples: usize,
    max_steps: u64,
}

/// Successive tolerances of the law's residual, relative to the typical acceleration.
const TOLERANCES: [f64; 5] = [0.5, 0.1, 0.02, 0.005, 0.001];

/// Method of the fit at one tolerance of the law.
const METHOD: Method =
    Method { first: 1e-4, least: 1e-12, tolerance: 1e-5, max_damping: 5e7, ..Method::TENFOLD };

impl Pinn {
    fn read(resolved: &Resolved) -> Result<Self, SettingsError> {
        let keys: Keys = resolved.section(ID)?;
        Ok(Self { library: SparseSettings::of_terms(resolved, ID, keys.library.clone())?, keys })
    }
}

impl Learner for Pinn {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let terms = self.library.terms(data);
        let library = Library::new(terms.clone());
        let shape = Shape { frequencies: self.keys.frequencies, hidden: self.keys.hidden_units };
        let seconds = self.keys.window_periods * data.period_s;
        let pieces = stretches(data, jumps(&library), seconds, self.keys.samples);
        if pieces.is_empty() {
            let problem = "no stretch of ten samples between two turning points; give records sampled faster"
                .to_owned();
            return Err(LearnError::Unsolvable { what: "pinn", problem });
        }
        let problem = Problem::new(shape, &library, &pieces, data);
        let seed = context.seed.child("initial weights");
        let networks = (0..pieces.len()).map(|at| shape.start(&seed.child(&at.to_string()))).collect();
        // First guess by the weak form; every step also changes the coefficients.
        let start = thresholded(&weak_sindy::regression(data, &terms), 0.0);
        let mut search = Search {
            problem: &problem,
            unknowns: Unknowns { coefficients: start, networks },
            sizes: Sizes { noise: data.noise, tolerance: data.scale.acceleration },
            steps: 0,
            converged: true,
        };
        for tolerance in TOLERANCES {
            search.sizes.tolerance = tolerance * data.scale.acceleration;
            search.settle(context.steps(self.keys.max_steps), context)?;
        }
        let standing = problem.standing(&search.unknowns, search.sizes);
        // The remaining residuals set the weights of the observations and of the law.
        let sizes = Sizes {
            noise: standing.misfit.max(data.noise),
            tolerance: standing.residual.max(search.sizes.tolerance),
        };
        let covariance = problem.equations(&search.unknowns, sizes).covariance();
        let weights = &search.unknowns.coefficients;
        let spread: Option<Vec<f64>> =
            covariance.as_ref().map(|all| all.diagonal().iter().map(|own| own.sqrt()).collect());
        let posterior = Posterior::of(weights, covariance.as_ref(), &context.seed);
        let model = |posterior, noise| {
            law(ID, &library, (weights, spread.as_deref()), posterior, Running::new(data, noise), data)
        };
        let error = validation_error(&model(Posterior::default(), data.noise), data);
        let noise = if error.is_finite() { error } else { standing.misfit };
        let reached = if search.converged { Reached::Converged } else { Reached::BudgetSpent };
        Ok(Fitted { model: Box::new(model(posterior, noise)), reached, steps: search.steps })
    }
}

/// Search in progress.
struct Search<'a> {
    problem: &'a Problem<'a>,
    unknowns: Unknowns,
    sizes: Sizes,
    steps: u64,
    converged: bool,
}

impl Search<'_> {
    /// Minimizes the objective at one tolerance by Levenberg–Marquardt, in at most `most` accepted steps.
    fn settle(&mut self, mut most: u64, context: &Context<'_>) -> Result<(), LearnError> {
        let (problem, sizes) = (self.problem, self.sizes);
        let mut best = (problem.standing(&self.unknowns, sizes), self.unknowns.clone());
        let mut equations = None;
        let mut descent = Descent::new(METHOD);
        while most > 0
            && let Ok(damping) = descent.next_damping()
        {
            context.check()?;
            let system = equations.get_or_insert_with(|| problem.equations(&best.1, sizes));
            let next = system.step(&best.1, damping).map(|next| (problem.standing(&next, sizes), next));
            if descent.advance(&mut best, next, |(standing, _)| standing.objective) {
                (equations, most) = (None, most - 1);
                self.steps += 1;
                let phase = format!("law held to {:.3e}", sizes.tolerance);
                (context.observe)(&Step { step: self.steps, phase, train: best.0.misfit, validation: None });
            }
        }
        self.converged = descent.is_converged();
        self.unknowns = best.1;
        Ok(())
    }
}
