//! Grey-box identification: a stated law, of several chosen by held-out error, with parameters fitted to free runs.
//!
//! A law gives the rates of its states, of which one is observed and others may be hidden: the hysteretic force of
//! Bouc and Wen, the level of an upper tank. Its parameters and the start state of each training part minimize the
//! error of free runs (output error) by Levenberg–Marquardt: first those of a short stretch, then those of a longer
//! one, and in the end those of the whole part. Every law is fitted from several starts. Of the fits whose error on the
//! validation part is the smallest within its uncertainty, the one with the fewest parameters is kept, and fitted once
//! more to training and validation part together.
//!
//! Ljung, System Identification, 2nd ed. 1999, section 7.2 (output error); Bohlin, Practical Grey-box Process
//! Identification, 2006.

mod bouc_wen;
mod choice;
mod curve;
mod duffing;
mod fit;
mod form;
mod law;
mod model;
mod polynomial;
mod run;
#[cfg(test)]
mod tests;
mod two_tanks;

use crate::data::DataSet;
use crate::flow::Running;
use crate::judge::validation_squares;
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner, Step};
use choice::{Candidate, simplest};
use estimator::Reached;
use fit::{Point, Prior, Runs};
use form::{Form, NAMES};
use law::Guess;
use least_squares::StopReason;
use model::{About, GreyBox, ID};
use run::Piece;
use serde::Deserialize;
use settings::{Default, Field, Kind as Value, Origin, Resolved, SettingsError};
use std::ops::ControlFlow;

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Grey-box law",
    summary: "Fits stated laws, with hidden states where they have any, to free runs and keeps the simplest of those that \
              predict the validation part best.",
    reference: "Bohlin, Practical Grey-box Process Identification, Springer 2006",
    kind: Kind::Regressor,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(Settings::read(resolved)?) as Box<dyn Learner>),
    restore: |stored| Ok(Box::new(GreyBox::restored(stored)?)),
};

const FIELDS: &[Field] = &[
    Field::new("laws", Value::Texts { at_least: 1, at_most: 10 }, Default::Texts(NAMES)).meaning(
        "Laws to choose among, all of those of the default; laws that do not apply to the data are left out.",
    ),
    Field::new("samples", Value::Integer { min: 100, max: 10_000_000 }, Default::Integer(100_000))
        .unit("samples")
        .meaning("Most training samples; those at the start of the training part are used."),
    Field::new("max_steps", Value::Integer { min: 0, max: 1_000_000 }, Default::Integer(100))
        .unit("steps")
        .meaning("Most steps on stretches of each length."),
    Field::new("fit_validation", Value::Boolean, Default::Boolean(true)).meaning(
        "true: the chosen law is fitted once more, to training and validation part together; false: to the training part \
         alone.",
    ),
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Settings {
    laws: Vec<String>,
    samples: usize,
    max_steps: u64,
    fit_validation: bool,
}

/// Lengths of the stretches of consecutive fits, in periods. The last fit is that of all parameters.
const LENGTHS: [f64; 3] = [20.0, 200.0, f64::INFINITY];

impl Settings {
    fn read(resolved: &Resolved) -> Result<Self, SettingsError> {
        let settings: Self = resolved.section(ID)?;
        match settings.laws.iter().find(|name| !NAMES.contains(&name.as_str())) {
            None => Ok(settings),
            Some(unknown) => {
                let key = format!("{ID}.laws");
                let own = resolved.settings().iter().find(|setting| setting.key() == key);
                let origin = own.map_or(Origin::Default, |setting| setting.origin.clone());
                let known = NAMES.iter().map(|name| (*name).to_owned()).collect();
                Err(SettingsError::unknown_name(origin, "law", unknown, known))
            }
        }
    }
}

/// Search from one start of one law.
struct Search<'a> {
    name: &'a str,
    form: Form,
    guess: Guess,
    point: Point,
    /// Prior of the hidden state by the latest fit.
    prior: Option<Prior>,
    /// Root mean square error of the latest fit.
    rms: f64,
    reached: Reached,
}

/// Searches whose first fit is worse than the best one by more than this factor are given up.
const GIVEN_UP: f64 = 3.0;

impl Learner for Settings {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let mut trace = Trace { context, steps: 0, train: f64::INFINITY };
        let mut searches = Vec::new();
        for name in &self.laws {
            let Some(form) = Form::named(name, data) else { continue };
            for guess in form.law().guesses(data) {
                let mut search = Search::new(name, form.clone(), guess, data);
                self.stretch(&mut search, 0, data, &mut trace)?;
                searches.push(search);
            }
        }
        let least = searches.iter().map(|search| search.rms).fold(f64::INFINITY, f64::min);
        let (mut tried, mut candidates) = (Vec::new(), Vec::new());
        for mut search in searches.into_iter().filter(|search| search.rms <= GIVEN_UP * least) {
            for length in 1..LENGTHS.len() {
                self.stretch(&mut search, length, data, &mut trace)?;
            }
            let squares = validation_squares(&search.model(data, None), data);
            let candidate = Candidate { parameters: search.point.parameters.len(), squares };
            trace.chosen(search.name, candidate.error());
            candidates.push(candidate);
            tried.push(search);
        }
        let none =
            "no law applies: they need an input, and tanks positive levels; state others in laws".to_owned();
        let best = simplest(&candidates).and_then(|at| Some((tried.get_mut(at)?, candidates.get(at)?)));
        let (search, chosen) = best.ok_or(LearnError::Unsolvable { what: ID, problem: none })?;
        let validation = Some(chosen.error()).filter(|error| self.fit_validation && error.is_finite());
        if validation.is_some() {
            self.refit(search, data, &mut trace)?;
        }
        let model = search.model(data, validation);
        Ok(Fitted { model: Box::new(model), reached: search.reached, steps: trace.steps })
    }
}

