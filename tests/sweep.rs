//! Tests of `trainer sweep`: every combination, frozen beforehand, resumable, and the same bits for any way
//! of running it.

use crate::support::{result, root, timeless_files, trainer};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};
use tempfile::TempDir;

/// Runs that take a moment each: a few steps of a network without a tolerance.
pub(crate) const SLOW: &[&str] = &[
    "sweep",
    "configs/pinn.toml",
    "seed=0..5",
    "fit.max_steps=25",
    "fit.tolerance_percent=1e6",
    "estimator.hidden=[16,16]",
];

pub(crate) fn scratch() -> (TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("sweep").to_str().unwrap().to_owned();
    (folder, out)
}

/// Runs a sweep into a folder.
pub(crate) fn sweep(arguments: &[&str], out: &str, options: &[&str]) -> Output {
    trainer(&[arguments, &["--out", out], options].concat())
}

pub(crate) fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub(crate) fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn lines(out: &str) -> Vec<Value> {
    json(&Path::new(out).join("sweep.json"))["runs"].as_array().unwrap().clone()
}

pub(crate) fn states(out: &str) -> Vec<String> {
    lines(out).iter().map(|line| line["state"].as_str().unwrap().to_owned()).collect()
}

/// Removes the wall times from a value.
fn timeless(mut value: Value) -> Value {
    fn forget(value: &mut Value) {
        match value {
            Value::Object(fields) => {
                fields.remove("seconds");
                fields.values_mut().for_each(forget);
            }
            Value::Array(entries) => entries.iter_mut().for_each(forget),
            _ => (),
        }
    }
    forget(&mut value);
    value
}

/// Returns every run's result by digest, without wall times.
pub(crate) fn results(out: &str) -> BTreeMap<String, Value> {
    let of = |line: &Value| {
        let run = Path::new(out).join(line["run"].as_str().unwrap());
        (line["digest"].as_str().unwrap().to_owned(), timeless(json(&run.join("result.json"))))
    };
    lines(out).iter().map(of).collect()
}

/// Returns the time at which each finished run ended.
pub(crate) fn ends(out: &str) -> BTreeMap<PathBuf, SystemTime> {
    let entries = std::fs::read_dir(Path::new(out).join("state")).into_iter().flatten();
    entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .map(|path| (path.clone(), path.metadata().unwrap().modified().unwrap()))
        .collect()
}

pub(crate) fn start(arguments: &[&str], out: &str, options: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args([arguments, &["--out", out], options].concat())
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(File::create(format!("{out}.stderr")).unwrap())
        .spawn()
        .unwrap()
}

