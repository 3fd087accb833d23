//! What every page has: head, origin, verdict, warnings, pipelines, data and files.

use runs::result::{DataSummary, OracleSummary, PipelineRow};

use crate::RunTexts;
use crate::plot::Hue;
use crate::tables::{self, Fact, PipelineView};
use crate::verdict::{self, Origin, Verdict};

/// What `base.html` and the templates that pages include are filled with.
pub(crate) struct Frame<'a> {
    pub(crate) hues: &'static [Hue],
    /// Of the run.
    pub(crate) name: &'a str,
    /// What kind of run, in a few words.
    pub(crate) kicker: &'static str,
    pub(crate) verdict: Verdict,
    pub(crate) origin: Origin,
    pub(crate) warnings: Vec<String>,
    pub(crate) pipelines: Vec<PipelineView<'a>>,
    pub(crate) data: Vec<Fact>,
    pub(crate) findings: &'a [String],
    /// What the files are, and their texts.
    pub(crate) files: [(&'static str, &'a str); 3],
}

impl<'a> Frame<'a> {
    pub(crate) fn new(
        texts: &RunTexts<'a>,
        kicker: &'static str,
        verdict: Verdict,
        data: &'a DataSummary,
        oracle: &OracleSummary,
        pipelines: &'a [PipelineRow],
    ) -> Self {
        Self {
            hues: &Hue::ALL,
            name: texts.name,
            kicker,
            verdict,
            origin: verdict::origin(&data.origin),
            warnings: verdict::warnings(oracle),
            pipelines: tables::pipelines(pipelines),
            data: tables::data(data),
            findings: &data.findings,
            files: [
                ("Resolved configuration (config.toml)", texts.config),
                ("Environment (environment.json)", texts.environment),
                ("Every number, unrounded (result.json)", texts.result),
            ],
        }
    }
}
