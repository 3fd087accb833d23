//! Symbolic regression of the torque in weak form.
//!
//! Sums of expressions of position, velocity and input evolve. A sum's weights come from least squares in
//! weak form, in which no observation is differentiated. The Pareto front of error and number of nodes is
//! scored on the validation part; the simplest law within one standard error of the best is chosen, and
//! nothing is added to it. Finally its weights are refitted to trajectories.
//!
//! Searson, Leahy, Willis, IMECS 2010 (sums with least-squares weights); Cranmer, arXiv:2305.01582 (2023);
//! Breiman, Friedman, Olshen, Stone, Classification and Regression Trees (1984), section 3.4.3 (one standard
//! error).

mod evolution;
mod field;
mod weak;

use super::torque::{Progress, progressive};
use crate::data::DataSet;
use crate::expression::Expression;
use crate::flow::{Field, Fit, FlowModel, Penalty, Posterior, Running};
use crate::judge::validation_error;
use crate::linear::least_squares;
use crate::{Coefficient, Context, Entry, Fitted, Kind, LearnError, Learner, Model, Step, Stored};
use estimator::Reached;
use evolution::Grammar;
use field::Sum;
use rand::{Rng, RngExt};
use serde::Deserialize;
use serde_json::json;
use settings::{Default, Field as Key, Kind as Value};
use std::collections::BTreeMap;
use weak::Weak;

/// Identifier.
const ID: &str = "symbolic";

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Symbolic regression",
    summary: "Evolves an expression for the torque in weak form and takes the simplest that predicts as well as any.",
    reference: "Cranmer, arXiv:2305.01582 (2023)",
    kind: Kind::Regressor,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(resolved.section::<Symbolic>(ID)?) as Box<dyn Learner>),
    restore: |stored| restored(stored),
};

