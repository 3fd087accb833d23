//! The texts of a run that a page is made from.

/// The texts of the files in a run folder.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunTexts<'a> {
    /// Name of the run, as its folder is called.
    pub name: &'a str,
    /// `config.toml`: the resolved settings; of a diagnosis `repaired.toml`. Shown as it is; may be empty.
    pub config: &'a str,
    /// `result.json`: see [`results::EstimationResult`], [`results::ComparisonResult`] and
    /// [`results::PredictionResult`]; of a diagnosis `diagnosis.json`: [`results::DiagnosisResult`].
    pub result: &'a str,
    /// `trace.csv`: see [`results::TraceRow`]. Empty for a method that takes no steps, and
    /// for a comparison.
    pub trace: &'a str,
    /// `envelope.csv`: see [`results::EnvelopeRow`]. Empty for a study of prediction.
    pub envelope: &'a str,
    /// `predictions.csv`: see [`results::PredictionCsvRow`]. Empty but for a study of prediction.
    pub predictions: &'a str,
    /// `series.csv`: see [`results::SeriesRow`]. Empty but for a diagnosis.
    pub series: &'a str,
    /// `environment.json`: what the run was made with. Shown as it is; may be empty.
    pub environment: &'a str,
}
