//! Tests of whole runs on a disk that fails at any of its operations, and of resuming them afterwards. They
//! call the program's own functions in this process, so that the disk can be passed in.

use crate::commands::run::run_until;
use crate::error::TrainerError;
use crate::options::{ExperimentArguments, Output, RunOptions};
use crate::outcome::Outcome;
use estimator::Cancel;
use rand::RngExt;
use runs::faults::{Faults, Lasts, Refusal};
use runs::{Disk, RunFolder};
use seed::Seed;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

static NOBODY: Cancel = Cancel::new();

/// Writes the first two seconds of the shipped record beside a run's folder: each of a thousand runs reads
/// and draws them.
fn record(root: &Path, out: &Path) -> PathBuf {
    let path = out.with_file_name("record.csv");
    if !path.exists() {
        let shipped = std::fs::read_to_string(root.join("experiments/default-record/record.csv")).unwrap();
        let begin: Vec<&str> = shipped.lines().take(500).collect();
        std::fs::write(&path, begin.join("\n")).unwrap();
    }
    path
}

fn arguments(overrides: &[&str], out: &Path, resume: bool, disk: Disk) -> ExperimentArguments {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut all = vec![format!("data.path={}", record(&root, out).display())];
    all.extend(overrides.iter().map(|&text| text.to_owned()));
    let file = if overrides.iter().any(|text| text.starts_with("compare.")) { "compare" } else { "pinn" };
    ExperimentArguments {
        config: Some(root.join(format!("configs/{file}.toml"))),
        overrides: all,
        run: RunOptions { out: Some(out.to_owned()), resume, seed: None, threads: Some(1) },
        output: Output { quiet: true, json: false },
        disk,
    }
}

fn run(overrides: &[&str], out: &Path, resume: bool, disk: &Disk) -> Result<Outcome, TrainerError> {
    run_until(&arguments(overrides, out, resume, disk.clone()), &NOBODY)
}

/// A short run with every part: several fits, states stored within them, and a trained model.
const ESTIMATION: &[&str] =
    &["fit.seeds=2", "fit.max_steps=2", "estimator.hidden=[3]", "checkpoint.interval_s=0"];

/// The same with several methods, one of which stores no state within a fit.
const COMPARISON: &[&str] = &["compare.methods=ols,neural-ode", "fit.max_steps=1", "checkpoint.interval_s=0"];

/// Creates a folder for tests, in memory if possible, since every run waits for the disk a hundred times.
fn scratch() -> TempDir {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { TempDir::new_in(memory).unwrap() } else { TempDir::new().unwrap() }
}

/// Reads every file of a folder except those that record times; times are removed from the others.
fn timeless(folder: &Path) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(place) = folders.pop() {
        for entry in std::fs::read_dir(place).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_owned();
            if path.is_dir() {
                folders.push(path);
            } else if name == Path::new("result.json") {
                let mut value: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
                forget_seconds(&mut value);
                found.insert(name, value.to_string());
            } else if !["events.jsonl", "report.html", "tables.md", "table.tex", ".lock"]
                .contains(&name.to_str().unwrap())
            {
                found.insert(name, format!("{:?}", std::fs::read(&path).unwrap()));
            }
        }
    }
    found
}

fn forget_seconds(value: &mut Value) {
    match value {
        Value::Object(entries) => {
            entries.remove("seconds");
            entries.values_mut().for_each(forget_seconds);
        }
        Value::Array(entries) => entries.iter_mut().for_each(forget_seconds),
        _ => {}
    }
}

/// Lets operations of a run fail in turn, every so many of them once and every so many from then on. A file is written by five
/// operations, so that steps that are no multiple of five meet each kind. Every file that exists afterwards
/// is whole, the message names a file, and the run resumed on a sound disk ends as an undisturbed one.
fn fails_anywhere_and_is_resumed(overrides: &[&str], once: usize, for_good: usize) {
    let root = scratch();
    let sound = root.path().join("sound");
    let faults = Arc::new(Faults::none());
    let expected_outcome = run(overrides, &sound, false, &Disk::failing(Arc::clone(&faults))).unwrap();
    let expected = timeless(&sound);
    let operations = faults.asked();
    assert!(operations > 60, "{operations}");
    assert!(!sound.join("checkpoints").exists());
    for (refusal, lasts, stride) in
        [(Refusal::Device, Lasts::Once, once), (Refusal::Full, Lasts::ForGood, for_good)]
    {
        for first in (0..operations).step_by(stride) {
            let out = root.path().join(format!("{refusal:?}-{lasts:?}-{first}"));
            let disk = Disk::failing(Arc::new(Faults::new(first, refusal, lasts)));
            let error = run(overrides, &out, false, &disk).unwrap_err();
            let message = error.to_string();
            assert!(message.starts_with(&out.display().to_string()), "{first}: {message}");
            assert_ne!(error.exit_code(), 0, "{first}: {message}");
            if out.is_dir() {
                for (name, content) in timeless(&out) {
                    let is_checkpoint = name.starts_with("checkpoints");
                    assert!(
                        is_checkpoint || expected.get(&name) == Some(&content),
                        "{first}: {name:?} {message}"
                    );
                }
            }
            // This also holds if the flush of the last event failed, or the cleanup after it.
            let again = run(overrides, &out, true, &Disk::default()).unwrap();
            assert_eq!(again, expected_outcome, "{first}: {message}");
            let found = timeless(&out);
            for (name, content) in &expected {
                assert_eq!(found.get(name), Some(content), "{first}: {name:?} {message}");
            }
            std::fs::remove_dir_all(out).unwrap_or_default();
        }
    }
}

