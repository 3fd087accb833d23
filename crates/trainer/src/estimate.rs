//! Running the experiment of a configuration: the one place that wires the parts together.

use crate::Outcome;
use crate::cli::ExperimentArguments;
use crate::console;
use crate::environment::Environment;
use crate::error::TrainerError;
use crate::interrupt;
use crate::progress::{Progress, Watcher};
use crate::registry::ESTIMATORS;
use crate::rerender::write_report;
use crate::summary;
use envelope::Extraction;
use estimator::{Cancel, Estimate, FitContext, Reached};
use experiment::{Experiment, Pipeline, resolve};
use oracle::DecayFit;
use rayon::prelude::*;
use record::{Clock, ClockChoice, Record, Source, read_file};
use runs::result::{
    DataSummary, EnvelopeRow, EnvelopeSummary, EstimateSummary, EstimationResult, OracleSummary,
    PipelineOutcome, PipelineRow, RESULT_SCHEMA, SeedRow, TraceRow,
};
use runs::{RunFolder, default_root, to_csv};
use seed::Seed;
use serde_json::json;
use settings::Document;
use std::path::Path;
use std::time::Instant;

/// Reads, fits, compares, writes and prints.
pub(crate) fn estimate(arguments: &ExperimentArguments) -> Result<Outcome, TrainerError> {
    let cancel = interrupt::watch()?;
    let experiment = read_config(arguments)?;
    let silent = arguments.output.quiet || arguments.output.json;
    let input = Input::read(&experiment)?;
    let folder = match &arguments.out {
        Some(path) => RunFolder::create_at(path)?,
        None => RunFolder::create(&default_root(), &experiment.name)?,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.map_or(0, usize::from))
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    let threads = pool.current_num_threads();
    folder.write("config.toml", experiment.resolved.to_toml().as_bytes())?;
    folder.write_json("environment.json", &Environment::new(threads, &input.source.digest))?;
    folder.record_event("start", &json!({ "estimator": experiment.entry.id, "seed": experiment.seed }))?;

    let progress = Progress::new(experiment.fit.seeds, silent);
    let fits = pool.install(|| fit_all(&experiment, &input, &progress, cancel))?;
    progress.finish();

    let Some((first, _)) = fits.split_first() else {
        return Err(TrainerError::TooManySeeds { seed: experiment.seed });
    };
    let result = input.result(&experiment, first, &fits);
    keep(&folder, &input, first, &result)?;
    if arguments.output.json {
        let text = serde_json::to_string_pretty(&result)
            .map_err(|error| TrainerError::System { what: "the result", problem: error.to_string() })?;
        console::result(&text);
    } else if !arguments.output.quiet {
        console::result(&summary::summary(&result, folder.path()));
    }
    Ok(if fits.iter().any(|fit| fit.estimate.stop.reached == Reached::Interrupted) {
        Outcome::Interrupted
    } else if result.pass {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    })
}

fn read_config(arguments: &ExperimentArguments) -> Result<Experiment, TrainerError> {
    let path = arguments.config.as_ref().ok_or(TrainerError::NoConfig)?;
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| TrainerError::Config {
        file: file.clone(),
        problem: if path.is_dir() { "it is a folder".to_owned() } else { error.to_string() },
    })?;
    let mut document = Document::parse(&file, &text)?;
    for argument in &arguments.overrides {
        document.apply_override(argument)?;
    }
    if let Some(seed) = arguments.seed {
        document.apply_override(&format!("seed={seed}"))?;
    }
    Ok(resolve(&document, ESTIMATORS)?)
}

/// The record, its clock and its envelope, with the oracle's answer.
struct Input {
    record: Record,
    source: Source,
    clock: Clock,
    /// The clock that the stamps and the values speak for.
    believed: Clock,
    extraction: Extraction,
    oracle: DecayFit,
}

impl Input {
    fn read(experiment: &Experiment) -> Result<Self, TrainerError> {
        let data = &experiment.data;
        let (record, source) = read_file(Path::new(&data.path), &data.read_options())?;
        let clock_of = |choice| Clock::new(&record, choice).map_err(|fault| fault.in_file(&source.path));
        let believed = clock_of(ClockChoice::Auto)?;
        let clock = clock_of(data.clock)?;
        let extraction = experiment
            .envelope
            .extract(experiment.envelope.pipeline, &record, &clock)
            .map_err(|error| TrainerError::Envelope { file: data.path.clone(), source: error })?;
        let oracle = oracle::decay_rate(&extraction.envelope)
            .map_err(|error| TrainerError::Oracle { file: data.path.clone(), source: error })?;
        Ok(Self { record, source, clock, believed, extraction, oracle })
    }

