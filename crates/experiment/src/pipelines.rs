//! Pipelines from a record to an envelope, and the choice between them.

use envelope::{EnvelopeError, Extraction, PaperPipeline, RecommendedPipeline};
use identify::{Basis, SamplesPipeline};
use record::{Clock, Record};
use serde::Deserialize;
use settings::{Resolved, SettingsError};

/// Envelope pipeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pipeline {
    /// [`RecommendedPipeline`] for a record with enough peaks of one mode, else [`SamplesPipeline`].
    Auto,
    /// [`PaperPipeline`].
    Paper,
    /// [`RecommendedPipeline`].
    Recommended,
    /// [`SamplesPipeline`].
    Samples,
}

impl Pipeline {
    /// Returns the name used in configurations and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Paper => "paper",
            Self::Recommended => "recommended",
            Self::Samples => "samples",
        }
    }
}

/// Section `envelope` and its subsections.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvelopeSettings {
    /// Pipeline in force.
    pub pipeline: Pipeline,
    /// Settings of the paper's pipeline.
    pub paper: PaperPipeline,
    /// Settings of the recommended pipeline.
    pub recommended: RecommendedPipeline,
    /// Settings of the pipeline that fits the samples.
    pub samples: SamplesPipeline,
}

/// Number of peaks below which the samples are fitted: four periods.
const FEW_PEAKS: usize = 8;
/// Smallest decay rate, in standard errors, of a record without enough peaks.
const TOLD: f64 = 5.0;
/// Smallest share of a second mode in the power of a record whose peaks mix two modes.
const SECOND_MODE: f64 = 0.01;

impl EnvelopeSettings {
    /// Runs a pipeline on a record.
    ///
    /// # Errors
    /// The pipeline's error.
    pub fn extract(
        &self,
        pipeline: Pipeline,
        record: &Record,
        clock: &Clock,
    ) -> Result<Extraction, EnvelopeError> {
        match pipeline {
            Pipeline::Auto => chosen(&self.recommended, &self.samples, record, clock),
            Pipeline::Paper => self.paper.extract(record, clock),
            Pipeline::Recommended => self.recommended.extract(record, clock),
            Pipeline::Samples => self.samples.extract(record, clock),
        }
    }
}

/// Finds peaks, or fits the samples of a free decay whose peaks are few or mix several modes.
fn chosen(
    recommended: &RecommendedPipeline,
    samples: &SamplesPipeline,
    record: &Record,
    clock: &Clock,
) -> Result<Extraction, EnvelopeError> {
    let peaks = recommended.extract(record, clock);
    let Some(because) = unsuited(&peaks, record, clock) else { return peaks };
    match (samples.extract(record, clock), peaks) {
        (Ok(samples), peaks) if peaks.is_ok() || is_told(&samples) => {
            Ok(Extraction { because: Some(because), ..samples })
        }
        (Err(EnvelopeError::NoSwing), Err(_)) => Err(EnvelopeError::NoSwing),
        (_, peaks) => peaks,
    }
}

/// Returns `true` if windows tell a decay: a swing that stops within a cycle has none.
fn is_told(samples: &Extraction) -> bool {
    oracle::decay_rate(&samples.envelope).is_ok_and(|fit| fit.decay_rate > TOLD * fit.std_error)
}

/// Returns the reason why peaks do not give the decay of a record, if there is one.
fn unsuited(peaks: &Result<Extraction, EnvelopeError>, record: &Record, clock: &Clock) -> Option<String> {
    if record.input().is_some() {
        return None;
    }
    let found = match peaks {
        Ok(found) => found.envelope.len(),
        Err(EnvelopeError::TooFewPeaks { found, .. }) => *found,
        Err(_) => return None,
    };
    if found < FEW_PEAKS {
        let s = if found == 1 { "" } else { "s" };
        return Some(format!("the record has {found} clear peak{s}, fewer than {FEW_PEAKS}"));
    }
    let modes = identify::modes(record, clock);
    if let Some(second) = modes.get(1).filter(|mode| mode.share > SECOND_MODE) {
        let (frequency, share) = (second.frequency_hz.value, 100.0 * second.share);
        return Some(match modes.iter().filter(|mode| !mode.is_steady).count() {
            1 => format!(
                "the record holds a steady line of {frequency:.3} Hz with {share:.0} % of the power, which is subtracted first"
            ),
            count => format!(
                "the record holds {count} modes, the second of {frequency:.3} Hz with {share:.0} % of the power; all but the \
                 strongest are subtracted first"
            ),
        });
    }
    let basis = identify::identify(record, clock).ok()?.basis;
    matches!(basis, Basis::Samples(_))
        .then(|| format!("the samples tell the damping much better than the {found} peaks"))
}

#[derive(Deserialize)]
struct PipelineName {
    pipeline: Pipeline,
}

/// Reads the section `envelope` of an experiment.
pub(crate) fn settings(resolved: &Resolved) -> Result<EnvelopeSettings, SettingsError> {
    let PipelineName { pipeline } = resolved.section("envelope")?;
    each(resolved, pipeline)
}

/// Reads the settings of all pipelines; `pipeline` is the one in force.
pub(crate) fn each(resolved: &Resolved, pipeline: Pipeline) -> Result<EnvelopeSettings, SettingsError> {
    Ok(EnvelopeSettings {
        pipeline,
        paper: resolved.section("envelope.paper")?,
        recommended: resolved.section("envelope.recommended")?,
        samples: resolved.section("envelope.samples")?,
    })
}