#[test]
fn an_estimation_survives_every_operation_of_the_disk_failing() {
    fails_anywhere_and_is_resumed(ESTIMATION, 1, 3);
}

#[test]
fn a_comparison_survives_a_failing_disk() {
    fails_anywhere_and_is_resumed(COMPARISON, 4, 7);
}

/// A disk that fails while a run is resumed does no more harm.
#[test]
fn resuming_survives_every_operation_of_the_disk_failing() {
    let root = scratch();
    let sound = root.path().join("sound");
    run(ESTIMATION, &sound, false, &Disk::default()).unwrap();
    let expected = timeless(&sound);
    let half = root.path().join("half");
    let killed = Disk::failing(Arc::new(Faults::new(60, Refusal::Device, Lasts::ForGood)));
    run(ESTIMATION, &half, false, &killed).unwrap_err();
    let begun = |name: &str| {
        let out = root.path().join(name);
        copied(&half, &out);
        out
    };
    let faults = Arc::new(Faults::none());
    run(ESTIMATION, &begun("counted"), true, &Disk::failing(Arc::clone(&faults))).unwrap();
    for first in 0..faults.asked() {
        let out = begun(&format!("at {first}"));
        let failing = Disk::failing(Arc::new(Faults::new(first, Refusal::Full, Lasts::ForGood)));
        assert!(run(ESTIMATION, &out, true, &failing).unwrap_err().exit_code() != 0);
        run(ESTIMATION, &out, true, &Disk::default()).unwrap();
        for (name, content) in &expected {
            assert_eq!(timeless(&out).get(name), Some(content), "{first}: {name:?}");
        }
    }
}

/// The run is killed every sixty operations, enough to begin, to take a step or two and to write the results.
#[test]
fn killed_again_and_again_it_gets_there() {
    let root = scratch();
    let (sound, out) = (root.path().join("sound"), root.path().join("out"));
    let long = [ESTIMATION, &["fit.max_steps=20", "fit.seeds=4"]].concat();
    let outcome = run(&long, &sound, false, &Disk::default()).unwrap();
    let mut attempts = 0;
    let reached = loop {
        attempts += 1;
        let disk = Disk::failing(Arc::new(Faults::new(60, Refusal::Device, Lasts::ForGood)));
        if let Ok(reached) = run(&long, &out, true, &disk) {
            break reached;
        }
        assert!(attempts < 100);
    };
    assert!(attempts > 3, "{attempts}");
    assert_eq!(reached, outcome);
    let found = timeless(&out);
    for (name, content) in timeless(&sound) {
        assert_eq!(found.get(&name), Some(&content), "{name:?} after {attempts}");
    }
}

