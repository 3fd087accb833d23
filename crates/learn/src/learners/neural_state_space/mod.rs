//! Neural state space: a discrete state that small networks move, carried through the whole run.
//!
//! x⁺ = x + step·f(x, u) with y = x₁, where every state's rate is linear with a few tanh units. The weights and the
//! start state of each piece minimize the error of free runs, on pieces that grow from one period to whole parts, by
//! Levenberg–Marquardt with exact sensitivities and a normal prior. The start state of a prediction is the one that
//! fits its past best. Two wirings are tried with several numbers of states: a chain, where each state is driven by
//! the next one and the input drives the last, and full coupling. The one with the smallest validation error is kept
//! and fitted once more to training and validation part together. A prediction is the median over several networks.
//!
//! Forgione, Piga, European Journal of Control 59 (2021) 69 (simulation error, start states as parameters); Beintema,
//! Schoukens, Tóth, Automatica 156 (2023) 111210 (SUBNET).

mod fit;
mod model;
mod network;
#[cfg(test)]
mod tests;

use crate::data::{DataSet, Trajectory};
use crate::judge::validation_error;
use crate::sequence::grid::evened;
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner, Step};
use dynamics::Hold;
use estimator::Reached;
use fit::{Piece, Prior, Problem};
use model::{About, ID, Member, NeuralStateSpace};
use network::{Shape, Wiring};
use serde::Deserialize;
use settings::{Default, Field, Kind as Value};
use std::f64::consts::TAU;

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Neural state space",
    summary: "Carries a state that small networks move through the whole run, and finds its start from the past.",
    reference: "Beintema, Schoukens, Tóth, Automatica 156 (2023) 111210",
    kind: Kind::Sequence,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(resolved.section::<Settings>(ID)?) as Box<dyn Learner>),
    restore: |stored| Ok(Box::new(NeuralStateSpace::restored(stored)?)),
};

