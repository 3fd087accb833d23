//! Gaussian process for the torque that the nominal simulator lacks.
//!
//! θ̈ = nominal + a·(linear terms + dry friction + f(θ, θ̇)), where f is a Gaussian process with a squared
//! exponential kernel in reduced rank: eigenfunctions of the Laplacian on a box around the visited region,
//! whose weights have the kernel's spectral density as prior variances. The posterior is Laplace's
//! approximation about the trajectory fit. The kernel's amplitude and length maximize the evidence of the
//! linearized fit, in two rounds.
//!
//! Solin, Särkkä, Statistics and Computing 30 (2020) 419 (reduced rank); Rasmussen, Williams, Gaussian
//! Processes for Machine Learning, MIT Press 2006, chapter 5 (evidence).

use super::torque::{Base, Corrected, Correction, Progress, finished, fit, pretrained, restored};
use crate::data::{DataSet, local_states};
use crate::flow::{Field, Fit, Penalty};
use crate::linear::raised;
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use settings::{Default, Field as Key, Kind as Value};
use std::f64::consts::PI;

/// Identifier.
const ID: &str = "gaussian-process";

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Gaussian-process torque",
    summary: "Learns the torque that the nominal simulator lacks as a Gaussian process of position and velocity, with bands.",
    reference: "Solin, Särkkä, Statistics and Computing 30 (2020) 419-446",
    kind: Kind::Field,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(resolved.section::<GaussianProcess>(ID)?) as Box<dyn Learner>),
    restore: |stored| restored::<Basis>(ID, stored),
};

const FIELDS: &[Key] = &[
    Key::new("functions", Value::Integer { min: 2, max: 30 }, Default::Integer(8))
        .meaning("Eigenfunctions along position and along velocity; their products are the basis."),
    Key::new("margin", Value::Float { min: 1.05, max: 10.0 }, Default::Float(1.4))
        .meaning("Half width of the box over the farthest state visited in training.")
        .source("Solin, Särkkä 2020: the kernel is distorted near the edge"),
    Key::new("dry_friction", Value::Boolean, Default::Boolean(true)).meaning(
        "Whether dry friction, whose size is learned, is added to the process, which is \
                smooth.",
    ),
    Key::new("samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(8_000))
        .unit("samples")
        .meaning("Most training samples; if there are more, evenly spaced pieces are used."),
    Key::new("max_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(15))
        .unit("steps")
        .meaning("Most steps on pieces of each length, in each of two rounds."),
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct GaussianProcess {
    functions: usize,
    margin: f64,
    dry_friction: bool,
    samples: usize,
    max_steps: u64,
}

/// Basis of products of sines on a box, in scaled position and velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Basis {
    functions: usize,
    /// Half-widths of the box.
    half: [f64; 2],
}

/// Amplitude and length of the kernel, in scaled torque and scaled states.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kernel {
    amplitude: f64,
    length: f64,
}

/// Prior precision of the linear terms; so small that the prior is nearly flat.
const LOOSE: f64 = 1e-2;

impl Basis {
    /// Returns √(1/L)·sin(π·j·(z + L)/(2L)) for every j from 1, each with its derivative.
    fn along(&self, z: f64, half: f64) -> impl Iterator<Item = (f64, f64)> + Clone {
        let (rate, norm) = (0.5 * PI / half, half.sqrt().recip());
        let phase = rate * (z + half);
        (1..=self.functions).map(move |number| {
            let number = number as f64;
            let (sine, cosine) = (number * phase).sin_cos();
            (norm * sine, norm * number * rate * cosine)
        })
    }

    /// Returns the prior precisions of the weights: the inverse spectral density at the eigenfrequencies.
    fn precisions(&self, kernel: Kernel) -> Vec<f64> {
        let [half_x, half_v] = self.half;
        let square = |number: usize, half: f64| (0.5 * PI * number as f64 / half).powi(2);
        let size = 2.0 * PI * (kernel.amplitude * kernel.length).powi(2);
        let pairs = (1..=self.functions).flat_map(|x| (1..=self.functions).map(move |v| (x, v)));
        pairs
            .map(|(x, v)| {
                let frequency = square(x, half_x) + square(v, half_v);
                (0.5 * kernel.length.powi(2) * frequency).min(200.0).exp() / size
            })
            .collect()
    }
}

impl Correction for Basis {
    fn weights(&self) -> usize {
        self.functions * self.functions
    }

    fn value(&self, weights: &[f64], [x, v, _]: [f64; 3]) -> f64 {
        let [half_x, half_v] = self.half;
        let of_v: Vec<f64> = self.along(v, half_v).map(|(value, _)| value).collect();
        let rows = weights.chunks(self.functions).zip(self.along(x, half_x));
        rows.map(|(row, (of_x, _))| {
            of_x * row.iter().zip(&of_v).map(|(weight, value)| weight * value).sum::<f64>()
        })
        .sum()
    }

    fn sloped(&self, weights: &[f64], [x, v, _]: [f64; 3], slope: &mut [f64]) -> (f64, [f64; 2]) {
        let [half_x, half_v] = self.half;
        let of_v: Vec<(f64, f64)> = self.along(v, half_v).collect();
        let (mut sum, mut along) = (0.0, [0.0; 2]);
        let rows =
            weights.chunks(self.functions).zip(slope.chunks_mut(self.functions)).zip(self.along(x, half_x));
        for ((row, own), (value_x, slope_x)) in rows {
            for ((weight, slot), (value_v, slope_v)) in row.iter().zip(own).zip(&of_v) {
                *slot = value_x * value_v;
                sum += weight * *slot;
                along = [along[0] + weight * slope_x * value_v, along[1] + weight * value_x * slope_v];
            }
        }
        (sum, along)
    }
}

impl Learner for GaussianProcess {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let base = Base::new(data, self.dry_friction);
        let basis = Basis { functions: self.functions, half: self.box_of(data) };
        let field = Corrected { base, correction: basis };
        let progress = Progress { samples: self.samples, most_steps: self.max_steps };
        let mut kernel = Kernel { amplitude: 1.0, length: 1.0 };
        let (mut weights, mut steps) = (vec![0.0; field.weights()], 0);
        let start = penalty(&base, &basis, kernel);
        weights = pretrained(&field, data, &start, weights, context.steps(self.max_steps)).0;
        let mut last = None;
        for _ in 0..2 {
            let penalty = penalty(&base, &basis, kernel);
            let (fit, own) = fit(ID, &field, data, context, (&penalty, progress), weights)?;
            steps += own;
            weights = fit.weights.clone();
            kernel = best_kernel(&base, &basis, &fit, &penalty).unwrap_or(kernel);
            last = Some((fit, penalty));
        }
        let (fit, penalty) = last.ok_or(LearnError::Interrupted)?;
        Ok(finished(ID, &field, data, context, (&fit, steps, &penalty)))
    }
}

