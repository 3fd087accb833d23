//! Page of a study of held-out prediction, and its tables as Markdown.

mod figures;
mod markdown;
mod scores;
mod study;

#[cfg(test)]
mod sample;
#[cfg(test)]
mod tests;

use askama::Template;
use results::{PredictionResult, ProblemOutcome, ProblemRow};

use crate::figures::Figure;
use crate::frame::{Frame, finish};
use crate::parse::Prediction;
use crate::tables::{Fact, ScoreTable, anchor};
use crate::verdict::{self, Origin};
use crate::{ReportError, RunTexts};

pub(crate) use markdown::markdown;
use study::{facts, headline, held_out, laws, origin};

/// One problem on the page.
struct ProblemView<'a> {
    /// Name of the problem's anchor in the page.
    id: String,
    title: &'a str,
    origin: Origin,
    /// Reason why the problem was not studied; empty if it was.
    absent: &'a str,
    facts: Vec<Fact>,
    verdict: &'a [String],
    table: Option<ScoreTable>,
    laws: Vec<String>,
    figures: Vec<Figure>,
}

#[derive(Template)]
#[template(path = "prediction.html")]
struct PredictionPage<'a> {
    frame: Frame<'a>,
    held_out: String,
    reading: [&'static str; 4],
    problems: Vec<ProblemView<'a>>,
}

pub(crate) fn render(texts: &RunTexts<'_>, prediction: &Prediction) -> Result<String, ReportError> {
    let result = &prediction.result;
    let page = PredictionPage {
        frame: Frame {
            warnings: absences(result),
            ..Frame::bare(texts, "many methods on peaks they did not see", headline(result), origin(result))
        },
        held_out: held_out(&result.splits),
        reading: scores::READING,
        problems: result.problems.iter().map(|row| view(row, prediction)).collect(),
    };
    finish(&page)
}

fn view<'a>(row: &'a ProblemRow, prediction: &Prediction) -> ProblemView<'a> {
    let mut view = ProblemView {
        id: format!("problem-{}", anchor(&row.id)),
        title: &row.title,
        origin: verdict::origin(row.origin),
        absent: "",
        facts: Vec::new(),
        verdict: &[],
        table: None,
        laws: Vec::new(),
        figures: Vec::new(),
    };
    match &row.outcome {
        ProblemOutcome::Absent { reason } => view.absent = reason,
        ProblemOutcome::Studied(study) => {
            view.facts = facts(study);
            view.verdict = &study.verdict;
            view.table = Some(scores::table(study));
            view.laws = laws(study);
            view.figures = figures::figures(&view.id, row, study, &prediction.rows);
        }
    }
    view
}

fn absences(result: &PredictionResult) -> Vec<String> {
    let absence = |row: &ProblemRow| match &row.outcome {
        ProblemOutcome::Absent { reason } => Some(format!("{} is absent: {reason}.", row.title)),
        ProblemOutcome::Studied(_) => None,
    };
    result.problems.iter().filter_map(absence).collect()
}
