//! Training on simulated envelopes.

use super::bank::{Example, Prior};
use super::mirror::{agreed, both_ways};
use crate::adam::Adam;
use crate::decay::{Differentiated, Encoder};
use crate::device::{tensor, values};
use crate::flat::with_parameters;
use burn::tensor::{Device, Tensor};
use estimator::{FitContext, FitError, Reached, Step};
use rand_chacha::ChaCha12Rng;
use serde::{Deserialize, Serialize};

/// Options for training an amortized network, and for reading with it. Ranges and defaults are in
/// [`fields`](super::fields).
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Training {
    /// Largest number of entries that the network reads; longer envelopes are read as means over runs of
    /// neighbors.
    pub longest_sequence: usize,
    /// Largest number of looks at an envelope.
    pub most_looks: usize,
    /// Number of training steps, each on new envelopes.
    pub max_steps: u64,
    /// Number of envelopes per step.
    pub batch: usize,
    /// Largest learning rate of Adam.
    pub learning_rate: f64,
    /// Number of envelopes that calibrate the stated errors after the training.
    pub calibration: usize,
}

/// Norm to which a gradient is clipped (Pascanu, Mikolov, Bengio, ICML 2013).
const LONGEST_GRADIENT: f64 = 1.0;

/// Share of the steps over which the learning rate rises.
const RISE: f64 = 0.05;

/// Number of words of the example generator: 16 per block, with a 64-bit block counter.
const WORDS: u128 = 1 << 68;

/// Factors on stated standard errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Calibration {
    pub(super) level: f64,
    pub(super) rate: f64,
}

impl Calibration {
    /// No calibration: errors as the network states them.
    pub(super) const NONE: Self = Self { level: 1.0, rate: 1.0 };
}

/// Result of a training.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Skill {
    pub(super) parameters: Vec<f64>,
    pub(super) calibration: Calibration,
    pub(super) steps: u64,
    pub(super) reached: Reached,
}

/// State from which a training resumes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct State {
    parameters: Vec<f64>,
    /// Parameters before the last step, which are restored if the loss becomes non-finite.
    before: Vec<f64>,
    adam: Adam,
    steps: u64,
    /// Position of the example generator, in words.
    words: u128,
}

impl State {
    fn at(start: Vec<f64>) -> Self {
        Self { before: start.clone(), adam: Adam::new(start.len()), parameters: start, steps: 0, words: 0 }
    }

    /// Returns the stored state, or the initial one if none is stored. A stored state is refused unless a
    /// training of at most `limit` steps could have stored it.
    fn resumed(start: Vec<f64>, limit: u64, context: &FitContext<'_>) -> Result<Self, FitError> {
        let expected = start.len();
        let Some(state) = context.resumed::<Self>()? else { return Ok(Self::at(start)) };
        let (found, steps) = (state.parameters.len(), state.steps);
        let before = state.before.len();
        let problem = if found != expected || before != expected {
            format!(
                "the saved state has {found} parameters and {before} of a step before, expected {expected}"
            )
        } else if steps > limit || !state.adam.has_taken(steps, expected) {
            format!("the saved state is not the result of {steps} of {limit} steps on {expected} parameters")
        } else if state.words >= WORDS {
            format!("the saved state has read {} words of a generator that has {WORDS}", state.words)
        } else {
            return Ok(state);
        };
        Err(FitError::Checkpoint { problem })
    }
}

