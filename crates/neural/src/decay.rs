//! Encoders that read an envelope, and the exponential decay that decodes their output.
//!
//! A network reads the peaks as a sequence and outputs two numbers, the level and the decay rate. The decoder
//! is physics: ln A(t) = ln A₀ − λt. The loss is the mean squared error of the peaks reconstructed in this
//! way. The network never sees a true rate; it sees only how well its own rate reconstructs the peaks.

use crate::device::{tensor, values};
use crate::flat::{flat_gradient, named_parameters, with_parameters};
use crate::lbfgs::{Lbfgs, Smooth};
use crate::levenberg_marquardt::LevenbergMarquardt;
use crate::sequence::Sequence;
use crate::weights::to_safetensors;
use burn::module::Module;
use burn::tensor::{Device, Tensor};
use envelope::Envelope;
use estimator::{
    Estimate, FitContext, FitError, ModelFile, Prediction, Reached, Scaling, Step, Stop, Uncertainty,
};
use least_squares::{Minimum, StopReason};
use nalgebra::DVector;
use serde::Deserialize;
use settings::{Default, Field, Kind};
use std::cell::RefCell;
use std::ops::ControlFlow;

/// Network that reads a sequence and outputs (c, r): the level of z in the middle of the record and the decay
/// rate, so that z(s) ≈ c − r·s.
pub trait Encoder: Module {
    /// Returns the network's input, of shape sequences × entries × features. All sequences have the same
    /// length.
    fn input(&self, sequences: &[Sequence], device: &Device) -> Tensor<3>;

    /// Returns (c, r) of every sequence: maps sequences × entries × features to sequences × 2.
    fn encode(&self, input: Tensor<3>) -> Tensor<2>;

    /// Returns the network's output, its loss, and the loss's gradient: by burn's tape, unless the network
    /// overrides this with a faster method.
    ///
    /// `self`, `input` and the tensors used by `loss` are on a recording device.
    ///
    /// # Errors
    /// [`FitError::Backend`] if burn gives no gradient.
    fn differentiate(
        &self,
        input: Tensor<3>,
        loss: impl FnOnce(Tensor<2>) -> Tensor<1>,
    ) -> Result<Differentiated, FitError> {
        let said = self.encode(input);
        let loss = loss(said.clone());
        let gradient = flat_gradient(self, &loss.backward())?;
        Ok(Differentiated { said, loss, gradient })
    }
}

/// Result of [`Encoder::differentiate`].
#[derive(Debug, Clone)]
pub struct Differentiated {
    /// Output of the network, sequences × 2.
    pub said: Tensor<2>,
    /// Loss of the output.
    pub loss: Tensor<1>,
    /// Derivatives of the loss with respect to the network's parameters, in the order of the flat list.
    pub gradient: Vec<f64>,
}

/// Options of a fit by reconstruction.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Reconstruction {
    /// Largest number of entries that the encoder reads; longer envelopes are [pooled](Sequence::pooled) for
    /// it. The loss always covers all peaks.
    pub longest_sequence: usize,
    /// Settings of the optimizer.
    #[serde(flatten)]
    pub optimizer: Lbfgs,
}

impl Reconstruction {
    /// Returns the key of the longest sequence with its largest value, its default and the default's source.
    #[must_use]
    pub const fn longest_sequence(max: i64, default: i64, source: &'static str) -> Field {
        Field::new("longest_sequence", Kind::Integer { min: 3, max }, Default::Integer(default))
            .unit("peaks")
            .meaning(
                "Most entries the network reads; a longer envelope is read as means over even runs of \
                    neighboring peaks. The loss is over all peaks.",
            )
            .source(source)
    }

