//! From a run's results to one HTML file, a pure function.
//!
//! [`render_run`] takes the texts of a run folder and gives back the page: no disk, no clock, no
//! network, and no number in it that is not in those texts or a plain difference or ratio of
//! numbers that are. The same texts give the same bytes.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod error;
mod figures;
pub mod format;
mod page;
mod parse;
pub mod plot;
mod tables;
mod verdict;

#[cfg(test)]
mod sample;

pub use error::ReportError;

/// The texts of the files in a run folder.
#[derive(Debug, Clone, Copy)]
pub struct RunTexts<'a> {
    /// Name of the run, as its folder is called.
    pub name: &'a str,
    /// `config.toml`: the resolved settings. Shown as it is; may be empty.
    pub config: &'a str,
    /// `result.json`: see [`runs::result::EstimationResult`].
    pub result: &'a str,
    /// `trace.csv`: see [`runs::result::TraceRow`]. Empty for a method that takes no steps.
    pub trace: &'a str,
    /// `envelope.csv`: see [`runs::result::EnvelopeRow`].
    pub envelope: &'a str,
    /// `environment.json`: what the run was made with. Shown as it is; may be empty.
    pub environment: &'a str,
}

/// The report on one run: a complete HTML page that loads nothing and runs no script.
///
/// # Errors
///
/// [`ReportError`] where the result or the envelope is missing, or where a file does not have the
/// form that a run gives it; the message says which file, where, and what to do.
pub fn render_run(texts: &RunTexts<'_>) -> Result<String, ReportError> {
    page::render(texts, &parse::parse(texts)?)
}
