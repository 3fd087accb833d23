//! Tables of a study, from the trials of all methods on all problems.

use crate::problem::{Missing, Ready};
use crate::tally::{Placed, adjust, outcome, score};
use crate::trial::best_exponential;
use crate::verdict::verdict;
use experiment::PredictionStudy;
use results::{
    ExponentialScores, Failure, Family, PredictionCsvRow, PredictionOutcome, PredictionResult, PredictionRow,
    ProblemOutcome, ProblemRow, ProblemStudy, RESULT_SCHEMA, SplitKind, SplitSummary,
};

/// Name of the best exponential in `predictions.csv`.
const EXPONENTIAL: &str = "best-exponential";

/// Method as the tables name it.
#[derive(Debug, Clone, Copy)]
pub struct StudiedMethod {
    /// Number in the paper's tables.
    pub number: Option<u8>,
    /// Id in configurations.
    pub id: &'static str,
    /// Title in tables.
    pub title: &'static str,
    /// Family to which the method belongs.
    pub family: Family,
}

/// All trials on one problem: those of the best exponential and those of every method.
#[derive(Debug)]
pub struct ProblemTrials {
    /// Trials of the best exponential.
    pub exponential: Vec<Placed>,
    /// Trials of every method, in the methods' order.
    pub methods: Vec<Vec<Placed>>,
}

impl ProblemTrials {
    /// Returns `true` if some trial was not begun.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        let not_begun = |placed: &Placed| matches!(placed.trial, Err(Failure::NotBegun));
        self.methods.iter().flatten().any(not_begun)
    }
}

/// Fits the best exponential on every draw and split of a problem.
#[must_use]
pub fn best_exponentials(problem: &Ready) -> Vec<Placed> {
    let mut placed = Vec::new();
    for (draw, envelope) in problem.envelopes.iter().enumerate() {
        for split_at in problem.splits_of(draw) {
            if let Some(split) = problem.splits.get(split_at) {
                let trial = best_exponential(problem, envelope, split);
                placed.push(Placed { draw, split: split_at, trial });
            }
        }
    }
    placed
}

/// Builds the content of `result.json`: every problem with the scores of every method. `methods` and the
/// methods' trials have the same order; `trials` has the order of the problems that are ready.
#[must_use]
pub fn result(
    study: &PredictionStudy,
    problems: &[Result<Ready, Missing>],
    methods: &[StudiedMethod],
    trials: &[ProblemTrials],
    seconds: f64,
) -> PredictionResult {
    let mut trials = trials.iter();
    let problems = problems
        .iter()
        .map(|problem| match problem {
            Ok(ready) => ProblemRow {
                id: ready.id.clone(),
                title: ready.title.clone(),
                origin: ready.origin,
                outcome: trials.next().and_then(|trials| examine(study, ready, methods, trials)).map_or_else(
                    || absent("no exponential could be fitted"),
                    |study| ProblemOutcome::Studied(Box::new(study)),
                ),
            },
            Err(missing) => ProblemRow {
                id: missing.id.clone(),
                title: missing.title.clone(),
                origin: missing.origin,
                outcome: absent(&missing.reason),
            },
        })
        .collect();
    let settings = &study.settings;
    PredictionResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "predict".to_owned(),
        seed: study.seed,
        splits: SplitSummary {
            block_peaks: settings.block_peaks,
            every: settings.every,
            last_share: settings.last_share,
            significance: settings.significance,
        },
        problems,
        seconds,
    }
}

fn absent(reason: &str) -> ProblemOutcome {
    ProblemOutcome::Absent { reason: reason.to_owned() }
}

