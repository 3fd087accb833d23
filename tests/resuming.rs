//! Tests of runs that are killed, stopped or started twice: nothing is lost, and a resumed run ends as an
//! uninterrupted one.

#![cfg(unix)]

use crate::support::{root, timeless_files, trainer};
use rand::{Rng, RngExt};
use seed::Seed;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn start(arguments: &[&str], out: &Path) -> Child {
    Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args(arguments)
        .args(["--quiet", "--threads", "2", "--out", out.to_str().unwrap()])
        .current_dir(root())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

fn wait_for(child: &mut Child, path: &Path) {
    while !path.exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended before {} was there", path.display());
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Waits until a number of events of a run are written completely. The log exists before its first line does.
fn wait_for_events(child: &mut Child, out: &Path, events: usize) {
    let written =
        || std::fs::read_to_string(out.join("events.jsonl")).map_or(0, |log| log.matches('\n').count());
    while written() < events {
        assert!(child.try_wait().unwrap().is_none(), "ended before {events} events were there");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Amortized networks, which train for a second each here; several finished fits, one in progress.
const TRAINING: &[&str] = &[
    "configs/lstm-amortized.toml",
    "fit.seeds=3",
    "estimator.max_steps=60",
    "estimator.batch=8",
    "estimator.hidden_units=4",
    "estimator.calibration=200",
    "checkpoint.interval_s=0.05",
];

/// Many short fits of several methods.
const COMPARISON: &[&str] = &[
    "configs/compare.toml",
    "compare.methods=ols,symbolic,pinn,lstm",
    "fit.seeds=2",
    "checkpoint.interval_s=0.02",
];

/// Amortized training, then many trials.
const PREDICTION: &[&str] = &[
    "configs/beyond.toml",
    "predict.problems=control",
    "predict.methods=ols,sindy,pinn",
    "predict.draws=3",
    "predict.draws_seeded=2",
    "predict.max_steps=20",
    "checkpoint.interval_s=0.02",
];

/// One learner of dynamics with the baselines; it stores nothing before its end.
const LEARNING: &[&str] = &["configs/learn/sindy.toml", "sindy.members=2", "sindy.refit_samples=500"];

/// Kills a run at random moments and resumes it until it ends by itself; then everything in its folder equals
/// that of an uninterrupted run.
fn killed_and_resumed(rounds: usize, seed: &Seed) {
    let scratch = tempfile::tempdir().unwrap();
    let mut generator = seed.generator();
    for (which, arguments) in [TRAINING, COMPARISON, PREDICTION, LEARNING].into_iter().enumerate() {
        let whole = scratch.path().join(format!("whole-{which}"));
        let begun = Instant::now();
        let code = start(arguments, &whole).wait().unwrap().code();
        let took = begun.elapsed();
        assert!(matches!(code, Some(0 | 1)), "{arguments:?} {code:?}");
        let expected = timeless_files(&whole);
        for round in (0..rounds).filter(|round| round % 4 == which) {
            let out = scratch.path().join(format!("{which}-{round}"));
            let mut kills = 0;
            loop {
                let mut child = start(&[arguments, &["--resume"]].concat(), &out);
                // The moments range from before the folder exists until after the end.
                std::thread::sleep(moment(took, &mut generator));
                child.kill().unwrap();
                match child.wait().unwrap().code() {
                    Some(found) => {
                        assert!(Some(found) == code || found == 0, "{found} {code:?} {arguments:?}");
                        break;
                    }
                    None => kills += 1,
                }
                if kills == 3 {
                    let last = start(&[arguments, &["--resume"]].concat(), &out).wait_with_output().unwrap();
                    let said = String::from_utf8_lossy(&last.stderr);
                    assert!(last.status.code() == code || last.status.code() == Some(0), "{said}");
                    break;
                }
            }
            if out.join("checkpoints").exists() {
                // The run was killed after its last event, before it cleaned up.
                let code = start(&[arguments, &["--resume"]].concat(), &out).wait().unwrap().code();
                assert_eq!(code, Some(0));
            }
            assert_eq!(timeless_files(&out), expected, "round {round}: {arguments:?} after {kills} kills");
            std::fs::remove_dir_all(out).unwrap();
        }
    }
}

fn moment(took: Duration, generator: &mut impl Rng) -> Duration {
    took.mul_f64(1.1 * generator.random::<f64>())
}

#[test]
fn killed_at_any_moment_and_resumed_it_ends_as_in_one_go() {
    killed_and_resumed(4, &Seed::new(5));
}

/// `cargo test -p trainer --test acceptance a_hundred_times -- --ignored`
#[test]
#[ignore = "takes minutes"]
fn killed_a_hundred_times_and_resumed_it_ends_as_in_one_go() {
    killed_and_resumed(100, &Seed::new(100));
}

/// Fits that take minutes together.
const LONG: &[&str] = &[
    "configs/pinn.toml",
    "estimator.hidden=[32,32]",
    "estimator.loss_tolerance=0",
    "estimator.max_steps=1000000",
    "estimator.collocation_points=500",
    "fit.seeds=1000",
];

#[test]
fn a_folder_is_one_programs_at_a_time() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    let mut first = start(LONG, &out);
    wait_for_events(&mut first, &out, 1);
    for arguments in [LONG.to_vec(), [LONG, &["--resume"]].concat()] {
        let second = start(&arguments, &out).wait_with_output().unwrap();
        let message = String::from_utf8(second.stderr).unwrap();
        assert_eq!(second.status.code(), Some(2), "{message}");
        assert!(message.contains(&format!("process {} on ", first.id())), "{message}");
        assert!(message.contains(" since 2"), "{message}");
    }
    // A killed run leaves no lock behind.
    first.kill().unwrap();
    first.wait().unwrap();
    let mut third = start(&[LONG, &["--resume"]].concat(), &out);
    wait_for_events(&mut third, &out, 2);
    signal(&third, "-TERM");
    assert_eq!(third.wait().unwrap().code(), Some(130));
}

#[test]
fn asked_to_stop_it_stops_within_a_second_and_can_be_resumed() {
    let scratch = tempfile::tempdir().unwrap();
    // In the development profile on a busy machine, the last training step may take longer than a second.
    let within = Duration::from_secs(if cfg!(debug_assertions) { 5 } else { 1 });
    let whole = scratch.path().join("whole");
    let code = start(TRAINING, &whole).wait().unwrap().code();
    for name in ["-TERM", "-INT"] {
        let out = scratch.path().join(name);
        let mut child = start(TRAINING, &out);
        wait_for(&mut child, &out.join("checkpoints"));
        let asked = Instant::now();
        signal(&child, name);
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert!(asked.elapsed() < within, "{:?}", asked.elapsed());
        let result: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("result.json")).unwrap()).unwrap();
        assert_eq!(result["estimate"]["reached"], "interrupted");
        assert_eq!(start(&[TRAINING, &["--resume"]].concat(), &out).wait().unwrap().code(), code);
        assert_eq!(timeless_files(&out), timeless_files(&whole));
    }
}

const SHORT: &[&str] = &["configs/pinn.toml", "fit.max_steps=3"];

#[test]
fn a_finished_run_is_left_as_it_is() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    let shown = out.to_str().unwrap();
    // Resuming a run that was never started starts it.
    let all = [SHORT, &["--out", shown, "--resume"]].concat();
    assert_eq!(trainer(&all).status.code(), Some(1));
    let files = || {
        let mut found: Vec<_> = std::fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.is_file() && !path.ends_with(".lock"))
            .map(|path| (std::fs::read(&path).unwrap(), path))
            .collect();
        found.sort();
        found
    };
    let before = files();
    let output = trainer(&all);
    let said = String::from_utf8(output.stdout).unwrap();
    // When a finished run is shown again, its failed check still counts.
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("this run is finished; nothing was changed"), "{said}");
    assert_eq!(files(), before);
    let output = trainer(&[&all[..], &["--json"]].concat());
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["steps"], 3);
    assert_eq!(files(), before);
}