impl Training {
    /// Trains an encoder from initial values or from the stored state. `rate_of` returns the λ that given
    /// parameters read from the watched envelope.
    pub(super) fn train<E: Encoder>(
        &self,
        prior: &Prior,
        encoder: &E,
        start: Vec<f64>,
        context: &FitContext<'_>,
        device: &Device,
        rate_of: impl Fn(&[f64]) -> Result<f64, FitError>,
    ) -> Result<Skill, FitError> {
        let recording = device.clone().autodiff();
        let mut generator: ChaCha12Rng = context.seed("bank").generator();
        let limit = context.step_limit(self.max_steps);
        let mut state = State::resumed(start, limit, context)?;
        generator.set_word_pos(state.words);
        let mut reached = loop {
            state.words = generator.get_word_pos();
            context.checkpoint(state.steps, || &state)?;
            let examples = prior.examples(self.batch, self.longest_sequence, &mut generator);
            let (loss, mut gradient) = loss_and_gradient(encoder, &state.parameters, &examples, &recording)?;
            let length = gradient.iter().map(|slope| slope * slope).sum::<f64>().sqrt();
            if !(loss.is_finite() && length.is_finite()) {
                if state.steps == 0 {
                    return Err(FitError::NotFinite { loss });
                }
                state.parameters.clone_from(&state.before);
                state.steps -= 1;
                break Reached::Diverged;
            }
            context.observe(&Step {
                step: state.steps,
                planned: limit,
                phase: "Adam, simulated envelopes".to_owned(),
                loss,
                decay_rate: rate_of(&state.parameters)?,
            });
            let reached = match () {
                () if context.is_canceled() => Some(Reached::Interrupted),
                () if state.steps >= self.max_steps && state.steps > 0 => Some(Reached::Converged),
                () if state.steps >= limit => Some(Reached::BudgetSpent),
                () => None,
            };
            if let Some(reached) = reached {
                break reached;
            }
            let cut = (LONGEST_GRADIENT / length).min(1.0);
            gradient.iter_mut().for_each(|slope| *slope *= cut);
            state.before.clone_from(&state.parameters);
            state.adam.step(&mut state.parameters, &gradient, self.rate(state.steps));
            state.steps += 1;
        };
        // Errors are calibrated only after a complete training.
        let mut calibration = Calibration::NONE;
        if reached == Reached::Converged {
            let encoder = with_parameters(encoder.clone(), &state.parameters, device)?;
            match self.calibrate(prior, &encoder, context, device)? {
                Some(found) => calibration = found,
                None => {
                    context.checkpoint(state.steps, || &state)?;
                    reached = Reached::Interrupted;
                }
            }
        }
        let State { parameters, steps, .. } = state;
        Ok(Skill { parameters, calibration, steps, reached })
    }

    /// Returns the learning rate of a step: it rises linearly and falls along a cosine to zero.
    ///
    /// Reference: Loshchilov, Hutter, SGDR, ICLR 2017, equation 5.
    fn rate(&self, step: u64) -> f64 {
        let done = (step as f64 + 0.5) / self.max_steps as f64;
        let share = if done < RISE {
            done / RISE
        } else {
            (1.0 + (std::f64::consts::PI * (done - RISE) / (1.0 - RISE)).cos()) / 2.0
        };
        self.learning_rate * share
    }
}

/// Returns the loss and its gradient: the mean over the examples of Σ ½·(v + (target − output)²/eᵛ) over
/// level and rate, where v is the logarithm of the variance that the network states.
///
/// Reference: Nix, Weigend 1994, equation 2.
fn loss_and_gradient<E: Encoder>(
    encoder: &E,
    parameters: &[f64],
    examples: &[Example],
    recording: &Device,
) -> Result<(f64, Vec<f64>), FitError> {
    let encoder = with_parameters(encoder.clone(), parameters, recording)?;
    let targets = examples.iter().flat_map(|example| example.line).collect();
    let targets = tensor(targets, [examples.len(), 2], recording);
    let entries = examples.first().map_or(1, |example| example.sequence.len());
    let sequences = both_ways(examples.iter().map(|example| &example.sequence));
    let input = encoder.input(&sequences, recording);
    let Differentiated { loss, gradient, .. } =
        encoder.differentiate(input, |said| negative_log_likelihood(agreed(said), targets, entries))?;
    Ok((values(loss)?.first().copied().unwrap_or(f64::NAN), gradient))
}

fn negative_log_likelihood(said: Tensor<2>, targets: Tensor<2>, entries: usize) -> Tensor<1> {
    let examples = said.dims()[0] as f64;
    let missed = said.clone().narrow(1, 0, 2) - targets;
    let log_variance = said.narrow(1, 2, 2) - (entries as f64).ln();
    let weighted = missed.clone() * missed * (-log_variance.clone()).exp();
    (log_variance + weighted).sum() / (2.0 * examples)
}

#[cfg(test)]
mod tests {
    use super::{State, WORDS, loss_and_gradient, negative_log_likelihood};
    use crate::adam::Adam;
    use crate::amortized::estimator::Skilled;
    use crate::amortized::mirror::SAID;
    use crate::amortized::tiny::{estimator, prior};
    use crate::device::{device, tensor, values};
    use crate::kept::Kept;
    use estimator::{Cancel, FitContext, FitError, Silent};
    use rand::SeedableRng;
    use rand::rngs::StdRng;
    use seed::Seed;

