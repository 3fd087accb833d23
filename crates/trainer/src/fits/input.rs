//! Input of an experiment's fits: from the record to an envelope and the oracle's answer.

use crate::error::TrainerError;
use envelope::Extraction;
use estimator::Uncertainty;
use experiment::{DataSettings, Experiment, Pipeline};
use oracle::DecayFit;
use record::{Clock, ClockChoice, Record, RecordError, Source, read_file};
use results::{DataSummary, EnvelopeRow, EnvelopeSummary, OracleSummary, PipelineOutcome, PipelineRow};
use std::path::Path;

/// Record with its clock, its envelope and the oracle's answer.
pub(crate) struct Input {
    pub(crate) record: Record,
    pub(crate) source: Source,
    pub(crate) clock: Clock,
    /// Clock that the time stamps and the values support.
    pub(crate) believed: Clock,
    pub(crate) extraction: Extraction,
    pub(crate) oracle: DecayFit,
    /// Results of the same record with each pipeline and each clock that makes a difference; the combination
    /// in force comes first. Empty before [`Self::with_pipelines`]. That is called before any fit: for a long
    /// record it takes seconds, for which nobody who stops a fit should have to wait.
    pub(crate) pipelines: Vec<PipelineRow>,
}

impl Input {
    pub(crate) fn read(experiment: &Experiment) -> Result<Self, TrainerError> {
        let data = &experiment.data;
        let (record, source) =
            read_file(Path::new(&data.path), &data.read_options()).map_err(|error| absent(error, data))?;
        let clock_of = |choice| Clock::new(&record, choice).map_err(|fault| fault.in_file(&source.path));
        let believed = clock_of(ClockChoice::Auto)?;
        let clock = clock_of(data.clock)?;
        let extraction = experiment
            .envelope
            .extract(experiment.envelope.pipeline, &record, &clock)
            .map_err(|error| TrainerError::Envelope { file: data.path.clone(), source: error })?;
        let oracle = oracle::decay_rate(&extraction.envelope)
            .map_err(|error| TrainerError::Oracle { file: data.path.clone(), source: error })?;
        Ok(Self { record, source, clock, believed, extraction, oracle, pipelines: Vec::new() })
    }

    /// Adds the results of the other pipelines and clocks.
    pub(crate) fn with_pipelines(self, experiment: &Experiment) -> Self {
        Self { pipelines: self.all_pipelines(experiment), ..self }
    }

    fn all_pipelines(&self, experiment: &Experiment) -> Vec<PipelineRow> {
        let settings = &experiment.envelope;
        let in_force = (self.extraction.pipeline, self.clock.kind.name());
        let mut rows = vec![row(in_force, Ok(fit(&self.extraction, &self.oracle)))];
        let host = Clock::new(&self.record, ClockChoice::Host).ok();
        for (pipeline, clock) in [
            (Pipeline::Paper, host.as_ref()),
            (Pipeline::Paper, Some(&self.believed)),
            (Pipeline::Recommended, Some(&self.believed)),
        ] {
            let Some(clock) = clock else { continue };
            let names = (pipeline.name(), clock.kind.name());
            if rows.iter().any(|row| (row.pipeline.as_str(), row.clock.as_str()) == names) {
                continue;
            }
            let extraction = settings.extract(pipeline, &self.record, clock);
            let outcome = extraction.map_err(|error| error.to_string()).and_then(|extraction| {
                let oracle = oracle::decay_rate(&extraction.envelope).map_err(|error| error.to_string())?;
                Ok(fit(&extraction, &oracle))
            });
            rows.push(PipelineRow { in_force: false, ..row(names, outcome) });
        }
        rows
    }

    pub(crate) fn data_summary(&self, experiment: &Experiment) -> DataSummary {
        DataSummary::new(
            &self.record,
            &self.source,
            &self.clock,
            &self.believed,
            experiment.data.statements(),
        )
    }

    pub(crate) fn envelope_summary(&self) -> EnvelopeSummary {
        let envelope = &self.extraction.envelope;
        EnvelopeSummary {
            pipeline: self.extraction.pipeline.to_owned(),
            pipeline_because: self.extraction.because.clone(),
            peaks: envelope.len(),
            samples: self.extraction.samples,
            period_s: self.extraction.period_s,
            omega_rad_s: envelope.omega_rad_s(),
            offset: self.extraction.offset,
            first_peak_s: self.extraction.first_peak_s,
        }
    }

    pub(crate) fn oracle_summary(&self) -> OracleSummary {
        let envelope = &self.extraction.envelope;
        OracleSummary {
            decay_rate: self.oracle.decay_rate,
            log_amplitude: self.oracle.log_amplitude,
            r_squared: self.oracle.r_squared,
            zeta: self.oracle.zeta,
            std_error: self.oracle.std_error,
            scatter_factor: self.oracle.scatter_factor,
            interval_95: self.oracle.interval_95,
            zeta_std_error: self.oracle.zeta_std_error,
            zeta_interval_95: self.oracle.interval_95.map(|bound| envelope.damping_ratio(bound)),
            condition: self.oracle.condition,
            promised_digits: self.oracle.promised_digits,
            residual_autocorrelation: self.oracle.residual_autocorrelation,
        }
    }

    /// Scales a method's stated error, which assumes even scatter of ln A, to the scatter of this record.
    pub(crate) fn scaled(&self, stated: Option<Uncertainty>, decay_rate: f64) -> Option<Uncertainty> {
        let factor = self.oracle.scatter_factor;
        stated.map(|known| Uncertainty {
            std_error: factor * known.std_error,
            interval_95: known.interval_95.map(|bound| decay_rate + factor * (bound - decay_rate)),
        })
    }

    /// Returns the rows of `envelope.csv`; `fitted` holds an estimator's function at the peaks.
    pub(crate) fn envelope_rows(&self, fitted: &[f64]) -> Vec<EnvelopeRow> {
        let envelope = &self.extraction.envelope;
        envelope
            .times_s()
            .iter()
            .zip(envelope.log_amplitudes())
            .zip(fitted)
            .map(|((&time_s, &log_amplitude), &estimate)| EnvelopeRow {
                time_s,
                log_amplitude,
                oracle: self.oracle.log_amplitude_at(time_s),
                estimate,
            })
            .collect()
    }
}

/// Builds the row of a pipeline under a clock, marked as in force.
fn row((pipeline, clock): (&str, &str), outcome: Result<PipelineOutcome, String>) -> PipelineRow {
    PipelineRow {
        pipeline: pipeline.to_owned(),
        clock: clock.to_owned(),
        in_force: true,
        outcome: outcome.unwrap_or_else(|reason| PipelineOutcome::Failed { reason }),
    }
}

fn fit(extraction: &Extraction, oracle: &DecayFit) -> PipelineOutcome {
    PipelineOutcome::Fit {
        peaks: extraction.envelope.len(),
        omega_rad_s: extraction.envelope.omega_rad_s(),
        decay_rate: oracle.decay_rate,
        zeta: oracle.zeta,
        zeta_std_error: oracle.zeta_std_error,
        r_squared: oracle.r_squared,
    }
}

/// Converts a record's error; if the file is missing, the error includes the source that the configuration
/// names.
fn absent(error: RecordError, data: &DataSettings) -> TrainerError {
    match &data.source {
        Some(source) if !Path::new(&data.path).exists() => {
            TrainerError::AbsentRecord { error, source_of: source.clone() }
        }
        _ => error.into(),
    }
}
