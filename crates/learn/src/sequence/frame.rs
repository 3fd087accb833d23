//! Units, sample times and the linear prediction that a sequence model corrects.

#![allow(clippy::indexing_slicing, reason = "a trajectory has an input for every sample")]

use super::Settings;
use super::grid::evened;
use crate::baselines::Arx;
use crate::data::{DataSet, LEAST_PAST, Scale, Trajectory};
use crate::{Ahead, LearnError, Model, Past};
use burn::tensor::{Device, Tensor};
use dynamics::Hold;
use neural::tensor;
use serde::{Deserialize, Serialize};

/// Largest number of samples in a past.
const MOST_PAST: usize = 96;

/// Smallest number of samples in a block.
const LEAST: usize = 8;

/// Lower limit of the linear prediction's typical error, as a share of the spread of positions.
const LEAST_MISS: f64 = 1e-3;

/// Ridges tried for the linear prediction, as shares of the regressors' mean squares.
const RIDGES: [f64; 3] = [1e-8, 1e-6, 1e-4];

/// Everything that a sequence model takes from the training part besides its weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Time between the model's samples, in seconds.
    pub interval_s: f64,
    /// Number of samples in the past.
    pub past: usize,
    /// Number of samples predicted at once.
    pub block: usize,
    /// `true` if there is an input.
    pub driven: bool,
    /// Interpolation of the input between samples.
    pub hold: Hold,
    /// Scales of the training part.
    pub scale: Scale,
    /// `true` if the first sample of a short past is repeated before it; otherwise a short past is refused.
    #[serde(default)]
    pub(super) repeats: bool,
    /// Linear prediction of a block from past positions, in scaled units; row-major, past × block.
    from_positions: Vec<f64>,
    /// Linear prediction of a block from the inputs of past and block; row-major, (past + block) × block.
    /// Empty without an input.
    from_inputs: Vec<f64>,
    /// Constant of the linear prediction, one per sample of a block.
    constant: Vec<f64>,
    /// Typical error of the linear prediction for each sample of a block, in scaled units.
    miss: Vec<f64>,
}

/// Training and validation part in a frame's units and sample times.
pub(super) struct Framed {
    pub(super) frame: Frame,
    pub(super) train: Vec<Trajectory>,
    pub(super) validation: Vec<Trajectory>,
}

impl Framed {
    /// Scales and resamples the training and validation part, and fits the linear prediction.
    pub(super) fn new(data: &DataSet, settings: &Settings) -> Result<Self, LearnError> {
        let rates: Vec<f64> = data.train.iter().map(Trajectory::rate_hz).collect();
        let own_s = rates.len() as f64 / rates.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let stride = (data.period_s / own_s / settings.samples_per_period as f64).ceil().max(1.0);
        let interval_s = own_s * stride;
        let warm_up =
            ((data.warm_up_s / interval_s * (1.0 + 1e-9)).floor() as usize + 1).clamp(LEAST_PAST, MOST_PAST);
        let past = settings.past.unwrap_or(warm_up);
        let block = ((settings.block_periods * data.period_s / interval_s).round() as usize).max(LEAST);
        let mut frame = Frame {
            interval_s,
            past,
            repeats: settings.past.is_some(),
            block,
            driven: data.is_driven(),
            hold: data.hold,
            scale: data.scale,
            from_positions: Vec::new(),
            from_inputs: Vec::new(),
            constant: Vec::new(),
            miss: vec![1.0; block],
        };
        let framed = |parts: &[Trajectory]| -> Result<Vec<Trajectory>, LearnError> {
            parts.iter().map(|part| frame.scaled(&evened(part, interval_s, data.hold)?)).collect()
        };
        let (train, validation) = (framed(&data.train)?, framed(&data.validation)?);
        let unit = Scale { center: 0.0, position: 1.0, input_center: 0.0, input: 1.0, ..data.scale };
        let scaled = DataSet {
            train,
            validation,
            test: Vec::new(),
            warm_up_s: (past as f64 - 1.0) * interval_s,
            scale: unit,
            ..data.clone()
        };
        frame.linearize(&Arx::validated(&scaled, &RIDGES)?.unbounded())?;
        frame.measure(&scaled.train);
        Ok(Self { frame, train: scaled.train, validation: scaled.validation })
    }
}

impl Frame {
    /// Returns the number of features of a sample: its position (observed or linearly predicted), the input
    /// if there is one, and a flag for samples of the block.
    #[must_use]
    pub fn features(&self) -> usize {
        2 + usize::from(self.driven)
    }

    /// Returns the number of samples of past and block together.
    #[must_use]
    pub fn length(&self) -> usize {
        self.past + self.block
    }

