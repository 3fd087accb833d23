//! Page of several rigs of one build.

#[cfg(test)]
mod tests;

use askama::Template;
use results::{FailedCase, RigRow, RigsResult, SharedCoefficientRow};

use crate::classes::{Standing, capitalized, class_title};
use crate::format::{self, estimate, significant, unit};
use crate::frame::{Frame, finish};
use crate::verdict::{self, Origin, Tone, Verdict};
use crate::{ReportError, RunTexts};

#[derive(Template)]
#[template(path = "rigs.html")]
struct RigsPage<'a> {
    frame: Frame<'a>,
    sentences: &'a [String],
    rigs: Vec<RigView<'a>>,
    failed: &'a [FailedCase],
    classes: Vec<ClassView<'a>>,
    coefficients: Vec<CoefficientView<'a>>,
}

/// A rig with its own diagnosis.
struct RigView<'a> {
    name: &'a str,
    folder: &'a str,
    summary: &'a str,
    nameless: String,
    /// Address of its page, relative to this one.
    link: String,
}

/// A cell of a table with the name of its column.
struct Cell<'a> {
    column: &'a str,
    text: String,
}

/// A class of effects on all rigs together and on each rig.
struct ClassView<'a> {
    title: String,
    /// `certain`, `likely`, `open` or `unlikely`.
    standing: &'static str,
    probability: String,
    /// Length of the bar in percent.
    bar: String,
    cells: Vec<Cell<'a>>,
}

/// A coefficient on each rig.
struct CoefficientView<'a> {
    title: String,
    cells: Vec<Cell<'a>>,
    verdict: &'static str,
    tone: &'static str,
    note: String,
}

pub(crate) fn render(texts: &RunTexts<'_>, result: &RigsResult) -> Result<String, ReportError> {
    finish(&RigsPage {
        frame: Frame {
            warnings: warnings(result),
            next: next(result),
            files: [
                ("Configuration", ""),
                ("Environment (environment.json)", texts.environment),
                ("Every number, unrounded (rigs.json)", texts.result),
            ],
            ..Frame::bare(
                texts,
                "several rigs of one build: what they share, and where they differ",
                headline(result),
                origin(result),
            )
        },
        sentences: &result.sentences,
        rigs: result.rigs.iter().map(rig).collect(),
        failed: &result.failed,
        classes: classes(result),
        coefficients: coefficients(result),
    })
}

fn headline(result: &RigsResult) -> Verdict {
    let differing = all_coefficients(result).filter(|row| row.agree == Some(false)).count();
    let compared = all_coefficients(result).filter(|row| row.agree.is_some()).count();
    let everywhere = |standing: Standing| -> Vec<String> {
        let own = result.classes.iter().filter(|class| Standing::of(class.probability) == Some(standing));
        own.map(|class| class_title(&class.id)).collect()
    };
    let (certain, likely) = (everywhere(Standing::Certain), everywhere(Standing::Likely));
    let said = [("certain", certain), ("likely", likely)]
        .into_iter()
        .filter(|(_, titles)| !titles.is_empty())
        .map(|(word, titles)| format!("{word}: {}", crate::classes::listed(&titles, "and")))
        .collect::<Vec<_>>();
    let shared = if said.is_empty() { "no class of effects is likely".to_owned() } else { said.join("; ") };
    let of_coefficients = match (compared, differing) {
        (0, _) => "No coefficient could be compared.".to_owned(),
        (all, 0) => format!("Of {all} coefficients that can be compared, all agree within their errors."),
        (all, differing) => {
            let verb = if differing == 1 { "differs" } else { "differ" };
            format!("Of {all} coefficients that can be compared, {differing} {verb} between the rigs.")
        }
    };
    let is_whole = result.complete && result.failed.is_empty();
    Verdict {
        tone: if is_whole { Tone::Good } else { Tone::Caution },
        label: if is_whole { "What the rigs share" } else { "What the rigs share, as far as they answered" },
        sentence: format!("Over {} rigs, {shared}. {of_coefficients}", result.rigs.len()),
    }
}

fn origin(result: &RigsResult) -> Origin {
    verdict::origin_of_all(result.rigs.iter().map(|rig| rig.origin), None)
}

