//! Blind diagnosis of the cases: each group of cases is diagnosed in a separate process, which gets that
//! group's folder and nothing else.

use super::arguments::TrialsArguments;
use super::files::{self, WITHOUT};
use super::open;
use crate::commands::diagnose::batch::FAILED;
use crate::error::TrainerError;
use crate::error::TrialsError;
use crate::own_program::own_program;
use crate::terminal::console;
use crate::terminal::progress::Progress;
use estimator::Cancel;
use results::{BatchResult, FailedCase, TrialsManifest, TrialsManifestLine};
use runs::RunFolder;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Pause between counts of finished answers.
const LOOK: Duration = Duration::from_millis(50);
/// Time for which a process may continue after it was asked to stop. It is shorter than the patience of this
/// process; answers are written whole or not at all.
const GRACE: Duration = Duration::from_millis(300);

/// Diagnoses every case of the share that has no answer; returns the messages of the failed cases, or `None`
/// if interrupted.
pub(crate) fn ask(
    arguments: &TrialsArguments,
    folder: &RunFolder,
    manifest: &TrialsManifest,
    cancel: &Cancel,
) -> Result<Option<BTreeMap<String, String>>, TrainerError> {
    let is_missing = |id: &str, group: &str| !folder.path().join(files::answer_name(group, id)).exists();
    let own: Vec<&TrialsManifestLine> =
        manifest.cases.iter().filter(|line| arguments.share.shard().takes_named(&line.id)).collect();
    let missing = own.iter().filter(|line| is_missing(&line.id, &line.group));
    let mut groups: BTreeMap<&str, usize> = BTreeMap::new();
    for line in missing.clone() {
        *groups.entry(line.group.as_str()).or_default() += 1;
    }
    let missing_ids: Vec<&String> = missing.map(|line| &line.id).collect();
    let count = missing_ids.len();
    let truths = folder.path().join(files::TRUTHS);
    if count > 0 && truths.exists() {
        // A case that got no answer when it was first diagnosed gets none now.
        let known = open::failed(folder)?;
        if missing_ids.iter().all(|id| known.contains_key(id.as_str())) {
            return Ok(Some(known));
        }
        return Err(TrialsError::Open { folder: truths.display().to_string(), missing: count }.into());
    }
    let silent = arguments.output.quiet || arguments.output.json;
    let progress = Progress::over(own.len() as u64, "cases", silent);
    let mut done = own.len() - count;
    progress.so_many_done(done as u64);
    let mut failed = BTreeMap::new();
    for (group, wanted) in groups {
        let Some(result) = group_answers(arguments, folder.path(), group, cancel, &|answered| {
            progress.so_many_done((done + answered.min(wanted)) as u64);
        })?
        else {
            progress.finish();
            return Ok(None);
        };
        for case in result.failed {
            progress.aside(|| console::error(&format!("{}: {}", case.id, case.message)));
            failed.insert(case.id, case.message);
        }
        done += wanted;
        progress.so_many_done(done as u64);
    }
    progress.finish();
    Ok(Some(failed))
}

/// Returns the reasons why cases have no answer, by case: those of `failed` and those found by other shares.
/// Also returns the number of cases that no share has diagnosed yet.
pub(crate) fn answered(
    folder: &RunFolder,
    manifest: &TrialsManifest,
    mut failed: BTreeMap<String, String>,
) -> (BTreeMap<String, String>, usize) {
    let mut open = 0;
    for line in &manifest.cases {
        let answer = folder.path().join(files::answer_name(&line.group, &line.id));
        if answer.exists() || failed.contains_key(&line.id) {
            continue;
        }
        let bytes = std::fs::read(answer.with_file_name(FAILED)).unwrap_or_default();
        match serde_json::from_slice::<FailedCase>(&bytes) {
            Ok(case) => drop(failed.insert(line.id.clone(), case.message)),
            Err(_) => open += 1,
        }
    }
    (failed, open)
}

/// Diagnoses one group; `None` if interrupted.
fn group_answers(
    arguments: &TrialsArguments,
    folder: &Path,
    group: &str,
    cancel: &Cancel,
    answered: &dyn Fn(usize),
) -> Result<Option<BatchResult>, TrialsError> {
    let failed = |problem: String| TrialsError::Process { group: group.to_owned(), problem };
    let program = own_program().map_err(|error| failed(error.to_string()))?;
    let answers = folder.join("answers").join(group);
    let before = names(&answers);
    let mut command = Command::new(program);
    command.arg("diagnose").arg("--batch").arg(folder.join("cases").join(group));
    command.arg("--out").arg(&answers).arg("--json");
    if let Some(shard) = arguments.share.shard {
        command.args(["--shard", &shard.to_string()]);
    }
    if let Some(threads) = arguments.run.threads {
        command.args(["--threads", &threads.to_string()]);
    }
    if let Some(effect) = group.strip_prefix(WITHOUT) {
        command.args(["--without", effect]);
    }
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| failed(error.to_string()))?;
    let (output, errors) = (drained(child.stdout.take()), drained(child.stderr.take()));
    let status = watch(&mut child, cancel, &|| answered(names(&answers).difference(&before).count()));
    let status = status.map_err(|error| failed(error.to_string()))?;
    let text = output.join().unwrap_or_default();
    if cancel.is_requested() || status == Some(130) {
        return Ok(None);
    }
    // The process also prints failed cases as errors; its error output is used only if there is no result.
    serde_json::from_str(&text).map(Some).map_err(|_| {
        let said = errors.join().unwrap_or_default();
        let code = status.map_or_else(|| "a signal".to_owned(), |code| format!("exit code {code}"));
        failed(format!("{code}: {}", said.trim()))
    })
}

/// Waits for a process, and counts answers meanwhile. After a request to stop, waits only for a limited time.
fn watch(child: &mut Child, cancel: &Cancel, count: &dyn Fn()) -> std::io::Result<Option<i32>> {
    let mut requested: Option<Instant> = None;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.code());
        }
        count();
        if cancel.is_requested() {
            // Ctrl-C on a terminal reaches the process as well; a signal sent to this process alone does not.
            let since = *requested.get_or_insert_with(Instant::now);
            if since.elapsed() > GRACE {
                child.kill()?;
            }
        }
        std::thread::sleep(LOOK);
    }
}

/// Reads a pipe to its end in a thread of its own: a full pipe would block the process.
fn drained(pipe: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut text = String::new();
        if let Some(mut pipe) = pipe {
            let _ = pipe.read_to_string(&mut text);
        }
        text
    })
}

/// Returns the names of the existing answers.
fn names(answers: &Path) -> BTreeSet<std::ffi::OsString> {
    let entries = std::fs::read_dir(answers).into_iter().flatten().flatten();
    entries.filter(|entry| entry.path().join(files::ANSWER).exists()).map(|entry| entry.file_name()).collect()
}
