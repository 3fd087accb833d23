//! Tests that an estimator's estimand selects the checks that it is held to.

use crate::CHECKS;
use crate::Subject;
use crate::line::least_squares;
use envelope::Envelope;
use estimator::{Entry, Estimate, Estimator, FitContext, FitError, Prediction, Reached, Stop, Tag};

fn estimate(
    decay_rate: f64,
    at: impl Fn(&f64) -> f64,
    envelope: &Envelope,
    context: &FitContext<'_>,
) -> Estimate {
    Estimate {
        decay_rate,
        log_amplitude: at(&0.0),
        uncertainty: None,
        stop: Stop { reached: Reached::Converged, because: "closed form".to_owned() },
        steps: 0,
        parameters: 2,
        fitted_log_amplitudes: envelope.times_s().iter().map(&at).collect(),
        predictions: context.query_times().iter().map(|time| Prediction::new(at(time), None)).collect(),
        equation: None,
        model: None,
    }
}

/// Decay rate at the first peak of a parabola in ln A. It differs from the mean slope if friction or drag
/// bend the envelope.
struct Initial;

impl Estimator for Initial {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
        let mean = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            times.iter().zip(logs).map(|(time, log)| of(*time, *log)).sum::<f64>() / times.len() as f64
        };
        let (middle, level) = (mean(&|time, _| time), mean(&|_, log| log));
        // Orthogonal polynomials over the peaks: 1, x and x² − v − k·x.
        let x = |time: f64| time - middle;
        let v = mean(&|time, _| x(time).powi(2));
        let k = mean(&|time, _| x(time).powi(3)) / v;
        let q = |time: f64| x(time).powi(2) - v - k * x(time);
        let slope = mean(&|time, log| x(time) * (log - level)) / v;
        let bend = mean(&|time, log| q(time) * (log - level)) / mean(&|time, _| q(time).powi(2));
        let rate = -(slope + bend * (2.0 * x(0.0) - k));
        Ok(estimate(rate, |time| level + slope * x(*time) + bend * q(*time), envelope, context))
    }
}

/// Least squares.
struct Squares;

impl Estimator for Squares {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let rate = least_squares(envelope).decay_rate;
        let count = envelope.len() as f64;
        let level = envelope.log_amplitudes().iter().sum::<f64>() / count
            + rate * envelope.times_s().iter().sum::<f64>() / count;
        Ok(estimate(rate, |time| level - rate * time, envelope, context))
    }
}

const AWARE: Entry = Entry {
    id: "initial-rate",
    paper_number: None,
    title: "Initial rate",
    summary: "",
    tags: &[Tag::OwnEstimand],
    citations: &[],
    fields: &[],
    build: |_settings| Ok(Box::new(Initial)),
};

fn failures(entry: &Entry) -> Vec<&'static str> {
    let subject = Subject::new(entry).unwrap();
    let own = CHECKS.iter().filter(|check| (check.applies)(entry));
    own.filter(|check| (check.run)(&subject).is_err()).map(|check| check.name).collect()
}

#[test]
fn an_estimator_of_something_else_passes_by_its_tag_and_fails_without_it() {
    assert_eq!(failures(&AWARE), [""; 0]);
    let untagged = Entry { tags: &[], ..AWARE };
    assert_eq!(failures(&untagged), ["it_agrees_with_least_squares"]);
}

#[test]
fn least_squares_under_the_tag_of_another_estimand_fails() {
    let squares = Entry { id: "squares", build: |_settings| Ok(Box::new(Squares)), ..AWARE };
    assert_eq!(failures(&squares), ["what_it_estimates_is_not_least_squares"]);
    assert_eq!(failures(&Entry { tags: &[], ..squares }), [""; 0]);
}