    /// Trains an encoder from initial values on an envelope, and takes the estimate from its decoder.
    ///
    /// The uncertainty is that of a decoder with two outputs: the Laplace approximation in (c, r), whose
    /// precision is the curvature of the loss there, with the residual variance for peaks − 2 degrees of
    /// freedom.
    ///
    /// Reference: MacKay, Neural Computation 4 (1992) 448, for the two outputs instead of the weights.
    ///
    /// # Errors
    /// [`FitError::NoSpread`] for an envelope without spread, [`FitError::NotFinite`] if the loss is not
    /// finite at the start, [`FitError::Backend`] if burn fails.
    pub fn fit<E: Encoder>(
        &self,
        envelope: &Envelope,
        context: &FitContext<'_>,
        encoder: &E,
        start: Vec<f64>,
        device: &Device,
    ) -> Result<Estimate, FitError> {
        let scaling = Scaling::of(envelope)?;
        let peaks = Sequence::of(envelope, &scaling);
        let recording = device.clone().autodiff();
        let sequence = peaks.clone().pooled(self.longest_sequence).as_read(context);
        let objective = Objective::new(encoder, &sequence, &peaks, &recording);
        let (start, most) = match context.is_at_zero() {
            // Held at zero: nothing is trained.
            true => (vec![0.0; start.len()], 0),
            false => (start, self.optimizer.max_steps),
        };
        let method = Lbfgs { max_steps: context.step_limit(most), ..self.optimizer };
        let minimum = method.minimize(&objective, DVector::from_vec(start), |state| {
            context.observe(&Step {
                step: state.step,
                planned: method.max_steps,
                phase: "L-BFGS, reconstruction".to_owned(),
                loss: state.loss,
                decay_rate: scaling
                    .rate_per_centered_time(objective.code(state.parameters).map_or(f64::NAN, |c| c.rate)),
            });
            if context.is_canceled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if !minimum.loss.is_finite() {
            return Err(FitError::NotFinite { loss: minimum.loss });
        }
        let code = objective.code(&minimum.parameters)?;
        let stop = stop(&minimum, code.slope(&peaks));
        let decay_rate = scaling.rate_per_centered_time(code.rate);
        let fitted = |s: f64| scaling.log_amplitude(code.level - code.rate * s);
        let trained = with_parameters(encoder.clone(), minimum.parameters.as_slice(), device)?;
        let knowledge = match stop.reached {
            // Away from the minimum, the loss is not quadratic and the approximation does not apply.
            Reached::Converged => code.knowledge(&peaks),
            _ => None,
        };
        let uncertainty = knowledge.and_then(|known| {
            let std_error = scaling.rate_per_centered_time(known.rate_std_error());
            Uncertainty::students_t(decay_rate, std_error, known.degrees_of_freedom)
        });
        let predict = |&time: &f64| {
            let s = scaling.centered_time(time);
            let std_error = knowledge.map(|known| scaling.deviation(known.prediction_std_error(s)));
            Prediction::new(fitted(s), std_error)
        };
        Ok(Estimate {
            decay_rate,
            log_amplitude: fitted(-1.0),
            uncertainty,
            stop,
            steps: minimum.steps,
            parameters: minimum.parameters.len(),
            fitted_log_amplitudes: peaks.times.iter().map(|&s| fitted(s)).collect(),
            predictions: context.query_times().iter().map(predict).collect(),
            equation: None,
            model: Some(ModelFile {
                name: "weights.safetensors".to_owned(),
                bytes: to_safetensors(&named_parameters(&trained)?)?,
            }),
        })
    }
}

/// Output of an encoder: z(s) ≈ level − rate·s.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Code {
    level: f64,
    rate: f64,
}

impl Code {
    fn of(output: Tensor<2>) -> Result<Self, FitError> {
        match values(output)?.as_slice() {
            &[level, rate] => Ok(Self { level, rate }),
            other => Err(FitError::Backend { problem: format!("a code of {} numbers", other.len()) }),
        }
    }

    fn residuals<'a>(&'a self, peaks: &'a Sequence) -> impl Iterator<Item = (f64, f64)> + 'a {
        let pairs = peaks.times.iter().zip(&peaks.values);
        pairs.map(|(s, z)| (*s, self.level - self.rate * s - z))
    }

    /// Returns the larger of the loss's absolute derivatives with respect to level and rate.
    fn slope(&self, peaks: &Sequence) -> f64 {
        let (by_level, by_rate) = self.residuals(peaks).fold((0.0, 0.0), |(one, other), (s, residual)| {
            (one + 2.0 * residual, other - 2.0 * residual * s)
        });
        f64::max(f64::abs(by_level), f64::abs(by_rate)) / peaks.len() as f64
    }

