//! `task = "compare"`: many methods, classical and learned, on one envelope.

use crate::Outcome;
use crate::cautions::cautions;
use crate::error::TrainerError;
use crate::fit::{FitSetting, SeedFit, seeds};
use crate::progress::Progress;
use crate::rerender::write_report;
use crate::run::Run;
use crate::summary;
use estimator::{Entry, Estimator, Tag};
use experiment::Comparison;
use oracle::classical::{CLASSICAL, ClassicalRoute};
use rayon::prelude::*;
use registry::ESTIMATORS;
use report::comparison_markdown;
use runs::result::{
    ComparisonResult, Derived, MethodEstimate, MethodOutcome, MethodRow, RESULT_SCHEMA, SeedRow,
};
use runs::to_csv;
use seed::Seed;
use serde_json::json;
use settings::{Document, Resolved, Section};
use std::time::Instant;

/// A method of the comparison.
enum Method {
    Classical(&'static ClassicalRoute),
    Learned(&'static Entry, Box<dyn Estimator>),
}

/// One fit of one method.
struct Fitted {
    row: SeedRow,
    because: String,
    std_error: Option<f64>,
    parameters: usize,
}

/// Fits every method on every seed, keeps going where one fails, and puts the table together.
pub(crate) fn compare(run: &Run<'_>, comparison: &Comparison) -> Result<Outcome, TrainerError> {
    let methods = choose(comparison)?;
    let start = Instant::now();
    let fits = fit_all(run, &methods)?;
    let result = result(run, comparison, &methods, fits, start.elapsed().as_secs_f64());
    keep(run, &result)?;
    run.print(&result, || summary::comparison(&result, run.folder.path()))?;
    Ok(if run.cancel.is_requested() {
        Outcome::Interrupted
    } else if result.pass {
        Outcome::Done
    } else {
        Outcome::CheckFailed
    })
}

/// The methods named, or all that the paper has; in the paper's order.
fn choose(comparison: &Comparison) -> Result<Vec<Method>, TrainerError> {
    let wanted = |id: &str, number: Option<u8>| match &comparison.methods {
        Some(names) => names.iter().any(|name| name == id),
        None => number.is_some(),
    };
    let mut methods = Vec::new();
    for route in CLASSICAL.iter().filter(|route| wanted(route.id, Some(route.paper_number))) {
        methods.push(Method::Classical(route));
    }
    for entry in ESTIMATORS.iter().filter(|entry| wanted(entry.id, entry.paper_number)) {
        let section = [Section { name: "estimator", fields: entry.fields }];
        let defaults = Resolved::new(&Document::default(), &section)?;
        methods.push(Method::Learned(entry, (entry.build)(&defaults)?));
    }
    methods.sort_by_key(|method| method.number().unwrap_or(u8::MAX));
    Ok(methods)
}

impl Method {
    fn number(&self) -> Option<u8> {
        match self {
            Self::Classical(route) => Some(route.paper_number),
            Self::Learned(entry, _) => entry.paper_number,
        }
    }

    fn draws(&self) -> bool {
        match self {
            Self::Classical(route) => route.draws,
            Self::Learned(entry, _) => entry.has(Tag::Seeded),
        }
    }

    fn fit(&self, run: &Run<'_>, setting: &FitSetting<'_>, seed: u64) -> Result<Fitted, String> {
        match self {
            Self::Classical(route) => fit_classical(run, route, seed),
            Self::Learned(entry, estimator) => setting
                .fit(entry, estimator.as_ref(), seed)
                .map(|SeedFit { estimate, row, .. }| Fitted {
                    row,
                    because: estimate.stop.because,
                    std_error: estimate.uncertainty.map(|known| known.std_error),
                    parameters: estimate.parameters,
                })
                .map_err(|error| error.to_string()),
        }
    }
}

fn fit_classical(run: &Run<'_>, route: &ClassicalRoute, seed: u64) -> Result<Fitted, String> {
    let envelope = &run.input.extraction.envelope;
    let start = Instant::now();
    let fit = (route.fit)(envelope, &Seed::new(seed).child(route.id)).map_err(|error| error.to_string())?;
    let seconds = start.elapsed().as_secs_f64();
    let error_percent = scoring::error_percent(fit.decay_rate, run.input.oracle.decay_rate);
    Ok(Fitted {
        row: SeedRow {
            seed,
            decay_rate: fit.decay_rate,
            zeta: envelope.damping_ratio(fit.decay_rate),
            error_percent,
            reached: fit.reached.name().to_owned(),
            steps: fit.steps,
            seconds,
        },
        because: fit.because,
        std_error: fit.std_error,
        // Intercept and slope.
        parameters: 2,
    })
}

/// The fits of every method, in the methods' order and the seeds' order.
fn fit_all(run: &Run<'_>, methods: &[Method]) -> Result<Vec<Vec<Result<Fitted, String>>>, TrainerError> {
    let seeds = seeds(run.experiment.seed, run.experiment.fit.seeds)?;
    let jobs: Vec<(usize, u64)> = methods
        .iter()
        .enumerate()
        .flat_map(|(at, method)| {
            let count = if method.draws() { usize::MAX } else { 1 };
            seeds.clone().take(count).map(move |seed| (at, seed))
        })
        .collect();
    let progress = Progress::over_fits(jobs.len() as u64, run.is_silent());
    let setting = FitSetting {
        input: &run.input,
        max_steps: run.experiment.fit.max_steps,
        progress: &progress,
        cancel: run.cancel,
    };
    let fitted: Vec<(usize, Result<Fitted, String>)> = run.pool.install(|| {
        jobs.into_par_iter()
            .filter_map(|(at, seed)| {
                let method = methods.get(at)?;
                if run.cancel.is_requested() {
                    return Some((at, Err("interrupted before it began".to_owned())));
                }
                let fit = method.fit(run, &setting, seed);
                progress.fit_done(method.id(), seed, fit.as_ref().map(|fit| &fit.row));
                Some((at, fit))
            })
            .collect()
    });
    progress.finish();
    let mut by_method: Vec<Vec<_>> = methods.iter().map(|_| Vec::new()).collect();
    for (at, fit) in fitted {
        if let Some(fits) = by_method.get_mut(at) {
            fits.push(fit);
        }
    }
    Ok(by_method)
}

impl Method {
    fn id(&self) -> &'static str {
        match self {
            Self::Classical(route) => route.id,
            Self::Learned(entry, _) => entry.id,
        }
    }

    fn row(&self, outcome: MethodOutcome) -> MethodRow {
        let (title, family) = match self {
            Self::Classical(route) => (route.title, "classical"),
            Self::Learned(entry, _) => (entry.title, "learned"),
        };
        MethodRow {
            number: self.number(),
            id: self.id().to_owned(),
            title: title.to_owned(),
            family: family.to_owned(),
            outcome,
        }
    }
}

/// One method's seeds as one outcome. A single seed that failed fails the method: leaving it out would
/// flatter.
fn outcome(run: &Run<'_>, fits: Vec<Result<Fitted, String>>) -> MethodOutcome {
    let fits: Vec<Fitted> = match fits.into_iter().collect() {
        Ok(fits) => fits,
        Err(reason) => return MethodOutcome::Failed { reason },
    };
    let Some(first) = fits.first() else {
        return MethodOutcome::Failed { reason: "no seed was fitted".to_owned() };
    };
    let errors = || fits.iter().map(|fit| fit.row.error_percent);
    let worst = scoring::worst(errors());
    let envelope = &run.input.extraction.envelope;
    MethodOutcome::Estimate(MethodEstimate {
        decay_rate: first.row.decay_rate,
        zeta: first.row.zeta,
        zeta_std_error: first.std_error.map(|error| envelope.damping_ratio(error)),
        error_percent: first.row.error_percent,
        median_error_percent: scoring::median(errors()),
        worst_error_percent: worst,
        digits_of_agreement: scoring::digits_of_agreement(worst),
        seeds: fits.len() as u64,
        steps: first.row.steps,
        parameters: first.parameters,
        seconds: scoring::median(fits.iter().map(|fit| fit.row.seconds)),
        reached: first.row.reached.clone(),
        stopped_because: first.because.clone(),
        pass: scoring::passes(worst, run.experiment.fit.tolerance_percent),
    })
}

fn result(
    run: &Run<'_>,
    comparison: &Comparison,
    methods: &[Method],
    fits: Vec<Vec<Result<Fitted, String>>>,
    seconds: f64,
) -> ComparisonResult {
    let (experiment, input) = (run.experiment, &run.input);
    let results: Vec<MethodRow> =
        methods.iter().zip(fits).map(|(method, fits)| method.row(outcome(run, fits))).collect();
    let estimates = || {
        results.iter().filter_map(|row| match &row.outcome {
            MethodOutcome::Estimate(estimate) => Some(estimate),
            MethodOutcome::Failed { .. } => None,
        })
    };
    let max_error_percent = scoring::worst(estimates().map(|row| row.worst_error_percent));
    let pass = estimates().filter(|row| row.pass).count() == results.len();
    let derived = derived(run, comparison.inertia_kg_m2);
    let envelope = input.envelope_summary(experiment);
    let pipelines = input.pipelines(experiment);
    ComparisonResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "compare".to_owned(),
        seed: experiment.seed,
        seeds: experiment.fit.seeds,
        data: input.data_summary(experiment),
        oracle: input.oracle_summary(),
        derived,
        results,
        max_error_percent,
        tolerance_percent: experiment.fit.tolerance_percent,
        pass,
        seconds,
        cautions: cautions(input, &envelope, &derived, max_error_percent, &pipelines),
        envelope,
        pipelines,
    }
}

