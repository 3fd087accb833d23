//! Trained networks as a model.

use super::fit::{Piece, Prior, Problem};
use super::network::Shape;
use crate::data::{Scale, span_s};
use crate::sequence::grid::{inputs, past_positions, read_back};
use crate::{Ahead, LearnError, Model, Past, Predicted, Stored, Tensor};
use dynamics::Hold;
use serde::{Deserialize, Serialize};

/// Identifier of the learner.
pub(super) const ID: &str = "neural-state-space";

/// Contents of a model's file beside the numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct About {
    pub(super) shape: Shape,
    /// Time between the model's samples, in seconds.
    pub(super) interval_s: f64,
    pub(super) hold: Hold,
    pub(super) scale: Scale,
    /// Standard deviation of a sample's noise, in scaled units.
    pub(super) noise: f64,
    /// Error on the validation part of the model as it was chosen, if it was fitted to that part afterwards.
    pub(super) validation: Option<f64>,
}

/// One of the networks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Member {
    pub(super) weights: Vec<f64>,
    /// Mean and variance of every state over the training part.
    pub(super) mean: Vec<f64>,
    pub(super) variance: Vec<f64>,
    /// Root mean square error of the training, in scaled units.
    pub(super) error: f64,
}

/// Networks of one shape; a prediction is the median of theirs.
pub(super) struct NeuralStateSpace {
    pub(super) about: About,
    pub(super) members: Vec<Member>,
}

/// Most steps of a search for a start state, and smallest variance that it assumes.
const MOST_STEPS: u64 = 40;
const LEAST_VARIANCE: f64 = 1e-6;

impl About {
    /// Converts a position to scaled units.
    pub(super) fn scaled(&self, position: f64) -> f64 {
        (position - self.scale.center) / self.scale.position
    }

    /// Returns the inputs of every step from the mean inputs between samples: that of the step, and those of the steps
    /// before and after it where the input is not kept between its samples.
    pub(super) fn inputs(&self, means: &[f64]) -> Vec<f64> {
        let scaled: Vec<f64> =
            means.iter().map(|value| (value - self.scale.input_center) / self.scale.input).collect();
        if self.shape.inputs < 2 {
            return scaled;
        }
        let before = scaled.iter().take(1).chain(&scaled);
        let after = scaled.iter().skip(1).chain(scaled.last());
        before.zip(&scaled).zip(after).flat_map(|((before, own), after)| [*before, *own, *after]).collect()
    }
}

impl Member {
    /// Fits the state at the first sample of a piece; hidden states are near those of the training.
    pub(super) fn start(&self, about: &About, piece: Piece) -> Vec<f64> {
        let first = piece.values.first().copied();
        let mean = first.into_iter().chain(self.mean.iter().skip(1).copied()).collect::<Vec<f64>>();
        let error = self.error.max(about.noise);
        let precision = |variance: &f64| error.powi(2) / variance.max(LEAST_VARIANCE);
        let precision = self.variance.iter().map(precision).collect();
        let start = Prior { mean: mean.clone(), precision };
        let problem = Problem { shape: &about.shape, pieces: &[piece], weights: None, start };
        let found = problem.fit(self.weights.clone(), vec![mean.clone()], MOST_STEPS, |_, _| true);
        found.starts.into_iter().next().unwrap_or(mean)
    }
}

impl NeuralStateSpace {
    /// Restores a model from its file.
    ///
    /// # Errors
    /// [`LearnError::Stored`] for a file of another form.
    pub(super) fn restored(stored: &Stored) -> Result<Self, LearnError> {
        let about: About = stored.described()?;
        let (weights, states) = (about.shape.weights(), about.shape.states);
        let rows = |name: &str, length: usize| {
            let values = &stored.tensor(name)?.values;
            match values.len() % length {
                0 => Ok(values.chunks(length).map(<[f64]>::to_vec).collect::<Vec<_>>()),
                _ => {
                    let problem =
                        format!("tensor `{name}` has {} numbers, not a multiple of {length}", values.len());
                    Err(LearnError::Stored { problem })
                }
            }
        };
        let of_states = rows("means", states)?.into_iter().zip(rows("variances", states)?);
        let errors = &stored.tensor("errors")?.values;
        let members = rows("weights", weights)?.into_iter().zip(of_states).zip(errors);
        let member = |((weights, (mean, variance)), &error)| Member { weights, mean, variance, error };
        let members = members.map(member).collect();
        Ok(Self { about, members })
    }
}

impl Model for NeuralStateSpace {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let (about, shape) = (&self.about, &self.about.shape);
        let (Some(&now), Some(&end)) = (past.times_s.last(), ahead.times_s.last()) else {
            return Ok(Predicted::default());
        };
        let count = (span_s(past.times_s) / about.interval_s + 0.5).floor() as usize + 1;
        // Two samples beyond the last time, so that the interpolating cubic has samples on both sides.
        let after = ((end - now) / about.interval_s).ceil() as usize + 2;
        let values = past_positions(past, about.interval_s, count, false)?;
        let values: Vec<f64> = values.into_iter().map(|value| about.scaled(value)).collect();
        let given = inputs((past, ahead), about.hold, about.interval_s, [count, after])?;
        let inputs = given.map_or_else(Vec::new, |given| about.inputs(&given));
        let mut runs = Vec::new();
        for member in &self.members {
            let piece = Piece { values: values.clone(), inputs: inputs.clone() };
            let start = member.start(about, piece);
            let states = shape.run(&member.weights, &start, &inputs, count + after, false).states;
            runs.push(states.into_iter().step_by(shape.states).collect::<Vec<f64>>());
        }
        let median = |sample: usize| {
            let mut own: Vec<f64> =
                runs.iter().filter_map(|run| run.get(sample)).copied().filter(|own| !own.is_nan()).collect();
            own.sort_by(f64::total_cmp);
            let last = own.len().checked_sub(1)?;
            let middle = 0.5 * (own.get(last / 2)? + own.get(own.len() / 2)?);
            Some(about.scale.center + about.scale.position * middle)
        };
        let first = now - (count as f64 - 1.0) * about.interval_s;
        let whole = (0..count + after).map(|sample| {
            let time_s = (sample + 1) as f64 * about.interval_s;
            median(sample).ok_or(LearnError::Diverged { time_s, bound: about.scale.position })
        });
        let whole: Vec<f64> = whole.collect::<Result<_, _>>()?;
        Ok(Predicted { values: read_back(&whole, first, about.interval_s, ahead.times_s), std: None })
    }

    fn parameters(&self) -> usize {
        self.members.iter().map(|member| member.weights.len()).sum()
    }

    fn validation(&self) -> Option<f64> {
        self.about.validation
    }

    fn stored(&self) -> Option<Stored> {
        let tensor = |name: &str, of: &dyn Fn(&Member) -> &Vec<f64>| {
            let rows: Vec<&Vec<f64>> = self.members.iter().map(of).collect();
            Tensor {
                name: name.to_owned(),
                shape: vec![rows.len(), rows.first().map_or(0, |row| row.len())],
                values: rows.into_iter().flatten().copied().collect(),
            }
        };
        let errors = self.members.iter().map(|member| member.error).collect::<Vec<f64>>();
        let tensors = vec![
            Tensor { name: "errors".to_owned(), shape: vec![errors.len()], values: errors },
            tensor("means", &|member| &member.mean),
            tensor("variances", &|member| &member.variance),
            tensor("weights", &|member| &member.weights),
        ];
        Stored::new(ID, &self.about, tensors).ok()
    }
}