/// Computes all scores of a problem; `None` if not even an exponential can be fitted.
fn examine(
    study: &PredictionStudy,
    ready: &Ready,
    methods: &[StudiedMethod],
    trials: &ProblemTrials,
) -> Option<ProblemStudy> {
    let common = study.settings.draws_seeded;
    let reference = |kind| score(ready, &trials.exponential, kind, common, None);
    let exponential = ExponentialScores {
        interpolation: reference(SplitKind::Interpolation)?,
        extrapolation: reference(SplitKind::Extrapolation)?,
    };
    let mut rows: Vec<PredictionRow> = methods
        .iter()
        .zip(&trials.methods)
        .map(|(method, placed)| PredictionRow {
            number: method.number,
            id: method.id.to_owned(),
            title: method.title.to_owned(),
            family: method.family,
            outcome: outcome(ready, placed, &trials.exponential, common),
        })
        .collect();
    let pairs = rows
        .iter_mut()
        .filter_map(|row| match &mut row.outcome {
            PredictionOutcome::Scored(scores) => Some(scores),
            PredictionOutcome::Failed { .. } => None,
        })
        .flat_map(|scores| [scores.interpolation.as_mut(), scores.extrapolation.as_mut()])
        .filter_map(|score| score?.against_exponential.as_mut())
        .collect();
    let comparisons = adjust(pairs);
    rows.sort_by(|one, other| error(one).total_cmp(&error(other)));
    let envelope = ready.envelopes.first()?;
    let mut found = ProblemStudy {
        unit: ready.unit.clone(),
        peaks: envelope.len(),
        duration_s: envelope.duration_s(),
        data: ready.data.clone(),
        law: ready.truth.as_ref().map(|truth| truth.law.clone()),
        exponential,
        methods: rows,
        comparisons,
        verdict: Vec::new(),
    };
    found.verdict = verdict(&found, study.settings.significance);
    Some(found)
}

/// Returns the sort key of a row: the error of extrapolation. Rows without one come last.
fn error(row: &PredictionRow) -> f64 {
    match &row.outcome {
        PredictionOutcome::Scored(scores) => scores.extrapolation.as_ref().map_or(f64::NAN, |score| {
            if score.rms_log_error.is_nan() { f64::INFINITY } else { score.rms_log_error }
        }),
        PredictionOutcome::Failed { .. } => f64::NAN,
    }
}

/// Returns the rows of `predictions.csv`, one for each method's prediction of each peak: for interpolation
/// the held-out peaks, for extrapolation all peaks. For a simulation only the first draw is included.
#[must_use]
pub fn csv_rows(
    problems: &[Result<Ready, Missing>],
    methods: &[StudiedMethod],
    trials: &[ProblemTrials],
) -> Vec<PredictionCsvRow> {
    let mut rows = Vec::new();
    let ready = problems.iter().filter_map(|problem| problem.as_ref().ok());
    for (problem, trials) in ready.zip(trials) {
        add_rows(&mut rows, problem, EXPONENTIAL, &trials.exponential);
        for (method, placed) in methods.iter().zip(&trials.methods) {
            add_rows(&mut rows, problem, method.id, placed);
        }
    }
    rows
}

fn add_rows(rows: &mut Vec<PredictionCsvRow>, problem: &Ready, method: &str, trials: &[Placed]) {
    let Some(envelope) = problem.envelopes.first() else { return };
    for placed in trials.iter().filter(|placed| placed.draw == 0) {
        let Some(split) = problem.splits.get(placed.split) else { continue };
        let Some(curve) = placed.trial.as_ref().ok().and_then(|trial| trial.curve.as_ref()) else { continue };
        let peaks = envelope.times_s().iter().zip(envelope.log_amplitudes()).zip(curve).zip(&split.held_out);
        for (index, (((&time_s, &log_amplitude), prediction), block)) in peaks.enumerate() {
            if split.kind == SplitKind::Interpolation && block.is_none() {
                continue;
            }
            rows.push(PredictionCsvRow {
                problem: problem.id.clone(),
                origin: problem.origin,
                split: split.kind,
                method: method.to_owned(),
                time_s,
                log_amplitude,
                truth: problem.truth.as_ref().and_then(|truth| truth.log_amplitudes.get(index).copied()),
                held_out: block.is_some(),
                predicted: prediction.log_amplitude,
                std_error: prediction.std_error,
            });
        }
    }
}