    fn data_summary(&self, experiment: &Experiment) -> DataSummary {
        let statements = experiment.data.statements().or(&self.source.statements);
        let mut findings = self.source.findings.clone();
        findings.extend(statements.contradictions(self.record.len(), &self.clock));
        DataSummary {
            path: self.source.path.clone(),
            digest: self.source.digest.clone(),
            origin: statements.origin.unwrap_or_default().name().to_owned(),
            samples: self.record.len(),
            clock: self.clock.kind.name().to_owned(),
            clock_reason: self.clock.reason.clone(),
            believed_clock: self.believed.kind.name().to_owned(),
            believed_clock_reason: self.believed.reason.clone(),
            sample_period_s: 1.0 / self.clock.sample_rate_hz,
            sample_rate_hz: self.clock.sample_rate_hz,
            sample_rate_std_error_hz: self.clock.sample_rate_std_error_hz,
            resolution: self.record.lattice().map(|lattice| lattice.step),
            unit: self.record.unit().to_owned(),
            findings,
        }
    }

    /// The same record through each pipeline and each clock that makes a difference.
    fn pipelines(&self, experiment: &Experiment) -> Vec<PipelineRow> {
        let settings = &experiment.envelope;
        let mut rows: Vec<PipelineRow> = Vec::new();
        for (pipeline, choice) in [
            (settings.pipeline, experiment.data.clock),
            (Pipeline::Paper, ClockChoice::Host),
            (Pipeline::Paper, ClockChoice::Auto),
            (Pipeline::Recommended, ClockChoice::Auto),
        ] {
            let Ok(clock) = Clock::new(&self.record, choice) else { continue };
            let (name, clock_name) = (pipeline.name(), clock.kind.name());
            if rows.iter().any(|row| row.pipeline == name && row.clock == clock_name) {
                continue;
            }
            let outcome = settings
                .extract(pipeline, &self.record, &clock)
                .map_err(|error| error.to_string())
                .and_then(|extraction| {
                    let fit = oracle::decay_rate(&extraction.envelope);
                    Ok((extraction, fit.map_err(|error| error.to_string())?))
                });
            rows.push(PipelineRow {
                pipeline: name.to_owned(),
                clock: clock_name.to_owned(),
                in_force: rows.is_empty(),
                outcome: match outcome {
                    Ok((extraction, fit)) => PipelineOutcome::Fit {
                        peaks: extraction.envelope.len(),
                        omega_rad_s: extraction.envelope.omega_rad_s(),
                        decay_rate: fit.decay_rate,
                        zeta: fit.zeta,
                        zeta_std_error: fit.zeta_std_error,
                        r_squared: fit.r_squared,
                    },
                    Err(reason) => PipelineOutcome::Failed { reason },
                },
            });
        }
        rows
    }

    fn result(&self, experiment: &Experiment, first: &SeedFit, fits: &[SeedFit]) -> EstimationResult {
        let envelope = &self.extraction.envelope;
        let estimate = &first.estimate;
        let uncertainty = estimate.uncertainty;
        let tolerance = experiment.fit.tolerance_percent;
        let worst = scoring::worst(fits.iter().map(|fit| fit.row.error_percent));
        EstimationResult {
            schema: RESULT_SCHEMA.to_owned(),
            task: "estimate".to_owned(),
            estimator: experiment.entry.id.to_owned(),
            estimator_title: experiment.entry.title.to_owned(),
            seed: first.row.seed,
            data: self.data_summary(experiment),
            envelope: EnvelopeSummary {
                pipeline: experiment.envelope.pipeline.name().to_owned(),
                peaks: envelope.len(),
                samples: self.extraction.samples,
                period_s: self.extraction.period_s,
                omega_rad_s: envelope.omega_rad_s(),
                offset: self.extraction.offset,
                first_peak_s: self.extraction.first_peak_s,
            },
            oracle: OracleSummary {
                decay_rate: self.oracle.decay_rate,
                log_amplitude: self.oracle.log_amplitude,
                r_squared: self.oracle.r_squared,
                zeta: self.oracle.zeta,
                std_error: self.oracle.std_error,
                interval_95: self.oracle.interval_95,
                zeta_std_error: self.oracle.zeta_std_error,
                zeta_interval_95: self.oracle.interval_95.map(|bound| envelope.damping_ratio(bound)),
                condition: self.oracle.condition,
                promised_digits: self.oracle.promised_digits,
                residual_autocorrelation: self.oracle.residual_autocorrelation,
            },
            estimate: EstimateSummary {
                decay_rate: estimate.decay_rate,
                log_amplitude: estimate.log_amplitude,
                zeta: envelope.damping_ratio(estimate.decay_rate),
                std_error: uncertainty.map(|known| known.std_error),
                interval_95: uncertainty.map(|known| known.interval_95),
                zeta_std_error: uncertainty.map(|known| envelope.damping_ratio(known.std_error)),
                zeta_interval_95: uncertainty
                    .map(|known| known.interval_95.map(|bound| envelope.damping_ratio(bound))),
                reached: estimate.stop.reached.name().to_owned(),
                stopped_because: estimate.stop.because.clone(),
            },
            error_percent: first.row.error_percent,
            tolerance_percent: tolerance,
            pass: scoring::passes(worst, tolerance),
            seconds: first.row.seconds,
            steps: estimate.steps,
            parameters: estimate.parameters,
            seeds: fits.iter().map(|fit| fit.row.clone()).collect(),
            worst_error_percent: worst,
            pipelines: self.pipelines(experiment),
        }
    }
}

