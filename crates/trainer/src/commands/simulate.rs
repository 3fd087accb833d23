//! `trainer simulate`: records of systems drawn from priors, with their truths sealed separately.

use crate::configured::{check_task, read_config};
use crate::error::TrainerError;
use crate::folders::resume::{Beginning, Begun, begin, end};
use crate::options::ExperimentArguments;
use crate::outcome::Outcome;
use crate::terminal::interrupt::{self, Saving};
use crate::terminal::progress::Progress;

use crate::terminal::table::table;
use estimator::Cancel;
use rayon::prelude::*;
use results::{EffectCount, Manifest, ManifestLine, RECORDS_SCHEMA, RESULT_SCHEMA, SimulationResult};
use runs::RunFolder;
use serde_json::json;
use simulator::{GenerationError, Plan, csv_text, generate, nominal_text};
use std::time::Instant;
use truth::{Sealed, Truth, digest};

/// Subfolders of the run's folder, separate so that the records can be passed on without the truths.
const RECORDS_FOLDER: &str = "records";
const TRUTH_FOLDER: &str = "truth";

/// Reads the configuration and simulates.
pub(crate) fn command(arguments: &ExperimentArguments) -> Result<Outcome, TrainerError> {
    let cancel = interrupt::watch()?;
    let document = read_config(arguments)?;
    check_task(&document, "simulate", "configs/simulate.toml")?;
    simulate(arguments, &Plan::resolve(&document)?, cancel)
}

/// Record that was written.
struct Written {
    line: ManifestLine,
    samples: u64,
    /// Ids of the effects of its system.
    effects: Vec<&'static str>,
    /// `true` if it is the first record of its system.
    first: bool,
}

/// Draws, simulates, writes and prints.
pub(crate) fn simulate(
    arguments: &ExperimentArguments,
    plan: &Plan,
    cancel: &'static Cancel,
) -> Result<Outcome, TrainerError> {
    let start = Instant::now();
    let file = arguments.config.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
    let failure = |system, record| {
        let file = file.clone();
        move |source| TrainerError::Generation { file, system, record, source }
    };
    // A fault of the first record is a fault of most: it is found before the folder is created.
    plan.record(0, 0).map_err(failure(0, 0))?;

    let pool = arguments.thread_pool()?;
    let beginning = Beginning {
        name: &plan.name,
        seed: plan.seed,
        config: plan.resolved.to_toml(),
        data: Vec::new(),
        threads: pool.current_num_threads(),
    };
    // Records that were made before are made again: a seed gives the same records.
    let folder = match begin(arguments, &beginning)? {
        Begun::Open(folder) => folder,
        Begun::Finished(outcome) => return Ok(outcome),
    };
    let count = plan.systems.saturating_mul(plan.records);
    let progress = Progress::over(count as u64, "records", arguments.output.quiet || arguments.output.json);
    let written: Vec<Option<Written>> = pool.install(|| {
        (0..count)
            .into_par_iter()
            .map(|job| {
                if cancel.is_requested() {
                    return Ok(None);
                }
                let (system, record) = (job / plan.records, job % plan.records);
                let written = write(plan, &folder, system, record, failure(system, record))?;
                progress.one_of_many_done();
                Ok(Some(written))
            })
            .collect::<Result<_, TrainerError>>()
    })?;
    progress.finish();
    let _saving = Saving::begin();
    let written: Vec<Written> = written.into_iter().flatten().collect();
    let result = result(plan, count, &written, start.elapsed().as_secs_f64());
    let manifest = Manifest {
        schema: RECORDS_SCHEMA.to_owned(),
        records: written.into_iter().map(|written| written.line).collect(),
    };
    folder.write_json("manifest.json", &manifest)?;
    folder.write_json("result.json", &result)?;
    let details = json!({ "records": result.records, "complete": result.complete });
    end(&folder, !result.complete, arguments.output.quiet, &details)?;
    arguments.output.print(&result, || summary(plan, &result, &folder))?;
    Ok(Outcome::of(!result.complete, true))
}

