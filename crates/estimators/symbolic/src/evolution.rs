//! Evolution of a population of expressions.

use crate::config::SymbolicConfig;
use crate::constants::{FULL, fit_constants, loss};
use crate::data::Data;
use crate::expression::{Expression, Workspace};
use crate::front::Front;
use crate::variation::Grammar;
use estimator::{FitContext, Reached, Step};
use least_squares::Method;
use rand::{Rng, RngExt};
use std::collections::{BTreeMap, BTreeSet};

/// Most draws for an expression of the first population, and for a new child.
const MOST_DRAWS: usize = 50;

/// Number of fits of the constants of one structure, each from other starts.
const FITS_PER_STRUCTURE: u32 = 3;

/// Relative decrease of the loss in a step below which the fit is good enough for breeding.
const BREEDING_TOLERANCE: f64 = 1e-8;

/// Relative decrease of the least held-out error that counts as progress.
const PROGRESS: f64 = 0.01;

/// Expression of the population.
#[derive(Debug, Clone)]
pub(crate) struct Individual {
    pub(crate) expression: Expression,
    pub(crate) loss: f64,
    /// Score in tournaments; smaller is better.
    score: f64,
}

/// Result of the evolution.
pub(crate) struct Evolved {
    /// Pareto front; empty if the evolution did not begin.
    pub(crate) front: Front,
    /// Best expression of the random first population, with its constants as drawn.
    pub(crate) drawn: Individual,
    pub(crate) generations: u64,
    pub(crate) reached: Reached,
}

/// Stored fit of a structure.
struct Known {
    constants: Vec<f64>,
    loss: f64,
    fits: u32,
}

struct Evolution<'a> {
    config: &'a SymbolicConfig,
    grammar: Grammar,
    data: &'a Data,
    workspace: Workspace,
    /// Fits by structure.
    known: BTreeMap<Vec<u8>, Known>,
    front: Front,
}

/// Runs the evolution on the given peaks.
pub(crate) fn evolve(config: &SymbolicConfig, data: &Data, context: &FitContext<'_>) -> Evolved {
    let mut evolution = Evolution {
        config,
        grammar: Grammar { depth: config.initial_depth, sine: config.sine },
        data,
        workspace: Workspace::default(),
        known: BTreeMap::new(),
        front: Front::default(),
    };
    evolution.run(context)
}