fn warnings(result: &RigsResult) -> Vec<String> {
    let mut warnings = Vec::new();
    if !result.complete {
        warnings.push("It was interrupted: some rigs were not diagnosed.".to_owned());
    }
    let mut origins: Vec<&str> = result.rigs.iter().map(|rig| rig.origin.name()).collect();
    origins.sort_unstable();
    origins.dedup();
    if origins.len() > 1 {
        warnings.push(format!("The rigs’ records are of several origins: {}.", origins.join(", ")));
    }
    warnings
}

fn next(result: &RigsResult) -> Vec<String> {
    let mut steps: Vec<String> = Vec::new();
    if all_coefficients(result).any(|row| row.agree == Some(false)) {
        steps.push(
            "A coefficient that differs is a property of the single rig: look for what was built or set up \
             differently there."
                .to_owned(),
        );
    }
    if result.classes.iter().any(|class| {
        (1..result.rigs.len()).contains(&class.present_in.len()) && Standing::of(class.probability).is_some()
    }) {
        steps.push(
            "Only some rigs show certain classes: record these rigs again before you believe them. An effect \
             that only absorbs a residual of one record seldom appears in the next."
                .to_owned(),
        );
    }
    steps
}

fn all_coefficients(result: &RigsResult) -> impl Iterator<Item = &SharedCoefficientRow> {
    let likely = result.classes.iter().filter(|class| Standing::of(class.probability).is_some());
    likely.flat_map(|class| &class.coefficients)
}

fn rig(row: &RigRow) -> RigView<'_> {
    RigView {
        name: &row.name,
        folder: &row.folder,
        summary: &row.summary,
        nameless: row.nameless_share.map_or_else(|| "–".to_owned(), format::share),
        link: format!("{}/report.html", encoded(&row.name)),
    }
}

/// Encodes a name as a step of a relative address.
pub(crate) fn encoded(name: &str) -> String {
    name.bytes()
        .map(|byte| match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => char::from(byte).to_string(),
            other => format!("%{other:02X}"),
        })
        .collect()
}

fn classes(result: &RigsResult) -> Vec<ClassView<'_>> {
    let view = |class: &results::SharedClassRow| {
        let own = |rig: &RigRow| rig.classes.iter().find(|own| own.id == class.id).map(|own| own.probability);
        ClassView {
            title: capitalized(&class_title(&class.id)),
            standing: Standing::of(class.probability).map_or("unlikely", Standing::word),
            probability: format::probability(class.probability),
            bar: format!("{:.1}", 100.0 * class.probability.clamp(0.0, 1.0)),
            cells: result
                .rigs
                .iter()
                .map(|rig| Cell {
                    column: &rig.name,
                    text: own(rig).map_or_else(|| "–".to_owned(), format::probability),
                })
                .collect(),
        }
    };
    result.classes.iter().map(view).collect()
}

fn coefficients(result: &RigsResult) -> Vec<CoefficientView<'_>> {
    let view = |row: &SharedCoefficientRow| {
        let (verdict, tone) = match row.agree {
            Some(true) => ("the same within errors", "good"),
            Some(false) => ("not the same", "caution"),
            None => ("not compared", "absent"),
        };
        let own = |rig: &RigRow| {
            let value = row.values.iter().find(|value| value.rig == rig.name);
            value.map_or_else(
                || "–".to_owned(),
                |value| estimate(value.value, value.interval_95, unit(&value.unit)),
            )
        };
        CoefficientView {
            title: format!("{}, {}", row.title, row.parameter.replace('_', " ")),
            cells: result.rigs.iter().map(|rig| Cell { column: &rig.name, text: own(rig) }).collect(),
            verdict,
            tone,
            note: note(row),
        }
    };
    all_coefficients(result).map(view).collect()
}

fn note(row: &SharedCoefficientRow) -> String {
    let mut parts = Vec::new();
    if let Some(chi_squared) = row.chi_squared {
        parts.push(format!("χ² {}, degrees of freedom {}", significant(chi_squared, 2), row.degrees));
    }
    if let Some(mean) = row.mean {
        parts.push(format!("mean {}", estimate(mean.value, mean.interval_95, unit(&row.unit))));
    } else if let Some(pair) = &row.farthest {
        let [one, other] = &pair.rigs;
        parts.push(format!("{one} and {other}: {} standard errors", significant(pair.standard_errors, 2)));
    }
    parts.join("; ")
}
