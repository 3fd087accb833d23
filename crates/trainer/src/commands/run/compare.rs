//! `task = "compare"`: many methods, classical and learned, on one envelope.

use super::ready::Run;
use super::summary;
use crate::error::TrainerError;
use crate::fits::ablations::{ablations, linfa};
use crate::fits::agreement::disagreement;
use crate::fits::cautions::cautions;
use crate::fits::fit::{FitSetting, SeedFit, seeds};
use crate::fits::known_truth::{self, Answer};
use crate::fits::method::{Method, Request};
use crate::folders::page::write_report;
use crate::folders::resume::end;
use crate::outcome::Outcome;
use crate::terminal::interrupt::Saving;
use crate::terminal::progress::Progress;
use experiment::{Claims, Comparison};
use rayon::prelude::*;
use report::{comparison_latex, comparison_markdown};
use results::{
    AblationRow, ComparisonResult, Derived, Failure, MethodEstimate, MethodOutcome, MethodRow, RESULT_SCHEMA,
    Reached, SeedRow,
};
use runs::to_csv;
use serde_json::json;
use std::time::Instant;
use workflow::estimate::scaled;

/// Index of a method, and its fit or the reason why there is none.
type Fitted = (usize, Result<SeedFit, Failure>);

/// Fits every method on every seed, continues if one fails, and builds the table.
pub(crate) fn compare(run: &Run<'_>, comparison: &Comparison) -> Result<Outcome, TrainerError> {
    let methods = choose(comparison)?;
    let start = Instant::now();
    let fits = fit_all(run, &methods)?;
    let ablated = ablate_all(run, &methods);
    let _saving = Saving::begin();
    let interrupted = run.cancel.is_requested() && fits.iter().flatten().any(is_interrupted);
    let outcomes = methods.iter().zip(fits).zip(ablated);
    let outcomes = outcomes.map(|((method, fits), ablated)| {
        let outcome = outcome(run, method, fits, ablated);
        let excused = methods.len() > 1 && is_excused(run, comparison, method, &outcome);
        row(method, excused, outcome)
    });
    let mut result = result(run, comparison, outcomes.collect(), start.elapsed().as_secs_f64());
    let answer = Answer { zeta: result.oracle.zeta, zeta_std_error: Some(result.oracle.zeta_std_error) };
    result.truth = known_truth::compare(&run.input, &answer)?;
    keep(run, &result, interrupted)?;
    run.print(&result, || summary::comparison(&result, run.folder.path()))?;
    Ok(Outcome::of(interrupted, result.pass))
}

/// Returns `true` if a fit was stopped before its end or not begun.
fn is_interrupted(fit: &Result<SeedFit, Failure>) -> bool {
    fit.as_ref().map_or_else(|failure| *failure == Failure::NotBegun, SeedFit::is_interrupted)
}

/// Returns the named methods, or all methods of the paper, in the paper's order.
fn choose(comparison: &Comparison) -> Result<Vec<Method>, TrainerError> {
    let mut methods = Method::all()?;
    methods.retain(|method| match &comparison.methods {
        Some(names) => names.iter().any(|name| name == method.id()),
        None => method.number().is_some(),
    });
    Ok(methods)
}