impl Evolution<'_> {
    fn run(&mut self, context: &FitContext<'_>) -> Evolved {
        let planned = context.step_limit(self.config.max_generations);
        let mut population = self.first(&mut context.seed("population").generator());
        let mut generator = context.seed("evolution").generator();
        let best = population.iter().min_by(|one, other| one.loss.total_cmp(&other.loss));
        let drawn = best.cloned().unwrap_or(Individual {
            expression: Expression::constant(0.0),
            loss: 1.0,
            score: 0.0,
        });
        self.observe(&drawn, 0, planned, context);
        let (mut generations, mut idle) = (0, 0);
        let mut least = f64::INFINITY;
        let reached = loop {
            if context.is_canceled() {
                break Reached::Interrupted;
            }
            if idle >= self.config.patience || least <= self.data.rounding() {
                break Reached::Converged;
            }
            if generations >= planned {
                break Reached::BudgetSpent;
            }
            let candidates = if generations == 0 {
                std::mem::take(&mut population).into_iter().map(|individual| individual.expression).collect()
            } else {
                self.children(&population, &mut generator)
            };
            population = candidates.into_iter().map(|candidate| self.grown(candidate)).collect();
            generations += 1;
            // The front takes part in breeding, so that nothing good is lost.
            let kept: Vec<Individual> = self
                .front
                .members()
                .iter()
                .map(|member| self.individual(member.expression.clone(), member.loss))
                .collect();
            population.extend(kept);
            let now = self.front.least_held_out().map_or(f64::INFINITY, |error| error.mean);
            idle = if now < least * (1.0 - PROGRESS) { 0 } else { idle + 1 };
            least = least.min(now);
            let chosen = self.front.simplest_adequate(self.data);
            let chosen = chosen.map(|member| self.individual(member.expression.clone(), member.loss));
            self.observe(chosen.as_ref().unwrap_or(&drawn), generations, planned, context);
        };
        Evolved { front: std::mem::take(&mut self.front), drawn, generations, reached }
    }

    fn observe(&mut self, individual: &Individual, step: u64, planned: u64, context: &FitContext<'_>) {
        let values = self.workspace.values(&individual.expression, &self.data.times);
        let decay_rate = self.data.scaling.rate_per_unit_time(-self.data.projected_slope(values));
        let phase = "evolution".to_owned();
        context.observe(&Step { step, planned, phase, loss: individual.loss, decay_rate });
    }

    /// Draws the first population; it is not fitted, and too flat to be an answer.
    fn first<G: Rng>(&mut self, generator: &mut G) -> Vec<Individual> {
        (0..self.config.population)
            .map(|index| {
                let drawn = (0..MOST_DRAWS).find_map(|_| {
                    let expression = self.grammar.ramped(index, generator).folded();
                    let loss = loss(&expression, self.data, &mut self.workspace);
                    let values = self.workspace.values(&expression, &self.data.times);
                    let steepness = self.data.projected_slope(values).abs();
                    let fits = loss.is_finite()
                        && steepness <= self.config.initial_steepness
                        && expression.complexity() <= self.config.max_nodes;
                    fits.then_some((expression, loss))
                });
                let (expression, loss) = drawn.unwrap_or((Expression::constant(0.0), 1.0));
                self.individual(expression, loss)
            })
            .collect()
    }

    fn individual(&self, expression: Expression, loss: f64) -> Individual {
        // In steps of 1e-6, so that rounding does not decide between two equivalent expressions.
        let error = (loss + self.data.rounding()).ln();
        let score = (error * 1e6).round() / 1e6 + self.config.parsimony * expression.complexity() as f64;
        Individual { expression, loss, score }
    }

    /// Fits the constants of an expression and offers it to the front.
    fn grown(&mut self, mut expression: Expression) -> Individual {
        let structure = expression.structure();
        let method = Method { max_steps: self.config.constant_steps, tolerance: BREEDING_TOLERANCE, ..FULL };
        if self.known.get(&structure).is_none_or(|known| known.fits < FITS_PER_STRUCTURE) {
            let loss = fit_constants(&mut expression, self.data, method, &mut self.workspace).loss;
            // Constants that allow a pole between two peaks are worthless.
            let loss = if expression.is_sound() { loss } else { f64::INFINITY };
            let known = self.known.entry(structure.clone()).or_insert_with(|| Known {
                constants: expression.constants().collect(),
                loss: f64::INFINITY,
                fits: 0,
            });
            known.fits += 1;
            if loss < known.loss {
                known.loss = loss;
                known.constants = expression.constants().collect();
            }
        }
        let loss = match self.known.get(&structure) {
            Some(known) => {
                expression.set_constants(&known.constants);
                known.loss
            }
            None => f64::INFINITY,
        };
        self.front.offer(&expression, loss, self.data, &mut self.workspace);
        self.individual(expression, loss)
    }

    /// Returns the next generation: children that differ from each other in more than their constants.
    fn children<G: Rng>(&self, population: &[Individual], generator: &mut G) -> Vec<Expression> {
        let mut seen = BTreeSet::new();
        (0..self.config.population)
            .map(|index| {
                let child = (0..MOST_DRAWS).find_map(|_| {
                    let child = self.child(population, generator).folded();
                    let fits = child.complexity() <= self.config.max_nodes
                        && child.constants().all(f64::is_finite)
                        && seen.insert(child.structure());
                    fits.then_some(child)
                });
                child.unwrap_or_else(|| self.grammar.ramped(index, generator).folded())
            })
            .collect()
    }

    fn child<G: Rng>(&self, population: &[Individual], generator: &mut G) -> Expression {
        let config = self.config;
        let Some(parent) = self.winner(population, generator) else {
            return self.grammar.ramped(0, generator);
        };
        let way: f64 = generator.random();
        if way < config.crossover {
            let other = self.winner(population, generator).unwrap_or(parent);
            self.grammar.crossover(parent, other, generator)
        } else if way < config.crossover + config.subtree_mutation {
            self.grammar.mutate_subtree(parent, generator)
        } else if way < config.crossover + config.subtree_mutation + config.point_mutation {
            self.grammar.mutate_point(parent, generator)
        } else {
            self.grammar.hoist(parent, generator)
        }
    }

    /// Returns the best of some random individuals; the first one among equals.
    fn winner<'b, G: Rng>(&self, population: &'b [Individual], generator: &mut G) -> Option<&'b Expression> {
        (0..self.config.tournament)
            .filter_map(|_| population.get(generator.random_range(0..population.len().max(1))))
            .min_by(|one, other| one.score.total_cmp(&other.score))
            .map(|individual| &individual.expression)
    }
}