    /// Returns the Laplace approximation at the minimum of the loss; `None` if the peaks leave no scatter to
    /// estimate.
    fn knowledge(&self, peaks: &Sequence) -> Option<Knowledge> {
        let count = peaks.len() as f64;
        let degrees_of_freedom = count - 2.0;
        let middle = peaks.times.iter().sum::<f64>() / count;
        let curvature: f64 = peaks.times.iter().map(|s| (s - middle).powi(2)).sum();
        let squares: f64 = self.residuals(peaks).map(|(_, residual)| residual * residual).sum();
        let variance = squares / degrees_of_freedom;
        let usable = variance.is_finite() && curvature > 0.0;
        usable.then_some(Knowledge { variance, curvature, middle, count, degrees_of_freedom })
    }
}

/// Laplace approximation in (level, rate): the inverse of the loss's curvature Σ (1, −s)ᵀ(1, −s), multiplied
/// by the residual variance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knowledge {
    /// Variance of a peak's z about the decoder's line.
    variance: f64,
    /// Σ (s − middle)².
    curvature: f64,
    /// Mean of s.
    middle: f64,
    /// Number of peaks.
    count: f64,
    degrees_of_freedom: f64,
}

impl Knowledge {
    fn rate_std_error(&self) -> f64 {
        (self.variance / self.curvature).sqrt()
    }

    /// Returns the standard deviation of a measured z at s about the line: its own scatter and the error of
    /// the line.
    fn prediction_std_error(&self, s: f64) -> f64 {
        (self.variance * (1.0 + 1.0 / self.count + (s - self.middle).powi(2) / self.curvature)).sqrt()
    }
}

/// Objective: the mean over the peaks of (c − r·s − z)², where (c, r) is the encoder's output.
struct Objective<'a, E> {
    encoder: &'a E,
    recording: &'a Device,
    input: Tensor<3>,
    /// Rows 1 and −s: decoding is a matrix product with it.
    decoder: Tensor<2>,
    targets: Tensor<2>,
    /// Last parameters evaluated, and the encoder's output for them.
    last: RefCell<Option<(DVector<f64>, Code)>>,
}

impl<'a, E: Encoder> Objective<'a, E> {
    fn new(encoder: &'a E, sequence: &Sequence, peaks: &Sequence, recording: &'a Device) -> Self {
        let count = peaks.len();
        let rows = std::iter::repeat_n(1.0, count).chain(peaks.times.iter().map(|s| -s)).collect();
        Self {
            encoder,
            recording,
            input: encoder.input(std::slice::from_ref(sequence), recording),
            decoder: tensor(rows, [2, count], recording),
            targets: tensor(peaks.values.clone(), [1, count], recording),
            last: RefCell::new(None),
        }
    }

    /// Returns the encoder's output for these parameters.
    fn code(&self, parameters: &DVector<f64>) -> Result<Code, FitError> {
        if let Some((_, code)) = self.last.borrow().as_ref().filter(|(last, _)| last == parameters) {
            return Ok(*code);
        }
        let encoder = with_parameters(self.encoder.clone(), parameters.as_slice(), self.recording)?;
        Code::of(encoder.encode(self.input.clone()))
    }
}

impl<E: Encoder> Smooth for Objective<'_, E> {
    type Error = FitError;

    fn value_and_gradient(&self, parameters: &DVector<f64>) -> Result<(f64, DVector<f64>), FitError> {
        let encoder = with_parameters(self.encoder.clone(), parameters.as_slice(), self.recording)?;
        let found = encoder.differentiate(self.input.clone(), |said| {
            let residuals = said.matmul(self.decoder.clone()) - self.targets.clone();
            (residuals.clone() * residuals).mean()
        })?;
        self.last.replace(Some((parameters.clone(), Code::of(found.said)?)));
        let loss = values(found.loss)?.first().copied().unwrap_or(f64::NAN);
        Ok((loss, DVector::from_vec(found.gradient)))
    }
}

/// Derivative of the loss in the decoder's two numbers below which rounding errors may dominate.
const SLOPE_OF_ROUNDING: f64 = 1e-8;

fn stop(minimum: &Minimum, slope: f64) -> Stop {
    let (reached, because) = match minimum.reason {
        StopReason::Settled => (
            Reached::Converged,
            format!("the gradient of the loss is {slope:.0e} in the decoder's scaled parameters"),
        ),
        StopReason::Stationary if slope <= SLOPE_OF_ROUNDING => (
            Reached::Converged,
            format!(
                "no step lowers the loss or its gradient any more, which is {slope:.0e} in the decoder's \
                 scaled parameters"
            ),
        ),
        StopReason::Stationary => (
            Reached::Diverged,
            format!(
                "no step lowers the loss, but its gradient is {slope:.0e} in the decoder's scaled \
                 parameters; lower estimator.initial_scale or take another seed"
            ),
        ),
        StopReason::StepsSpent | StopReason::NotFinite | StopReason::Interrupted => {
            return LevenbergMarquardt::stop(minimum);
        }
    };
    Stop { reached, because }
}

