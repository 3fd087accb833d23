//! Page of a diagnosis.

mod budget;
mod classes;
mod figures;
mod maps;
mod portrait;
mod record;
mod spectrum;
mod tables;
#[cfg(test)]
mod tests;

#[cfg(test)]
pub(crate) use tests::small;

use askama::Template;
use results::{DiagnosisResult, VerdictStatus};

use crate::classes::{effect_title, is_calibrated_already, listed, unlikely_classes};
use crate::figures::Figure;
use crate::frame::{Frame, finish};
use crate::log_unit::LogUnit;
use crate::modes::{ModeView, mode_views};
use crate::parse::Diagnosis;
use crate::remarks::is_of_the_chain_only;
use crate::tables::Fact;
use crate::verdict::{self, Origin, Tone, Verdict};
use crate::{Reader, ReportError, RunTexts, actuator_sentence, format, in_fields};
use budget::Share;
use classes::{Group, Nameless};
pub use spectrum::plot as spectrum_plot;
use tables::{CoefficientView, EffectView, GapView, RecordView};

#[derive(Template)]
#[template(path = "diagnosis.html")]
struct DiagnosisPage<'a> {
    frame: Frame<'a>,
    groups: Vec<Group>,
    nameless: Option<Nameless>,
    unlikely: Option<String>,
    exact_set: Option<String>,
    gap: Vec<GapView>,
    has_bars: bool,
    gap_notes: Vec<String>,
    shares: Vec<Share>,
    effects: Vec<EffectView>,
    apart: Vec<String>,
    experiments: Vec<String>,
    /// The plot below the verdict, if there is one.
    lead: Vec<Figure>,
    record_figures: Vec<Figure>,
    modes: Vec<ModeView>,
    place_figures: Vec<Figure>,
    portrait_figures: Vec<Figure>,
    no_backbone: bool,
    coefficients: Vec<CoefficientView>,
    /// Sentence on a joint's inner loop.
    inner_loop: Option<String>,
    chain: Vec<Fact>,
    findings: Vec<String>,
    records: Vec<RecordView<'a>>,
    equation: &'a str,
    latex: &'a str,
    stages: String,
    /// `true` in the page, which has no folder beside it.
    is_on_page: bool,
}

pub(crate) fn render(texts: &RunTexts<'_>, mut diagnosis: Diagnosis) -> Result<String, ReportError> {
    let unit = LogUnit::of(&diagnosis.result);
    if let Some(unit) = &unit {
        unit.convert(&mut diagnosis.result);
        unit.convert_series(&mut diagnosis.series);
    }
    if texts.reader == Reader::Page {
        name_fields(&mut diagnosis.result);
    }
    let result = &diagnosis.result;
    let gap = tables::gap(result);
    let (lead, record_figures) = record::figures(result, &diagnosis.series, texts.reader);
    let page = DiagnosisPage {
        frame: Frame {
            warnings: warnings(result),
            next: next(result, texts.reader),
            files: [
                ("Repaired simulator (repaired.toml)", texts.config),
                ("Environment (environment.json)", texts.environment),
                ("Every number, unrounded (diagnosis.json)", texts.result),
            ],
            ..Frame::bare(
                texts,
                "where a simulator and records differ, and what closes the gap",
                headline(result),
                origin(result, texts.reader),
            )
        },
        groups: classes::groups(result),
        nameless: classes::nameless(result),
        unlikely: unlikely_classes(result),
        exact_set: tables::exact_set(result),
        has_bars: gap.iter().any(|row| row.bar.is_some()),
        gap,
        gap_notes: tables::gap_notes(result).into_iter().chain(unit.map(|unit| unit.note())).collect(),
        is_on_page: texts.reader == Reader::Page,
        shares: budget::shares(&result.place.budget),
        effects: tables::effects(result),
        apart: tables::apart(result),
        experiments: tables::experiments(result),
        lead,
        record_figures,
        modes: mode_views(&result.modes),
        place_figures: maps::figures(result),
        portrait_figures: portrait::figures(result),
        no_backbone: result.backbone.measured.is_empty(),
        coefficients: tables::coefficients(result),
        inner_loop: Some(actuator_sentence(result)).filter(|sentence| !sentence.is_empty()),
        chain: tables::chain(result),
        findings: tables::findings(result),
        records: tables::records(result),
        equation: &result.equation.text,
        latex: &result.equation.latex,
        stages: tables::stages(result),
    };
    finish(&page)
}

