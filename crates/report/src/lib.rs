//! Renders a run's results as one HTML file, as a pure function.
//!
//! [`render`] takes the texts of a run folder and returns the page. It uses no disk, no clock and no network.
//! Every number on the page is in those texts or follows from them by a difference, a ratio or a conversion
//! of units. The same texts give the same bytes.
//!
//! The task of the run determines the page: [`render_run`] shows one estimator's estimate,
//! [`render_comparison`] many methods on one envelope, [`render_prediction`] many methods on held-out peaks,
//! [`render_diagnosis`] the gap between a simulator and records, [`render_trials`] the accuracy of a
//! diagnosis, [`render_run_table`] the runs of a sweep. [`comparison_markdown`] and [`prediction_markdown`]
//! return the tables of a comparison and of a prediction study as Markdown, [`comparison_latex`] those of a
//! comparison as LaTeX.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod actuator;
mod classes;
mod comparison;
mod diagnosis;
mod error;
mod factors;
mod figures;
mod fleet;
pub mod format;
mod frame;
pub mod glossary;
mod joints;
mod latex;
mod learning;
mod log_unit;
mod modes;
mod page;
mod parse;
pub mod plot;
mod prediction;
mod reader;
mod remarks;
mod rigs;
mod run_table;
mod scripts;
mod tables;
mod texts;
mod trials;
mod verdict;
mod whole;

#[cfg(test)]
mod sample;

pub use actuator::actuator_sentence;
pub use classes::{
    ClassStatement, Standing, class_statements, class_title, is_calibrated_already, listed, nameless_share,
    unlikely_classes, verdict_sentence,
};
pub use comparison::{ABLATION_READING, ablation_cell, beside_least_squares};
pub use diagnosis::spectrum_plot;
pub use error::ReportError;
pub use modes::{half_power_width, quality_factor, sentence as modes_sentence};
pub use reader::{Reader, in_fields};
pub use remarks::{
    bar_state, is_believed, is_exponential, is_of_the_chain_only, noticed, truth_rows, warnings,
};
pub use run_table::{
    csv as run_table_csv, latex as run_table_latex, markdown as run_table_markdown,
    text_cells as run_table_text,
};
pub use scripts::policy as script_policy;
pub use texts::RunTexts;
pub use trials::class_rows;
pub use verdict::in_a_sentence;

/// Renders the report on a run of any task: a self-contained HTML page, including its scripts.
///
/// # Errors
///
/// [`ReportError`] if the result or the envelope is missing, or if a file does not have the form that a run
/// gives it. The message states the file, the place and the remedy.
pub fn render(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    match parse::task(texts.result)? {
        parse::Task::Estimate => render_run(texts),
        parse::Task::Compare => render_comparison(texts),
        parse::Task::Learn => learning::render(texts, &parse::parse_learning(texts)?),
        parse::Task::Predict => render_prediction(texts),
        parse::Task::Diagnose => render_diagnosis(texts),
        parse::Task::Joints => joints::render(texts, &parse::joints_result(texts.result)?),
        parse::Task::Rigs => rigs::render(texts, &parse::rigs_result(texts.result)?),
        parse::Task::Fleet => fleet::render(texts, &parse::fleet_result(texts.result)?),
        parse::Task::Trials => render_trials(texts),
        parse::Task::Table => render_run_table(texts),
    }
}

/// Renders the report on an estimation, `task = "estimate"`.
///
/// # Errors
///
/// As [`render`], and if the run has a different task.
pub fn render_run(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    page::render(texts, &parse::parse(texts)?)
}

/// Renders the report on a comparison, `task = "compare"`. The trace in `texts` may be empty.
///
/// # Errors
///
/// As [`render`], and if the run has a different task.
pub fn render_comparison(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    comparison::render(texts, &parse::parse_comparison(texts)?)
}

/// Renders the report on a study of held-out prediction, `task = "predict"`. Trace and envelope in `texts`
/// may be empty.
///
/// # Errors
///
/// As [`render`], and if the run has a different task.
pub fn render_prediction(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    prediction::render(texts, &parse::parse_prediction(texts)?)
}

/// Renders the report on a diagnosis. Its result is `diagnosis.json`, and its `config` is the repaired
/// simulator.
///
/// # Errors
///
/// As [`render`], and if the run has a different task.
pub fn render_diagnosis(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    diagnosis::render(texts, parse::parse_diagnosis(texts)?)
}

/// Converts errors, positions and their units in a diagnosis into the unit of its logs, if they share one, as its report
/// shows them. Coefficients stay in SI units.
#[must_use]
pub fn in_log_unit(result: &results::DiagnosisResult) -> results::DiagnosisResult {
    let mut shown = result.clone();
    log_unit::LogUnit::of(result).into_iter().for_each(|unit| unit.convert(&mut shown));
    shown
}

/// Renders the report on withheld-effect trials, `task = "trials"`.
///
/// # Errors
///
/// As [`render`], and if the run has a different task.
pub fn render_trials(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    trials::render(texts, &parse::trials_result(texts.result)?)
}

/// Renders the page of a table of runs: those of a sweep, or runs put side by side.
///
/// # Errors
///
/// As [`render`], and if the run has a different task.
pub fn render_run_table(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    run_table::render(texts, &parse::run_table(texts.result)?)
}

/// Returns the verdicts and the tables of a study of held-out prediction as GitHub Markdown, from its
/// `result.json`.
///
/// # Errors
///
/// As [`render`], for that file.
pub fn prediction_markdown(result: &str) -> Result<String, ReportError> {
    Ok(prediction::markdown(&parse::prediction_result(result)?))
}

/// Returns the verdict and the tables of a comparison as GitHub Markdown, from its `result.json`.
///
/// # Errors
///
/// As [`render`], for that file.
pub fn comparison_markdown(result: &str) -> Result<String, ReportError> {
    Ok(comparison::markdown(&parse::comparison_result(result)?))
}

/// Returns the methods of a comparison as LaTeX tables with the rules of booktabs, from its `result.json`.
///
/// # Errors
///
/// As [`render`], for that file.
pub fn comparison_latex(result: &str) -> Result<String, ReportError> {
    Ok(comparison::latex(&parse::comparison_result(result)?))
}
