//! Neural ordinary differential equation: a network learns the torque that the nominal simulator lacks.
//!
//! θ̈ = nominal + a·(linear terms + dry friction + N(θ, θ̇, u)), where N is a network with one hidden layer
//! of tanh units. It is trained through the integrator's own steps (discretize, then optimize) with exact
//! forward sensitivities, by Levenberg–Marquardt on pieces that grow from two periods to whole parts. For
//! tens of weights this takes far fewer passes than a gradient method. A Gaussian prior keeps the weights
//! small; Laplace's approximation at the optimum gives bands.
//!
//! Chen, Rubanova, Bettencourt, Duvenaud, NeurIPS 2018; Rackauckas et al., arXiv:2001.04385 (universal
//! differential equations); MacKay, Neural Computation 4 (1992) 448 (Laplace's approximation).

use super::torque::{Base, Corrected, Correction, Progress, finished, fit, pretrained, restored};
use crate::data::DataSet;
use crate::flow::{Field, Penalty};
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner};
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};
use settings::{Default, Field as Key, Kind as Value};

/// Identifier.
const ID: &str = "neural-ode";

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Neural ordinary differential equation",
    summary: "Learns the torque that the nominal simulator lacks with a network, trained through the integrator's steps.",
    reference: "Chen, Rubanova, Bettencourt, Duvenaud, NeurIPS 2018",
    kind: Kind::Field,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(resolved.section::<NeuralOde>(ID)?) as Box<dyn Learner>),
    restore: |stored| restored::<Network>(ID, stored),
};

const FIELDS: &[Key] = &[
    Key::new("hidden_units", Value::Integer { min: 1, max: 200 }, Default::Integer(8))
        .unit("units")
        .meaning("Units of the hidden layer."),
    Key::new("dry_friction", Value::Boolean, Default::Boolean(true)).meaning(
        "Whether dry friction, whose size is learned, is added to the network, which is \
                smooth.",
    ),
    Key::new("weight_decay", Value::Float { min: 1e-9, max: 1e9 }, Default::Float(0.1))
        .meaning("One over the prior variance of a weight, inputs and torque scaled to spread 1."),
    Key::new("samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(8_000))
        .unit("samples")
        .meaning("Most training samples; if there are more, evenly spaced pieces are used."),
    Key::new("restarts", Value::Integer { min: 1, max: 1000 }, Default::Integer(4))
        .meaning("Networks that are pretrained, each from weights of its own; the best is trained on."),
    Key::new("pretraining_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(40))
        .unit("steps")
        .meaning("Most steps of matching accelerations before any trajectory is run."),
    Key::new("max_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(40))
        .unit("steps")
        .meaning("Most steps on pieces of each length."),
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct NeuralOde {
    hidden_units: usize,
    dry_friction: bool,
    weight_decay: f64,
    samples: usize,
    restarts: u64,
    pretraining_steps: u64,
    max_steps: u64,
}

/// Network with one hidden layer: each unit has three input weights, a bias and an output weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Network {
    hidden: usize,
}

/// Number of weights of a hidden unit.
const OF_UNIT: usize = 5;

impl Correction for Network {
    fn weights(&self) -> usize {
        OF_UNIT * self.hidden
    }

    fn value(&self, weights: &[f64], [x, v, u]: [f64; 3]) -> f64 {
        let units = weights.as_chunks::<OF_UNIT>().0.iter();
        units.map(|[by_x, by_v, by_u, bias, out]| out * (by_x * x + by_v * v + by_u * u + bias).tanh()).sum()
    }

    fn sloped(&self, weights: &[f64], [x, v, u]: [f64; 3], slope: &mut [f64]) -> (f64, [f64; 2]) {
        let (mut sum, mut along) = (0.0, [0.0; 2]);
        let units = weights.as_chunks::<OF_UNIT>().0.iter().zip(slope.as_chunks_mut::<OF_UNIT>().0);
        for ([by_x, by_v, by_u, bias, out], own) in units {
            let active = (by_x * x + by_v * v + by_u * u + bias).tanh();
            let steep = out * (1.0 - active * active);
            sum += out * active;
            along = [along[0] + steep * by_x, along[1] + steep * by_v];
            *own = [steep * x, steep * v, steep * u, steep, active];
        }
        (sum, along)
    }
}

impl Learner for NeuralOde {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let field = Corrected {
            base: Base::new(data, self.dry_friction),
            correction: Network { hidden: self.hidden_units },
        };
        let count = field.weights();
        let penalty = Penalty { mean: vec![0.0; count], precision: vec![self.weight_decay; count] };
        let start = self.first_guess(&field, data, &penalty, context);
        let progress = Progress { samples: self.samples, most_steps: self.max_steps };
        let (fit, steps) = fit(ID, &field, data, context, (&penalty, progress), start)?;
        Ok(finished(ID, &field, data, context, (&fit, steps, &penalty)))
    }
}

impl NeuralOde {
    /// Returns the best of several pretrained networks. Output weights start at zero, so each network starts
    /// as the nominal simulator.
    fn first_guess(
        &self,
        field: &Corrected<Network>,
        data: &DataSet,
        penalty: &Penalty,
        context: &Context<'_>,
    ) -> Vec<f64> {
        let drawn = |restart: u64| {
            let mut generator = context.seed.child("initial weights").child(&restart.to_string()).generator();
            let mut start = vec![0.0; field.weights()];
            let (_, units) = start.split_at_mut(field.base.weights());
            for unit in units.as_chunks_mut::<OF_UNIT>().0 {
                let [inputs @ .., _] = unit;
                inputs.iter_mut().for_each(|weight| *weight = StandardNormal.sample(&mut generator));
            }
            pretrained(field, data, penalty, start, context.steps(self.pretraining_steps))
        };
        let best = (0..self.restarts).map(drawn).min_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or_else(|| vec![0.0; field.weights()], |(weights, _)| weights)
    }
}