#[cfg(test)]
mod tests {
    use super::{Code, Encoder, Reconstruction, stop};
    use crate::device::device;
    use crate::lbfgs::Lbfgs;
    use crate::sequence::Sequence;
    use burn::module::Module;
    use burn::nn::{Initializer, Linear, LinearConfig};
    use burn::tensor::{Device, Tensor};
    use envelope::Envelope;
    use estimator::{Cancel, FitContext, FitError, Reached, Silent};
    use least_squares::{Minimum, StopReason};
    use nalgebra::DVector;
    use seed::Seed;

    fn sequence() -> Sequence {
        Sequence { times: vec![-1.0, -0.4, 0.0, 0.5, 1.0], values: vec![1.0, 2.0, 4.0, 8.0, 16.0] }
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_loss() {
        let peaks = sequence();
        let loss = |level: f64, rate: f64| {
            let errors = peaks.times.iter().zip(&peaks.values).map(|(s, z)| level - rate * s - z);
            errors.map(|error| error * error).sum::<f64>() / 5.0
        };
        let h = 1e-3;
        let by_level = (loss(5.0 + h, -3.0) - loss(5.0 - h, -3.0)) / (2.0 * h);
        let by_rate = (loss(5.0, -3.0 + h) - loss(5.0, -3.0 - h)) / (2.0 * h);
        let slope = Code { level: 5.0, rate: -3.0 }.slope(&peaks);
        assert!((slope - by_level.abs().max(by_rate.abs())).abs() < 1e-9, "{slope}");
    }

    #[test]
    fn every_end_is_told_with_what_to_do() {
        let end = |reason, slope| {
            let parameters = DVector::zeros(1);
            stop(&Minimum { parameters, loss: 0.1, last_gain: 0.0, steps: 7, reason }, slope)
        };
        for (reason, slope, reached, because) in [
            (StopReason::Settled, 3e-16, Reached::Converged, "the gradient of the loss is 3e-16"),
            (StopReason::Stationary, 3e-16, Reached::Converged, "or its gradient any more"),
            (StopReason::Stationary, 0.1, Reached::Diverged, "lower estimator.initial_scale"),
            (StopReason::StepsSpent, 0.1, Reached::BudgetSpent, "7 steps ended; raise"),
            (StopReason::NotFinite, 0.1, Reached::Diverged, "lower estimator.initial_scale"),
            (StopReason::Interrupted, 0.1, Reached::Interrupted, "after 7 steps"),
        ] {
            let stop = end(reason, slope);
            assert_eq!(stop.reached, reached);
            assert!(stop.because.contains(because), "{}", stop.because);
        }
    }

    /// Encoder that returns the mean of its input, multiplied by two weights.
    #[derive(Module, Debug)]
    struct Mean {
        head: Linear,
    }

    impl Encoder for Mean {
        fn input(&self, sequences: &[Sequence], device: &Device) -> Tensor<3> {
            Tensor::ones([1, sequences[0].len(), 1], device)
        }

        fn encode(&self, input: Tensor<3>) -> Tensor<2> {
            self.head.forward(input.mean_dim(1).squeeze_dim::<2>(1))
        }
    }

    #[test]
    fn a_start_that_is_not_finite_or_of_another_size_is_refused() {
        let device = device().unwrap();
        let head = LinearConfig::new(1, 2).with_bias(false).with_initializer(Initializer::Zeros);
        let encoder = Mean { head: head.init(&device) };
        let envelope = Envelope::new(vec![0.0, 1.0, 2.0], vec![2.0, 1.1, 0.0], 6.0).unwrap();
        let optimizer = Lbfgs { max_steps: 50, memory: 5, gradient_tolerance: 1e-13 };
        let training = Reconstruction { longest_sequence: 10, optimizer };
        let cancel = Cancel::new();
        let context = FitContext::new(Seed::new(0), None, &Silent, &cancel);
        let fit = |start| training.fit(&envelope, &context, &encoder, start, &device);
        let rate = fit(vec![0.1, 0.2]).unwrap().decay_rate;
        assert!((rate - 1.0).abs() < 1e-12, "{rate}");
        assert!(matches!(fit(vec![f64::NAN, 0.2]), Err(FitError::NotFinite { .. })));
        assert!(matches!(fit(vec![1e200, 0.2]), Err(FitError::NotFinite { .. })));
        assert!(matches!(fit(vec![0.1]), Err(FitError::Backend { .. })));
    }
}