/// Steps of the training so far.
struct Trace<'a> {
    context: &'a Context<'a>,
    steps: u64,
    /// Root mean square error of the latest step.
    train: f64,
}

impl<'a> Search<'a> {
    fn new(name: &'a str, form: Form, guess: Guess, data: &DataSet) -> Self {
        let start = |part| form.law().start(part, data.period_s, guess.hidden);
        let point =
            Point { parameters: guess.parameters.clone(), starts: data.train.iter().map(start).collect() };
        let (rms, reached) = (f64::INFINITY, Reached::BudgetSpent);
        Self { name, point, prior: None, rms, reached, form, guess }
    }

    /// Returns the law as a model. `validation` is the error on the validation part before the law was fitted to it.
    fn model(&self, data: &DataSet, validation: Option<f64>) -> GreyBox {
        let about = About {
            form: self.form.clone(),
            running: Running::new(data, data.noise),
            state_sizes: self.form.law().sizes(data),
            spread: data.scale.position,
            unit: data.unit.clone(),
            validation,
            prior: self.prior,
        };
        GreyBox::new(about, self.point.parameters.clone())
    }
}

impl Settings {
    /// Fits a law to the whole training and validation parts together.
    fn refit(
        &self,
        search: &mut Search<'_>,
        data: &DataSet,
        trace: &mut Trace<'_>,
    ) -> Result<(), LearnError> {
        let model = search.model(data, None);
        for part in &data.validation {
            search.point.starts.push(model.start(&part.part(0, data.warm_up_samples(part)))?);
        }
        let train = [data.train.as_slice(), &data.validation].concat();
        self.stretch(search, LENGTHS.len() - 1, &DataSet { train, ..data.clone() }, trace)
    }

    /// Fits the starts of the training parts, up to one of the [`LENGTHS`].
    fn stretch(
        &self,
        search: &mut Search<'_>,
        length: usize,
        data: &DataSet,
        trace: &mut Trace<'_>,
    ) -> Result<(), LearnError> {
        let running = Running::new(data, data.noise);
        let all: Vec<usize> = (0..search.guess.parameters.len()).collect();
        let is_last = length + 1 == LENGTHS.len();
        // A caller's length is one of the list.
        let periods = LENGTHS.get(length).copied().unwrap_or(f64::INFINITY);
        let pieces = self.pieces(data, periods * data.period_s, &running)?;
        let law = search.form.law();
        let runs = Runs {
            law,
            pieces: &pieces,
            running: &running,
            sizes: &search.guess.sizes,
            state_sizes: law.sizes(data),
            free: if is_last { &all } else { &search.guess.first },
            spread: data.scale.position,
            prior: None,
        };
        let starts = search.point.starts.iter().take(pieces.len()).copied().collect();
        let from = Point { starts, parameters: search.point.parameters.clone() };
        let phase =
            if is_last { "whole parts".to_owned() } else { format!("stretches of {periods} periods") };
        let phase = format!("{}, {phase}", search.name);
        let most = trace.context.steps(self.max_steps);
        let (mut found, mut minimum) = runs.fit(&from, most, |step, rms| trace.observe(step, &phase, rms))?;
        // Limits of states leave kinks in the error, at which a fit stops; with the numbers scaled anew, it goes on.
        for _ in 1..if is_last { MOST_FITS } else { 1 } {
            let (next, lower) = runs.fit(&found, most, |step, rms| trace.observe(step, &phase, rms))?;
            let has_gained = lower.loss < GAINED * minimum.loss;
            (found, minimum) = (next, lower);
            if !has_gained {
                break;
            }
        }
        trace.context.check()?;
        let count: usize = pieces.iter().map(|piece| piece.values.len()).sum();
        search.rms = data.scale.position * (minimum.loss / count.max(1) as f64).sqrt();
        search.prior = Prior::of(&runs.motions(&found), search.rms);
        let converged = matches!(minimum.reason, StopReason::Settled | StopReason::Stationary);
        search.reached = if converged { Reached::Converged } else { Reached::BudgetSpent };
        search.point.starts.iter_mut().zip(found.starts).for_each(|(own, found)| *own = found);
        search.point.parameters = found.parameters;
        Ok(())
    }

    /// Returns the start of every training part, up to a length and to the largest number of samples.
    fn pieces(&self, data: &DataSet, seconds: f64, running: &Running) -> Result<Vec<Piece>, LearnError> {
        let mut left = self.samples;
        let mut pieces = Vec::new();
        for part in &data.train {
            let samples = part.samples_within(seconds).min(left);
            left -= samples;
            if samples >= LEAST_PIECE {
                pieces.push(Piece::new(&part.part(0, samples), running)?);
            }
        }
        Ok(pieces)
    }
}

/// Most fits of whole parts, and the share of the error below which the next one has to end for another.
const MOST_FITS: usize = 12;
const GAINED: f64 = 0.999;

/// Fewest samples of a piece.
const LEAST_PIECE: usize = 24;

impl Trace<'_> {
    fn observe(&mut self, step: u64, phase: &str, rms: f64) -> ControlFlow<()> {
        if step > 0 {
            self.steps += 1;
            self.train = rms;
            let step = Step { step: self.steps, phase: phase.to_owned(), train: rms, validation: None };
            (self.context.observe)(&step);
        }
        if self.context.cancel.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn chosen(&mut self, law: &str, validation: f64) {
        self.steps += 1;
        let phase = format!("{law}, validation");
        let validation = Some(validation).filter(|error| error.is_finite());
        (self.context.observe)(&Step { step: self.steps, phase, train: self.train, validation });
    }
}