/// Waits until a number of runs have ended.
pub(crate) fn wait_for(child: &mut Child, out: &str, runs: usize) {
    let since = Instant::now();
    while ends(out).len() < runs {
        if let Some(status) = child.try_wait().unwrap() {
            assert!(
                ends(out).len() >= runs,
                "{status}: {}",
                std::fs::read_to_string(format!("{out}.stderr")).unwrap()
            );
        }
        assert!(since.elapsed() < Duration::from_secs(120), "no run came to its end");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn every_combination_becomes_an_ordinary_run() {
    let (_folder, out) = scratch();
    let arguments = ["sweep", "configs/pinn.toml", "estimator=ols,lstm", "seed=0..2"];
    let output = sweep(&arguments, &out, &["--json"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let table: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&table["done"], &table["failed"], &table["pass"]), (&6.into(), &0.into(), &true.into()));
    assert_eq!(json(&Path::new(&out).join("sweep.json"))["schema"], "ringdown.sweep/1");
    assert_eq!(states(&out), ["done"; 6]);
    let overrides: Vec<&str> =
        table["rows"].as_array().unwrap().iter().map(|row| row["estimator"].as_str().unwrap()).collect();
    assert_eq!(overrides, ["ols", "ols", "ols", "lstm", "lstm", "lstm"]);
    for name in ["report.html", "table.md", "table.tex", "config.toml", "environment.json", "result.json"] {
        assert!(Path::new(&out).join(name).is_file(), "{name}");
    }
    let csv = std::fs::read_to_string(Path::new(&out).join("table.csv")).unwrap();
    assert_eq!(csv.lines().count(), 7, "{csv}");

    // The run of a combination equals the run with its overrides alone.
    let last = &lines(&out)[5];
    assert_eq!(last["overrides"], serde_json::json!(["estimator=lstm", "seed=2"]));
    let (_, alone, _) = result(&["configs/pinn.toml", "estimator=lstm", "seed=2"]);
    assert_eq!(results(&out)[last["digest"].as_str().unwrap()], timeless(alone));

    // `trainer report` can read its folder, and that of the sweep; the pages come out the same.
    let run = Path::new(&out).join(last["run"].as_str().unwrap());
    for folder in [run.as_path(), Path::new(&out)] {
        let page = folder.join("report.html");
        let before = std::fs::read(&page).unwrap();
        std::fs::remove_file(&page).unwrap();
        assert_eq!(code(&trainer(&["report", folder.to_str().unwrap()])), 0);
        assert_eq!(std::fs::read(&page).unwrap(), before);
    }
    let frozen = std::fs::read(Path::new(&out).join(last["config"].as_str().unwrap())).unwrap();
    assert_eq!(std::fs::read(run.join("config.toml")).unwrap(), frozen);
}

#[test]
fn threads_and_shares_do_not_change_a_bit() {
    let arguments = ["sweep", "configs/lstm.toml", "seed=0..6", "fit.seeds=2"];
    let (_one, one) = scratch();
    assert_eq!(code(&sweep(&arguments, &one, &["--threads", "1", "--quiet"])), 0);
    let (_two, two) = scratch();
    assert_eq!(code(&sweep(&arguments, &two, &["--threads", "2", "--quiet"])), 0);
    // Three shares run at the same time on one folder; any of them may be the one that freezes it.
    let (_shares, shares) = scratch();
    let children: Vec<Child> =
        (1..=3).map(|index| start(&arguments, &shares, &["--shard", &format!("{index}/3")])).collect();
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    assert_eq!(results(&one), results(&two));
    assert_eq!(results(&one), results(&shares));
    assert_eq!(results(&one).len(), 7);
    // The last share left a complete table.
    let table = |out: &str| {
        let mut table = timeless(json(&Path::new(out).join("result.json")));
        table.as_object_mut().unwrap().remove("folder");
        table
    };
    assert_eq!(table(&one), table(&shares));
    // No run was made twice.
    assert_eq!(std::fs::read_dir(Path::new(&shares).join("runs")).unwrap().count(), 7);
}

#[test]
fn a_share_runs_its_own_part_only() {
    let (_folder, out) = scratch();
    let arguments = ["sweep", "configs/ols.toml", "seed=0..4"];
    assert_eq!(code(&sweep(&arguments, &out, &["--shard", "2/2", "--quiet"])), 0);
    assert_eq!(states(&out), ["pending", "done", "pending", "done", "pending"]);
    // The other runs follow later, from the frozen list alone.
    assert_eq!(code(&sweep(&["sweep"], &out, &["--resume", "--shard", "1/2", "--quiet"])), 0);
    assert_eq!(states(&out), ["done"; 5]);
    let refused = sweep(&arguments, &out, &["--shard", "3/2"]);
    assert!(code(&refused) == 2 && said(&refused).contains("I from 1 to N"), "{}", said(&refused));
}

#[test]
fn a_bad_combination_is_named_before_anything_is_written() {
    for (axis, says) in [
        ("fit.tolerance_percent=0.1,-1", "combination 2 (seed=1 fit.tolerance_percent=-1)"),
        ("estimator=ols,lsmt", "did you mean `lstm`"),
        ("estimator.layers=1,2", "combination 1 (seed=1 estimator.layers=1)"),
        ("data.path=experiments/default-record/record.csv,absent.csv", "absent.csv: cannot be read"),
        ("fit.seeds=2,2", "are the same experiment"),
        ("fit.seeds=9..1", "ends before it begins"),
        ("seed=1", "`seed` is given twice"),
        ("task=predict", "cannot be swept"),
        ("fit.seeds", "is no axis"),
    ] {
        let (_folder, out) = scratch();
        let output = sweep(&["sweep", "configs/ols.toml", "seed=1", axis], &out, &[]);
        let message = said(&output);
        assert_eq!(code(&output), 2, "{axis}: {message}");
        assert!(message.contains(says), "{axis}: {message}");
        assert!(!Path::new(&out).exists(), "{axis}");
    }
}

#[test]
fn one_failing_run_is_one_row_and_the_others_go_on() {
    let (folder, out) = scratch();
    let bad = folder.path().join("bad.csv");
    std::fs::write(&bad, "time_s,angle_rad\n0,1\n0.1,x\n").unwrap();
    let paths = format!("data.path={},experiments/default-record/record.csv", bad.display());
    let arguments = ["sweep", "configs/lstm.toml", &paths, "seed=0,1"];
    let output = sweep(&arguments, &out, &["--threads", "1"]);
    assert_eq!(code(&output), 1);
    assert_eq!(states(&out), ["failed", "failed", "done", "done"]);
    // The failure is reported at once, before the runs that follow.
    let message = said(&output);
    let failed = message.find("run 0001").unwrap_or_else(|| panic!("{message}"));
    assert!(failed < message.find("0003 (").unwrap(), "{message}");
    assert!(message.contains("bad.csv:3: `x` in column `angle_rad` is not a number"), "{message}");
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("FAILED: ") && shown.contains("2 done, 2 failed, 0 open"), "{shown}");
    assert!(!shown.contains('\u{1b}'), "colors are for terminals");
    let page = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(page.contains("bad.csv:3:") && page.matches("class=\"fails\"").count() == 2);

    // Resuming repeats neither finished nor failed runs; on request the failed ones are made again.
    let before = ends(&out);
    assert_eq!(code(&sweep(&arguments, &out, &["--resume", "--quiet"])), 1);
    assert_eq!(ends(&out), before);
    let again = sweep(&arguments, &out, &["--resume", "--failed"]);
    assert!(code(&again) == 1 && said(&again).contains("2 of them now"), "{}", said(&again));
    assert_eq!(ends(&out).iter().filter(|(path, time)| before[*path] == **time).count(), 2);
    // A record that has changed since is not swept into the same table.
    std::fs::write(&bad, "time_s,angle_rad\n0,1\n0.1,2\n").unwrap();
    let refused = sweep(&arguments, &out, &["--resume", "--failed"]);
    assert_eq!(code(&refused), 2);
    assert!(
        said(&refused).contains("the record has changed since the sweep was frozen"),
        "{}",
        said(&refused)
    );
}

#[test]
fn a_run_outside_its_tolerance_is_exit_code_1() {
    let (_folder, out) = scratch();
    let output = sweep(&["sweep", "configs/pinn.toml", "estimator=ols,baseline"], &out, &[]);
    assert_eq!((code(&output), states(&out)), (1, vec!["done".to_owned(); 2]));
    assert!(String::from_utf8_lossy(&output.stdout).contains("FAILS"));
}

#[test]
fn killed_at_any_moment_it_goes_on_where_it_was() {
    let (_whole, whole) = scratch();
    assert_eq!(code(&sweep(SLOW, &whole, &["--quiet"])), 0);
    let (_folder, out) = scratch();
    let mut kept: BTreeMap<PathBuf, SystemTime> = BTreeMap::new();
    // The sweep is killed while it freezes, after the first runs, and in the middle of others.
    for (runs, pause) in [(0, 10), (1, 0), (2, 40), (4, 90)] {
        let mut child = start(SLOW, &out, &["--resume", "--threads", "1"]);
        wait_for(&mut child, &out, runs);
        std::thread::sleep(Duration::from_millis(pause));
        child.kill().unwrap();
        child.wait().unwrap();
        let now = ends(&out);
        // Finished runs stay as they were.
        for (path, time) in &kept {
            assert_eq!(now.get(path), Some(time), "{}", path.display());
        }
        kept = now;
        assert!(kept.len() >= runs);
        if Path::new(&out).join("sweep.json").exists() {
            assert_eq!(lines(&out).len(), 6);
        }
    }
    let before = ends(&out);
    // As if the sweep had been killed while writing each kind of file.
    for place in ["", "configs", "state"] {
        std::fs::write(Path::new(&out).join(place).join(".tmpXYZ123"), "half a fi").unwrap();
    }
    let output = sweep(SLOW, &out, &["--resume"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert_eq!(temporary(Path::new(&out)), Vec::<PathBuf>::new());
    let missing = format!("{} of them now", 6 - before.len());
    assert!(said(&output).contains(&missing), "{missing}: {}", said(&output));
    assert!(before.iter().all(|(path, time)| ends(&out)[path] == *time));
    assert_eq!(results(&out), results(&whole));
    assert_eq!(states(&out), ["done"; 6]);
}

/// Returns the temporary files in a folder and below it.
pub(crate) fn temporary(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(temporary(&path));
        } else if path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(".tmp")) {
            found.push(path);
        }
    }
    found
}

