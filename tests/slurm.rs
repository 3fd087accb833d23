//! Tests of job arrays on a Slurm cluster, set up by `tests/slurm/single_node.sh`; skipped with a notice if
//! there is none.

use crate::support::{NOMINAL, root, trainer};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Runs that take about a second each.
const SLOW: &[&str] = &[
    "sweep",
    "configs/pinn.toml",
    "fit.seeds=6",
    "fit.max_steps=40",
    "fit.tolerance_percent=1e6",
    "estimator.hidden=[16,16]",
    "checkpoint.interval_s=0",
];

/// Locks the cluster for one test at a time; `None`, with a notice, if there is none.
fn cluster() -> Option<MutexGuard<'static, ()>> {
    static ONE: Mutex<()> = Mutex::new(());
    if std::env::var_os("RINGDOWN_SLURM").is_some() {
        return Some(ONE.lock().unwrap_or_else(PoisonError::into_inner));
    }
    let line = b"SKIPPED: no Slurm here; tests/slurm/single_node.sh sets one up and runs these tests\n";
    std::io::stderr().write_all(line).unwrap();
    None
}

/// Creates a folder that the node can access too.
fn scratch() -> (TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").to_str().unwrap().to_owned();
    (folder, out)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
        .unwrap()
}

/// Submits work to Slurm and returns the jobs' numbers.
fn launch(words: &[&str], out: &str, options: &[&str]) -> Vec<u64> {
    let output = trainer(&[words, &["--out", out, "--launcher", "slurm", "--json"], options].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    told["arrays"].as_array().unwrap().iter().map(|array| array["job"].as_u64().unwrap()).collect()
}

fn slurm(program: &str, words: &[&str]) -> String {
    let output = Command::new(program).args(words).output().unwrap();
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

/// Returns the states of a job's tasks that are waiting or running.
fn queued(job: u64) -> Vec<String> {
    let job = job.to_string();
    let told = slurm("squeue", &["--noheader", "--array", "--format=%T", "--jobs", &job]);
    told.lines().map(|line| line.trim().to_owned()).collect()
}

fn running(jobs: &[u64]) -> usize {
    jobs.iter().flat_map(|job| queued(*job)).filter(|state| state == "RUNNING").count()
}

/// Returns the final states of a job's tasks.
fn ended(job: u64) -> Vec<String> {
    let told = slurm("scontrol", &["--oneliner", "show", "job", &job.to_string()]);
    let state = |line: &str| Some(line.split("JobState=").nth(1)?.split(' ').next()?.to_owned());
    told.lines().filter_map(state).collect()
}

fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let since = Instant::now();
    while !is_so() {
        assert!(since.elapsed() < Duration::from_secs(240), "{what}: {}", slurm("squeue", &[]));
        std::thread::sleep(Duration::from_millis(100));
    }
}

fn through(jobs: &[u64]) {
    until("the jobs do not end", || jobs.iter().all(|job| queued(*job).is_empty()));
}

fn states(out: &str) -> Vec<String> {
    let manifest = json(&Path::new(out).join("sweep.json"));
    let lines = manifest["runs"].as_array().unwrap();
    lines.iter().map(|line| line["state"].as_str().unwrap().to_owned()).collect()
}

/// Returns the results of a sweep's runs, by digest.
fn numbers(out: &str) -> BTreeMap<String, String> {
    let manifest = json(&Path::new(out).join("sweep.json"));
    let of = |line: &Value| {
        let result = json(&Path::new(out).join(line["run"].as_str().unwrap()).join("result.json"));
        (line["digest"].as_str().unwrap().to_owned(), result["estimate"].to_string())
    };
    manifest["runs"].as_array().unwrap().iter().map(of).collect()
}

/// Returns the names of a run's events, for every run of a sweep.
fn events(out: &str) -> Vec<Vec<String>> {
    let runs = std::fs::read_dir(Path::new(out).join("runs")).into_iter().flatten().flatten();
    let named = |line: &str| Some(serde_json::from_str::<Value>(line).ok()?["event"].as_str()?.to_owned());
    runs.map(|run| {
        let text = std::fs::read_to_string(run.path().join("events.jsonl")).unwrap_or_default();
        text.lines().filter_map(named).collect()
    })
    .collect()
}

fn logs(out: &str) -> BTreeMap<PathBuf, String> {
    let files = std::fs::read_dir(Path::new(out).join("slurm")).into_iter().flatten().flatten();
    let read = |path: PathBuf| (path.clone(), std::fs::read_to_string(path).unwrap());
    let is_log = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "log");
    files.map(|file| file.path()).filter(is_log).map(read).collect()
}

/// Returns the processes whose command line names a folder.
fn working_in(out: &str) -> Vec<String> {
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    let names =
        |path: PathBuf| String::from_utf8_lossy(&std::fs::read(path).unwrap_or_default()).contains(out);
    processes
        .filter(|process| names(process.path().join("cmdline")))
        .map(|process| process.file_name().to_string_lossy().into_owned())
        .collect()
}

