//! Methods of a learning study: the registries' learners and baselines, each tried on a data set and judged.

use super::problem::Ready;
use ::learn::baselines::{BASELINES, exact};
use ::learn::data::DataSet;
use ::learn::judge::{Run, Score, Truth, runs, score};
use ::learn::learners::LEARNERS;
use ::learn::{Context, Fitted, LearnError, Model, Step};
use estimator::Reached;
use experiment::LearnSettings;
use results::{LearnEnd, LearnKind};
use settings::{Resolved, SettingsError};

type Make<'a> = Box<dyn Fn(&Ready, &Context<'_>) -> Result<Fitted, LearnError> + Send + Sync + 'a>;

/// A row to be: what makes its model.
pub(crate) struct Method<'a> {
    pub(crate) id: &'static str,
    pub(crate) title: &'static str,
    pub(crate) kind: LearnKind,
    make: Make<'a>,
}

/// What a method gave on a problem.
pub(crate) struct Tried {
    pub(crate) fitted: Result<Judged, LearnError>,
    pub(crate) seconds: f64,
    pub(crate) steps: Vec<Step>,
}

/// A model with its scores.
pub(crate) struct Judged {
    pub(crate) model: Box<dyn Model>,
    pub(crate) reached: LearnEnd,
    pub(crate) score: Score,
    pub(crate) runs: Vec<Run>,
}

/// The methods that a configuration asks for, in the order of the registries.
pub(crate) fn methods<'a>(
    settings: &LearnSettings,
    resolved: &Resolved,
) -> Result<Vec<Method<'a>>, SettingsError> {
    let wanted = |names: &Option<Vec<String>>, id: &str| {
        names.as_ref().is_none_or(|names| names.iter().any(|name| name == id))
    };
    let mut methods: Vec<Method<'a>> = Vec::new();
    for entry in LEARNERS.iter().filter(|entry| wanted(&settings.learners, entry.id)) {
        let learner = (entry.build)(resolved)?;
        let make: Make<'a> = Box::new(move |ready, context| learner.fit(&ready.data, context));
        methods.push(Method { id: entry.id, title: entry.title, kind: LearnKind::Learner, make });
    }
    for baseline in BASELINES.iter().filter(|baseline| wanted(&settings.baselines, baseline.id)) {
        let make: Make<'a> = Box::new(|ready, context| (baseline.make)(&ready.data, context));
        methods.push(Method { id: baseline.id, title: baseline.title, kind: LearnKind::Baseline, make });
    }
    let make: Make<'a> = Box::new(|ready, context| match &ready.truth {
        Some(system) => exact(system, &ready.data, context),
        None => {
            Err(LearnError::Unsolvable { what: "exact fit", problem: "the truth is not known".to_owned() })
        }
    });
    methods.push(Method { id: "exact", title: "True law, fitted exactly", kind: LearnKind::Reference, make });
    Ok(methods)
}

/// Makes a method's model of a data set and scores it on the test part.
pub(super) fn attempt(
    ready: &Ready,
    method: &Method<'_>,
    context: &Context<'_>,
) -> Result<Judged, LearnError> {
    let fitted = context.check().and_then(|()| (method.make)(ready, context))?;
    Ok(judged(fitted.model, end_of(fitted.reached), &ready.data))
}

/// A model with its scores on the test part.
pub(super) fn judged(model: Box<dyn Model>, reached: LearnEnd, data: &DataSet) -> Judged {
    let runs = runs(model.as_ref(), data);
    let score = score(model.as_ref(), &runs, data);
    Judged { model, reached, score, runs }
}

fn end_of(reached: Reached) -> LearnEnd {
    match reached {
        Reached::Converged => LearnEnd::Converged,
        Reached::BudgetSpent => LearnEnd::BudgetSpent,
        Reached::Diverged => LearnEnd::Diverged,
        Reached::Interrupted => LearnEnd::Interrupted,
        Reached::Stalled => LearnEnd::Stalled,
    }
}

/// The truth of a problem's records at visited states, where it is a function of the state.
pub(super) fn truth_of(ready: &Ready) -> Option<Truth> {
    ready.truth.as_ref().and_then(|system| Truth::new(system, &ready.data).ok().flatten())
}