/// Returns the events of a run's log by name.
pub(crate) fn events(run: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(run.join("events.jsonl")).unwrap_or_default();
    let named = |line: &str| Some(serde_json::from_str::<Value>(line).ok()?["event"].as_str()?.to_owned());
    text.lines().filter_map(named).collect()
}

/// Waits until a run of a sweep has stored the state of a fit, and kills the sweep.
fn killed_within_a_fit(arguments: &[&str], out: &str, run: &Path) {
    let mut child = start(arguments, out, &["--resume", "--threads", "1"]);
    let since = Instant::now();
    let kept = || std::fs::read_dir(run.join("checkpoints")).into_iter().flatten().flatten();
    while !kept().any(|entry| entry.file_name().to_string_lossy().ends_with(".state")) {
        assert!(child.try_wait().unwrap().is_none() && since.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

/// A run that was in progress when the sweep was killed resumes in its own folder: from its last checkpoint,
/// or as finished if the kill came before the sweep noted its end. If that folder is damaged, the run starts
/// again beside it.
#[test]
fn a_run_killed_within_a_sweep_goes_on_in_its_folder() {
    let arguments = [SLOW, &["fit.seeds=3", "checkpoint.interval_s=0"]].concat();
    let (_whole, whole) = scratch();
    assert_eq!(code(&sweep(&arguments, &whole, &["--quiet"])), 0);
    let (_folder, out) = scratch();
    let runs = Path::new(&out).join("runs");
    let names = ["0001-seed-0", "0002-seed-1", "0003-seed-2"];
    killed_within_a_fit(&arguments, &out, &runs.join(names[0]));
    killed_within_a_fit(&arguments, &out, &runs.join(names[1]));
    assert_eq!(events(&runs.join(names[0])), ["start", "resume", "end"]);
    killed_within_a_fit(&arguments, &out, &runs.join(names[2]));
    // As if the sweep had been killed between the end of a run and the line about it.
    let state = ends(&out).into_keys().next().unwrap();
    std::fs::remove_file(state).unwrap();
    let damaged =
        std::fs::read_dir(runs.join(names[2]).join("checkpoints")).unwrap().next().unwrap().unwrap().path();
    let whole_file = std::fs::read(&damaged).unwrap();
    std::fs::write(&damaged, &whole_file[..whole_file.len() / 2]).unwrap();
    let output = sweep(&arguments, &out, &["--resume"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let says =
        format!("runs/{} cannot be resumed, so the run starts again in a new folder beside it: ", names[2]);
    assert!(said(&output).contains(&says), "{}", said(&output));
    assert_eq!(results(&out), results(&whole));
    let mut found: Vec<String> = std::fs::read_dir(&runs)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    let expected = [&names[..], &["0003-seed-2-2", "0004-seed-3", "0005-seed-4", "0006-seed-5"]].concat();
    assert_eq!(found, expected);
    for name in ["0001-seed-0", "0002-seed-1"] {
        assert_eq!(events(&runs.join(name)), ["start", "resume", "end"], "{name}");
        let files = |out: &str| timeless_files(&Path::new(out).join("runs").join(name));
        assert_eq!(files(&out), files(&whole), "{name}");
    }
}

/// A sweep that was killed before its manifest was written has not begun; the earlier files are no obstacle.
#[test]
fn killed_while_it_froze_it_begins_again() {
    let (_folder, out) = scratch();
    let arguments = ["sweep", "configs/ols.toml", "seed=0,1"];
    assert_eq!(code(&sweep(&arguments, &out, &["--quiet"])), 0);
    for left in [&["configs", "config.toml", "environment.json"][..], &["configs"]] {
        for entry in std::fs::read_dir(&out).unwrap() {
            let path = entry.unwrap().path();
            match path.file_name().is_some_and(|name| left.iter().any(|kept| name == *kept)) {
                true => continue,
                false if path.is_dir() => std::fs::remove_dir_all(&path).unwrap(),
                false => std::fs::remove_file(&path).unwrap(),
            }
        }
        assert_eq!(code(&sweep(&arguments, &out, &["--quiet"])), 2, "it holds something");
        assert_eq!(code(&sweep(&arguments, &out, &["--quiet", "--resume"])), 0);
        assert_eq!(states(&out), ["done"; 2]);
    }
}

#[cfg(unix)]
#[test]
fn interrupted_it_keeps_what_is_done_and_exits_with_130() {
    let (_folder, out) = scratch();
    let mut child = start(SLOW, &out, &["--threads", "1"]);
    wait_for(&mut child, &out, 1);
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let done = states(&out).iter().filter(|state| *state == "done").count();
    assert!((1..6).contains(&done), "{:?}", states(&out));
    assert!(states(&out).iter().all(|state| state != "failed"), "{:?}", states(&out));
    assert!(Path::new(&out).join("report.html").is_file());
    assert_eq!(code(&sweep(SLOW, &out, &["--resume", "--quiet"])), 0);
    assert_eq!(states(&out), ["done"; 6]);
}

#[test]
fn another_configuration_is_refused_with_the_difference() {
    let (folder, out) = scratch();
    let config = folder.path().join("own.toml");
    // Paths start from the file's own folder.
    let shipped = format!("{}/experiments", root().display());
    let text = std::fs::read_to_string(root().join("configs/lstm.toml")).unwrap();
    let text = text.replace("../experiments", &shipped);
    std::fs::write(&config, &text).unwrap();
    let own = config.to_str().unwrap();
    assert_eq!(code(&sweep(&["sweep", own, "seed=0,1"], &out, &["--quiet"])), 0);
    let refused = |arguments: &[&str], options: &[&str]| {
        let output = sweep(arguments, &out, options);
        assert_eq!(code(&output), 2);
        said(&output)
    };
    let begun = refused(&["sweep", own, "seed=0,1"], &[]);
    assert!(begun.contains("a sweep was started there already; --resume continues it"), "{begun}");
    let longer = refused(&["sweep", own, "seed=0..2"], &["--resume"]);
    assert!(longer.contains("2 runs then, 3 now"), "{longer}");
    let other = refused(&["sweep", own, "seed=0,2"], &["--resume"]);
    assert!(other.contains("run 2 (seed=1): `seed = 1` then, `seed = 2` now"), "{other}");
    std::fs::write(&config, format!("{text}\n[envelope.recommended]\nfloor_in_noise = 9.0\n")).unwrap();
    let edited = refused(&["sweep", own, "seed=0,1"], &["--resume"]);
    assert!(edited.contains("`envelope.recommended.floor_in_noise = 8.0` then, "), "{edited}");
    // The place of values in the file does not matter, only the values do.
    std::fs::write(&config, text.replacen("seed", "# moved\nseed", 1)).unwrap();
    assert_eq!(code(&sweep(&["sweep", own, "seed=0..1"], &out, &["--resume", "--quiet"])), 0);
    // The frozen list needs no configuration, but it must be unchanged.
    assert_eq!(code(&sweep(&["sweep"], &out, &["--resume", "--quiet"])), 0);
    let frozen = Path::new(&out).join("configs/0002.toml");
    let text = std::fs::read_to_string(&frozen).unwrap();
    std::fs::write(&frozen, text.replace("tolerance_percent = 0.1", "tolerance_percent = 5.0")).unwrap();
    let changed = refused(&["sweep"], &["--resume"]);
    assert!(changed.contains("0002.toml: the frozen configuration is missing or was changed"), "{changed}");
    // A folder with other files is not used for a sweep.
    let occupied = refused_in(folder.path(), own);
    assert!(occupied.contains("is not empty"), "{occupied}");
}

/// Returns the message if the folder for a sweep has other files.
fn refused_in(folder: &Path, config: &str) -> String {
    let output = sweep(&["sweep", config, "seed=0,1"], folder.to_str().unwrap(), &["--resume"]);
    assert_eq!(code(&output), 2);
    said(&output)
}