/// Fits every method on every seed; returns the fits in the order of the methods and the seeds.
fn fit_all(run: &Run<'_>, methods: &[Method]) -> Result<Vec<Vec<Result<SeedFit, Failure>>>, TrainerError> {
    let seeds = seeds(run.experiment.seed, run.experiment.fit.seeds)?;
    let jobs: Vec<(usize, u64)> = methods
        .iter()
        .enumerate()
        .flat_map(|(at, method)| {
            let count = if method.draws() { usize::MAX } else { 1 };
            seeds.clone().take(count).map(move |seed| (at, seed))
        })
        .collect();
    let progress = Progress::over(jobs.len() as u64, "fits", run.is_silent());
    let setting = FitSetting {
        envelope: &run.input.extraction.envelope,
        request: Request { query_times: &[], max_steps: run.experiment.fit.max_steps, cancel: run.cancel },
        progress: &progress,
        ledger: Some(&run.ledger),
        pause: None,
    };
    let fit_one = |method: &Method, seed: u64| {
        if run.cancel.is_requested() {
            return Ok(Err(Failure::NotBegun));
        }
        let fit = match setting.fit(method, seed) {
            // A failing disk is not a fault of the method.
            Err(error @ (TrainerError::Run(_) | TrainerError::Resume(_))) => return Err(error),
            other => other.map_err(|error| Failure::of(&error)),
        };
        progress.fit_done(method.id(), seed, fit.as_ref().map(|fit| run.row(fit)).as_ref());
        Ok(fit)
    };
    let fitted: Result<Vec<Fitted>, TrainerError> = run.pool.install(|| {
        jobs.into_par_iter()
            .filter_map(|(at, seed)| Some(fit_one(methods.get(at)?, seed).map(|fit| (at, fit))))
            .collect()
    });
    progress.finish();
    let mut by_method: Vec<Vec<_>> = methods.iter().map(|_| Vec::new()).collect();
    for (at, fit) in fitted? {
        if let Some(fits) = by_method.get_mut(at) {
            fits.push(fit);
        }
    }
    Ok(by_method)
}

/// Fits every method without its learned part on the first seed, in the methods' order.
fn ablate_all(run: &Run<'_>, methods: &[Method]) -> Vec<Vec<AblationRow>> {
    let request = Request { query_times: &[], max_steps: run.experiment.fit.max_steps, cancel: run.cancel };
    let envelope = &run.input.extraction.envelope;
    let (seed, oracle) = (run.experiment.seed, run.input.oracle.decay_rate);
    run.pool.install(|| {
        methods.par_iter().map(|method| ablations(method, envelope, seed, &request, oracle)).collect()
    })
}

/// Returns `true` if a method's miss says nothing about the fits: the weak baseline has used up its own fixed
/// steps. It counts where the paper's statements about its methods are checked, and if the configuration cut the
/// steps.
fn is_excused(run: &Run<'_>, comparison: &Comparison, method: &Method, outcome: &MethodOutcome) -> bool {
    method.has_fixed_steps()
        && comparison.claims == Claims::None
        && run.experiment.fit.max_steps.is_none()
        && outcome.estimate().is_some_and(|found| !found.pass && found.reached == Reached::BudgetSpent)
}

fn row(method: &Method, excused: bool, outcome: MethodOutcome) -> MethodRow {
    MethodRow {
        number: method.number(),
        id: method.id().to_owned(),
        title: method.title().to_owned(),
        family: method.family(),
        estimand: method.estimand(),
        excused,
        outcome,
    }
}

/// Combines the fits of one method's seeds into one outcome. A single failed seed fails the method, since
/// leaving it out would flatter the method.
fn outcome(
    run: &Run<'_>,
    method: &Method,
    fits: Vec<Result<SeedFit, Failure>>,
    ablations: Vec<AblationRow>,
) -> MethodOutcome {
    let fits: Vec<SeedFit> = match fits.into_iter().collect() {
        Ok(fits) => fits,
        Err(reason) => return MethodOutcome::Failed { reason },
    };
    let rows: Vec<SeedRow> = fits.iter().map(|fit| run.row(fit)).collect();
    let (Some(first), Some(row)) = (fits.first(), rows.first()) else {
        return MethodOutcome::Failed { reason: "no seed was fitted".into() };
    };
    let errors = || rows.iter().map(|row| row.error_percent);
    let worst = scoring::worst(errors());
    let envelope = &run.input.extraction.envelope;
    let stated = scaled(&run.input.oracle, first.estimate.uncertainty, row.decay_rate);
    MethodOutcome::Estimate(MethodEstimate {
        decay_rate: row.decay_rate,
        zeta: row.zeta,
        zeta_std_error: stated.map(|known| envelope.damping_ratio_error(row.decay_rate, known.std_error)),
        error_percent: row.error_percent,
        median_error_percent: scoring::median(errors()),
        worst_error_percent: worst,
        digits_of_agreement: scoring::digits_of_agreement(worst),
        seeds: fits.len() as u64,
        steps: row.steps,
        parameters: first.estimate.parameters,
        seconds: scoring::median(rows.iter().map(|row| row.seconds)),
        reached: row.reached,
        stopped_because: first.estimate.stop.because.clone(),
        pass: method.passes(worst, run.experiment.fit.tolerance_percent),
        ablations,
    })
}

