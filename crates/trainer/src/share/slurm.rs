//! Submission of shares to Slurm: job arrays with one task for each share.

use super::ShareOptions;
use super::script::{Script, quoted};
use crate::error::{LaunchError, TrainerError};
use crate::options::Output;
use crate::outcome::Outcome;
use crate::own_program::own_program;
use record::counted;
use results::{LAUNCH_SCHEMA, LaunchResult, LaunchedArray};
use runs::{RunError, RunFolder};
use serde_json::json;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name of the job script in the folder of results.
const SCRIPT: &str = "slurm.sh";

/// Slurm's default `MaxArraySize`: array indices stay below it.
const USUAL_ARRAY_SIZE: usize = 1001;

/// Work to be shared.
pub(crate) struct Work<'a> {
    /// Name of the job.
    pub(crate) name: &'a str,
    /// Folder of results, to which all shares write.
    pub(crate) folder: &'a RunFolder,
    /// Number of runs or cases, which limits the number of shares.
    pub(crate) parts: usize,
    /// Word for one part, such as "run".
    pub(crate) part: &'static str,
    /// Words of the command that works on a share, without `--shard`, `--as-task` and `--threads`.
    pub(crate) words: Vec<String>,
    /// Threads of each task.
    pub(crate) threads: u16,
}

/// Writes the job script and submits it, unless it is only to be written.
pub(crate) fn launch(
    options: &ShareOptions,
    work: &Work<'_>,
    output: Output,
) -> Result<Outcome, TrainerError> {
    let shares = usize::from(options.shards).min(work.parts.max(1));
    let arrays = split(shares, largest_array(), options.slurm_at_once);
    work.folder.write("slurm/README", b"What each task printed: <job>_<task>.log\n")?;
    let folder = absolute(work.folder.path())?;
    let script = Script {
        name: work.name,
        program: &own_program().map_err(system("the program's own path"))?,
        words: &work.words,
        here: &std::env::current_dir().map_err(system("the current folder"))?,
        folder: &folder,
        shares,
        array: arrays.first().map(|array| array.indices.clone()).unwrap_or_default(),
        threads: work.threads,
        options: &options.slurm_option,
        setup: &options.slurm_setup,
        prefix: options.slurm_prefix.as_deref(),
    };
    work.folder.write(SCRIPT, script.text().as_bytes())?;
    let script = folder.join(SCRIPT);
    let launched = submitted(&arrays, &script, options)?;
    let result = LaunchResult {
        schema: LAUNCH_SCHEMA.to_owned(),
        launcher: "slurm".to_owned(),
        folder: work.folder.path().display().to_string(),
        script: script.display().to_string(),
        parts: work.parts,
        shares,
        submitted: !options.write_only,
        arrays: launched,
    };
    if !options.write_only {
        work.folder.record_event("submitted", &json!({ "shares": shares, "arrays": result.arrays }))?;
    }
    output.print(&result, || summary(&result, work.part))?;
    Ok(Outcome::Done)
}

/// Job array: the indices of its tasks, in the form of `--array`, and the offset from an index to the number
/// of its share.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Array {
    indices: String,
    tasks: usize,
    offset: usize,
}

impl Array {
    /// Returns the words of the command that submits the array. If `after` names a job, the array starts once
    /// that job has ended.
    fn words(&self, script: &Path, after: Option<&str>) -> Vec<String> {
        let mut words =
            vec!["sbatch".to_owned(), "--parsable".to_owned(), format!("--array={}", self.indices)];
        words.extend(after.map(|job| format!("--dependency=afterany:{job}")));
        words.extend([script.display().to_string(), self.offset.to_string()]);
        words
    }
}

/// Splits the shares into arrays, none larger than the cluster allows.
fn split(shares: usize, largest: usize, at_once: Option<u16>) -> Vec<Array> {
    let throttle = at_once.map(|tasks| format!("%{tasks}")).unwrap_or_default();
    let array = |offset: usize| {
        let tasks = (shares - offset).min(largest);
        Array { indices: format!("1-{tasks}{throttle}"), tasks, offset }
    };
    (0..shares).step_by(largest.max(1)).map(array).collect()
}

/// Returns the maximum number of tasks in one array, which is one less than the cluster's `MaxArraySize`.
fn largest_array() -> usize {
    let told = Command::new("scontrol").args(["show", "config"]).output().ok();
    let size = told.and_then(|told| array_size(&String::from_utf8_lossy(&told.stdout)));
    size.unwrap_or(USUAL_ARRAY_SIZE).saturating_sub(1).max(1)
}

fn array_size(config: &str) -> Option<usize> {
    let line = config.lines().find(|line| line.trim_start().starts_with("MaxArraySize"))?;
    line.split_once('=')?.1.trim().parse().ok()
}

