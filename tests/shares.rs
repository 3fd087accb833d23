//! Tests of several processes on one folder: they share the work, the others take over from a killed process,
//! and the page on a fleet is made from the available answers.

use crate::diagnose::{decay, refusal, write};
use crate::support::{NOMINAL, root, trainer};
use crate::sweep::{
    SLOW, code, ends, events, json, results, said, scratch, start, states, sweep, temporary, wait_for,
};
use serde_json::Value;
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Two processes on one folder that do not know of each other share the runs, and none is made twice.
#[test]
fn a_second_process_beside_a_live_one_shares_its_runs() {
    let (_whole, whole) = scratch();
    assert_eq!(code(&sweep(SLOW, &whole, &["--quiet"])), 0);
    let (_folder, out) = scratch();
    let mut first = start(SLOW, &out, &["--threads", "1"]);
    wait_for(&mut first, &out, 1);
    let second = sweep(SLOW, &out, &["--resume", "--threads", "1"]);
    assert_eq!(code(&second), 0, "{}", said(&second));
    // It returns once all runs are finished, no matter which process made them.
    assert_eq!(states(&out), ["done"; 6]);
    assert!(first.wait().unwrap().success());
    assert_eq!(results(&out), results(&whole));
    let runs: Vec<_> = std::fs::read_dir(Path::new(&out).join("runs")).unwrap().flatten().collect();
    assert_eq!(runs.len(), 6);
    for run in runs {
        assert_eq!(events(&run.path()), ["start", "end"], "{:?}", run.path());
    }
}

