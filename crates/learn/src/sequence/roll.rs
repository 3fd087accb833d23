//! Free runs in batches, and their gradient.
//!
//! The cost of an automatic differentiation tape grows faster than linearly with its length, so each block
//! has its own tape. A forward pass keeps only the positions; the backward pass recomputes each block, given
//! the adjoint of its prediction from all later blocks.

#![allow(clippy::indexing_slicing, reason = "windows and blocks lie within their trajectories")]

use super::frame::{Frame, OnDevice};
use super::{Architecture, Batch, Network, Sizes};
use crate::LearnError;
use crate::data::{Trajectory, Window};
use crate::training::Trainable;
use burn::tensor::{Device, Tensor};
use estimator::FitError;
use neural::{flat_gradient, named_parameters, tensor, values, with_parameters};
use seed::Seed;

/// Sequence model during training.
pub(super) struct Roll<'a, A: Architecture> {
    pub(super) architecture: &'a A,
    pub(super) frame: &'a Frame,
    pub(super) train: &'a [Trajectory],
    pub(super) validation: &'a [Trajectory],
    /// Windows of the validation part.
    pub(super) held: Vec<Window>,
    /// Network of the right shape.
    pub(super) shape: A::Network,
    /// Device for the computation.
    pub(super) device: Device,
}

/// Windows as rows of numbers, each of `length` samples: positions and, if there is one, the input.
pub(super) struct Rows {
    pub(super) count: usize,
    pub(super) length: usize,
    pub(super) positions: Vec<f64>,
    pub(super) inputs: Option<Vec<f64>>,
}

impl Rows {
    fn of(parts: &[Trajectory], windows: &[Window]) -> Self {
        let positions = |window: &Window| &parts[window.trajectory].values()[window.from..window.to];
        let input = |window: &Window| Some(&parts[window.trajectory].input()?[window.from..window.to]);
        let positions = windows.iter().map(positions).collect::<Vec<_>>().concat();
        Self {
            count: windows.len(),
            length: positions.len() / windows.len().max(1),
            positions,
            inputs: windows.iter().map(input).collect::<Option<Vec<_>>>().map(|rows| rows.concat()),
        }
    }

    /// Returns the samples `from..from + length` of every row.
    fn cut(&self, of: &[f64], from: usize, length: usize) -> Vec<f64> {
        let rows = of.chunks(self.length.max(1));
        rows.flat_map(|row| row[from..from + length].iter().copied()).collect()
    }

    fn input(&self, from: usize, length: usize, device: &Device) -> Option<Tensor<2>> {
        let inputs = self.inputs.as_ref()?;
        Some(tensor(self.cut(inputs, from, length), [self.count, length], device))
    }
}

/// Predicts a block from past positions, windows × past, and inputs, windows × (past + block).
fn block<N: Network>(
    network: &N,
    (frame, matrices): (&Frame, &OnDevice),
    positions: Tensor<2>,
    inputs: Option<Tensor<2>>,
) -> Tensor<2> {
    let [windows, _] = positions.dims();
    let device = positions.device();
    let mut linear = positions.clone().matmul(matrices.from_positions.clone()) + matrices.constant.clone();
    if let Some((inputs, weights)) = inputs.clone().zip(matrices.from_inputs.clone()) {
        linear = linear + inputs.matmul(weights);
    }
    let ahead = Tensor::<2>::cat(
        vec![Tensor::zeros([windows, frame.past], &device), Tensor::ones([windows, frame.block], &device)],
        1,
    );
    let mut features = vec![Tensor::cat(vec![positions, linear.clone()], 1)];
    features.extend(inputs);
    features.push(ahead);
    let tokens = Tensor::cat(features.into_iter().map(|own| own.unsqueeze_dim::<3>(2)).collect(), 2);
    linear + network.forward(Batch { tokens, block: frame.block }) * matrices.miss.clone()
}

/// Runs every row freely from its first `frame.past` positions to its end. Returns the positions with those
/// after the past replaced by predictions. `rows.length` is the past plus a whole number of blocks.
pub(super) fn free_run<N: Network>(
    network: &N,
    frame: &Frame,
    rows: &Rows,
    device: &Device,
) -> Result<Vec<f64>, LearnError> {
    let matrices = frame.on(device);
    let mut whole = rows.positions.clone();
    for from in starts(frame, rows) {
        let positions = tensor(rows.cut(&whole, from, frame.past), [rows.count, frame.past], device);
        let inputs = rows.input(from, frame.length(), device);
        let predicted = values(block(network, (frame, &matrices), positions, inputs))?;
        for (row, own) in whole.chunks_mut(rows.length).zip(predicted.chunks(frame.block)) {
            if let Some(place) = row.get_mut(from + frame.past..from + frame.length()) {
                place.copy_from_slice(own);
            }
        }
    }
    Ok(whole)
}