/// One seed's fit.
struct SeedFit {
    estimate: Estimate,
    trace: Vec<TraceRow>,
    row: SeedRow,
}

/// Fits every seed, in parallel; the order of the result is that of the seeds. A request to stop leaves
/// out the seeds that were not begun, apart from the first, which the result is about.
fn fit_all(
    experiment: &Experiment,
    input: &Input,
    progress: &Progress,
    cancel: &Cancel,
) -> Result<Vec<SeedFit>, TrainerError> {
    let first = experiment.seed;
    let end = first.checked_add(experiment.fit.seeds).ok_or(TrainerError::TooManySeeds { seed: first })?;
    (first..end)
        .into_par_iter()
        .filter(|&seed| seed == first || !cancel.is_requested())
        .map(|seed| fit_one(experiment, input, progress, cancel, seed))
        .collect()
}

fn fit_one(
    experiment: &Experiment,
    input: &Input,
    progress: &Progress,
    cancel: &Cancel,
    seed: u64,
) -> Result<SeedFit, TrainerError> {
    let estimator = experiment.entry.id;
    let envelope = &input.extraction.envelope;
    let watcher = Watcher::new(progress);
    let context =
        FitContext::new(Seed::new(seed).child(estimator), experiment.fit.max_steps, &watcher, cancel);
    let start = Instant::now();
    let estimate = experiment.estimator.fit(envelope, &context).map_err(|source| TrainerError::Fit {
        estimator,
        seed,
        source,
    })?;
    let seconds = start.elapsed().as_secs_f64();
    if !(estimate.decay_rate.is_finite() && estimate.log_amplitude.is_finite()) {
        return Err(TrainerError::NotFinite { estimator, seed });
    }
    let row = SeedRow {
        seed,
        decay_rate: estimate.decay_rate,
        zeta: envelope.damping_ratio(estimate.decay_rate),
        error_percent: scoring::error_percent(estimate.decay_rate, input.oracle.decay_rate),
        reached: estimate.stop.reached.name().to_owned(),
        steps: estimate.steps,
        seconds,
    };
    progress.seed_done(&row);
    Ok(SeedFit { estimate, trace: watcher.into_trace(), row })
}

/// Writes everything that is left to write, the report last.
fn keep(
    folder: &RunFolder,
    input: &Input,
    first: &SeedFit,
    result: &EstimationResult,
) -> Result<(), TrainerError> {
    let envelope = &input.extraction.envelope;
    let rows: Vec<EnvelopeRow> = envelope
        .times_s()
        .iter()
        .zip(envelope.log_amplitudes())
        .zip(&first.estimate.fitted_log_amplitudes)
        .map(|((&time_s, &log_amplitude), &estimate)| EnvelopeRow {
            time_s,
            log_amplitude,
            oracle: input.oracle.log_amplitude_at(time_s),
            estimate,
        })
        .collect();
    folder.write("envelope.csv", &to_csv("envelope.csv", &rows)?)?;
    if !first.trace.is_empty() {
        folder.write("trace.csv", &to_csv("trace.csv", &first.trace)?)?;
    }
    if let Some(model) = &first.estimate.model {
        folder.write(&format!("model/{}", model.name), &model.bytes)?;
    }
    folder.write_json("result.json", result)?;
    write_report(folder)?;
    folder.record_event("end", &json!({ "reached": result.estimate.reached, "pass": result.pass }))?;
    Ok(())
}