fn derived(run: &Run<'_>, inertia: f64) -> Derived {
    let oracle = &run.input.oracle;
    let omega = run.input.extraction.envelope.omega_rad_s();
    let period = run.input.extraction.period_s;
    let stiffness = scoring::stiffness(inertia, omega);
    Derived {
        period_s: period,
        frequency_hz: 1.0 / period,
        inertia_kg_m2: inertia,
        stiffness_n_m_per_rad: stiffness,
        damping_n_m_s_per_rad: scoring::damping_coefficient(inertia, oracle.decay_rate),
        critical_damping_n_m_s_per_rad: scoring::critical_damping(inertia, stiffness),
        quality_factor: scoring::quality_factor(oracle.zeta),
        cycles_to_one_over_e: scoring::cycles_to_one_over_e(oracle.zeta),
        half_life_s: scoring::half_life(oracle.decay_rate),
        time_constant_s: scoring::time_constant(oracle.decay_rate),
    }
}

/// Writes everything that is left to write, the report last.
fn keep(run: &Run<'_>, result: &ComparisonResult) -> Result<(), TrainerError> {
    let folder = &run.folder;
    let envelope = &run.input.extraction.envelope;
    let line: Vec<f64> =
        envelope.times_s().iter().map(|&time| run.input.oracle.log_amplitude_at(time)).collect();
    folder.write("envelope.csv", &to_csv("envelope.csv", &run.input.envelope_rows(&line))?)?;
    folder.write_json("result.json", result)?;
    let text = serde_json::to_string(result)
        .map_err(|error| TrainerError::System { what: "the result", problem: error.to_string() })?;
    folder.write("tables.md", comparison_markdown(&text)?.as_bytes())?;
    write_report(folder)?;
    folder.record_event("end", &json!({ "pass": result.pass }))?;
    Ok(())
}