/// Submits the arrays one after the other; if the number of parallel tasks is limited, each array waits for
/// the previous one.
fn submitted(
    arrays: &[Array],
    script: &Path,
    options: &ShareOptions,
) -> Result<Vec<LaunchedArray>, LaunchError> {
    let mut launched: Vec<LaunchedArray> = Vec::new();
    for array in arrays {
        let after = launched.last().filter(|_| options.slurm_at_once.is_some());
        // If nothing is submitted, there is no job number yet.
        let after = after.map(|before| before.job.map_or_else(|| "JOB".to_owned(), |job| job.to_string()));
        let words = array.words(script, after.as_deref());
        let command = words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ");
        let job = match options.write_only {
            true => None,
            false => Some(submit(&words).map_err(|problem| refused(problem, script, &command, &launched))?),
        };
        launched.push(LaunchedArray { job, tasks: array.tasks, first_share: array.offset + 1, command });
    }
    Ok(launched)
}

/// Reason why an array was not submitted.
#[derive(Debug)]
enum Problem {
    /// There is no `sbatch` on this machine.
    Absent,
    /// `sbatch` refused the script.
    Refused(String),
}

/// Builds the message for an array that was not submitted, after some others were.
fn refused(problem: Problem, script: &Path, command: &str, before: &[LaunchedArray]) -> LaunchError {
    let script = script.display().to_string();
    let complaint = match problem {
        Problem::Absent => return LaunchError::NoSlurm { script, command: command.to_owned() },
        Problem::Refused(complaint) => complaint,
    };
    let jobs: Vec<String> = before.iter().filter_map(|array| array.job).map(|job| job.to_string()).collect();
    let submitted = match jobs.is_empty() {
        true => String::new(),
        false => format!("; job {}, submitted before it, goes on", jobs.join(", ")),
    };
    LaunchError::Refused { script, complaint, submitted }
}

/// Submits an array and returns the job's number.
fn submit(words: &[String]) -> Result<u64, Problem> {
    let (program, rest) = words.split_first().ok_or(Problem::Absent)?;
    let output = Command::new(program).args(rest).output().map_err(|error| match error.kind() {
        ErrorKind::NotFound => Problem::Absent,
        _ => Problem::Refused(error.to_string()),
    })?;
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().replace('\n', ", ");
    if !output.status.success() {
        return Err(Problem::Refused(said(&output.stderr)));
    }
    // With `--parsable`, the output is the number, followed by a semicolon and the cluster.
    let text = said(&output.stdout);
    let number = text.split(';').next().and_then(|number| number.trim().parse().ok());
    number.ok_or_else(|| Problem::Refused(format!("it answered `{text}`, which is not a job number")))
}

fn summary(result: &LaunchResult, part: &str) -> String {
    let shares = counted(result.shares, "share");
    let parts = counted(result.parts, part);
    let LaunchResult { script, folder, .. } = result;
    let mut lines: Vec<String> = Vec::new();
    if result.submitted {
        let job = |array: &LaunchedArray| array.job.map(|job| job.to_string());
        let jobs: Vec<String> = result.arrays.iter().filter_map(job).collect();
        lines.push(format!("submitted as job {}: {parts} in {shares}", jobs.join(", ")));
        lines.push(format!("logs: {folder}/slurm; results so far: trainer report {folder}"));
    } else {
        lines.push(format!("{script} is written for {parts} in {shares}; it is submitted with"));
        lines.extend(result.arrays.iter().map(|array| array.command.clone()));
    }
    lines.join("\n")
}

fn absolute(path: &Path) -> Result<PathBuf, TrainerError> {
    path.canonicalize()
        .map_err(|source| RunError::Io { path: path.to_owned(), action: "find", source }.into())
}

fn system(what: &'static str) -> impl FnOnce(std::io::Error) -> TrainerError {
    move |error| TrainerError::System { what, problem: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::{array_size, split};

    #[test]
    fn arrays_are_as_large_as_the_cluster_allows_and_hold_every_share_once() {
        assert_eq!(array_size("MaxArraySize            = 1001\nMaxBatchRequeue = 5"), Some(1001));
        assert_eq!(array_size("slurm_load_ctl_conf error"), None);
        let said = |shares, largest, at_once| -> Vec<(String, usize, usize)> {
            let arrays = split(shares, largest, at_once).into_iter();
            arrays.map(|array| (array.indices, array.tasks, array.offset)).collect()
        };
        assert_eq!(said(8, 1000, None), [("1-8".to_owned(), 8, 0)]);
        assert_eq!(
            said(5, 2, Some(3)),
            [("1-2%3".to_owned(), 2, 0), ("1-2%3".to_owned(), 2, 2), ("1-1%3".to_owned(), 1, 4)]
        );
        assert_eq!(said(4, 2, None).len(), 2);
    }
}