/// More shares than one array may have, on a partition for two tasks: the numbers equal those of one process,
/// and a second launch finds nothing to do.
#[test]
fn arrays_of_a_sweep_wait_for_a_full_partition_and_give_the_numbers_of_one_process() {
    let Some(_cluster) = cluster() else { return };
    let words = [SLOW, &["seed=0..5"]].concat();
    let (_folder, out) = scratch();
    let jobs = launch(&words, &out, &["--shards", "6"]);
    assert_eq!(jobs.len(), 2, "MaxArraySize is 5");
    let mut most = 0;
    until("the jobs do not end", || {
        most = most.max(running(&jobs));
        jobs.iter().all(|job| queued(*job).is_empty())
    });
    assert_eq!((most, states(&out)), (2, vec!["done".to_owned(); 6]));
    assert_eq!(logs(&out).len(), 6, "{:?}", logs(&out).keys());
    let (_alone, alone) = scratch();
    assert!(trainer(&[&words[..], &["--out", &alone, "--quiet"]].concat()).status.success());
    assert_eq!(numbers(&out), numbers(&alone));

    let before = std::fs::metadata(Path::new(&out).join("runs")).unwrap().modified().unwrap();
    through(&launch(&words, &out, &["--shards", "2", "--resume"]));
    assert_eq!(std::fs::metadata(Path::new(&out).join("runs")).unwrap().modified().unwrap(), before);
    assert!(events(&out).iter().all(|run| *run == ["start", "end"]), "{:?}", events(&out));
}

/// The number of simultaneous tasks stays within the requested limit.
#[test]
fn tasks_are_held_back_where_that_is_asked_for() {
    let Some(_cluster) = cluster() else { return };
    let (_folder, out) = scratch();
    let words = [SLOW, &["seed=0..4"]].concat();
    let jobs = launch(&words, &out, &["--shards", "5", "--slurm-at-once", "1"]);
    assert_eq!(jobs.len(), 2);
    let mut most = 0;
    until("the jobs do not end", || {
        most = most.max(running(&jobs));
        jobs.iter().all(|job| queued(*job).is_empty())
    });
    assert_eq!((most, states(&out)), (1, vec!["done".to_owned(); 5]));
}

/// A run outside of its tolerance is a row of the table; its task counts as successful, and dependent jobs
/// start.
#[test]
fn a_run_out_of_tolerance_does_not_fail_its_task() {
    let Some(_cluster) = cluster() else { return };
    let (folder, out) = scratch();
    let job =
        launch(&["sweep", "configs/pinn.toml", "estimator=baseline", "seed=0,1"], &out, &["--shards", "2"])
            [0];
    let after = folder.path().join("after");
    let wrapped = format!("touch {}", after.display());
    slurm("sbatch", &[&format!("--dependency=afterok:{job}"), "--output=/dev/null", "--wrap", &wrapped]);
    through(&[job]);
    assert_eq!(ended(job), ["COMPLETED"; 2]);
    until("afterok does not run", || after.exists());
    assert_eq!(json(&Path::new(&out).join("result.json"))["pass"], false);
}

/// After `kill -9` of every task in the middle, the table has the finished runs, and the next launch makes
/// the others, to the bit.
#[test]
fn killed_tasks_leave_a_table_and_the_next_array_makes_the_rest() {
    let Some(_cluster) = cluster() else { return };
    let words = [SLOW, &["seed=0..3"]].concat();
    let (_folder, out) = scratch();
    let job = launch(&words, &out, &["--shards", "2"])[0];
    let done = || {
        std::fs::read_dir(Path::new(&out).join("state"))
            .into_iter()
            .flatten()
            .flatten()
            .filter(|entry| entry.path().extension().is_some_and(|extension| extension == "json"))
            .count()
    };
    until("no run comes to its end", || done() >= 1);
    // The processes are killed directly, as by the kernel when memory runs out; scancel would ask them to
    // stop first.
    for process in working_in(&out) {
        assert!(Command::new("kill").args(["-9", &process]).status().unwrap().success());
    }
    through(&[job]);
    assert_eq!(ended(job), ["FAILED"; 2]);
    let done = done();
    assert!(done < 4, "killed too late");
    let report = trainer(&["report", &out]);
    assert_eq!(report.status.code(), Some(0), "{}", said(&report));
    let table = json(&Path::new(&out).join("result.json"));
    assert_eq!((&table["done"], &table["open"]), (&done.into(), &(4 - done).into()));
    through(&launch(&words, &out, &["--shards", "2", "--resume"]));
    assert_eq!(states(&out), ["done"; 4]);
    let (_alone, alone) = scratch();
    assert!(trainer(&[&words[..], &["--out", &alone, "--quiet"]].concat()).status.success());
    assert_eq!(numbers(&out), numbers(&alone));
}

