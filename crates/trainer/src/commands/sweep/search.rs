//! Search among runs: batches of proposals, and rungs of successive halving.
//!
//! Li, Jamieson, DeSalvo, Rostamizadeh, Talwalkar, Hyperband, Journal of Machine Learning Research 18 (2018)
//! 6765: of n trials on a rung, the best ⌊n/η⌋ continue on the next rung, which is η times as long. The last
//! rung has no limit.

use super::execute::{Making, execute};
use super::frozen::{FrozenSweep, Job, is_missing, line};
use super::measure::value_of;
use super::study::proposed;
use crate::error::{SweepCommandError, TrainerError};
use crate::terminal::console;
use record::counted;
use results::{SweepEnd, SweepLine, SweepManifest, SweepRung, SweepRungValue, SweepSearch, SweepState};
use runs::SweepFolder;

/// Name under which a searching process claims the sweep.
const HELD: &str = "search";

/// Makes the runs of a search that depends on results until it is done or a stop is requested; returns the
/// number of runs made.
pub(super) fn search(
    sweep: &mut FrozenSweep,
    search: &SweepSearch,
    failed_too: bool,
    making: &Making,
) -> Result<usize, TrainerError> {
    let folder = sweep.folder.clone();
    let Some(_held) = folder.claim(HELD)? else {
        return Err(SweepCommandError::Searching { folder: folder.path().display().to_string() }.into());
    };
    match &search.halving {
        Some(_) => halved(sweep, failed_too, making),
        None => batches(sweep, search, failed_too, making),
    }
}

/// Makes runs in batches of proposals. Each batch depends only on the results of all earlier ones, not on the
/// processes that made them or on the number of parallel runs.
fn batches(
    sweep: &mut FrozenSweep,
    search: &SweepSearch,
    failed_too: bool,
    making: &Making,
) -> Result<usize, TrainerError> {
    let mut made = 0;
    loop {
        let jobs: Vec<Job<'_>> =
            sweep.jobs().filter(|(line, _)| is_missing(line, failed_too && made == 0)).collect();
        made += jobs.len();
        execute(sweep, &jobs, making)?;
        sweep.folder.refresh(&mut sweep.manifest)?;
        let is_open = |line: &SweepLine| is_missing(line, false);
        let count = sweep.manifest.runs.len();
        if count >= search.trials || sweep.manifest.runs.iter().any(is_open) {
            return Ok(made);
        }
        let runs = proposed(&sweep.manifest, search, &costs(&sweep.folder, &sweep.manifest, search)?)?;
        let configs: Vec<String> = runs.iter().map(|run| run.config.clone()).collect();
        sweep.folder.extend(&mut sweep.manifest, runs.iter().map(line).collect(), &configs)?;
        sweep.configs.extend(configs);
        if !making.is_silent() {
            let all = sweep.manifest.runs.len();
            console::remark(&format!("trials {} to {all} of {} proposed", count + 1, search.trials));
        }
    }
}

/// Returns the cost of each run: the measure, with its sign reversed if it is maximized.
fn costs(
    folder: &SweepFolder,
    manifest: &SweepManifest,
    search: &SweepSearch,
) -> Result<Vec<Option<f64>>, TrainerError> {
    manifest
        .runs
        .iter()
        .map(|line| Ok(value_of(folder, search, line)?.map(|own| cost(search, own))))
        .collect()
}

fn cost(search: &SweepSearch, value: f64) -> f64 {
    if search.maximize { -value } else { value }
}

/// Makes the rungs of successive halving. The manifest records the measures of all trials once a rung is
/// done, so that a resumed search promotes the same trials.
fn halved(sweep: &mut FrozenSweep, failed_too: bool, making: &Making) -> Result<usize, TrainerError> {
    let mut made = 0;
    while let Some(rung) = Rung::next(&sweep.manifest) {
        let jobs: Vec<Job<'_>> = sweep
            .jobs()
            .filter(|(line, _)| rung.numbers.contains(&line.number) && is_missing(line, failed_too))
            .collect();
        made += jobs.len();
        if !making.is_silent() {
            let steps = |steps: u64| counted(usize::try_from(steps).unwrap_or(usize::MAX), "step");
            let length = rung.steps.map_or_else(|| "to the end".to_owned(), steps);
            let trials = counted(rung.numbers.len(), "trial");
            console::remark(&format!("rung {}: {trials}, {length}", rung.place + 1));
        }
        execute(sweep, &jobs, &Making { pause_after: rung.steps, ..*making })?;
        sweep.folder.refresh(&mut sweep.manifest)?;
        if making.cancel.is_requested() {
            return Ok(made);
        }
        close(sweep, &rung)?;
    }
    Ok(made)
}

