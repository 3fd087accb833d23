//! Properties shared by all architectures.

use super::*;
use crate::baselines::Arx;
use crate::data::{DataSet, windows};
use crate::judge::{runs, score};
use crate::learners::LEARNERS;
use crate::learners::state_space::StateSpace;
use crate::testing::{context, data_set, drag_and_cubic, learner};
use crate::training::Trainable;
use crate::{Context, Past};
use estimator::Checkpoints;
use frame::Framed;
use neural::{DeviceKind, Precision, tensor};
use roll::{Roll, sizes};
use serde_json::json;
use std::sync::Mutex;

fn settings() -> Settings {
    Settings {
        past: None,
        samples_per_period: 16,
        block_periods: 0.5,
        blocks: 3,
        windows: 16,
        epochs: 1,
        batch: 8,
        learning_rate: 5e-3,
        weight_decay: 0.0,
        patience: 5,
        device: DeviceKind::Cpu,
        precision: Precision::F64,
    }
}

fn driven() -> DataSet {
    data_set(&drag_and_cubic(), true, 2e-3)
}

/// Builds an architecture from those settings that it has.
fn of<A: Architecture>() -> A {
    let all = json!({ "units": 4, "channels": 4, "states": 2, "layers": 2, "heads": 2, "head_width": 3 });
    serde_json::from_value(all).unwrap()
}

/// Returns the derivative of the loss along a direction, by the gradient and by finite differences.
fn slopes<A: Architecture>() -> [f64; 2] {
    let Framed { frame, train, validation } = Framed::new(&driven(), &settings()).unwrap();
    let (architecture, device) = (of::<A>(), plain_device().unwrap());
    let shape = architecture.init(sizes(&frame), &Seed::new(3), &device).unwrap();
    let roll = Roll {
        architecture: &architecture,
        held: Vec::new(),
        shape,
        frame: &frame,
        train: &train,
        validation: &validation,
        device,
    };
    let batch = windows(&train, frame.past, 3 * frame.block, 97);
    let mut weights = roll.initial(&Seed::new(4)).unwrap();
    // The head starts at zero, where no other weight has an effect.
    weights.iter_mut().enumerate().for_each(|(at, weight)| *weight += 0.1 * (at as f64).sin());
    let direction: Vec<f64> = (0..weights.len()).map(|at| (1.7 * at as f64).cos()).collect();
    let mut gradient = vec![0.0; weights.len()];
    roll.loss(&weights, &batch, &mut gradient).unwrap();
    let along = gradient.iter().zip(&direction).map(|(a, b)| a * b).sum();
    let loss = |by: f64| {
        let moved: Vec<f64> = weights.iter().zip(&direction).map(|(own, way)| own + by * way).collect();
        roll.loss(&moved, &batch, &mut vec![0.0; weights.len()]).unwrap()
    };
    [along, (loss(1e-5) - loss(-1e-5)) / 2e-5]
}

#[test]
fn gradients_pass_through_all_blocks_of_a_free_run() {
    use crate::learners::{lstm::Lstm, temporal_convolution::TemporalConvolution, transformer::Transformer};
    for [own, expected] in
        [slopes::<Lstm>(), slopes::<Transformer>(), slopes::<TemporalConvolution>(), slopes::<StateSpace>()]
    {
        assert!((own - expected).abs() < 1e-6 * expected.abs().max(1e-3), "{own} {expected}");
    }
}

/// Returns the change of the corrections, sample by sample, caused by a change of the very last token.
fn change_of_the_last_sample<A: Architecture>() -> Vec<f64> {
    let (sizes, device) = (Sizes { features: 3, length: 10, block: 4 }, plain_device().unwrap());
    let network = of::<A>().init(sizes, &Seed::new(1), &device).unwrap();
    let mut weights: Vec<f64> =
        named_parameters(&network).unwrap().into_iter().flat_map(|own| own.values).collect();
    weights.iter_mut().enumerate().for_each(|(at, weight)| *weight += 0.3 * (at as f64).sin());
    let network = with_parameters(network, &weights, &device).unwrap();
    let said = |last: f64| {
        let mut numbers: Vec<f64> = (0..30).map(|at| (0.7 * f64::from(at)).sin()).collect();
        numbers[28] = last;
        let tokens = tensor(numbers, [10, 3], &device).unsqueeze_dim::<3>(0);
        neural::values(network.forward(Batch { tokens, block: 4 })).unwrap()
    };
    said(0.0).iter().zip(said(1.0)).map(|(a, b)| (a - b).abs()).collect()
}

