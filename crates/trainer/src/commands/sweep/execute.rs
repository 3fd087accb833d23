//! Execution of the runs of a sweep, several at a time.

use super::frozen::{FrozenSweep, Job};
use super::measure::value_of;
use crate::commands::learn::problem::prepare;
use crate::commands::learn::{self, Study};
use crate::commands::run::{Run, perform};
use crate::configured::registries;
use crate::error::TrainerError;
use crate::fits::input;
use crate::folders::resume::{Beginning, FAILED, Ledger, TakenUp, start, take_up};
use crate::options::Output;
use crate::outcome::Outcome;
use crate::run_table::of_sweep::label;
use crate::terminal::console;
use crate::terminal::progress::Progress;
use estimator::Cancel;
use experiment::CheckpointSettings;
use experiment::sweep::Swept;
use record::two_digits;
use results::{Reached, RunTableRow, SweepEnd, SweepLine, SweepManifest, SweepState};
use runs::{Disk, RunFolder, read_run};
use serde_json::json;
use settings::Document;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Pause between writes of `sweep.json`, as a multiple of the duration of a write.
const REST: u32 = 20;

/// Pause between checks of a run that another process is making.
const LOOK: Duration = Duration::from_millis(200);

/// Output options of a run in a sweep: it prints nothing, since the sweep reports on it.
const SILENT: Output = Output { quiet: true, json: false };

/// Conditions under which runs are made.
#[derive(Clone, Copy)]
pub(super) struct Making {
    pub(super) threads: usize,
    pub(super) output: Output,
    pub(super) cancel: &'static Cancel,
    /// Number of steps of its trace after which a training pauses, to be resumed later.
    pub(super) pause_after: Option<u64>,
}

impl Making {
    /// Returns `true` if nothing is to be printed.
    pub(super) fn is_silent(&self) -> bool {
        self.output.quiet || self.output.json
    }
}

