//! Page of a learning study: learners and baselines on records that were not used for training.

mod figures;
mod residuals;
mod runs;
mod scores;
#[cfg(test)]
mod tests;

use askama::Template;
use results::{LearnKind, LearnProblem, LearnResult, LearnRow};

use crate::figures::Figure;
use crate::format::{fixed, quantity, significant};
use crate::frame::{Frame, finish};
use crate::parse::Learning;
use crate::tables::{Fact, ScoreTable, anchor, fact, whole};
use crate::verdict::{self, Origin, Tone, Verdict};
use crate::{ReportError, RunTexts};

/// Explanation of the tables.
const READING: &str = "Each method was given the start of a test record, its warm-up, and predicted the rest \
                       without further observations. The free run’s error is the root mean square over all \
                       test records, in their unit and divided by the sensor’s noise; the horizon is the \
                       median time until the error over a quarter of a period exceeds three times the noise. \
                       One step is the error of predictions one sample ahead of the measured past. The \
                       torque’s error is relative to the torque that the nominal simulator lacks. Baselines \
                       use no knowledge, or that of a simulator; no method can beat the true law with \
                       exactly fitted coefficients. The last rows are the learners’ models with everything \
                       that they learned set to zero, and with noise in place of past and input: if the \
                       error stays small, the removed part contributed nothing.";

/// One coefficient of a learned law.
struct CoefficientView<'a> {
    method: &'a str,
    cells: Vec<String>,
}

/// One data set on the page.
struct ProblemView<'a> {
    id: String,
    title: &'a str,
    origin: Origin,
    absent: &'a str,
    facts: Vec<Fact>,
    table: Option<ScoreTable>,
    laws: Vec<String>,
    coefficients: Vec<CoefficientView<'a>>,
    figures: Vec<Figure>,
}

#[derive(Template)]
#[template(path = "learning.html")]
struct LearningPage<'a> {
    frame: Frame<'a>,
    reading: &'static str,
    problems: Vec<ProblemView<'a>>,
}

pub(crate) fn render(texts: &RunTexts<'_>, learning: &Learning) -> Result<String, ReportError> {
    let result = &learning.result;
    let page = LearningPage {
        frame: Frame {
            warnings: result.problems.iter().filter_map(|problem| problem.absent.clone()).collect(),
            ..Frame::bare(texts, "dynamics learned from records", headline(result), origin(result))
        },
        reading: READING,
        problems: result.problems.iter().map(|problem| view(problem, learning)).collect(),
    };
    finish(&page)
}

fn view<'a>(problem: &'a LearnProblem, learning: &'a Learning) -> ProblemView<'a> {
    let rows: Vec<&LearnRow> =
        learning.result.results.iter().filter(|row| row.problem == problem.id).collect();
    let id = format!("problem-{}", anchor(&problem.id));
    let methods: Vec<&LearnRow> =
        rows.iter().copied().filter(|row| row.kind != LearnKind::Ablation).collect();
    let law = |row: &&LearnRow| row.equation.as_ref().map(|equation| format!("{}: {equation}", row.title));
    ProblemView {
        title: &problem.title,
        origin: verdict::origin(problem.origin),
        absent: problem.absent.as_deref().unwrap_or_default(),
        facts: if problem.absent.is_some() { Vec::new() } else { facts(problem) },
        laws: methods.iter().filter_map(law).collect(),
        coefficients: methods.iter().flat_map(|row| coefficients(row)).collect(),
        figures: figures::figures(&id, problem, &methods, learning),
        table: (!rows.is_empty()).then(|| scores::table(problem, &rows)),
        id,
    }
}

fn facts(problem: &LearnProblem) -> Vec<Fact> {
    let data = &problem.data;
    let mut facts = vec![
        fact("Records", whole(data.records)),
        fact(
            "Stretches",
            format!(
                "{} to learn from, {} to choose among models, {} to test on",
                data.train, data.validation, data.test
            ),
        ),
        fact("Samples learned from", whole(problem.training_samples)),
        fact("Sampling rate", quantity(&significant(problem.rate_hz, 5), "Hz")),
        fact("Typical period", quantity(&significant(problem.period_s, 4), "s")),
        fact("Warm-up", quantity(&significant(problem.warm_up_s, 4), "s")),
        fact("Predicted after it", quantity(&significant(problem.test_s, 4), "s")),
        fact("Sensor noise", quantity(&significant(problem.noise, 3), &problem.unit)),
    ];
    let input = problem.input_between_samples();
    facts.extend(input.map(|does| fact("Input between its samples", does.to_owned())));
    facts.extend(problem.missing.iter().map(|missing| fact("Record with missing cells", missing.clone())));
    facts
}

fn coefficients(row: &LearnRow) -> Vec<CoefficientView<'_>> {
    let one = |(name, own): (&String, &results::LearnCoefficient)| {
        let interval = own.interval_95.map_or_else(String::new, |[low, high]| {
            format!("{} to {}", significant(low, 4), significant(high, 4))
        });
        let cells = vec![
            name.clone(),
            significant(own.value, 5),
            interval,
            own.truth.map_or_else(String::new, |truth| significant(truth, 5)),
            own.inclusion.map_or_else(String::new, |share| format!("{} %", fixed(100.0 * share, 0))),
            own.unit.clone(),
        ];
        CoefficientView { method: &row.title, cells }
    };
    row.coefficients.iter().flatten().map(one).collect()
}

/// Returns the verdict: the number of data sets on which a learner predicts better than every baseline except
/// the repaired simulator.
fn headline(result: &LearnResult) -> Verdict {
    let present: Vec<&LearnProblem> =
        result.problems.iter().filter(|problem| problem.absent.is_none()).collect();
    let error =
        |row: &LearnRow| row.test.as_ref().and_then(|test| test.free_run_rmse).unwrap_or(f64::INFINITY);
    let least = |problem: &LearnProblem, kind: LearnKind| {
        let own = result.results.iter().filter(|row| row.problem == problem.id && row.kind == kind);
        own.filter(|row| row.id != "repaired").map(error).fold(f64::INFINITY, f64::min)
    };
    let better = present
        .iter()
        .filter(|problem| least(problem, LearnKind::Learner) < least(problem, LearnKind::Baseline))
        .count();
    let (tone, label) = match (present.len(), better) {
        (0, _) => (Tone::Bad, "Nothing learned"),
        (all, better) if all == better => (Tone::Good, "Learning helps on every data set"),
        (_, 0) => (Tone::Bad, "Learning helps nowhere"),
        _ => (Tone::Caution, "Learning helps on some data sets"),
    };
    let sentence = format!(
        "On {better} of {} data sets, at least one learner predicts unseen records better than persistence, \
         the nominal and the recalibrated simulator, and a linear autoregression.",
        present.len()
    );
    Verdict { tone, label, sentence }
}

fn origin(result: &LearnResult) -> Origin {
    let origins = result.problems.iter().map(|problem| problem.origin);
    verdict::origin_of_all(origins, Some("Each section states the origin of its data set."))
}