#[test]
fn a_correction_depends_on_no_later_input() {
    use crate::learners::{lstm::Lstm, temporal_convolution::TemporalConvolution, transformer::Transformer};
    for change in [
        change_of_the_last_sample::<Lstm>(),
        change_of_the_last_sample::<Transformer>(),
        change_of_the_last_sample::<TemporalConvolution>(),
        change_of_the_last_sample::<StateSpace>(),
    ] {
        assert!(change[..3].iter().all(|change| *change < 1e-12) && change[3] > 1e-6, "{change:?}");
    }
}

/// Returns the learners of this module, which all have its settings.
fn sequence_learners() -> impl Iterator<Item = &'static str> {
    let is_own = |entry: &&crate::Entry| entry.fields.iter().any(|field| field.key == "block_periods");
    LEARNERS.iter().filter(is_own).map(|entry| entry.id)
}

/// Without a training step, a sequence model is an autoregression; its ridge keeps it from being worse than
/// the baseline.
#[test]
fn an_untrained_network_is_the_linear_prediction() {
    let data = driven();
    let error = |model: &dyn crate::Model| score(model, &runs(model, &data), &data).free_run_rmse;
    let expected = error(&Arx::fit(&data).unwrap());
    let untrained = sequence_learners()
        .map(|id| error(learner(id, &["epochs=0"]).fit(&data, &context()).unwrap().model.as_ref()));
    let untrained: Vec<f64> = untrained.collect();
    assert!(untrained.iter().all(|own| *own < 1.1 * expected), "{untrained:?} {expected}");
    assert!(untrained.windows(2).all(|pair| (pair[0] / pair[1] - 1.0).abs() < 1e-9), "{untrained:?}");
}

#[test]
fn a_past_that_is_too_short_is_refused() {
    let data = driven();
    let model = learner("lstm", &["epochs=0"]).fit(&data, &context()).unwrap().model;
    let times = [0.0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14];
    let past = Past { times_s: &times, values: &[0.0; 8], input: Some(&[0.0; 8]) };
    let ahead = crate::Ahead { times_s: &[0.16], input: Some(&[0.0]) };
    let error = model.free_run(&past, &ahead).unwrap_err().to_string();
    assert!(error.contains("the past is too short: 5 of the 25 samples"), "{error}");
}

/// Stores the first states of a training and none of the later ones.
struct FirstStates {
    left: Mutex<u64>,
    kept: Mutex<Option<Vec<u8>>>,
}

impl Checkpoints for FirstStates {
    fn latest(&self) -> Option<Vec<u8>> {
        self.kept.lock().unwrap().clone()
    }

    fn is_due(&self) -> bool {
        let mut left = self.left.lock().unwrap();
        *left = left.saturating_sub(1);
        *left > 0
    }

    fn keep(&self, _step: u64, state: &[u8]) -> Result<(), String> {
        *self.kept.lock().unwrap() = Some(state.to_vec());
        Ok(())
    }
}

#[test]
fn a_resumed_model_is_the_same_to_the_bit() {
    let data = driven();
    let own = learner("temporal-convolution", &["epochs=4", "windows=40", "samples_per_period=16"]);
    let bytes =
        |context: &Context<'_>| own.fit(&data, context).unwrap().model.stored().unwrap().to_bytes().unwrap();
    let whole = bytes(&context());
    let place = FirstStates { left: Mutex::new(3), kept: Mutex::default() };
    let keeping = Context { checkpoints: Some(&place), ..context() };
    assert_eq!(bytes(&keeping), whole);
    // The state of the second epoch is stored, and the training resumes from it.
    let state: crate::training::State = keeping.resumed().unwrap().unwrap();
    assert_eq!(state.epoch, 2);
    assert_eq!(bytes(&keeping), whole);
}
