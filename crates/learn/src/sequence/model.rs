//! Trained sequence model.

use super::band::{Band, Calibration};
use super::frame::Frame;
use super::grid::{inputs, past_positions, read_back};
use super::roll::{Rows, free_run, sizes};
use super::{Architecture, plain_device};
use crate::data::{DataSet, Trajectory};
use crate::{Ahead, LearnError, Model, Past, Predicted, Stored, Tensor};
use neural::{NamedTensor, named_parameters, with_parameters};
use seed::Seed;
use serde::{Deserialize, Serialize};

/// Absolute scaled position beyond which a prediction counts as diverged.
const BOUND: f64 = 1e3;

/// Weights of an architecture, with the frame of their training.
pub(super) struct SequenceModel<A> {
    architecture: A,
    frame: Frame,
    weights: Vec<NamedTensor>,
    /// Root mean square error of free runs over the validation part, in the unit of the positions; used as
    /// band if `band` is `None`.
    std: f64,
    /// Calibrated band; `None` if the validation part left nothing to calibrate on.
    band: Option<Band>,
}

#[derive(Serialize, Deserialize)]
struct Described<A> {
    architecture: A,
    frame: Frame,
    std: f64,
    #[serde(default)]
    band: Option<Band>,
}

impl<A: Architecture> SequenceModel<A> {
    pub(super) fn new(
        architecture: A,
        frame: Frame,
        network: &A::Network,
        std: f64,
    ) -> Result<Self, LearnError> {
        Ok(Self { architecture, frame, weights: named_parameters(network)?, std, band: None })
    }

    pub(super) fn restored(stored: &Stored) -> Result<Self, LearnError> {
        let described: Described<A> = stored.described()?;
        let Described { architecture, frame, std, band } = described;
        let shape = architecture.init(sizes(&frame), &Seed::new(0), &plain_device()?)?;
        let mut weights = Vec::new();
        for own in named_parameters(&shape)? {
            let found = stored.tensor(&own.name)?;
            if found.shape != own.shape {
                let problem = format!(
                    "tensor `{}` has the shape {:?} where the network has {:?}",
                    own.name, found.shape, own.shape
                );
                return Err(LearnError::Stored { problem });
            }
            weights.push(NamedTensor { values: found.values.clone(), ..own });
        }
        Ok(Self { architecture, frame, weights, std, band })
    }

    /// Returns the same model with bands calibrated on free runs over the validation part. The runs start at
    /// the beginning of each part and at a third of its length.
    pub(super) fn calibrated(self, data: &DataSet) -> Self {
        let run = |(record, part): (usize, &Trajectory), share: f64| {
            let begin = (share * part.len() as f64) as usize;
            let part = part.part(begin, part.len());
            let now = data.warm_up_samples(&part);
            let input = |from: usize, to: usize| part.input().and_then(|input| input.get(from..to));
            let past = Past {
                times_s: part.times_s().get(..now)?,
                values: part.values().get(..now)?,
                input: input(0, now),
            };
            let times_s = part.times_s().get(now..)?;
            let ahead = Ahead { times_s, input: input(now, part.len()) };
            let predicted = self.free_run(&past, &ahead).ok()?.values;
            let leads_s = leads(&past, &ahead);
            let observed = part.values().get(now..)?.to_vec();
            (!leads_s.is_empty()).then_some(Calibration { record, leads_s, predicted, observed })
        };
        let parts = data.validation.iter().enumerate();
        let runs: Vec<Calibration> =
            parts.flat_map(|part| [0.0, 1.0 / 3.0].map(|share| run(part, share))).flatten().collect();
        let band = Band::calibrated(&runs, self.frame.scale.center, data.noise, data.period_s);
        Self { band, ..self }
    }

    fn network(&self) -> Result<A::Network, LearnError> {
        let device = plain_device()?;
        let shape = self.architecture.init(sizes(&self.frame), &Seed::new(0), &device)?;
        let flat: Vec<f64> = self.weights.iter().flat_map(|own| own.values.iter().copied()).collect();
        Ok(with_parameters(shape, &flat, &device)?)
    }
}

/// Returns the times ahead, counted from the end of the past; empty for an empty past.
fn leads(past: &Past<'_>, ahead: &Ahead<'_>) -> Vec<f64> {
    past.times_s.last().map_or_else(Vec::new, |now| ahead.times_s.iter().map(|time| time - now).collect())
}

impl<A: Architecture> Model for SequenceModel<A> {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let frame = &self.frame;
        let (Some(&now), Some(&end)) = (past.times_s.last(), ahead.times_s.last()) else {
            return Ok(Predicted::default());
        };
        // Two samples beyond the last time, so that the interpolating cubic has samples on both sides.
        let needed = ((end - now) / frame.interval_s).ceil() as usize + 2;
        let after = needed.div_ceil(frame.block) * frame.block;
        let start = past_positions(past, frame.interval_s, frame.past, frame.repeats)?;
        let mut positions: Vec<f64> = start.iter().map(|&value| frame.position_in(value)).collect();
        positions.resize(frame.past + after, 0.0);
        let given = inputs((past, ahead), frame.hold, frame.interval_s, [frame.past, after])?;
        let rows = Rows {
            count: 1,
            length: positions.len(),
            positions,
            inputs: given.map(|given| given.into_iter().map(|value| frame.input_in(value)).collect()),
        };
        let whole = free_run(&self.network()?, frame, &rows, &plain_device()?)?;
        if let Some(place) = whole.iter().position(|value| value.is_nan() || value.abs() > BOUND) {
            let time_s = (place as f64 - frame.past as f64) * frame.interval_s;
            return Err(LearnError::Diverged { time_s, bound: BOUND * frame.scale.position });
        }
        let whole: Vec<f64> = whole.into_iter().map(|value| frame.position_out(value)).collect();
        let first = now - (frame.past as f64 - 1.0) * frame.interval_s;
        Ok(Predicted { values: read_back(&whole, first, frame.interval_s, ahead.times_s), std: None })
    }

    fn banded_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        let found = self.free_run(past, ahead)?;
        let std = match &self.band {
            Some(band) => band.std(&leads(past, ahead), &found.values),
            None => vec![self.std; found.values.len()],
        };
        Ok(Predicted { std: Some(std), ..found })
    }

    fn parameters(&self) -> usize {
        self.weights.iter().map(|own| own.values.len()).sum()
    }

    fn stored(&self) -> Option<Stored> {
        let described = Described {
            architecture: self.architecture.clone(),
            frame: self.frame.clone(),
            std: self.std,
            band: self.band.clone(),
        };
        let tensors = self.weights.iter().map(|own| Tensor {
            name: own.name.clone(),
            shape: own.shape.clone(),
            values: own.values.clone(),
        });
        Stored::new(A::ID, &described, tensors.collect()).ok()
    }
}
