use super::*;
use crate::data::{Trajectory, windows};
use crate::testing::{context, friction_and_gravity, record};

/// Linear model with two weights that predicts the next sample from a past of two samples.
struct Line {
    parts: Vec<Trajectory>,
}

impl Line {
    fn at<'a>(&'a self, window: &Window) -> &'a [f64] {
        &self.parts[window.trajectory].values()[window.from..window.to]
    }
}

impl Trainable for Line {
    fn initial(&self, _seed: &Seed) -> Result<Vec<f64>, LearnError> {
        Ok(vec![0.0, 0.0])
    }

    fn loss(&self, weights: &[f64], batch: &[Window], gradient: &mut [f64]) -> Result<f64, LearnError> {
        let mut sum = 0.0;
        for window in batch {
            let [before, last, next] = self.at(window) else { panic!() };
            let error = weights[0] * before + weights[1] * last - next;
            sum += error * error;
            gradient[0] += 2.0 * error * before / batch.len() as f64;
            gradient[1] += 2.0 * error * last / batch.len() as f64;
        }
        Ok(sum / batch.len() as f64)
    }

    fn validation(&self, weights: &[f64]) -> Result<f64, LearnError> {
        let all = windows(&self.parts, 2, 1, 7);
        Ok(self.loss(weights, &all, &mut [0.0; 2])?.sqrt())
    }
}

fn training(epochs: u64) -> Training {
    let schedule = Schedule { peak: 0.05, warm_up: 0.1, last: 0.01 };
    Training { epochs, batch: 32, schedule, clip: 1.0, weight_decay: 0.0, patience: 1000 }
}

fn line() -> (Line, Vec<Window>) {
    let parts = vec![record(&friction_and_gravity(), 0, false, 0.0)];
    let all = windows(&parts, 2, 1, 1);
    (Line { parts }, all)
}

#[test]
fn adam_reaches_the_least_squares_line() {
    let (model, all) = line();
    let trained = train(&model, &all, &training(200), None, &context(), &mut |_| Ok(())).unwrap();
    // For a sampled oscillation, the next value is nearly twice the last value minus the one before.
    assert!(trained.state.best_validation < 0.02, "{:?}", trained.state);
    assert!((trained.state.best[1] - 1.9).abs() < 0.2 && (trained.state.best[0] + 0.95).abs() < 0.2);
}

#[test]
fn a_resumed_training_ends_in_the_same_bits() {
    let (model, all) = line();
    let whole = train(&model, &all, &training(12), None, &context(), &mut |_| Ok(())).unwrap();
    let mut kept = None;
    train(&model, &all, &training(12), None, &context(), &mut |state| {
        if state.epoch == 5 {
            kept = Some(serde_json::to_string(state).unwrap());
        }
        Ok(())
    })
    .unwrap();
    let from = serde_json::from_str(&kept.unwrap()).unwrap();
    let resumed = train(&model, &all, &training(12), Some(from), &context(), &mut |_| Ok(())).unwrap();
    assert_eq!(resumed, whole);
}

#[test]
fn training_stops_where_validation_gets_no_better() {
    let (model, all) = line();
    let impatient = Training { patience: 3, ..training(5000) };
    let trained = train(&model, &all, &impatient, None, &context(), &mut |_| Ok(())).unwrap();
    assert!(trained.stopped_early && trained.state.epoch < 5000);
}

#[test]
fn without_a_window_there_is_nothing_to_train_on() {
    let (model, _) = line();
    let error = train(&model, &[], &training(1), None, &context(), &mut |_| Ok(())).unwrap_err().to_string();
    assert!(error.contains("shorten them"), "{error}");
}

#[test]
fn a_rate_rises_and_falls() {
    let schedule = Schedule { peak: 1.0, warm_up: 0.1, last: 0.05 };
    assert!((schedule.rate(4, 100) - 0.5).abs() < 1e-12 && (schedule.rate(9, 100) - 1.0).abs() < 1e-12);
    assert!((schedule.rate(99, 100) - 0.05).abs() < 1e-12);
    assert!((10..99).all(|step| schedule.rate(step + 1, 100) <= schedule.rate(step, 100)));
}