/// Writes options in the sentences of a result as fields of the page.
fn name_fields(result: &mut DiagnosisResult) {
    let findings = result.records.iter_mut().flat_map(|record| &mut record.findings);
    for sentence in findings.chain([&mut result.verdict.summary]) {
        *sentence = in_fields(sentence);
    }
}

fn headline(result: &DiagnosisResult) -> Verdict {
    // Beyond √2 noise floors, more than half of the remaining squared error is not noise.
    let [ratio, _] = result.gap.ratio_to_floor_interval_95;
    let explained = if ratio.powi(2) > 2.0 { Tone::Caution } else { Tone::Good };
    let (tone, label) = match result.verdict.status {
        VerdictStatus::None => (explained, "Nothing is missing"),
        VerdictStatus::Calibration if is_calibrated_already(result) => (explained, "Nothing is missing"),
        VerdictStatus::Calibration => (explained, "Only calibration"),
        VerdictStatus::Effect if is_of_the_chain_only(result) => {
            (explained, "Nothing is missing in the motion")
        }
        VerdictStatus::Effect => (explained, "Missing effect"),
        VerdictStatus::Unknown => (Tone::Caution, "Unknown: no known effect explains the gap"),
    };
    Verdict { tone, label, sentence: result.verdict.summary.clone() }
}

fn origin(result: &DiagnosisResult, reader: Reader) -> Origin {
    let origin = verdict::origin_of_all(result.records.iter().map(|record| record.origin), None);
    match (origin.class, reader) {
        ("unstated", Reader::Page) => Origin {
            note: "If it was measured, choose so under “origin” and read the log again.",
            ..origin
        },
        _ => origin,
    }
}

fn warnings(result: &DiagnosisResult) -> Vec<String> {
    let mut warnings = Vec::new();
    for class in &result.verdict.equivalent {
        let title = |id: &String| match id.as_str() {
            "calibration" => "coefficients that are off".to_owned(),
            id => effect_title(result, id),
        };
        let titles: Vec<String> = class.iter().map(title).collect();
        let others = if titles.len() == 2 { "the other" } else { "the others" };
        warnings.push(format!(
            "These data cannot distinguish {}: whichever is named, {others} would explain them as well.",
            listed(&titles, "and")
        ));
    }
    if result.samples_used < 0.9999 {
        warnings.push(format!(
            "The records are long, so {} of their samples were used: every n-th sample, as long as a swing \
             stays well sampled, and then evenly spaced stretches.",
            format::share(result.samples_used)
        ));
    }
    warnings
}

/// Returns the next experiment, and possible uses of the present answer.
fn next(result: &DiagnosisResult, reader: Reader) -> Vec<String> {
    let mut steps = Vec::new();
    if !result.next_experiment.text.is_empty() {
        steps.push(format!("Next experiment: {}", result.next_experiment.text));
    }
    if matches!(result.verdict.status, VerdictStatus::Calibration | VerdictStatus::Effect) {
        let saved = match reader {
            Reader::CommandLine => {
                "The repaired simulator is saved beside this page: “trainer simulate repaired.toml” runs it, and \
                 its section below lists the files for SciPy, Modelica, MuJoCo and URDF."
            }
            Reader::Page => {
                "Save the repaired simulator, for SciPy, Modelica, MuJoCo or URDF, or as repaired.toml: dropped beside \
                 another log of this system, it is the simulator of the next diagnosis."
            }
        };
        steps.push(saved.to_owned());
    }
    steps
}