impl GaussianProcess {
    /// Returns the half-widths of a box around the states visited in training, in scaled position and
    /// velocity.
    fn box_of(&self, data: &DataSet) -> [f64; 2] {
        let states = data.train.iter().flat_map(|part| local_states(part, data.period_s / 8.0));
        let scale = &data.scale;
        let farthest = states.fold([1.0_f64, 1.0_f64], |[x, v], state| {
            let away = (state.position - scale.center) / scale.position;
            [x.max(away.abs()), v.max((state.velocity / scale.velocity).abs())]
        });
        farthest.map(|half| self.margin * half)
    }
}

fn penalty(base: &Base, basis: &Basis, kernel: Kernel) -> Penalty {
    let mut precision = vec![LOOSE; base.weights()];
    precision.extend(basis.precisions(kernel));
    Penalty { mean: vec![0.0; precision.len()], precision }
}

/// Returns the kernel with the largest evidence on a grid, for the fit linearized about its weights.
fn best_kernel(base: &Base, basis: &Basis, fit: &Fit, used: &Penalty) -> Option<Kernel> {
    let information = &fit.information / fit.variance();
    let weights = DVector::from_column_slice(&fit.weights);
    let prior = DVector::from_column_slice(&used.precision);
    // At the penalized optimum, the gradient of the data term balances that of the prior.
    let pull = &information * &weights + prior.component_mul(&weights);
    let evidence = |kernel: Kernel| -> Option<f64> {
        let precision = DVector::from_vec(penalty(base, basis, kernel).precision);
        let whole = &information + DMatrix::from_diagonal(&precision);
        let root = raised(&whole, 1e-13).cholesky()?;
        let own: f64 = precision.iter().map(|precision| precision.ln()).sum();
        let all: f64 = root.l().diagonal().iter().map(|entry| 2.0 * entry.ln()).sum();
        Some(0.5 * (own - all + pull.dot(&root.solve(&pull))))
    };
    let lengths = [0.4, 0.6, 0.9, 1.3, 2.0, 3.0];
    let amplitudes = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0];
    let grid = lengths
        .iter()
        .flat_map(|&length| amplitudes.iter().map(move |&amplitude| Kernel { amplitude, length }));
    let scored =
        grid.filter_map(|kernel| Some((evidence(kernel).filter(|value| value.is_finite())?, kernel)));
    scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, kernel)| kernel)
}