/// Simulates one record and writes it with its truth and, for the first of a system, the nominal simulator.
fn write(
    plan: &Plan,
    folder: &RunFolder,
    system: usize,
    record: usize,
    failure: impl FnOnce(GenerationError) -> TrainerError,
) -> Result<Written, TrainerError> {
    let made = || {
        let drawn = plan.draw(system)?;
        let truth = drawn.truths.get(record).ok_or(GenerationError::NoSuchRecord { record })?;
        let made = generate(truth)?;
        let text = csv_text(&made, truth.sampling.stamp_decimals, truth.sampling.value_decimals);
        Ok((text, made.len(), Sealed::seal(truth)?, effects(truth), nominal_text(&drawn.nominal)))
    };
    let (text, samples, sealed, effects, nominal) = made().map_err(failure)?;
    // A single system needs no folder of its own.
    let place = if plan.systems == 1 { String::new() } else { format!("system-{system:03}/") };
    let line = ManifestLine {
        record: format!("{RECORDS_FOLDER}/{place}record-{record:03}.csv"),
        record_digest: digest(&text),
        truth: format!("{TRUTH_FOLDER}/{place}record-{record:03}.json"),
        truth_digest: sealed.digest().to_owned(),
    };
    if record == 0 {
        folder.write_reproducible(&format!("{RECORDS_FOLDER}/{place}nominal.toml"), nominal.as_bytes())?;
    }
    folder.write_reproducible(&line.record, text.as_bytes())?;
    folder.write_reproducible(&line.truth, sealed.text_to_store().as_bytes())?;
    Ok(Written { line, samples: samples as u64, effects, first: record == 0 })
}

/// Returns the ids of the effects that generated a record, in the system and in the chain.
fn effects(truth: &Truth) -> Vec<&'static str> {
    truth.system.effects().iter().chain(truth.chain.effects()).map(|active| active.id()).collect()
}

fn result(plan: &Plan, count: usize, written: &[Written], seconds: f64) -> SimulationResult {
    let having = |id: &str| {
        written.iter().filter(|written| written.first && written.effects.contains(&id)).count() as u64
    };
    let digests: String = written
        .iter()
        .flat_map(|written| [&written.line.record_digest, &written.line.truth_digest])
        .fold(String::new(), |all, digest| all + digest + "\n");
    SimulationResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "simulate".to_owned(),
        name: plan.name.clone(),
        seed: plan.seed,
        systems: plan.systems as u64,
        records: written.len() as u64,
        complete: written.len() == count,
        samples: written.iter().map(|written| written.samples).sum(),
        effects: plan
            .effects()
            .map(|effect| EffectCount { id: effect.id().to_owned(), systems: having(effect.id()) })
            .collect(),
        records_folder: RECORDS_FOLDER.to_owned(),
        truth_folder: TRUTH_FOLDER.to_owned(),
        digest: digest(&digests),
        seconds,
    }
}

/// Formats the result for the terminal, on one screen.
fn summary(plan: &Plan, result: &SimulationResult, folder: &RunFolder) -> String {
    let sampling = plan.sampling();
    let noun = |count: u64, one: &str| if count == 1 { one.to_owned() } else { format!("{one}s") };
    let headline = format!(
        "{} simulated {} of {} {}, seed {}, in {:.1} s{}",
        result.records,
        noun(result.records, "record"),
        result.systems,
        noun(result.systems, "system"),
        result.seed,
        result.seconds,
        if result.complete { "" } else { ": INTERRUPTED" },
    );
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![
        row("samples", result.samples.to_string()),
        row(
            "sampling",
            format!("{} at {} Hz, {:.3} s each", sampling.samples, sampling.rate_hz, {
                sampling.samples as f64 / sampling.rate_hz
            }),
        ),
    ];
    for effect in &result.effects {
        rows.push(row(&effect.id, format!("in {} of {}", effect.systems, result.systems)));
    }
    rows.push(row("digest", result.digest.clone()));
    let path = folder.path().display();
    format!(
        "{headline}\n\n{}\n\nrecords: {path}/{}\ntruths, sealed: {path}/{}\nwhich belongs to which: {path}/manifest.json",
        table(&[], rows),
        result.records_folder,
        result.truth_folder
    )
}