#[test]
fn an_edited_configuration_is_refused_with_the_keys_that_differ() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    let shown = out.to_str().unwrap();
    trainer(&[SHORT, &["--out", shown]].concat());
    let other = ["configs/pinn.toml", "fit.max_steps=4", "estimator.hidden=[9]", "seed=1"];
    let output = trainer(&[&other[..], &["--out", shown, "--resume"]].concat());
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    for words in ["seed was 0, now 1", "fit.max_steps was 3, now 4", "estimator.hidden was [", "now [9]"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    // The advice of the message works: the run is unchanged, including its failed check.
    let config = format!("{shown}/config.toml");
    assert_eq!(trainer(&[&config, "--out", shown, "--resume"]).status.code(), Some(1));
}

#[test]
fn another_record_is_refused_with_both_digests() {
    let scratch = tempfile::tempdir().unwrap();
    let (out, record) = (scratch.path().join("run"), scratch.path().join("record.csv"));
    std::fs::copy(root().join("experiments/default-record/record.csv"), &record).unwrap();
    let path = format!("data.path={}", record.display());
    let all = [LONG, &[&path]].concat();
    let mut child = start(&all, &out);
    wait_for_events(&mut child, &out, 1);
    child.kill().unwrap();
    child.wait().unwrap();
    let text = std::fs::read_to_string(&record).unwrap();
    std::fs::write(&record, text.trim_end().rsplit_once('\n').unwrap().0).unwrap();
    let output = start(&[&all[..], &["--resume"]].concat(), &out).wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert_eq!(message.matches("sha256:").count(), 2, "{message}");
    assert!(message.contains("record.csv: the record is not the one"), "{message}");
}

#[test]
fn resuming_needs_to_know_where_and_finds_a_run_there() {
    let output = trainer(&["configs/pinn.toml", "--resume"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("--out"));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("thesis.tex"), "x").unwrap();
    let output = trainer(&["configs/pinn.toml", "--resume", "--out", folder.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("there is no run in it"));
}

/// A run that was killed while it wrote a log line has a torn last line, which is reported and left out.
#[test]
fn a_torn_last_event_is_said() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    let all = [SHORT, &["--out", out.to_str().unwrap()]].concat();
    assert_eq!(trainer(&all).status.code(), Some(1));
    let log = out.join("events.jsonl");
    let whole = std::fs::read(&log).unwrap();
    std::fs::write(&log, &whole[..whole.len() - 9]).unwrap();
    let before = timeless_files(&out);
    let output = trainer(&[&all[..], &["--resume"]].concat());
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("events.jsonl:2: a crash cut the last line short; it is left out"), "{said}");
    assert_eq!(timeless_files(&out), before);
}

/// A disk limit per file, set by the shell: the run ends with a message that names the file, and the files
/// from before are intact.
#[test]
fn a_limit_on_the_size_of_files_is_an_error_with_the_files_name() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("run");
    let script = format!(
        "trap '' XFSZ; ulimit -f 4; exec {} configs/pinn.toml fit.max_steps=3 --quiet --out {}",
        env!("CARGO_BIN_EXE_trainer"),
        out.display()
    );
    let output = Command::new("bash").args(["-c", &script]).current_dir(root()).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("cannot write"), "{message}");
    assert!(out.join("config.toml").is_file() && !out.join("result.json").exists());
    assert_eq!(
        trainer(&[SHORT, &["--out", out.to_str().unwrap(), "--resume"]].concat()).status.code(),
        Some(1)
    );
}
