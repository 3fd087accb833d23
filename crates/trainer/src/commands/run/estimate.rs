//! `task = "estimate"`: one method, one or more seeds.

use super::ready::Run;
use super::summary;
use crate::error::TrainerError;
use crate::fits::agreement::disagreement;
use crate::fits::fit::{FitSetting, SeedFit, seeds};
use crate::fits::known_truth::{self, Answer};
use crate::fits::method::{Method, Request};
use crate::folders::page::write_report;
use crate::folders::resume::end;
use crate::outcome::Outcome;
use crate::terminal::interrupt::Saving;
use crate::terminal::progress::Progress;
use rayon::prelude::*;
use results::{EstimateSummary, EstimationResult, RESULT_SCHEMA, Resonance, SeedRow, WithInterval};
use runs::to_csv;
use serde_json::json;
use workflow::estimate::scaled;

/// Fits every seed, stores the fit of the first, and reports the worst error.
pub(crate) fn estimate(run: &Run<'_>, method: &Method) -> Result<Outcome, TrainerError> {
    let fits = fit_all(run, method)?;
    let _saving = Saving::begin();
    let Some((first, _)) = fits.split_first() else {
        return Err(TrainerError::TooManySeeds { seed: run.experiment.seed });
    };
    let mut result = result(run, method, first, &fits);
    let answer = Answer {
        zeta: result.estimate.zeta,
        zeta_std_error: result.estimate.zeta_std_error.or(Some(result.oracle.zeta_std_error)),
    };
    result.truth = known_truth::compare(&run.input, &answer)?;
    // Seeds that were not begun are missing.
    let interrupted =
        (fits.len() as u64) < run.experiment.fit.seeds || fits.iter().any(SeedFit::is_interrupted);
    keep(run, first, &result, interrupted)?;
    run.print(&result, || summary::summary(&result, run.folder.path()))?;
    Ok(Outcome::of(interrupted, result.pass))
}

/// Fits every seed in parallel; the results are in the order of the seeds. A request to stop skips the seeds
/// that were not begun, except for the first, which the result describes.
fn fit_all(run: &Run<'_>, method: &Method) -> Result<Vec<SeedFit>, TrainerError> {
    let progress = Progress::over_seeds(run.experiment.fit.seeds, run.is_silent());
    let setting = FitSetting {
        envelope: &run.input.extraction.envelope,
        request: Request { query_times: &[], max_steps: run.experiment.fit.max_steps, cancel: run.cancel },
        progress: &progress,
        ledger: Some(&run.ledger),
        pause: run.pause_after.map(|after| (after, run.cancel)),
    };
    let first = run.experiment.seed;
    let seeds = seeds(first, run.experiment.fit.seeds)?;
    let fit_one = |seed: u64| {
        let fit = setting.fit(method, seed);
        progress.fit_done(method.id(), seed, fit.as_ref().map(|fit| run.row(fit)).as_ref());
        fit
    };
    let fits = run.pool.install(|| {
        seeds
            .into_par_iter()
            .filter(|&seed| seed == first || !run.cancel.is_requested())
            .map(fit_one)
            .collect()
    });
    progress.finish();
    fits
}

fn result(run: &Run<'_>, method: &Method, first: &SeedFit, fits: &[SeedFit]) -> EstimationResult {
    let (experiment, input) = (run.experiment, &run.input);
    let envelope = &input.extraction.envelope;
    let estimate = &first.estimate;
    let uncertainty = scaled(&input.oracle, estimate.uncertainty, estimate.decay_rate);
    let tolerance = experiment.fit.tolerance_percent;
    let rows: Vec<SeedRow> = fits.iter().map(|fit| run.row(fit)).collect();
    let zeta = envelope.damping_ratio(estimate.decay_rate);
    let zeta_interval_95 =
        uncertainty.map(|known| known.interval_95.map(|bound| envelope.damping_ratio(bound)));
    let with_interval = WithInterval { value: zeta, interval_95: zeta_interval_95.unwrap_or([f64::NAN; 2]) };
    let worst = scoring::worst(rows.iter().map(|row| row.error_percent));
    EstimationResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "estimate".to_owned(),
        estimator: method.id().to_owned(),
        estimator_title: method.title().to_owned(),
        seed: first.seed,
        data: input.data_summary(experiment.data.statements()),
        envelope: input.envelope_summary(),
        oracle: input.oracle_summary(),
        estimate: EstimateSummary {
            decay_rate: estimate.decay_rate,
            log_amplitude: estimate.log_amplitude,
            zeta,
            std_error: uncertainty.map(|known| known.std_error),
            interval_95: uncertainty.map(|known| known.interval_95),
            zeta_std_error: uncertainty
                .map(|known| envelope.damping_ratio_error(estimate.decay_rate, known.std_error)),
            zeta_interval_95,
            resonance: Resonance::of_swing(envelope.omega_rad_s(), with_interval),
            reached: estimate.stop.reached,
            stopped_because: estimate.stop.because.clone(),
        },
        error_percent: run.row(first).error_percent,
        tolerance_percent: tolerance,
        pass: method.passes(worst, tolerance),
        seconds: first.seconds,
        steps: estimate.steps,
        parameters: estimate.parameters,
        seeds: rows,
        worst_error_percent: worst,
        disagreement: disagreement(&input.pipelines, &input.data_summary(experiment.data.statements())),
        truth: None,
        modes: input.modes.clone(),
        pipelines: input.pipelines.clone(),
    }
}

/// Writes the tables and results that are not written yet, with the report last.
fn keep(
    run: &Run<'_>,
    first: &SeedFit,
    result: &EstimationResult,
    interrupted: bool,
) -> Result<(), TrainerError> {
    if interrupted {
        run.ledger.flush()?;
    }
    let folder = &run.folder;
    let rows = run.input.envelope_rows(&first.estimate.fitted_log_amplitudes);
    folder.write("envelope.csv", &to_csv("envelope.csv", &rows)?)?;
    if !first.trace.is_empty() {
        folder.write("trace.csv", &to_csv("trace.csv", &first.trace)?)?;
    }
    if let Some(model) = &first.estimate.model {
        folder.write(&format!("model/{}", model.name), &model.bytes)?;
    }
    folder.write_json("result.json", result)?;
    write_report(folder)?;
    let details = json!({ "reached": result.estimate.reached, "pass": result.pass });
    end(folder, interrupted, run.output.quiet, &details)
}