/// Makes the runs on the given number of threads. Each run is fitted on a single thread, so that its bits do
/// not depend on their number. A failed run is reported, and the others continue; after a request to stop, no
/// further run begins. A run that another process is making is left to that process, and taken over if it
/// ends without a result.
///
/// Returns an error only for a fault of the sweep as a whole: the end of a run could not be recorded, or a
/// result lacks the measure of a search.
pub(super) fn execute(sweep: &FrozenSweep, jobs: &[Job<'_>], making: &Making) -> Result<(), TrainerError> {
    let Making { output, cancel, .. } = *making;
    let progress = Progress::over(jobs.len() as u64, "runs", making.is_silent());
    let queue = Queue::new(jobs);
    let fault: Mutex<Option<TrainerError>> = Mutex::new(None);
    let clerk = Mutex::new(Clerk::new(sweep));
    let remark = |words: &str| {
        if !output.quiet {
            progress.aside(|| console::remark(words));
        }
    };
    let work = || {
        while !cancel.is_requested() && !is_some(&fault) {
            let Some((job, waited)) = queue.next() else { break };
            match claimed(sweep, job, making, &remark) {
                Ok(Hands::Own(end)) => {
                    if let Err(error) = report(sweep, job.0, &end, &progress, output) {
                        *fault.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                    }
                    clerk.lock().unwrap_or_else(PoisonError::into_inner).note(sweep);
                }
                Ok(Hands::Done) => {
                    progress.run_done(&format!("{:04}: made by another process", job.0.number))
                }
                Ok(Hands::Other) => queue.later(job, waited, &remark),
                Err(error) => *fault.lock().unwrap_or_else(PoisonError::into_inner) = Some(error),
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..making.threads.min(jobs.len()) {
            scope.spawn(work);
        }
    });
    progress.finish();
    match fault.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

/// Process that makes or made a run.
enum Hands {
    /// This process made it; the run ended like this.
    Own(SweepEnd),
    /// No process any more: another one has made it meanwhile.
    Done,
    /// Another process is making it.
    Other,
}

/// Makes a run and records its end, unless another process is making or has made it.
fn claimed(
    sweep: &FrozenSweep,
    (line, config): Job<'_>,
    making: &Making,
    remark: &dyn Fn(&str),
) -> Result<Hands, TrainerError> {
    let Some(_claim) = sweep.folder.claim(&line.digest)? else { return Ok(Hands::Other) };
    let ended = |end: &SweepEnd| match end.state {
        SweepState::Done | SweepState::Stopped => true,
        // A failed run is repeated if that was asked for, unless another process has just repeated it.
        SweepState::Failed => line.state != SweepState::Failed || end.run != line.run,
        SweepState::Pending | SweepState::Interrupted => false,
    };
    if sweep.folder.end_of(&line.digest).is_some_and(|end| ended(&end)) {
        return Ok(Hands::Done);
    }
    let end = make(sweep, (line, config), making, remark);
    sweep.folder.end_run(&end)?;
    Ok(Hands::Own(end))
}

/// Queue of the runs to be made; runs that other processes are making are at the end.
struct Queue<'a> {
    /// Runs, each with a flag that is `true` if another process was found to be making it.
    jobs: Mutex<VecDeque<(Job<'a>, bool)>>,
    said: AtomicBool,
}

impl<'a> Queue<'a> {
    fn new(jobs: &[Job<'a>]) -> Self {
        Self {
            jobs: Mutex::new(jobs.iter().map(|job| (*job, false)).collect()),
            said: AtomicBool::new(false),
        }
    }

    fn next(&self) -> Option<(Job<'a>, bool)> {
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner).pop_front()
    }

    /// Moves a run to the end of the queue, after a pause if it has been there before.
    fn later(&self, job: Job<'a>, waited: bool, remark: &dyn Fn(&str)) {
        if waited {
            if !self.said.swap(true, Ordering::Relaxed) {
                remark("waiting for runs that another process is making");
            }
            std::thread::sleep(LOOK);
        }
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner).push_back((job, true));
    }
}

fn is_some<T>(shared: &Mutex<Option<T>>) -> bool {
    shared.lock().unwrap_or_else(PoisonError::into_inner).is_some()
}

/// Makes one run and returns its end.
fn make(sweep: &FrozenSweep, (line, config): Job<'_>, making: &Making, remark: &dyn Fn(&str)) -> SweepEnd {
    let mut run = None;
    // A panic would be a fault of the program; even then the other runs continue.
    let made = catch_unwind(AssertUnwindSafe(|| attempt(sweep, (line, config), making, &mut run, remark)));
    let (state, message) = match made {
        Ok(Ok(Outcome::Interrupted)) => (SweepState::Interrupted, None),
        Ok(Ok(Outcome::Done | Outcome::CheckFailed)) => (SweepState::Done, None),
        // A request to stop may also end a training that has no result yet.
        Ok(Err(_)) if making.cancel.is_requested() => (SweepState::Interrupted, None),
        Ok(Err(error)) => (SweepState::Failed, Some(error.to_string())),
        Err(_) => {
            let message = "the program panicked; its message is above (a bug, please report it)";
            (SweepState::Failed, Some(message.to_owned()))
        }
    };
    if let (Some(folder), Some(message)) = (&run, &message) {
        // The sweep's own state file reports the failure as well; failing to write this file is not a failure
        // of its own.
        let folder = RunFolder::open(&sweep.folder.path().join(folder));
        let _ = folder.record_event(FAILED, &json!({ "message": message }));
    }
    SweepEnd { digest: line.digest.clone(), state, run, message }
}

/// Reads, fits and saves. The run's folder is created or reopened only after its record has been read.
fn attempt(
    sweep: &FrozenSweep,
    (line, config): Job<'_>,
    making: &Making,
    run: &mut Option<String>,
    remark: &dyn Fn(&str),
) -> Result<Outcome, TrainerError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })?;
    let Making { cancel, pause_after, .. } = *making;
    let resolved = Swept::resolve(&Document::parse(&line.config, config)?, &registries())?;
    match resolved.map_err(|task| TrainerError::System { what: "the task", problem: task })? {
        Swept::Experiment(experiment) => {
            let input = input::read(&experiment)?.with_pipelines(&experiment.envelope);
            let beginning = Beginning::of(&experiment, &input.source.digest, config.to_owned(), 1);
            let Some(folder) = opened(sweep, line, &beginning, run, remark)? else {
                return Ok(Outcome::Done);
            };
            let ledger = Ledger::open(&folder, experiment.checkpoint)?;
            let experiment = &experiment;
            perform(&Run { experiment, input, folder, ledger, pool, cancel, pause_after, output: SILENT })
        }
        Swept::Learning(study) => {
            let problems = study.problems.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
            let beginning =
                Beginning { config: config.to_owned(), ..learn::beginning(&study, &pool, &problems) };
            let Some(folder) = opened(sweep, line, &beginning, run, remark)? else {
                return Ok(Outcome::Done);
            };
            let study = &study;
            learn::perform(&Study { study, problems, folder, pool, cancel, pause_after, output: SILENT })
        }
    }
}

/// Returns the run's folder, open for work; `None` if an earlier attempt finished the run.
fn opened(
    sweep: &FrozenSweep,
    line: &SweepLine,
    beginning: &Beginning<'_>,
    run: &mut Option<String>,
    remark: &dyn Fn(&str),
) -> Result<Option<RunFolder>, TrainerError> {
    let label = label(&sweep.manifest, line);
    match begun_before(sweep, &label, beginning, remark) {
        Some((name, before)) => {
            *run = Some(name);
            Ok(match before {
                TakenUp::Finished(_) => None,
                TakenUp::Open(folder) => Some(folder),
            })
        }
        None => {
            let (name, folder) = sweep.folder.begin_run(&label)?;
            *run = Some(name);
            Ok(Some(start(folder, beginning)?))
        }
    }
}