const FIELDS: &[Field] = &[
    Field::new("wirings", Value::Texts { at_least: 1, at_most: 2 }, Default::Texts(&["chain", "full"])).meaning(
        "Wirings to choose among: chain, where each state is driven by itself and the next one, and the last by the \
         input; full, where all states and the input drive each one.",
    ),
    Field::new("states", Value::Integer { min: 2, max: 20 }, Default::Integer(3))
        .meaning("Most states; every number from two up to this one is tried."),
    Field::new("units", Value::Integer { min: 0, max: 200 }, Default::Integer(3))
        .meaning("Units of the network of each state."),
    Field::new("members", Value::Integer { min: 1, max: 1_000 }, Default::Integer(8))
        .meaning("Networks that are kept of twice as many, each from weights of its own; a prediction is their median."),
    Field::new("weight_decay", Value::Float { min: 0.0, max: 1e9 }, Default::Float(2e-2))
        .meaning("Penalty on the square of a weight, over that on the square of an error; both are scaled to spread 1."),
    Field::new("samples_per_period", Value::Integer { min: 8, max: 1_000 }, Default::Integer(64))
        .meaning("Most samples of a typical period; records sampled faster are thinned out."),
    Field::new("samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(6_000))
        .unit("samples")
        .meaning("Most training samples; if there are more, evenly spaced pieces are used."),
    Field::new("max_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(60))
        .unit("steps")
        .meaning("Most steps on pieces of each length."),
    Field::new("fit_validation", Value::Boolean, Default::Boolean(true)).meaning(
        "true: what was chosen is fitted once more, to training and validation part together; false: to the training \
         part alone.",
    ),
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Settings {
    wirings: Vec<Wiring>,
    states: usize,
    units: usize,
    members: u64,
    weight_decay: f64,
    samples_per_period: usize,
    samples: usize,
    max_steps: u64,
    fit_validation: bool,
}

/// Lengths of the pieces of consecutive fits, in periods, and the share of the prior that acts on each.
const PHASES: [(f64, f64); 3] = [(1.0, 0.01), (3.0, 0.1), (1e6, 1.0)];

/// Precision of the prior of a start state during training, over that of an error.
const START_PRECISION: f64 = 3e-4;

/// Networks that are trained for each one that is kept.
const DRAWN: u64 = 2;

/// Samples from which the start state of a piece is guessed.
const GUESSED_FROM: usize = 24;

/// Lower limit of the noise of a sample, in scaled units.
const LEAST_NOISE: f64 = 1e-3;

impl Learner for Settings {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let mut trace = Trace { context, steps: 0, train: f64::INFINITY };
        let mut best: Option<(f64, NeuralStateSpace)> = None;
        for &wiring in &self.wirings {
            for states in 2..=self.states {
                let about = self.about(data, wiring, states);
                let model = self.trained(&data.train, data, about, &mut trace)?;
                let error = validation_error(&model, data);
                trace.chosen(&format!("{wiring:?}, {states} states"), error);
                if best.as_ref().is_none_or(|(least, _)| error < *least) {
                    best = Some((error, model));
                }
            }
        }
        let none = "there is nothing to choose among; name a wiring in wirings".to_owned();
        let (error, mut model) = best.ok_or(LearnError::Unsolvable { what: ID, problem: none })?;
        if self.fit_validation && error.is_finite() {
            let both = [data.train.as_slice(), &data.validation].concat();
            let about = About { validation: Some(error), ..model.about };
            model = self.trained(&both, data, about, &mut trace)?;
        }
        Ok(Fitted { model: Box::new(model), reached: Reached::BudgetSpent, steps: trace.steps })
    }
}

/// Steps of the training so far.
struct Trace<'a> {
    context: &'a Context<'a>,
    steps: u64,
    /// Root mean square error of the latest step.
    train: f64,
}

impl Trace<'_> {
    fn observe(&mut self, phase: &str, train: f64, validation: Option<f64>) {
        (self.steps, self.train) = (self.steps + 1, train);
        (self.context.observe)(&Step { step: self.steps, phase: phase.to_owned(), train, validation });
    }

    fn chosen(&mut self, what: &str, validation: f64) {
        let validation = Some(validation).filter(|error| error.is_finite());
        self.observe(&format!("{what}, validation"), self.train, validation);
    }
}

impl Settings {
    fn about(&self, data: &DataSet, wiring: Wiring, states: usize) -> About {
        let rates: f64 = data.train.iter().map(Trajectory::rate_hz).sum();
        let own_s = data.train.len() as f64 / rates.max(f64::MIN_POSITIVE);
        let stride = (data.period_s / own_s / self.samples_per_period as f64).ceil().max(1.0);
        let interval_s = own_s * stride;
        let inputs = match (data.is_driven(), data.hold) {
            (false, _) => 0,
            (true, Hold::Zero) => 1,
            (true, _) => 3,
        };
        let step = TAU * interval_s / data.period_s;
        About {
            shape: Shape { wiring, states, inputs, units: self.units, step },
            interval_s,
            hold: data.hold,
            scale: data.scale,
            noise: (data.noise / data.scale.position).max(LEAST_NOISE),
            validation: None,
        }
    }

    /// Trains networks on parts, each from weights of its own, and keeps those with the smallest loss.
    fn trained(
        &self,
        parts: &[Trajectory],
        data: &DataSet,
        about: About,
        trace: &mut Trace<'_>,
    ) -> Result<NeuralStateSpace, LearnError> {
        let even = parts.iter().map(|part| evened(part, about.interval_s, about.hold));
        let even = DataSet { train: even.collect::<Result<_, _>>()?, ..data.clone() };
        let phases = PHASES.map(|(periods, share)| {
            let pieces = even.training_pieces(periods * data.period_s, self.samples);
            (pieces.iter().map(|piece| about.piece(piece)).collect::<Vec<Piece>>(), share)
        });
        let member = |number: u64, trace: &mut Trace<'_>| self.member(number, &phases, &about, trace);
        let drawn = (0..DRAWN * self.members).map(|number| member(number, trace));
        let mut drawn = drawn.collect::<Result<Vec<(f64, Member)>, _>>()?;
        drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
        let members = drawn.into_iter().take(self.members as usize).map(|(_, member)| member).collect();
        Ok(NeuralStateSpace { about, members })
    }

