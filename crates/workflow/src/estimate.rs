//! Input of an estimate, from the record to an envelope and the answer of closed-form least squares, and the parts of an
//! estimate that do not depend on who asks for it.

use crate::look::of_decay;
use crate::modes::modes;
use envelope::{Envelope, EnvelopeError, Extraction};
use estimator::{Estimate, Prediction, Reached, Stop, Uncertainty};
use experiment::{EnvelopeSettings, Pipeline};
use oracle::classical::{self, ClassicalFit};
use oracle::{DecayFit, OracleError};
use record::{Clock, ClockChoice, Record, RecordError, Source, Statements};
use results::{
    DataSummary, EnvelopeRow, EnvelopeSummary, ModeRow, OracleSummary, PipelineOutcome, PipelineRow,
};
use thiserror::Error;

/// Reason why a record gives no estimate. Messages name keys of a configuration.
#[derive(Debug, Error)]
pub enum EstimateError {
    /// The stamps form no clock.
    #[error(transparent)]
    Clock(#[from] RecordError),
    /// The record has no envelope.
    #[error("{file}: {source}")]
    Envelope {
        /// Name of the record.
        file: String,
        /// Fault that was found.
        source: EnvelopeError,
    },
    /// The envelope determines no decay.
    #[error("{file}: {source}")]
    Oracle {
        /// Name of the record.
        file: String,
        /// Fault that was found.
        source: OracleError,
    },
}

/// Record with its clock, its envelope and the oracle's answer.
pub struct Input {
    /// Record, in SI units.
    pub record: Record,
    /// Source of the record, for display only.
    pub source: Source,
    /// Clock in force.
    pub clock: Clock,
    /// Clock that the time stamps and the values support.
    pub believed: Clock,
    /// Envelope with the way from the record to it.
    pub extraction: Extraction,
    /// Closed-form least squares on the envelope.
    pub oracle: DecayFit,
    /// Results of the same record with each pipeline and each clock that makes a difference; the combination
    /// in force comes first. Empty before [`Self::with_pipelines`]. That is called before any fit: for a long
    /// record it takes seconds, for which nobody who stops a fit should have to wait.
    pub pipelines: Vec<PipelineRow>,
    /// Modes of the record, the most powerful first; empty if it shows only one, and before [`Self::with_pipelines`].
    pub modes: Vec<ModeRow>,
}

impl Input {
    /// Extracts the envelope of a record by the settings, under a choice of clock, and fits it by least squares.
    ///
    /// # Errors
    /// [`EstimateError`] for stamps that form no clock, a record without enough peaks, or an envelope that determines no
    /// decay.
    pub fn of(
        record: Record,
        source: Source,
        choice: ClockChoice,
        settings: &EnvelopeSettings,
    ) -> Result<Self, EstimateError> {
        let file = || source.path.clone();
        let clock_of = |choice| Clock::new(&record, choice).map_err(|fault| fault.in_file(&source.path));
        let believed = clock_of(ClockChoice::Auto)?;
        let clock = clock_of(choice)?;
        let extraction = settings
            .extract(settings.pipeline, &record, &clock)
            .map_err(|error| EstimateError::Envelope { file: file(), source: error })?;
        let oracle = oracle::decay_rate(&extraction.envelope)
            .map_err(|error| EstimateError::Oracle { file: file(), source: error })?;
        Ok(Self {
            record,
            source,
            clock,
            believed,
            extraction,
            oracle,
            pipelines: Vec::new(),
            modes: Vec::new(),
        })
    }

    /// Adds the results of the other pipelines and clocks, the modes, and to the findings of the source the remarks of a
    /// first look on what no single oscillator describes.
    #[must_use]
    pub fn with_pipelines(mut self, settings: &EnvelopeSettings) -> Self {
        self.pipelines = self.all_pipelines(settings);
        self.modes = modes(&self.record, &self.clock);
        let remarks = of_decay(&self.record, &self.clock, self.modes.len(), Some(&self.extraction.envelope));
        self.source.findings.extend(remarks);
        self
    }

    fn all_pipelines(&self, settings: &EnvelopeSettings) -> Vec<PipelineRow> {
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

    /// Returns the summary of the data; `stated` is what a configuration states about them.
    #[must_use]
    pub fn data_summary(&self, stated: Statements) -> DataSummary {
        DataSummary::new(&self.record, &self.source, &self.clock, &self.believed, stated)
    }

    /// Returns the summary of the envelope.
    #[must_use]
    pub fn envelope_summary(&self) -> EnvelopeSummary {
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

    /// Returns the summary of the least-squares fit.
    #[must_use]
    pub fn oracle_summary(&self) -> OracleSummary {
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

    /// Returns the rows of `envelope.csv`; `fitted` holds an estimator's function at the peaks.
    #[must_use]
    pub fn envelope_rows(&self, fitted: &[f64]) -> Vec<EnvelopeRow> {
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

/// Converts the line of a classical method into an estimate, with its function at `query_times` (seconds after the first
/// peak).
#[must_use]
pub fn of_line(envelope: &Envelope, fit: ClassicalFit, query_times: &[f64]) -> Estimate {
    let times = envelope.times_s();
    let degrees = times.len() as f64 - 2.0;
    let predictions = fit.predictions(envelope, query_times).into_iter();
    let predictions = predictions.map(|line| Prediction::new(line.log_amplitude, line.std_error)).collect();
    let reached = match fit.reached {
        classical::Reached::Converged => Reached::Converged,
        classical::Reached::BudgetSpent => Reached::BudgetSpent,
        classical::Reached::Stalled => Reached::Stalled,
    };
    Estimate {
        decay_rate: fit.decay_rate,
        log_amplitude: fit.log_amplitude,
        uncertainty: fit
            .std_error
            .and_then(|std_error| Uncertainty::students_t(fit.decay_rate, std_error, degrees)),
        stop: Stop { reached, because: fit.because },
        steps: fit.steps,
        // Intercept and slope.
        parameters: 2,
        fitted_log_amplitudes: times.iter().map(|t| fit.log_amplitude - fit.decay_rate * t).collect(),
        predictions,
        equation: None,
        model: None,
    }
}

/// Scales a method's stated error, which assumes even scatter of ln A, to the scatter of a record, as least squares
/// found it.
#[must_use]
pub fn scaled(least_squares: &DecayFit, stated: Option<Uncertainty>, decay_rate: f64) -> Option<Uncertainty> {
    let factor = least_squares.scatter_factor;
    stated.map(|known| Uncertainty {
        std_error: factor * known.std_error,
        interval_95: known.interval_95.map(|bound| decay_rate + factor * (bound - decay_rate)),
    })
}