/// A second array on the folder of a live one shares the runs, and each run starts once.
#[test]
fn a_second_array_beside_a_live_one_shares_its_runs() {
    let Some(_cluster) = cluster() else { return };
    let words = [SLOW, &["seed=0..5"]].concat();
    let (_folder, out) = scratch();
    let first = launch(&words, &out, &["--shards", "1"])[0];
    until("the first does not begin", || running(&[first]) == 1 && !events(&out).is_empty());
    let second = launch(&words, &out, &["--shards", "1", "--resume"])[0];
    let mut both = 0;
    until("the jobs do not end", || {
        both = both.max(running(&[first, second]));
        queued(first).is_empty() && queued(second).is_empty()
    });
    assert_eq!((both, states(&out)), (2, vec!["done".to_owned(); 6]));
    assert_eq!([ended(first), ended(second)].concat(), ["COMPLETED"; 2]);
    let events = events(&out);
    assert_eq!(events.len(), 6);
    assert!(events.iter().all(|run| *run == ["start", "end"]), "{events:?}");
}

/// A task that is requeued resumes, and its log keeps the earlier lines.
#[test]
fn a_task_put_in_the_queue_again_adds_to_its_log() {
    let Some(_cluster) = cluster() else { return };
    let words = [SLOW, &["seed=0..3"]].concat();
    let (_folder, out) = scratch();
    let job = launch(&words, &out, &["--shards", "1"])[0];
    until("no run comes to its end", || {
        events(&out).iter().any(|run| run.last().is_some_and(|last| last == "end"))
    });
    slurm("scontrol", &["requeue", &format!("{job}_1")]);
    through(&[job]);
    assert_eq!(states(&out), ["done"; 4]);
    let logs = logs(&out);
    assert_eq!(logs.len(), 1);
    let log = logs.values().next().unwrap();
    let begun: Vec<&str> = log.lines().filter(|line| line.starts_with("sweep of 4 runs in ")).collect();
    assert_eq!(begun.len(), 2, "{log}");
    assert!(begun[0].ends_with(", 4 of them now") && !begun[1].ends_with(", 4 of them now"), "{log}");
    assert!(events(&out).iter().all(|run| run.iter().filter(|event| *event == "start").count() == 1));
}

/// A batch of diagnoses and trials use the same launcher.
#[test]
fn a_batch_and_trials_run_as_arrays() {
    let Some(_cluster) = cluster() else { return };
    let (folder, out) = scratch();
    let cases = folder.path().join("cases");
    for number in 0..5 {
        let case = cases.join(format!("case-{number}"));
        std::fs::create_dir_all(&case).unwrap();
        let row = |index: usize| {
            let t = index as f64 / 130.0;
            format!("{t:.6},{:.6}\n", (0.7 + 0.01 * number as f64) * (-0.15 * t).exp() * (22.0 * t).cos())
        };
        let record = "time_s,angle_rad\n".to_owned() + &(0..500).map(row).collect::<String>();
        std::fs::write(case.join("record-000.csv"), record).unwrap();
        std::fs::write(case.join("nominal.toml"), NOMINAL).unwrap();
    }
    through(&launch(&["diagnose", "--batch", cases.to_str().unwrap()], &out, &["--shards", "3"]));
    for number in 0..5 {
        assert!(Path::new(&out).join(format!("case-{number}/diagnosis.json")).is_file(), "{:?}", logs(&out));
    }

    let (_folder, out) = scratch();
    let banks = [
        "calibration",
        "pair",
        "left_out",
        "foreign",
        "releases",
        "driven",
        "stressed",
        "measured_cases",
        "engine_cases",
        "composite",
        "rigs_cases",
    ]
    .map(|bank| format!("trials.{bank}=0"));
    let banks: Vec<&str> = banks.iter().map(String::as_str).collect();
    let own = [
        "trials",
        "configs/trials-quick.toml",
        "trials.none=2",
        "trials.single=2",
        "record.seconds=8",
        "record.rate_hz=130",
    ];
    through(&launch(&[&own[..], &banks].concat(), &out, &["--shards", "2"]));
    let scores = json(&Path::new(&out).join("result.json"));
    assert_eq!((&scores["cases"], &scores["unanswered"]), (&4.into(), &0.into()), "{:?}", logs(&out));
}

/// A refusal by Slurm is reported in its own words, with the options that help.
#[test]
fn a_refusal_says_what_to_change() {
    let Some(_cluster) = cluster() else { return };
    let (_folder, out) = scratch();
    let words =
        ["sweep", "configs/ols.toml", "seed=0,1", "--launcher", "slurm", "--slurm-option", "partition=none"];
    let refused = trainer(&[&words[..], &["--out", &out]].concat());
    let message = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "{message}");
    assert!(
        message.contains("invalid partition specified: none") && message.contains("--slurm-option"),
        "{message}"
    );
    assert!(root().join("tests/slurm/single_node.sh").is_file());
}