/// Records the measures of the trials on a rung, and stops the trials that do not continue.
fn close(sweep: &mut FrozenSweep, rung: &Rung) -> Result<(), TrainerError> {
    let Some(search) = sweep.manifest.search.clone() else { return Ok(()) };
    let own = sweep.manifest.runs.iter().filter(|line| rung.numbers.contains(&line.number));
    let value = |line: &SweepLine| -> Result<SweepRungValue, SweepCommandError> {
        Ok(SweepRungValue { number: line.number, value: value_of(&sweep.folder, &search, line)? })
    };
    let values = own.map(value).collect::<Result<Vec<_>, _>>()?;
    if let Some(halving) = sweep.manifest.search.as_mut().and_then(|search| search.halving.as_mut()) {
        halving.rungs.push(SweepRung { steps: rung.steps, values });
    }
    let next = Rung::next(&sweep.manifest);
    let goes_on = |number| next.as_ref().is_some_and(|next| next.numbers.contains(&number));
    for line in sweep.manifest.runs.iter().filter(|line| rung.numbers.contains(&line.number)) {
        if line.state == SweepState::Interrupted && !goes_on(line.number) {
            sweep.folder.end_run(&SweepEnd {
                digest: line.digest.clone(),
                state: SweepState::Stopped,
                run: line.run.clone(),
                message: Some(format!("stopped on rung {}: others were better", rung.place + 1)),
            })?;
        }
    }
    Ok(sweep.folder.refresh(&mut sweep.manifest)?)
}

/// Rung that is to be run.
struct Rung {
    /// Index of the rung, from 0.
    place: usize,
    /// Number of steps of the trace after which the rung stops; `None` for the last rung.
    steps: Option<u64>,
    /// Numbers of its trials.
    numbers: Vec<usize>,
}

impl Rung {
    /// Returns the rung after those in the manifest; `None` after the last.
    fn next(manifest: &SweepManifest) -> Option<Self> {
        let search = manifest.search.as_ref()?;
        let halving = search.halving.as_ref()?;
        let (place, trials) = (halving.rungs.len(), manifest.runs.len());
        let ladder = ladder(trials, halving.keep_one_in, halving.first_steps);
        let &(count, steps) = ladder.get(place)?;
        let numbers = match halving.rungs.last() {
            None => manifest.runs.iter().map(|line| line.number).collect(),
            Some(rung) => best(search, &rung.values, count),
        };
        Some(Self { place, steps, numbers })
    }
}

/// Returns the number of trials and the length in steps of each rung.
fn ladder(trials: usize, keep_one_in: usize, first_steps: u64) -> Vec<(usize, Option<u64>)> {
    let mut rungs = Vec::new();
    let (mut count, mut steps) = (trials, first_steps);
    while count >= keep_one_in {
        rungs.push((count, Some(steps)));
        count /= keep_one_in;
        steps = steps.saturating_mul(keep_one_in as u64);
    }
    rungs.push((count, None));
    rungs
}

/// Returns the numbers of the best trials of a rung. Of equal trials the first is better; failed trials come
/// last, so they are included only if there are too few others.
fn best(search: &SweepSearch, values: &[SweepRungValue], count: usize) -> Vec<usize> {
    let mut order: Vec<(f64, usize)> = values
        .iter()
        .map(|own| (own.value.map_or(f64::INFINITY, |value| cost(search, value)), own.number))
        .collect();
    order.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    let mut numbers: Vec<usize> = order.into_iter().take(count).map(|(_, number)| number).collect();
    numbers.sort_unstable();
    numbers
}

#[cfg(test)]
mod tests {
    use super::{best, ladder};
    use results::{SweepRungValue, SweepSearch};

    #[test]
    fn a_third_goes_on_three_times_as_long() {
        assert_eq!(ladder(50, 3, 4), [(50, Some(4)), (16, Some(12)), (5, Some(36)), (1, None)]);
        assert_eq!(ladder(2, 3, 4), [(2, None)]);
        assert_eq!(ladder(8, 2, 1), [(8, Some(1)), (4, Some(2)), (2, Some(4)), (1, None)]);
    }

    #[test]
    fn the_best_go_on_and_failures_are_the_worst() {
        let values = [Some(2.0), None, Some(-1.0), Some(2.0), Some(7.0)];
        let values = (1..).zip(values).map(|(number, value)| SweepRungValue { number, value });
        let values: Vec<SweepRungValue> = values.collect();
        let search = |maximize| SweepSearch {
            sampler: results::SweepSampler::Random,
            trials: 5,
            batch: 1,
            seed: 0,
            measure: String::new(),
            maximize,
            halving: None,
        };
        assert_eq!(best(&search(false), &values, 2), [1, 3]);
        assert_eq!(best(&search(true), &values, 2), [1, 5]);
        assert_eq!(best(&search(true), &values, 4), [1, 3, 4, 5]);
    }
}