fn result(run: &Run<'_>, comparison: &Comparison, results: Vec<MethodRow>, seconds: f64) -> ComparisonResult {
    let (experiment, input) = (run.experiment, &run.input);
    let libraries =
        vec![linfa(&input.extraction.envelope, input.oracle.decay_rate, experiment.fit.tolerance_percent)];
    // For a method that estimates another quantity, the distance from least squares is not an error.
    let held = results.iter().filter(|row| row.is_held_to_least_squares());
    let max_error_percent =
        scoring::worst(held.filter_map(|row| row.outcome.estimate()).map(|own| own.worst_error_percent));
    let pass = results.iter().chain(&libraries).all(|row| row.excused || row.outcome.passes());
    let derived = derived(run, comparison.inertia_kg_m2);
    let cautions = match comparison.claims {
        Claims::None => Vec::new(),
        Claims::Paper => {
            cautions(input, &input.envelope_summary(), &derived, max_error_percent, &input.pipelines)
        }
    };
    let envelope = input.envelope_summary();
    let pipelines = input.pipelines.clone();
    ComparisonResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "compare".to_owned(),
        seed: experiment.seed,
        seeds: experiment.fit.seeds,
        data: input.data_summary(experiment.data.statements()),
        oracle: input.oracle_summary(),
        derived,
        results,
        libraries,
        max_error_percent,
        tolerance_percent: experiment.fit.tolerance_percent,
        pass,
        seconds,
        cautions,
        disagreement: disagreement(&pipelines, &input.data_summary(experiment.data.statements())),
        truth: None,
        envelope,
        modes: input.modes.clone(),
        pipelines,
    }
}

fn derived(run: &Run<'_>, stated: Option<f64>) -> Derived {
    let inertia = stated.unwrap_or(1.0);
    let oracle = &run.input.oracle;
    let omega = run.input.extraction.envelope.omega_rad_s();
    let period = run.input.extraction.period_s;
    // Whichever definition of ζ is used, λ/ζ is the frequency that belongs to the stiffness.
    let natural = if oracle.zeta == 0.0 { omega } else { oracle.decay_rate / oracle.zeta };
    let stiffness = scoring::stiffness(inertia, natural);
    Derived {
        period_s: period,
        frequency_hz: 1.0 / period,
        inertia_kg_m2: inertia,
        per_unit_of_inertia: stated.is_none(),
        stiffness_n_m_per_rad: stiffness,
        damping_n_m_s_per_rad: scoring::damping_coefficient(inertia, oracle.decay_rate),
        critical_damping_n_m_s_per_rad: scoring::critical_damping(inertia, stiffness),
        quality_factor: scoring::quality_factor(oracle.zeta),
        cycles_to_one_over_e: scoring::cycles_to_one_over_e(oracle.decay_rate / omega),
        half_life_s: scoring::half_life(oracle.decay_rate),
        time_constant_s: scoring::time_constant(oracle.decay_rate),
    }
}

/// Writes the tables and results that are not written yet, with the report last.
fn keep(run: &Run<'_>, result: &ComparisonResult, interrupted: bool) -> Result<(), TrainerError> {
    if interrupted {
        run.ledger.flush()?;
    }
    let folder = &run.folder;
    let envelope = &run.input.extraction.envelope;
    let line: Vec<f64> =
        envelope.times_s().iter().map(|&time| run.input.oracle.log_amplitude_at(time)).collect();
    folder.write("envelope.csv", &to_csv("envelope.csv", &run.input.envelope_rows(&line))?)?;
    folder.write_json("result.json", result)?;
    let text = serde_json::to_string(result)
        .map_err(|error| TrainerError::System { what: "the result", problem: error.to_string() })?;
    folder.write("tables.md", comparison_markdown(&text)?.as_bytes())?;
    folder.write("table.tex", comparison_latex(&text)?.as_bytes())?;
    write_report(folder)?;
    end(folder, interrupted, run.output.quiet, &json!({ "pass": result.pass }))
}