const FIELDS: &[Key] = &[
    Key::new("population", Value::Integer { min: 2, max: 100_000 }, Default::Integer(120))
        .meaning("Sums of expressions in a generation."),
    Key::new("generations", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(60))
        .meaning("Generations."),
    Key::new("parsimony", Value::Float { min: 0.0, max: 10.0 }, Default::Float(0.02))
        .meaning("Share by which one more node must lower the error to be preferred in breeding."),
    Key::new("most_parts", Value::Integer { min: 1, max: 64 }, Default::Integer(7))
        .meaning("Most expressions of a sum."),
    Key::new("most_nodes", Value::Integer { min: 1, max: 64 }, Default::Integer(7))
        .meaning("Most nodes of an expression."),
    Key::new("samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(6_000))
        .unit("samples")
        .meaning(
            "Most training samples of the refit to trajectories; if there are more, evenly spaced \
                pieces are used.",
        ),
    Key::new("max_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(30))
        .unit("steps")
        .meaning("Most steps of the refit on pieces of each length."),
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Symbolic {
    population: usize,
    generations: u64,
    parsimony: f64,
    most_parts: usize,
    most_nodes: usize,
    samples: usize,
    max_steps: u64,
}

/// Largest number of windows in weak form.
const MOST_WINDOWS: usize = 500;

/// Tournament size: a parent is the best of this many sums.
const TOURNAMENT: usize = 4;

/// Sum with its weights and its relative error on the training part.
#[derive(Debug, Clone)]
struct Individual {
    sum: Sum,
    weights: Vec<f64>,
    error: f64,
    score: f64,
}

impl Symbolic {
    /// Fits the weights of a sum by least squares; `None` if they are not finite or cannot be determined.
    fn individual(&self, weak: &Weak, parts: Vec<Expression>) -> Option<Individual> {
        let columns = weak.columns(&parts)?;
        let weights: Vec<f64> = least_squares(&columns, &weak.right)?.iter().copied().collect();
        let errors = weak.errors(&parts, &weights)?;
        let error = (errors.iter().sum::<f64>() / errors.len().max(1) as f64).max(f64::MIN_POSITIVE);
        let sum = Sum { parts };
        let score = error.ln() + self.parsimony * sum.nodes() as f64;
        (weights.iter().all(|weight| weight.is_finite()) && score.is_finite()).then_some(Individual {
            sum,
            weights,
            error,
            score,
        })
    }

    /// Evolves sums and returns the Pareto front of error and number of nodes, simplest first.
    fn evolved(
        &self,
        weak: &Weak,
        grammar: Grammar,
        context: &Context<'_>,
    ) -> Result<Vec<Individual>, LearnError> {
        let mut generator = context.seed.child("evolution").generator();
        let drawn = (0..self.population).map(|_| grammar.tidied(grammar.sum(&mut generator)));
        let mut population: Vec<Individual> =
            drawn.filter_map(|parts| self.individual(weak, parts)).collect();
        let mut front: BTreeMap<usize, Individual> = BTreeMap::new();
        for generation in 0..=context.steps(self.generations) {
            context.check()?;
            population.iter().for_each(|own| offer(&mut front, own));
            let least = front.values().map(|own| own.error).fold(f64::INFINITY, f64::min);
            let phase = "evolution, error in weak form".to_owned();
            (context.observe)(&Step { step: generation, phase, train: least.sqrt(), validation: None });
            population.extend(front.values().cloned());
            population.sort_by(|a, b| a.score.total_cmp(&b.score));
            let children: Vec<Individual> = (0..self.population)
                .filter_map(|_| {
                    let [one, other] = [(); 2].map(|()| winner(&population, &mut generator));
                    let parts = grammar.child([&one?.sum.parts, &other?.sum.parts], &mut generator);
                    self.individual(weak, parts)
                })
                .collect();
            population.truncate(self.population / 10);
            population.extend(children);
        }
        population.iter().for_each(|own| offer(&mut front, own));
        Ok(front.into_values().collect())
    }

    /// Returns the simplest individual of a front whose error on validation windows is within one standard
    /// error of the smallest.
    fn chosen(front: Vec<Individual>, held_out: &Weak) -> Option<Individual> {
        let judged: Vec<(f64, f64, Individual)> = front
            .into_iter()
            .filter_map(|own| {
                let errors = held_out.errors(&own.sum.parts, &own.weights)?;
                let count = errors.len().max(2) as f64;
                let mean = errors.iter().sum::<f64>() / count;
                let spread = errors.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / (count - 1.0);
                Some((mean, (spread / count).sqrt(), own))
            })
            .collect();
        let best = judged.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let bound = best.0 + best.1;
        judged.into_iter().find(|(mean, ..)| *mean <= bound).map(|(.., own)| own)
    }
}

/// Adds an individual to the front unless a simpler one, or one of the same size, is as good.
fn offer(front: &mut BTreeMap<usize, Individual>, own: &Individual) {
    let nodes = own.sum.nodes();
    if front.range(..=nodes).any(|(_, other)| other.error <= own.error) {
        return;
    }
    front.retain(|other, held| *other < nodes || held.error < own.error);
    front.insert(nodes, own.clone());
}

/// Returns the best of a few randomly drawn individuals.
fn winner<'a, G: Rng>(population: &'a [Individual], generator: &mut G) -> Option<&'a Individual> {
    // The population is sorted by score.
    let places = (0..TOURNAMENT).map(|_| generator.random_range(0..population.len().max(1)));
    places.min().and_then(|place| population.get(place))
}

impl Learner for Symbolic {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let weak = |parts| Weak::new(parts, data.period_s, data.hold, MOST_WINDOWS).checked();
        let (train, held_out) = (weak(&data.train)?, weak(&data.validation)?);
        let grammar = Grammar {
            driven: data.is_driven(),
            angle: data.unit == "rad",
            most_parts: self.most_parts,
            most_nodes: self.most_nodes,
        };
        let front = self.evolved(&train, grammar, context)?;
        let Some(own) = Self::chosen(front, &held_out) else {
            let problem = "no drawn law was finite; give it a larger population".to_owned();
            return Err(LearnError::Unsolvable { what: "symbolic", problem });
        };
        let flat = Penalty { mean: vec![0.0; own.weights.len()], precision: vec![0.0; own.weights.len()] };
        let plain = |weights: &[f64]| model(&own.sum, weights, None, Running::new(data, data.noise), context);
        let validate = |weights: &[f64]| validation_error(&plain(weights), data);
        let progress = Progress { samples: self.samples, most_steps: self.max_steps };
        let evolved = context.steps(self.generations);
        match progressive(&own.sum, data, context, (&flat, progress), own.weights.clone(), &validate) {
            Ok((fit, steps)) => {
                let running = Running::new(data, fit.rms());
                let whole = model(&own.sum, &fit.weights, Some(&fit), running, context);
                let reached = if fit.converged { Reached::Converged } else { Reached::BudgetSpent };
                Ok(Fitted { model: Box::new(whole), reached, steps: evolved + steps })
            }
            // A law that cannot be refitted keeps the weights of the weak form.
            Err(LearnError::Diverged { .. }) => Ok(Fitted {
                model: Box::new(plain(&own.weights)),
                reached: Reached::Diverged,
                steps: evolved,
            }),
            Err(other) => Err(other),
        }
    }
}

fn model(
    sum: &Sum,
    weights: &[f64],
    fit: Option<&Fit>,
    running: Running,
    context: &Context<'_>,
) -> FlowModel {
    let covariance = fit.and_then(Fit::covariance);
    let error = |at: usize| covariance.as_ref().and_then(|all| all.get((at, at))).map(|own| own.sqrt());
    let coefficient = |(at, (part, value)): (usize, (&Expression, &f64))| Coefficient {
        name: part.to_string(),
        value: *value,
        unit: "of the acceleration per unit of the term".to_owned(),
        std_error: error(at).filter(|error| error.is_finite()),
        inclusion: None,
    };
    FlowModel {
        learner: ID,
        coefficients: sum.parts.iter().zip(weights).enumerate().map(coefficient).collect(),
        equation: Some(sum.equation(weights)),
        form: json!({ "parts": sum.parts }),
        field: Box::new(sum.clone()),
        weights: weights.to_vec(),
        posterior: Posterior::of(weights, covariance.as_ref(), &context.seed),
        running,
    }
}

fn restored(stored: &Stored) -> Result<Box<dyn Model>, LearnError> {
    let field = |form: &serde_json::Value| -> Result<Box<dyn Field>, LearnError> {
        let problem =
            |error: String| LearnError::Stored { problem: format!("the parts of the law: {error}") };
        let parts = form.get("parts").cloned().ok_or_else(|| problem("there are none".to_owned()))?;
        let parts: Vec<Expression> =
            serde_json::from_value(parts).map_err(|error| problem(error.to_string()))?;
        Ok(Box::new(Sum { parts }))
    };
    Ok(Box::new(FlowModel::restore(ID, stored, field)?))
}