    #[test]
    fn the_loss_is_the_normal_likelihoods() {
        let device = device().unwrap();
        let said = vec![0.5, -1.0, 0.3, 0.7];
        let loss = negative_log_likelihood(
            tensor(said, [1, 4], &device),
            tensor(vec![0.1, -1.2], [1, 2], &device),
            10,
        );
        // Without the constant ½·ln 2π per term.
        let term = |missed: f64, log: f64| {
            let variance = log.exp() / 10.0;
            0.5 * (variance.ln() + missed * missed / variance)
        };
        let expected = term(0.4, 0.3) + term(0.2, 0.7);
        assert!((values(loss).unwrap()[0] - expected).abs() < 1e-14);
    }

    #[test]
    fn its_gradient_is_that_of_finite_differences() {
        let device = device().unwrap();
        let encoder = estimator().network.encoder(SAID, &device);
        let recording = device.autodiff();
        let examples = prior().examples(6, 24, &mut StdRng::seed_from_u64(1));
        let parameters = [0.1, -0.3, 0.2, 0.4, -0.1, 0.3, 0.5, -0.2];
        let of = |parameters: &[f64]| loss_and_gradient(&encoder, parameters, &examples, &recording).unwrap();
        let (_, gradient) = of(&parameters);
        assert_eq!(gradient.len(), parameters.len());
        for at in 0..parameters.len() {
            let h = 1e-5;
            let moved = |by: f64| {
                let mut moved = parameters;
                moved[at] += by;
                of(&moved).0
            };
            let difference = (moved(h) - moved(-h)) / (2.0 * h);
            let off = (gradient[at] - difference).abs();
            assert!(off < 1e-6 * difference.abs().max(1.0), "{at}: {} {difference}", gradient[at]);
        }
    }

    #[test]
    fn the_rate_rises_and_falls_to_nothing() {
        let training = estimator().training;
        let rates: Vec<f64> = (0..300).map(|step| training.rate(step)).collect();
        // It rises over a twentieth of the 300 steps and falls over the rest.
        assert!(rates[..15].windows(2).all(|pair| pair[0] < pair[1]));
        assert!(rates[15..].windows(2).all(|pair| pair[0] > pair[1]));
        assert!((rates[14] - 0.1).abs() < 4e-3 && rates[299] < 1e-5 && rates[0] < 4e-3, "{rates:?}");
    }

    #[test]
    fn what_it_cannot_have_kept_is_refused() {
        let cancel = Cancel::new();
        let resumed = |state: &State| {
            let kept = Kept::default();
            let context = FitContext::new(Seed::new(0), None, &Silent, &cancel).checkpointing_to(&kept);
            context.checkpoint(state.steps, || state).unwrap();
            State::resumed(vec![0.0; 2], 1, &context)
        };
        let mut adam = Adam::new(2);
        adam.step(&mut [0.0; 2], &[1.0; 2], 0.1);
        let kept = State { parameters: vec![0.3; 2], before: vec![0.2; 2], adam, steps: 1, words: WORDS - 1 };
        assert_eq!(resumed(&kept).unwrap(), kept);
        for (state, says) in [
            (
                State { parameters: vec![0.3; 3], ..kept.clone() },
                "has 3 parameters and 2 of a step before, expected 2",
            ),
            (State { before: vec![], ..kept.clone() }, "has 2 parameters and 0 of a step before, expected 2"),
            (State { adam: Adam::new(2), ..kept.clone() }, "not the result of 1 of 1 steps on 2 parameters"),
            (State { adam: Adam::new(1), steps: 0, ..kept.clone() }, "not the result of 0 of 1 steps"),
            (State { steps: 2, ..kept.clone() }, "not the result of 2 of 1 steps"),
            (State { words: WORDS, ..kept }, "has read 295147905179352825856 words"),
        ] {
            let refused = resumed(&state).unwrap_err();
            assert!(
                matches!(&refused, FitError::Checkpoint { problem } if problem.contains(says)),
                "{refused}"
            );
        }
    }
}
