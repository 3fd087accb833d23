//! Grey-box identification: a stated law, of several chosen by held-out error, with parameters fitted to free runs.
//!
//! A law gives the rates of its states, of which one is observed and others may be hidden: the hysteretic force of
//! Bouc and Wen, the level of an upper tank. Its parameters and the start state of each training part minimize the
//! error of free runs (output error) by Levenberg–Marquardt: first those of a short stretch, then those of a longer
//! one, and in the end those of the whole part. Every law is fitted from several starts; the fit with the smallest
//! error on the validation part is kept.
//!
//! Ljung, System Identification, 2nd ed. 1999, section 7.2 (output error); Bohlin, Practical Grey-box Process
//! Identification, 2006.

mod bouc_wen;
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
use crate::judge::validation_error;
use crate::{Context, Entry, Fitted, Kind, LearnError, Learner, Step};
use estimator::Reached;
use fit::{Point, Runs};
use form::{Form, NAMES};
use law::Guess;
use model::{About, GreyBox, ID};
use neural::StopReason;
use run::Piece;
use serde::Deserialize;
use settings::{Default, Field, Kind as Value, Origin, Resolved, SettingsError};
use std::ops::ControlFlow;

/// Entry in the registry.
pub const ENTRY: Entry = Entry {
    id: ID,
    title: "Grey-box law",
    summary: "Fits stated laws, with hidden states where they have any, to free runs and keeps the one that predicts the \
              validation part best.",
    reference: "Bohlin, Practical Grey-box Process Identification, Springer 2006",
    kind: Kind::Regressor,
    fields: FIELDS,
    build: |resolved| Ok(Box::new(Settings::read(resolved)?) as Box<dyn Learner>),
    restore: |stored| Ok(Box::new(GreyBox::restored(stored)?)),
};

const PLAIN: Field =
    Field { key: "", kind: Value::Text, default: Default::Absent, unit: "", meaning: "", source: "" };

const FIELDS: &[Field] = &[
    Field {
        key: "laws",
        kind: Value::Texts { at_least: 1, at_most: 10 },
        default: Default::Texts(NAMES),
        meaning: "Laws to choose among, all of those of the default; laws that do not apply to the data are left out.",
        ..PLAIN
    },
    Field {
        key: "samples",
        kind: Value::Integer { min: 100, max: 10_000_000 },
        default: Default::Integer(100_000),
        unit: "samples",
        meaning: "Most training samples; those at the start of the training part are used.",
        ..PLAIN
    },
    Field {
        key: "max_steps",
        kind: Value::Integer { min: 0, max: 1_000_000 },
        default: Default::Integer(100),
        unit: "steps",
        meaning: "Most steps on stretches of each length.",
        ..PLAIN
    },
];

/// The learner. Ranges and defaults are stated in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Settings {
    laws: Vec<String>,
    samples: usize,
    max_steps: u64,
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

/// Fit of one law from one start.
struct Candidate {
    model: GreyBox,
    validation: f64,
    reached: Reached,
}

impl Learner for Settings {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        let mut trace = Trace { context, steps: 0, train: f64::INFINITY };
        let mut best: Option<Candidate> = None;
        for name in &self.laws {
            let Some(form) = Form::named(name, data) else { continue };
            for guess in form.law().guesses(data) {
                let candidate = self.candidate(name, &form, guess, data, &mut trace)?;
                if best.as_ref().is_none_or(|best| candidate.validation < best.validation) {
                    best = Some(candidate);
                }
            }
        }
        let none =
            "no law applies: they need an input, and tanks positive levels; state others in laws".to_owned();
        let best = best.ok_or(LearnError::Unsolvable { what: ID, problem: none })?;
        Ok(Fitted { model: Box::new(best.model), reached: best.reached, steps: trace.steps })
    }
}

/// Steps of the training so far.
struct Trace<'a> {
    context: &'a Context<'a>,
    steps: u64,
    /// Root mean square error of the latest step.
    train: f64,
}

impl Settings {
    fn candidate(
        &self,
        name: &str,
        form: &Form,
        guess: Guess,
        data: &DataSet,
        trace: &mut Trace<'_>,
    ) -> Result<Candidate, LearnError> {
        let running = Running::new(data, data.noise);
        let (law, state_sizes) = (form.law(), form.law().sizes(data));
        let all: Vec<usize> = (0..guess.parameters.len()).collect();
        let starts = data.train.iter().map(|part| law.start(part, data.period_s, guess.hidden)).collect();
        let mut point = Point { parameters: guess.parameters, starts };
        let (mut reached, mut hidden) = (Reached::BudgetSpent, guess.hidden);
        for (number, periods) in LENGTHS.iter().enumerate() {
            let is_last = number + 1 == LENGTHS.len();
            let pieces = self.pieces(data, periods * data.period_s, &running)?;
            let count: usize = pieces.iter().map(|piece| piece.values.len()).sum();
            let runs = Runs {
                law,
                pieces: &pieces,
                running: &running,
                sizes: &guess.sizes,
                state_sizes,
                free: if is_last { &all } else { &guess.first },
                spread: data.scale.position,
            };
            let from =
                Point { starts: point.starts.iter().take(pieces.len()).copied().collect(), ..point.clone() };
            let phase =
                if is_last { format!("{name}, whole parts") } else { format!("{name}, {periods} periods") };
            let most = trace.context.steps(self.max_steps);
            let (found, minimum) = runs.fit(&from, most, |step, rms| trace.observe(step, &phase, rms))?;
            trace.context.check()?;
            for (own, found) in point.starts.iter_mut().zip(&found.starts) {
                *own = *found;
            }
            point.parameters = found.parameters.clone();
            hidden =
                runs.motions(&found).iter().map(|motion| motion.hidden).sum::<f64>() / count.max(1) as f64;
            let converged = matches!(minimum.reason, StopReason::Settled | StopReason::Stationary);
            reached = if converged { Reached::Converged } else { Reached::BudgetSpent };
        }
        let spread = data.scale.position;
        let about = About { form: form.clone(), running, state_sizes, spread, unit: data.unit.clone() };
        let model = GreyBox::new(about, point.parameters, hidden);
        let validation = validation_error(&model, data);
        trace.chosen(name, validation);
        Ok(Candidate { model, validation, reached })
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
