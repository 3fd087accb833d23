//! The texts of a run that a page is made from.

/// The texts of the files in a run folder.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunTexts<'a> {
    /// Name of the run, as its folder is called.
    pub name: &'a str,
    /// `config.toml`: the resolved settings; of a diagnosis `repaired.toml`. Shown as it is; may be empty.
    pub config: &'a str,
    /// `result.json`: see [`runs::result::EstimationResult`], [`runs::result::ComparisonResult`] and
    /// [`runs::result::PredictionResult`]; of a diagnosis `diagnosis.json`: [`runs::result::DiagnosisResult`].
    pub result: &'a str,
    /// `trace.csv`: see [`runs::result::TraceRow`]. Empty for a method that takes no steps, and
    /// for a comparison.
    pub trace: &'a str,
    /// `envelope.csv`: see [`runs::result::EnvelopeRow`]. Empty for a study of prediction.
    pub envelope: &'a str,
    /// `predictions.csv`: see [`runs::result::PredictionCsvRow`]. Empty but for a study of prediction.
    pub predictions: &'a str,
    /// `series.csv`: see [`runs::result::SeriesRow`]. Empty but for a diagnosis.
    pub series: &'a str,
    /// `environment.json`: what the run was made with. Shown as it is; may be empty.
    pub environment: &'a str,
}