/// Returns the starts of the blocks' windows in order.
fn starts(frame: &Frame, rows: &Rows) -> impl DoubleEndedIterator<Item = usize> + use<> {
    let (block, blocks) = (frame.block, rows.length.saturating_sub(frame.past) / frame.block);
    (0..blocks).map(move |number| number * block)
}

impl<A: Architecture> Roll<'_, A> {
    /// Adds the gradient with respect to the weights, given the derivatives with respect to each position of
    /// a run.
    fn pass_back(
        &self,
        weights: &[f64],
        rows: &Rows,
        whole: &[f64],
        mut adjoint: Vec<f64>,
        gradient: &mut [f64],
    ) -> Result<(), LearnError> {
        let recording = self.device.clone().autodiff();
        let network = with_parameters(self.shape.clone(), weights, &recording)?;
        let (frame, matrices) = (self.frame, self.frame.on(&recording));
        let none = || FitError::Backend { problem: "no gradient of a block's past".to_owned() };
        for from in starts(frame, rows).rev() {
            let cut = rows.cut(whole, from, frame.past);
            let positions = tensor(cut, [rows.count, frame.past], &recording).require_grad();
            let inputs = rows.input(from, frame.length(), &recording);
            let predicted = block(&network, (frame, &matrices), positions.clone(), inputs);
            let by = rows.cut(&adjoint, from + frame.past, frame.block);
            let by = tensor(by, [rows.count, frame.block], &recording);
            let gradients = (predicted * by).sum().backward();
            let own = flat_gradient(&network, &gradients)?;
            gradient.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            let by_past = values(positions.grad(&gradients).ok_or_else(none)?)?;
            for (row, own) in adjoint.chunks_mut(rows.length).zip(by_past.chunks(frame.past)) {
                let places = row.iter_mut().skip(from);
                places.zip(own).for_each(|(sum, own)| *sum += own);
            }
        }
        Ok(())
    }
}

impl<A: Architecture> Trainable for Roll<'_, A> {
    fn initial(&self, seed: &Seed) -> Result<Vec<f64>, LearnError> {
        let frame = self.frame;
        let network = self.architecture.init(sizes(frame), seed, &self.device)?;
        Ok(named_parameters(&network)?.into_iter().flat_map(|own| own.values).collect())
    }

    fn loss(&self, weights: &[f64], batch: &[Window], gradient: &mut [f64]) -> Result<f64, LearnError> {
        let device = self.device.clone();
        let rows = Rows::of(self.train, batch);
        let network = with_parameters(self.shape.clone(), weights, &device)?;
        let whole = free_run(&network, self.frame, &rows, &device)?;
        let count = (rows.count * rows.length.saturating_sub(self.frame.past)).max(1) as f64;
        let errors: Vec<f64> =
            whole.iter().zip(&rows.positions).map(|(own, observed)| own - observed).collect();
        let loss = errors.iter().map(|error| error * error).sum::<f64>() / count;
        let adjoint = errors.iter().map(|error| 2.0 * error / count).collect();
        self.pass_back(weights, &rows, &whole, adjoint, gradient)?;
        Ok(loss)
    }

    fn validation(&self, weights: &[f64]) -> Result<f64, LearnError> {
        let device = self.device.clone();
        let rows = Rows::of(self.validation, &self.held);
        let network = with_parameters(self.shape.clone(), weights, &device)?;
        let whole = free_run(&network, self.frame, &rows, &device)?;
        let count = (rows.count * rows.length.saturating_sub(self.frame.past)).max(1) as f64;
        let square: f64 =
            whole.iter().zip(&rows.positions).map(|(own, observed)| (own - observed).powi(2)).sum();
        Ok((square / count).sqrt() * self.unit())
    }

    fn unit(&self) -> f64 {
        self.frame.scale.position
    }
}

/// Returns the dimensions that a frame requires of a network.
pub(super) fn sizes(frame: &Frame) -> Sizes {
    Sizes { features: frame.features(), length: frame.length(), block: frame.block }
}