/// A process waits for runs in progress elsewhere; if the other process is killed, it makes those runs
/// itself.
#[test]
fn runs_of_a_killed_process_are_taken_over_by_one_that_waits() {
    let (_folder, out) = scratch();
    let arguments = [SLOW, &["seed=0..1", "fit.seeds=20", "checkpoint.interval_s=0"]].concat();
    let arguments: Vec<&str> = arguments.into_iter().filter(|word| *word != "seed=0..5").collect();
    let mut first = start(&arguments, &out, &["--threads", "2"]);
    let runs = Path::new(&out).join("runs");
    let begun = || {
        std::fs::read_dir(&runs).into_iter().flatten().flatten().filter(|run| !events(&run.path()).is_empty())
    };
    let since = Instant::now();
    while begun().count() < 2 {
        assert!(first.try_wait().unwrap().is_none() && since.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    let log = format!("{out}.second");
    let mut second = Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args([&arguments[..], &["--out", &out, "--resume"]].concat())
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(File::create(&log).unwrap())
        .spawn()
        .unwrap();
    while !std::fs::read_to_string(&log).unwrap().contains("waiting for runs that another process is making")
    {
        assert!(second.try_wait().unwrap().is_none() && since.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(second.wait().unwrap().success(), "{}", std::fs::read_to_string(&log).unwrap());
    assert_eq!(states(&out), ["done"; 2]);
    let logs: Vec<Vec<String>> = begun().map(|run| events(&run.path())).collect();
    assert_eq!(logs, [["start", "resume", "end"], ["start", "resume", "end"]]);
}

/// Every task was killed before one could make the table: `trainer report` makes it from the finished runs.
#[test]
fn a_report_on_a_killed_sweep_has_the_table_of_what_there_is() {
    let (_folder, out) = scratch();
    let mut child = start(SLOW, &out, &["--threads", "1"]);
    wait_for(&mut child, &out, 2);
    child.kill().unwrap();
    child.wait().unwrap();
    let done = ends(&out).len();
    assert!(!Path::new(&out).join("result.json").exists());
    let report = trainer(&["report", &out]);
    assert_eq!(code(&report), 0, "{}", said(&report));
    let table = json(&Path::new(&out).join("result.json"));
    assert_eq!((&table["done"], &table["open"]), (&done.into(), &(6 - done).into()));
    assert_eq!(std::fs::read_to_string(Path::new(&out).join("table.csv")).unwrap().lines().count(), 7);
    assert!(std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap().contains("Not finished"));
}

#[test]
fn a_task_has_done_its_work_whatever_its_runs_say() {
    let (_folder, out) = scratch();
    let arguments = ["sweep", "configs/pinn.toml", "estimator=baseline", "seed=0,1"];
    assert_eq!(code(&sweep(&arguments, &out, &["--shard", "1/2", "--as-task", "--quiet"])), 0);
    assert_eq!(code(&sweep(&arguments, &out, &["--resume", "--quiet"])), 1, "it is outside of its tolerance");
}

/// Creates a fleet of short records; the third case has labels of its robot and joint.
fn fleet(cases: &Path, count: usize) {
    for number in 0..count {
        let name = |file: &str| format!("case-{number}/{file}");
        write(cases, &name("record-000.csv"), &decay(500, 0.7 + 0.01 * number as f64));
        write(cases, &name("nominal.toml"), NOMINAL);
    }
    write(cases, "case-2/case.toml", "robot = \"r7\"\njoint = \"elbow\"\n");
}

/// Starts a batch, which prints its result.
fn batch(cases: &Path, answers: &Path, options: &[&str]) -> Child {
    let words =
        ["diagnose", "--batch", cases.to_str().unwrap(), "--out", answers.to_str().unwrap(), "--json"];
    Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args([&words, options].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn batch_result(child: Child) -> (Option<i32>, Value) {
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    (
        output.status.code(),
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {message}")),
    )
}

/// Two batches on one folder at the same time share its cases; shares are disjoint, and a repeated share
/// finds nothing to do.
#[test]
fn batches_and_shares_on_one_folder_diagnose_every_case_once() {
    let scratch = tempfile::tempdir().unwrap();
    let (cases, answers) = (scratch.path().join("cases"), scratch.path().join("answers"));
    fleet(&cases, 6);
    let both = [(); 2].map(|()| batch(&cases, &answers, &["--threads", "1"])).map(batch_result);
    let count = |found: &Value, name: &str| found[name].as_u64().unwrap();
    assert!(both.iter().all(|(code, found)| *code == Some(0) && found["complete"] == true), "{both:?}");
    assert_eq!(both.iter().map(|(_, found)| count(found, "diagnosed")).sum::<u64>(), 6, "{both:?}");
    assert_eq!(both.iter().map(|(_, found)| count(found, "skipped")).sum::<u64>(), 6, "{both:?}");
    let case: Value =
        serde_json::from_slice(&std::fs::read(answers.join("case-2/case.json")).unwrap()).unwrap();
    assert_eq!(case["labels"], serde_json::json!({ "joint": "elbow", "robot": "r7" }));

    let shared = scratch.path().join("shared");
    let shares =
        ["1/3", "2/3", "3/3"].map(|share| batch_result(batch(&cases, &shared, &["--shard", share])).1);
    assert_eq!(shares.iter().map(|found| count(found, "diagnosed")).sum::<u64>(), 6, "{shares:?}");
    let again = batch_result(batch(&cases, &shared, &["--shard", "2/3"])).1;
    assert_eq!((count(&again, "diagnosed"), &again["skipped"]), (0, &shares[1]["cases"]));
    let answer = |folder: &Path, id: &str| {
        let mut answer: Value =
            serde_json::from_slice(&std::fs::read(folder.join(id).join("diagnosis.json")).unwrap()).unwrap();
        answer.as_object_mut().unwrap().retain(|key, _| key != "seconds" && key != "stages");
        answer
    };
    for number in 0..6 {
        let id = format!("case-{number}");
        assert_eq!(answer(&answers, &id), answer(&shared, &id));
    }

    // An answer from other options or from another version is not accepted.
    let (code, found) = batch_result(batch(&cases, &answers, &["--without", "backlash"]));
    assert_eq!((code, count(&found, "diagnosed")), (Some(1), 0));
    assert!(found["failed"][0]["message"].as_str().unwrap().contains("with another without: []"), "{found}");
    let file = answers.join("case-0/case.json");
    let text = std::fs::read_to_string(&file).unwrap().replace("\"version\": \"", "\"version\": \"9");
    std::fs::write(&file, text).unwrap();
    let (code, found) = batch_result(batch(&cases, &answers, &[]));
    assert_eq!((code, count(&found, "skipped")), (Some(1), 5));
    assert!(found["failed"][0]["message"].as_str().unwrap().contains("with another version: \"9"), "{found}");
}

/// The cases of a killed batch are free at once for the next batch.
#[test]
fn a_killed_batch_leaves_its_cases_to_the_next() {
    let scratch = tempfile::tempdir().unwrap();
    let (cases, answers) = (scratch.path().join("cases"), scratch.path().join("answers"));
    fleet(&cases, 4);
    let mut first = batch(&cases, &answers, &["--threads", "1"]);
    while !(0..4).any(|number| answers.join(format!("case-{number}/diagnosis.json")).exists()) {
        assert!(first.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    // As if the batch had been killed while writing.
    let open = (0..4).map(|number| answers.join(format!("case-{number}")));
    for place in open.filter(|place| !place.join("diagnosis.json").exists()) {
        write(&place, ".tmpXYZ123", "half an ans");
    }
    let (code, found) = batch_result(batch(&cases, &answers, &[]));
    assert_eq!(code, Some(0), "{found}");
    assert!(temporary(&answers).is_empty(), "{:?}", temporary(&answers));
    assert_eq!(found["diagnosed"].as_u64().unwrap() + found["skipped"].as_u64().unwrap(), 4);
    assert!(found["skipped"].as_u64().unwrap() >= 1);
}

#[test]
fn a_share_of_one_diagnosis_is_refused() {
    let message = refusal(&["diagnose", "a.csv", "--nominal", "b.toml", "--out", "c", "--shard", "1/2"]);
    assert!(message.contains("--shard shares the cases of a batch"), "{message}");
}

/// Tests the report on the folder of a batch: one page and one file for all answers, with the labels of the
/// cases and the reasons for missing answers.
#[test]
fn the_answers_of_a_batch_make_one_page() {
    let scratch = tempfile::tempdir().unwrap();
    let (cases, answers) = (scratch.path().join("cases"), scratch.path().join("answers"));
    fleet(&cases, 3);
    write(&cases, "garbled/record-000.csv", "time_s,angle_rad\n0,zero\n");
    write(&cases, "garbled/nominal.toml", NOMINAL);
    let (code, _) = batch_result(batch(&cases, &answers, &[]));
    assert_eq!(code, Some(1));
    let report = trainer(&["report", answers.to_str().unwrap()]);
    assert_eq!(report.status.code(), Some(0), "{}", said(&report));
    let fleet = json(&answers.join("fleet.json"));
    assert_eq!((&fleet["schema"], fleet["cases"].as_array().unwrap().len()), (&"ringdown.fleet/1".into(), 3));
    assert_eq!(fleet["labels"], serde_json::json!(["robot", "joint"]));
    assert_eq!(fleet["groups"][0]["value"], "r7");
    assert_eq!(fleet["failed"][0]["id"], "garbled");
    let first: Value = json(&answers.join("case-0/diagnosis.json"));
    assert_eq!(fleet["cases"][0]["numbers"]["error over noise"]["value"], first["gap"]["ratio_to_floor"]);
    let page = std::fs::read_to_string(answers.join("report.html")).unwrap();
    for part in ["Of 3 diagnoses, ", "One case gave no answer", "case-2/diagnosis.json", "`zero` in column"] {
        assert!(page.contains(part), "{part}");
    }
    // After its record is repaired, the case no longer counts as a failure.
    write(&cases, "garbled/record-000.csv", &decay(500, 0.7));
    assert_eq!(batch_result(batch(&cases, &answers, &[])).0, Some(0));
    assert!(!answers.join("garbled/failed.json").exists());
}