    /// Converts a position to scaled units.
    #[must_use]
    pub fn position_in(&self, position: f64) -> f64 {
        (position - self.scale.center) / self.scale.position
    }

    /// Converts a scaled position back to its own unit.
    #[must_use]
    pub fn position_out(&self, scaled: f64) -> f64 {
        self.scale.center + self.scale.position * scaled
    }

    /// Converts an input to scaled units.
    #[must_use]
    pub fn input_in(&self, input: f64) -> f64 {
        (input - self.scale.input_center) / self.scale.input
    }

    fn scaled(&self, part: &Trajectory) -> Result<Trajectory, LearnError> {
        let values = part.values().iter().map(|&value| self.position_in(value)).collect();
        let input = part.input().map(|input| input.iter().map(|&value| self.input_in(value)).collect());
        Trajectory::new(part.name(), part.times_s().to_vec(), values, input)
    }

    /// Computes the matrices of the autoregression's free run over a block, which is linear in past and
    /// inputs, column by column from unit vectors.
    fn linearize(&mut self, model: &Arx) -> Result<(), LearnError> {
        let times: Vec<f64> = (0..self.length()).map(|at| at as f64).collect();
        let (before, after) = times.split_at(self.past);
        let run = |one: Option<usize>, input_one: Option<usize>| {
            let unit = |length: usize, one: Option<usize>| -> Vec<f64> {
                (0..length).map(|at| if Some(at) == one { 1.0 } else { 0.0 }).collect()
            };
            let (values, input) = (unit(self.past, one), unit(self.length(), input_one));
            let (input_before, input_after) = input.split_at(self.past);
            let past = Past { times_s: before, values: &values, input: self.driven.then_some(input_before) };
            let ahead = Ahead { times_s: after, input: self.driven.then_some(input_after) };
            model.free_run(&past, &ahead).map(|found| found.values)
        };
        let constant = run(None, None)?;
        let less = |found: Vec<f64>| -> Vec<f64> {
            found.iter().zip(&constant).map(|(value, constant)| value - constant).collect()
        };
        let inputs = if self.driven { self.length() } else { 0 };
        let positions =
            (0..self.past).map(|at| run(Some(at), None).map(less)).collect::<Result<Vec<_>, _>>()?;
        let from_inputs =
            (0..inputs).map(|at| run(None, Some(at)).map(less)).collect::<Result<Vec<_>, _>>()?;
        (self.from_positions, self.from_inputs) = (positions.concat(), from_inputs.concat());
        self.constant = constant;
        Ok(())
    }

    /// Computes the root mean square error of the linear prediction over training windows, for each sample of
    /// a block.
    fn measure(&mut self, train: &[Trajectory]) {
        let (mut squares, mut count) = (vec![0.0; self.block], 0_usize);
        for part in train {
            let windows = part.values().windows(self.length()).enumerate();
            for (from, window) in windows.step_by((self.block / 2).max(1)) {
                let (positions, ahead) = window.split_at(self.past);
                let inputs = part.input().map_or(&[][..], |input| &input[from..from + self.length()]);
                let predicted = self.linear(positions, inputs);
                for ((square, own), observed) in squares.iter_mut().zip(predicted).zip(ahead) {
                    *square += (own - observed).powi(2);
                }
                count += 1;
            }
        }
        let typical = |square: &f64| (square / count.max(1) as f64).sqrt().max(LEAST_MISS);
        self.miss = squares.iter().map(typical).collect();
    }

    fn linear(&self, positions: &[f64], inputs: &[f64]) -> Vec<f64> {
        let mut predicted = self.constant.clone();
        let rows = self.from_positions.chunks(self.block).zip(positions);
        for (row, value) in rows.chain(self.from_inputs.chunks(self.block).zip(inputs)) {
            predicted.iter_mut().zip(row).for_each(|(sum, weight)| *sum += weight * value);
        }
        predicted
    }

    /// Copies a frame's matrices to a device.
    pub(super) fn on(&self, device: &Device) -> OnDevice {
        let matrix = |values: &[f64], rows: usize| tensor(values.to_vec(), [rows, self.block], device);
        OnDevice {
            from_positions: matrix(&self.from_positions, self.past),
            from_inputs: self.driven.then(|| matrix(&self.from_inputs, self.length())),
            constant: matrix(&self.constant, 1),
            miss: matrix(&self.miss, 1),
        }
    }
}

/// Frame matrices as tensors.
pub(super) struct OnDevice {
    pub(super) from_positions: Tensor<2>,
    pub(super) from_inputs: Option<Tensor<2>>,
    pub(super) constant: Tensor<2>,
    pub(super) miss: Tensor<2>,
}
