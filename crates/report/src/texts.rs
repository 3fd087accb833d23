//! Texts of a run from which a page is made.

use crate::Reader;

/// The texts of the files in a run folder.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunTexts<'a> {
    /// Name of the run: the name of its folder.
    pub name: &'a str,
    /// `config.toml`: the resolved settings; for a diagnosis, `repaired.toml`. Shown unchanged; may be empty.
    pub config: &'a str,
    /// `result.json`: see [`results::EstimationResult`], or the type for the run's task in [`results`]; for a
    /// diagnosis, `diagnosis.json`: [`results::DiagnosisResult`].
    pub result: &'a str,
    /// `trace.csv`: see [`results::TraceRow`], and [`results::LearnTraceRow`] for a learning study. Empty for
    /// a method that takes no steps, and for other tasks.
    pub trace: &'a str,
    /// `envelope.csv`: see [`results::EnvelopeRow`]. Empty except for an estimation and a comparison.
    pub envelope: &'a str,
    /// `predictions.csv`: see [`results::PredictionCsvRow`], and [`results::LearnSeriesRow`] for a learning
    /// study. Empty for other tasks.
    pub predictions: &'a str,
    /// `series.csv`: see [`results::SeriesRow`], and [`results::LearnTorqueRow`] for a learning study. Empty
    /// except for these and a diagnosis.
    pub series: &'a str,
    /// `environment.json`: the program and the machine of the run. Shown unchanged; may be empty.
    pub environment: &'a str,
    /// Reader of the report; only that on a diagnosis differs.
    pub reader: Reader,
}