/// Returns the folder in which the run was begun and can be resumed to the same bits; `None` if there is none
/// or the run failed there. A folder that is damaged or in use by another process is left alone and reported.
fn begun_before(
    sweep: &FrozenSweep,
    label: &str,
    beginning: &Beginning<'_>,
    remark: &dyn Fn(&str),
) -> Option<(String, TakenUp)> {
    let name = sweep.folder.last_begun(label)?;
    let path = sweep.folder.path().join(&name);
    let open = || {
        if RunFolder::open(&path).events()?.last(FAILED).is_some() {
            return Ok(None);
        }
        let taken_up = take_up(&Disk::default(), &path, beginning, &|_| ())?;
        if let TakenUp::Open(folder) = &taken_up {
            // Opening the ledger finds damaged checkpoints.
            Ledger::open(folder, CheckpointSettings { interval_s: 10.0, interval_steps: None })?;
        }
        Ok(Some(taken_up))
    };
    let before = open().unwrap_or_else(|error: TrainerError| {
        remark(&format!(
            "{name} cannot be resumed, so the run starts again in a new folder beside it: {error}"
        ));
        None
    });
    before.map(|before| (name, before))
}

/// Reports the end of a run at once; returns an error if the result lacks the measure of a search.
fn report(
    sweep: &FrozenSweep,
    line: &SweepLine,
    end: &SweepEnd,
    progress: &Progress,
    output: Output,
) -> Result<(), TrainerError> {
    let name = format!("{:04} ({})", line.number, line.overrides.join(" "));
    if let Some(message) = &end.message {
        let said = format!("run {name} FAILED: {message}");
        if !output.quiet {
            progress.aside(|| console::failure(&said));
        }
        progress.run_done(&format!("{name}: FAILED"));
        return Ok(());
    }
    let run = end.run.as_ref().map(|run| read_run(&sweep.folder.path().join(run)));
    let result = match &run {
        Some(run) if !run.summary.is_empty() => run.summary.clone(),
        run => said(run.as_ref().map_or(&[], |run| &run.rows)),
    };
    let measure = match &sweep.manifest.search {
        Some(search) => {
            let ended = SweepLine { state: end.state, run: end.run.clone(), ..line.clone() };
            let value = value_of(&sweep.folder, search, &ended)?;
            format!(
                ", {} {}",
                search.measure,
                value.map_or_else(|| "none".to_owned(), |value| format!("{value:.6}"))
            )
        }
        None => String::new(),
    };
    progress.run_done(&format!("{name}: {result}{measure}"));
    Ok(())
}

/// Describes the rows of a run in one line.
fn said(rows: &[RunTableRow]) -> String {
    let bad = rows.iter().filter(|row| row.pass == Some(false)).count();
    match rows {
        [RunTableRow { zeta: Some(zeta), error_percent, reached, steps, seconds, .. }] => {
            let steps = steps.map(|steps| format!(" after {steps} steps"));
            let seconds = seconds.map(|seconds| format!(", {seconds:.2} s"));
            let gap = error_percent.map(|error| format!(", gap {} %", two_digits(error)));
            let [steps, seconds, gap] = [steps, seconds, gap].map(Option::unwrap_or_default);
            let fails = if bad > 0 { ", FAILS its tolerance" } else { "" };
            format!("{}{steps}{seconds}, ζ {zeta:.8}{gap}{fails}", reached.map_or("", Reached::in_words))
        }
        [RunTableRow { reason, .. }] if !reason.is_empty() => reason.clone(),
        rows => format!("{} methods, {bad} of them outside the tolerance", rows.len()),
    }
}

/// Keeps `sweep.json` nearly up to date while runs are made.
struct Clerk {
    manifest: SweepManifest,
    last: Instant,
    rest: Duration,
}

impl Clerk {
    fn new(sweep: &FrozenSweep) -> Self {
        Self { manifest: sweep.manifest.clone(), last: Instant::now(), rest: Duration::ZERO }
    }

    /// Writes the manifest, unless it was written just now: with thousands of runs, writing would take longer
    /// than the runs. Write errors are ignored here and reported at the end, when the manifest has to be
    /// written.
    fn note(&mut self, sweep: &FrozenSweep) {
        if self.last.elapsed() < self.rest {
            return;
        }
        let begun = Instant::now();
        let _ = sweep.folder.refresh(&mut self.manifest);
        (self.last, self.rest) = (Instant::now(), begun.elapsed() * REST);
    }
}

#[cfg(test)]
mod tests {
    use super::{RunTableRow, said};
    use results::RunState;

    #[test]
    fn what_is_not_known_of_a_run_is_not_said_to_be_zero() {
        let bare = RunTableRow::without_numbers("0001", RunState::Done, "");
        let known = RunTableRow { zeta: Some(0.01), reached: Some(results::Reached::BudgetSpent), ..bare };
        assert_eq!(said(std::slice::from_ref(&known)), "budget spent, ζ 0.01000000");
        let all = RunTableRow {
            steps: Some(7),
            seconds: Some(0.25),
            error_percent: Some(3e-6),
            pass: Some(false),
            ..known
        };
        assert_eq!(
            said(&[all]),
            "budget spent after 7 steps, 0.25 s, ζ 0.01000000, gap 3.0e-6 %, FAILS its tolerance"
        );
    }
}
