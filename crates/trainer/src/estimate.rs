//! `task = "estimate"`: one estimator, one or more seeds.

use crate::Outcome;
use crate::error::TrainerError;
use crate::fit::{FitSetting, SeedFit, seeds};
use crate::progress::Progress;
use crate::rerender::write_report;
use crate::run::Run;
use crate::summary;
use estimator::Reached;
use experiment::Single;
use rayon::prelude::*;
use runs::result::{EstimateSummary, EstimationResult, RESULT_SCHEMA};
use runs::to_csv;
use serde_json::json;

/// Fits every seed, keeps the first one's fit, reports the worst.
pub(crate) fn estimate(run: &Run<'_>, single: &Single) -> Result<Outcome, TrainerError> {
    let fits = fit_all(run, single)?;
    let Some((first, _)) = fits.split_first() else {
        return Err(TrainerError::TooManySeeds { seed: run.experiment.seed });
    };
    let result = result(run, single, first, &fits);
    keep(run, first, &result)?;
    run.print(&result, || summary::summary(&result, run.folder.path()))?;
    Ok(if fits.iter().any(|fit| fit.estimate.stop.reached == Reached::Interrupted) {
        Outcome::Interrupted
    } else if result.pass {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    })
}

/// Fits every seed, in parallel; the order of the result is that of the seeds. A request to stop leaves
/// out the seeds that were not begun, apart from the first, which the result is about.
fn fit_all(run: &Run<'_>, single: &Single) -> Result<Vec<SeedFit>, TrainerError> {
    let progress = Progress::over_seeds(run.experiment.fit.seeds, run.is_silent());
    let setting = FitSetting {
        input: &run.input,
        max_steps: run.experiment.fit.max_steps,
        progress: &progress,
        cancel: run.cancel,
    };
    let first = run.experiment.seed;
    let seeds = seeds(first, run.experiment.fit.seeds)?;
    let fit_one = |seed: u64| {
        let fit = setting.fit(&single.entry, single.estimator.as_ref(), seed);
        progress.fit_done(single.entry.id, seed, fit.as_ref().map(|fit| &fit.row));
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

fn result(run: &Run<'_>, single: &Single, first: &SeedFit, fits: &[SeedFit]) -> EstimationResult {
    let (experiment, input) = (run.experiment, &run.input);
    let envelope = &input.extraction.envelope;
    let estimate = &first.estimate;
    let uncertainty = estimate.uncertainty;
    let tolerance = experiment.fit.tolerance_percent;
    let worst = scoring::worst(fits.iter().map(|fit| fit.row.error_percent));
    EstimationResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "estimate".to_owned(),
        estimator: single.entry.id.to_owned(),
        estimator_title: single.entry.title.to_owned(),
        seed: first.row.seed,
        data: input.data_summary(experiment),
        envelope: input.envelope_summary(experiment),
        oracle: input.oracle_summary(),
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
        pipelines: input.pipelines(experiment),
    }
}

/// Writes everything that is left to write, the report last.
fn keep(run: &Run<'_>, first: &SeedFit, result: &EstimationResult) -> Result<(), TrainerError> {
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
    folder.record_event("end", &json!({ "reached": result.estimate.reached, "pass": result.pass }))?;
    Ok(())
}