    /// Trains one network on growing pieces. Returns its loss with it.
    fn member(
        &self,
        number: u64,
        phases: &[(Vec<Piece>, f64)],
        about: &About,
        trace: &mut Trace<'_>,
    ) -> Result<(f64, Member), LearnError> {
        let (shape, context) = (&about.shape, trace.context);
        let seed = context.seed.child("initial weights").child(&number.to_string());
        let (count, states) = (shape.weights(), shape.states);
        let mut member = Member {
            weights: shape.drawn(&seed),
            mean: vec![0.0; states],
            variance: vec![1.0; states],
            error: 1.0,
        };
        let mut least = f64::INFINITY;
        for (pieces, share) in phases {
            let start = Prior { mean: vec![0.0; states], precision: vec![START_PRECISION; states] };
            let precision = vec![share * self.weight_decay; count];
            let weights = Some(Prior { mean: vec![0.0; count], precision });
            let problem = Problem { shape, pieces, weights, start };
            let starts =
                pieces.iter().map(|piece| member.start(about, piece.first(GUESSED_FROM, shape.inputs)));
            let samples: usize = pieces.iter().map(|piece| piece.values.len()).sum();
            let phase =
                format!("{:?}, {states} states, network {number}, {} pieces", shape.wiring, pieces.len());
            let found = problem.fit(
                member.weights.clone(),
                starts.collect(),
                context.steps(self.max_steps),
                |_, loss| {
                    trace.observe(&phase, about.scale.position * (loss / samples.max(1) as f64).sqrt(), None);
                    !context.cancel.is_requested()
                },
            );
            context.check()?;
            (least, member) = (found.loss, about.seen(found, pieces));
        }
        Ok((least, member))
    }
}

impl Piece {
    /// Returns the first samples.
    fn first(&self, samples: usize, inputs: usize) -> Self {
        let values: Vec<f64> = self.values.iter().take(samples).copied().collect();
        let inputs = self.inputs.iter().take(values.len() * inputs).copied().collect();
        Self { values, inputs }
    }
}

impl About {
    /// Scales an even stretch.
    fn piece(&self, part: &Trajectory) -> Piece {
        let values = part.values().iter().map(|value| self.scaled(*value)).collect();
        Piece { values, inputs: part.input().map_or_else(Vec::new, |input| self.inputs(input)) }
    }

    /// Returns a network with the mean and variance of its states over the pieces.
    fn seen(&self, found: fit::Point, pieces: &[Piece]) -> Member {
        let states = self.shape.states;
        let run = |(piece, start): (&Piece, &Vec<f64>)| {
            self.shape.run(&found.weights, start, &piece.inputs, piece.values.len(), false).states
        };
        let all: Vec<f64> = pieces.iter().zip(&found.starts).flat_map(run).collect();
        let of = |state: usize| -> Vec<f64> {
            all.iter().skip(state).step_by(states).copied().filter(|own| !own.is_nan()).collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let moments = |state: usize| {
            let own = of(state);
            let center = mean(&own);
            (center, mean(&own.iter().map(|value| (value - center).powi(2)).collect::<Vec<f64>>()))
        };
        let observed = pieces.iter().flat_map(|piece| &piece.values);
        let squares: Vec<f64> =
            observed.zip(all.iter().step_by(states)).map(|(a, b)| (a - b).powi(2)).collect();
        let error = mean(&squares).sqrt();
        let (means, variance) = (0..states).map(moments).unzip();
        Member {
            weights: found.weights,
            mean: means,
            variance,
            error: if error.is_nan() { 1.0 } else { error },
        }
    }
}
