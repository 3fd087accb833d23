//! Page of withheld-effect trials.

mod classes;
mod figures;
mod grid;
mod grids;
mod probabilities;
#[cfg(test)]
mod tests;

pub use classes::class_rows;
use grid::{Section, percent, percents};

use askama::Template;
use results::{BarRow, FailureRow, TrialsResult};

use crate::format::{count, fixed, interval, quantity, significant};
use crate::frame::{Frame, finish};
use crate::verdict::{Origin, Tone, Verdict};
use crate::{ReportError, RunTexts, remarks};

/// Largest number of failures shown; `cases.csv` has all.
const MOST_FAILURES: usize = 300;

#[derive(Template)]
#[template(path = "trials.html")]
struct TrialsPage<'a> {
    frame: Frame<'a>,
    cases: String,
    right_means: &'a str,
    bars: Vec<BarView<'a>>,
    left_out: Vec<String>,
    sections: Vec<Section>,
    failure_note: String,
    failures: Vec<FailureView<'a>>,
}

struct BarView<'a> {
    metric: &'a str,
    bar: String,
    measured: String,
    cases: String,
    state: &'a str,
    class: &'static str,
}

struct FailureView<'a> {
    id: &'a str,
    bank: &'a str,
    hidden: &'a str,
    size: String,
    said: String,
    command: &'a str,
}

pub(crate) fn render(texts: &RunTexts<'_>, result: &TrialsResult) -> Result<String, ReportError> {
    let shown = result.failures.len().min(MOST_FAILURES);
    let page = TrialsPage {
        frame: Frame {
            warnings: warnings(result),
            next: next(result),
            ..Frame::bare(
                texts,
                "a diagnosis on effects that were withheld from it",
                headline(result),
                Origin {
                    class: "simulated",
                    label: "Cases with a known truth",
                    note: "The program made these cases. The name of a bank states whether it uses measured \
                           records or a physics engine.",
                },
            )
        },
        cases: count(result.cases),
        right_means: &result.right_means,
        bars: result.gate.iter().chain(&result.bars).map(bar).collect(),
        left_out: result.left_out.iter().map(|left| format!("{}: {}", left.bank, left.reason)).collect(),
        sections: [
            Some(grids::accuracy(result)),
            classes::section(result),
            Some(grids::confusion(result)),
            Some(probabilities::section(result)),
            Some(probabilities::unknown(result)),
            Some(grids::closure(result)),
            Some(grids::baselines(result)),
        ]
        .into_iter()
        .flatten()
        .collect(),
        failure_note: if shown < result.failures.len() {
            format!("The first {shown} of {}; cases.csv has all.", result.failures.len())
        } else {
            format!(
                "{} of {} cases. The command in the last column diagnoses a single case.",
                shown, result.cases
            )
        },
        failures: result.failures.iter().take(shown).map(failure).collect(),
    };
    finish(&page)
}

fn bar(row: &BarRow) -> BarView<'_> {
    let number = |value: f64| match row.unit.as_str() {
        "%" => percent(value),
        unit => quantity(&significant(value, 3), unit),
    };
    let bar = match (row.at_least, row.at_most) {
        (Some(low), Some(high)) => format!("{} to {}", number(low), number(high)),
        (Some(low), None) => format!("≥ {}", number(low)),
        (None, Some(high)) => format!("≤ {}", number(high)),
        (None, None) => String::new(),
    };
    let measured = match (row.value.is_finite(), row.unit.as_str()) {
        (false, _) => "–".to_owned(),
        (true, "%") => format!("{} {}", number(row.value), percents(row.interval_95)),
        (true, _) if row.interval_95[0].is_finite() => {
            format!("{} {}", number(row.value), interval(row.interval_95))
        }
        (true, _) => number(row.value),
    };
    let class = match (row.state.as_str(), row.missed_beyond_chance) {
        ("met", _) => "good",
        ("not met", true) => "bad",
        ("not met", false) => "caution",
        _ => "absent",
    };
    BarView {
        metric: &row.metric,
        bar,
        measured,
        cases: count(row.cases),
        state: remarks::bar_state(row),
        class,
    }
}

fn failure(row: &FailureRow) -> FailureView<'_> {
    FailureView {
        id: &row.id,
        bank: &row.bank,
        hidden: &row.hidden,
        size: if row.size.is_finite() { fixed(row.size, 1) } else { "–".to_owned() },
        said: if row.same_class {
            format!("{} (said to be indistinguishable)", row.said)
        } else {
            row.said.clone()
        },
        command: &row.command,
    }
}

fn headline(result: &TrialsResult) -> Verdict {
    let of = |state: &str| result.bars.iter().filter(|bar| bar.state == state).count();
    let beyond = result.bars.iter().filter(|bar| bar.missed_beyond_chance).count();
    let (met, missed, absent) = (of("met"), of("not met"), of("not measured here"));
    let (tone, label) = match (missed, beyond, met) {
        (0, _, 0) => (Tone::Caution, "No bar measured"),
        (0, ..) => (Tone::Good, "Every measured bar met"),
        (_, 0, _) => (Tone::Caution, "Some bars not met"),
        _ => (Tone::Bad, "Some bars missed beyond chance"),
    };
    Verdict {
        tone,
        label,
        sentence: format!(
            "Of {} bars {met} are met, {missed} are not (of these {beyond} with the whole 95 % interval), {absent} are \
             not measured here.",
            result.bars.len()
        ),
    }
}

/// Returns the next step: a look at a case that was answered wrongly.
fn next(result: &TrialsResult) -> Vec<String> {
    let first = result.failures.first();
    first
        .map(|case| {
            format!("Diagnose a single case that was answered wrongly, {}: {}", case.id, case.command)
        })
        .into_iter()
        .collect()
}

fn warnings(result: &TrialsResult) -> Vec<String> {
    let mut warnings = Vec::new();
    if result.unanswered > 0 {
        warnings.push(format!(
            "{} of {} cases have no answer; they count as wrong.",
            count(result.unanswered),
            count(result.cases)
        ));
    }
    warnings
}