/// Creates the folder of a run that was killed within its second fit.
fn half_done(root: &Path) -> PathBuf {
    let out = root.join("half");
    let counted = Arc::new(Faults::none());
    run(ESTIMATION, &root.join("whole"), false, &Disk::failing(Arc::clone(&counted))).unwrap();
    let most = counted.asked() * 3 / 5;
    let disk = Disk::failing(Arc::new(Faults::new(most, Refusal::Device, Lasts::ForGood)));
    run(ESTIMATION, &out, false, &disk).unwrap_err();
    let kept: Vec<String> = std::fs::read_dir(out.join("checkpoints"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(
        kept.iter().any(|name| name.starts_with("finished-"))
            && kept.iter().any(|name| name.ends_with(".state"))
    );
    out
}

/// Flips a byte and cuts the file, at every `stride`-th byte of every file that resuming reads. The file is
/// refused by its name or, for the log, the last line is dropped. There is never a panic and never another
/// result.
fn damaged_files_are_refused(stride: usize) {
    let root = scratch();
    let out = half_done(root.path());
    let expected = timeless(&root.path().join("whole"));
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(out.join("checkpoints")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.extend(["config.toml", "events.jsonl"].map(|name| out.join(name)));
    for path in files {
        let whole = std::fs::read(&path).unwrap();
        let log = std::fs::read(out.join("events.jsonl")).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        for at in (0..whole.len()).step_by(stride) {
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << (at % 8);
            for (kind, bytes) in [("flipped at", &flipped[..]), ("cut at", &whole[..at])] {
                std::fs::write(&path, bytes).unwrap();
                match run(ESTIMATION, &out, true, &Disk::default()) {
                    Err(error) => {
                        let message = error.to_string();
                        assert!(message.contains(name), "{name} {kind} {at}: {message}");
                        assert_eq!(error.exit_code(), 2, "{message}");
                    }
                    // A log without its last line is that of a run that was killed a moment before.
                    Ok(_) => {
                        assert_eq!(name, "events.jsonl", "{name} {kind} {at}");
                        let found = timeless(&out);
                        assert!(expected.iter().all(|(name, content)| found.get(name) == Some(content)));
                        std::fs::remove_dir_all(root.path().join("half")).unwrap();
                        std::fs::remove_dir_all(root.path().join("whole")).unwrap();
                        half_done(root.path());
                    }
                }
                // A refused run has added nothing.
                if path.exists() {
                    std::fs::write(&path, &whole).unwrap();
                }
                std::fs::write(out.join("events.jsonl"), &log).unwrap();
            }
        }
    }
    run(ESTIMATION, &out, true, &Disk::default()).unwrap();
}

#[test]
fn damaged_checkpoints_logs_and_configurations_are_refused_by_name() {
    damaged_files_are_refused(41);
}

/// Run with `cargo test -p trainer --bin trainer every_byte -- --ignored`.
#[test]
#[ignore = "every byte takes minutes"]
fn every_byte_of_checkpoints_logs_and_configurations_counts() {
    damaged_files_are_refused(1);
}

#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let root = scratch();
    let out = half_done(root.path());
    let other = root.path().join("other");
    let counted = Disk::failing(Arc::new(Faults::new(60, Refusal::Device, Lasts::ForGood)));
    run(&[ESTIMATION, &["seed=7"]].concat(), &other, false, &counted).unwrap_err();
    for entry in std::fs::read_dir(out.join("checkpoints")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, other.join("checkpoints").join(path.file_name().unwrap())).unwrap();
    }
    let message =
        run(&[ESTIMATION, &["seed=7"]].concat(), &other, true, &Disk::default()).unwrap_err().to_string();
    assert!(message.contains("belongs to another run"), "{message}");
}

/// Copies a run's folder.
fn copied(from: &Path, to: &Path) {
    for folder in [PathBuf::new(), PathBuf::from("checkpoints")] {
        std::fs::create_dir_all(to.join(&folder)).unwrap();
        for entry in std::fs::read_dir(from.join(&folder)).unwrap().map(Result::unwrap) {
            if entry.path().is_file() {
                std::fs::copy(entry.path(), to.join(&folder).join(entry.file_name())).unwrap();
            }
        }
    }
}

/// Returns the bytes with one of them changed, some left out, some repeated, or the rest cut off.
fn garbled(bytes: &[u8], generator: &mut impl rand::Rng) -> Vec<u8> {
    let at = generator.random_range(0..bytes.len());
    let to = generator.random_range(at..=bytes.len().min(at + 9));
    let mut found = bytes.to_vec();
    match generator.random_range(0..5) {
        0 => found[at] ^= 1 << generator.random_range(0..8),
        1 => found[at..to].fill(0xff),
        2 => _ = found.drain(at..to),
        3 => found.extend_from_slice(&bytes[at..]),
        _ => found.truncate(at),
    }
    found
}

/// A sealed checkpoint with a content from another build of the program, or edited by hand, is refused or
/// resumed; it never causes a panic.
#[test]
fn a_sealed_checkpoint_may_hold_anything() {
    let root = scratch();
    let half = half_done(root.path());
    let names = RunFolder::open(&half).checkpoints().unwrap();
    let mut generator = Seed::new(21).generator();
    let mut refused = 0;
    for number in 0..60 {
        let out = root.path().join(number.to_string());
        copied(&half, &out);
        let folder = RunFolder::open(&out);
        let name = &names[number % names.len()];
        let content = folder.read_checkpoint(name).unwrap().unwrap();
        folder.write_checkpoint(name, &garbled(&content, &mut generator)).unwrap();
        if let Err(error) = run(ESTIMATION, &out, true, &Disk::default()) {
            refused += 1;
            assert_eq!(error.exit_code(), 2, "{error}");
        }
        std::fs::remove_dir_all(&out).unwrap();
    }
    assert!(refused > 30, "{refused}");
}

/// Checkpoints are numbered upward from the last one. A last number with no successor used to end the
/// program.
#[test]
fn the_last_number_of_a_checkpoint_is_no_end() {
    let root = scratch();
    let out = half_done(root.path());
    let folder = out.join("checkpoints");
    std::fs::rename(folder.join("finished-000000"), folder.join(format!("finished-{}", u64::MAX))).unwrap();
    run(ESTIMATION, &out, true, &Disk::default()).unwrap();
}
