//! Making the runs of a sweep, several at a time.

use super::frozen::{FrozenSweep, Job};
use super::measure::value_of;
use crate::commands::learn::problem::prepare;
use crate::commands::learn::{self, Study};
use crate::commands::run::{Run, perform};
use crate::configured::registries;
use crate::error::TrainerError;
use crate::fits::input::Input;
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

/// `sweep.json` is written again when this many times its own writing time has passed.
const REST: u32 = 20;

/// How often a run in another process's hands is looked at.
const LOOK: Duration = Duration::from_millis(200);

/// What a run of a sweep prints: the sweep speaks for it.
const SILENT: Output = Output { quiet: true, json: false };

/// How runs are made.
#[derive(Clone, Copy)]
pub(super) struct Making {
    pub(super) threads: usize,
    pub(super) output: Output,
    pub(super) cancel: &'static Cancel,
    /// Steps of its trace after which a training is stopped, to be gone on with later.
    pub(super) pause_after: Option<u64>,
}

impl Making {
    /// Whether nothing is to be said.
    pub(super) fn is_silent(&self) -> bool {
        self.output.quiet || self.output.json
    }
}

/// Makes the runs on so many threads. Each run is fitted on a single one, so that its bits do not depend on them. A
/// run that fails is reported and the others go on; a request to stop lets none begin. A run that another process has
/// in hand is left to it, and taken over where that process ends without a result.
///
/// An error is one of the sweep as a whole: what became of a run could not be kept, or no result has what a search is for.
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

/// In whose hands a run was found.
enum Hands {
    /// In this process's, and this became of it.
    Own(SweepEnd),
    /// In none any more: another process has made it meanwhile.
    Done,
    /// In another process's.
    Other,
}

/// Makes a run and keeps what became of it, unless another process does or did.
fn claimed(
    sweep: &FrozenSweep,
    (line, config): Job<'_>,
    making: &Making,
    remark: &dyn Fn(&str),
) -> Result<Hands, TrainerError> {
    let Some(_claim) = sweep.folder.claim(&line.digest)? else { return Ok(Hands::Other) };
    let ended = |end: &SweepEnd| match end.state {
        SweepState::Done | SweepState::Stopped => true,
        // One that failed is made again where that was asked for, but not one that another process has just made again.
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

/// The runs to be made, those that are in other processes' hands at the end.
struct Queue<'a> {
    /// With what was looked at before and found in another process's hands.
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

    /// Puts a run at the end, after a pause where it has been there before.
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

/// Makes one run and says what became of it.
fn make(sweep: &FrozenSweep, (line, config): Job<'_>, making: &Making, remark: &dyn Fn(&str)) -> SweepEnd {
    let mut run = None;
    // A panic would be a fault of the program; even so the other runs go on.
    let made = catch_unwind(AssertUnwindSafe(|| attempt(sweep, (line, config), making, &mut run, remark)));
    let (state, message) = match made {
        Ok(Ok(Outcome::Interrupted)) => (SweepState::Interrupted, None),
        Ok(Ok(Outcome::Done | Outcome::CheckFailed)) => (SweepState::Done, None),
        // A request to stop may also end training that has nothing to show yet.
        Ok(Err(_)) if making.cancel.is_requested() => (SweepState::Interrupted, None),
        Ok(Err(error)) => (SweepState::Failed, Some(error.to_string())),
        Err(_) => {
            let message = "the program panicked; what it said stands above (a fault, please report it)";
            (SweepState::Failed, Some(message.to_owned()))
        }
    };
    if let (Some(folder), Some(message)) = (&run, &message) {
        // The sweep's own state file says so too; that this one cannot be written is no failure of its own.
        let folder = RunFolder::open(&sweep.folder.path().join(folder));
        let _ = folder.record_event(FAILED, &json!({ "message": message }));
    }
    SweepEnd { digest: line.digest.clone(), state, run, message }
}

/// Reads, fits and keeps; the run's folder is made, or taken up, once its record is read.
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
            let input = Input::read(&experiment)?.with_pipelines(&experiment);
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

/// The run's folder, open for work; `None` where an earlier attempt finished it.
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

/// The folder that the run was begun in and can go on in to the same bits; `None` where there is none, or
/// where it failed there. One that is damaged or in another process's hands is left alone, and said.
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
            // A damaged checkpoint is found out here.
            Ledger::open(folder, CheckpointSettings { interval_s: 10.0, interval_steps: None })?;
        }
        Ok(Some(taken_up))
    };
    let before = open().unwrap_or_else(|error: TrainerError| {
        remark(&format!("{name} cannot be gone on with, so the run begins again beside it: {error}"));
        None
    });
    before.map(|before| (name, before))
}

/// Says at once what became of a run; fails where a result lacks what a search is for.
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
    let rows = end.run.as_ref().map(|run| read_run(&sweep.folder.path().join(run)).rows).unwrap_or_default();
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
    progress.run_done(&format!("{name}: {}{measure}", said(&rows)));
    Ok(())
}

/// One line on the rows of a run.
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

    /// Writes it, unless that was done just now: with thousands of runs it would take longer than these. That it
    /// cannot be written is found out at the end, when it has to be.
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
