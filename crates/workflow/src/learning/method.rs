//! Methods of a learning study: the registries' learners and baselines, each fitted to a data set and scored.

use super::Ready;
use dynamics::System;
use experiment::LearnSettings;
use learn::baselines::{BASELINES, exact};
use learn::data::DataSet;
use learn::judge::{Run, Score, Truth, runs, score, validation_error};
use learn::learners::LEARNERS;
use learn::{Context, Fitted, LearnError, Learner, Model};
use results::{LearnKind, Reached};
use settings::{Resolved, SettingsError};

type Make<'a> = Box<dyn Fn(&Seen<'_>, &Context<'_>) -> Result<Fitted, LearnError> + Send + Sync + 'a>;

/// Data set without its test part, and the system that generated it for the reference alone.
struct Seen<'a> {
    data: DataSet,
    truth: Option<&'a System>,
}

/// Learner, baseline or reference, ready to be fitted to a data set.
pub struct Method<'a> {
    /// Identifier, as in configurations.
    pub id: &'a str,
    /// Name in words.
    pub title: &'a str,
    /// Learner, baseline or reference.
    pub kind: LearnKind,
    make: Make<'a>,
}

/// Model with its scores.
pub struct Judged {
    /// Fitted model.
    pub model: Box<dyn Model>,
    /// State in which the training ended.
    pub reached: Reached,
    /// Scores on the test part.
    pub score: Score,
    /// Error of free runs over the validation part, in the position's unit; infinite if a run fails.
    pub validation: f64,
    /// Free runs on the test part.
    pub runs: Vec<Run>,
}

/// Returns the methods that a configuration asks for, in the order of the registries.
///
/// # Errors
/// [`SettingsError`] for settings from which a learner cannot be built.
pub fn methods<'a>(settings: &LearnSettings, resolved: &Resolved) -> Result<Vec<Method<'a>>, SettingsError> {
    let wanted = |names: &Option<Vec<String>>, id: &str| {
        names.as_ref().is_none_or(|names| names.iter().any(|name| name == id))
    };
    let mut methods: Vec<Method<'a>> = Vec::new();
    for entry in LEARNERS.iter().filter(|entry| wanted(&settings.learners, entry.id)) {
        let learner = (entry.build)(resolved)?;
        let make: Make<'a> = Box::new(move |seen, context| learner.fit(&seen.data, context));
        methods.push(Method { id: entry.id, title: entry.title, kind: LearnKind::Learner, make });
    }
    for baseline in BASELINES.iter().filter(|baseline| wanted(&settings.baselines, baseline.id)) {
        let make: Make<'a> = Box::new(|seen, context| (baseline.make)(&seen.data, context));
        methods.push(Method { id: baseline.id, title: baseline.title, kind: LearnKind::Baseline, make });
    }
    let make: Make<'a> = Box::new(|seen, context| match seen.truth {
        Some(system) => exact(system, &seen.data, context),
        None => {
            Err(LearnError::Unsolvable { what: "exact fit", problem: "the truth is not known".to_owned() })
        }
    });
    methods.push(Method { id: "exact", title: "True law, fitted exactly", kind: LearnKind::Reference, make });
    Ok(methods)
}

/// Wraps a learner from outside the registries as a method.
#[must_use]
pub fn method_of<'a>(id: &'a str, title: &'a str, learner: &'a dyn Learner) -> Method<'a> {
    let make: Make<'a> = Box::new(move |seen, context| learner.fit(&seen.data, context));
    Method { id, title, kind: LearnKind::Learner, make }
}

/// Fits a method to a data set without its test part, and scores its model on the test part.
///
/// # Errors
/// [`LearnError`] if the method returns no model.
pub fn attempt(ready: &Ready, method: &Method<'_>, context: &Context<'_>) -> Result<Judged, LearnError> {
    let seen = Seen { data: ready.data.without_test(), truth: ready.truth.as_ref() };
    let fitted = context.check().and_then(|()| (method.make)(&seen, context))?;
    Ok(judged(fitted.model, fitted.reached, &ready.data))
}

/// Scores a model on the test part.
#[must_use]
pub fn judged(model: Box<dyn Model>, reached: Reached, data: &DataSet) -> Judged {
    let runs = runs(model.as_ref(), data);
    let score = score(model.as_ref(), &runs, data);
    let validation = validation_error(model.as_ref(), data);
    Judged { model, reached, score, validation, runs }
}

/// Returns the true torque of a data set's records at the visited states; `None` if it is unknown or not a
/// function of the state.
#[must_use]
pub fn truth_of(ready: &Ready) -> Option<Truth> {
    ready.truth.as_ref().and_then(|system| Truth::new(system, &ready.data).ok().flatten())
}
