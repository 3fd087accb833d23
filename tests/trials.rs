//! Tests of `trainer trials`: blind answers, tamper-proof seals, and resuming after an interruption.

use crate::support::{number, result, root, trainer};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{LazyLock, Mutex};
use std::time::{Duration, SystemTime};
use tempfile::TempDir;

/// Eight short cases.
const TINY: &[&str] = &[
    "configs/trials-quick.toml",
    "trials.none=1",
    "trials.calibration=1",
    "trials.single=3",
    "trials.pair=1",
    "trials.left_out=0",
    "trials.foreign=1",
    "trials.releases=1",
    "trials.driven=0",
    "trials.stressed=0",
    "trials.measured_cases=0",
    "trials.engine_cases=0",
    "trials.composite=0",
    "trials.rigs_cases=0",
    "record.seconds=5",
    "record.rate_hz=130",
];

/// Scores of [`TINY`] by one process, and their folder, which the test that changes it takes.
static WHOLE: LazyLock<(Value, Mutex<Option<TempDir>>)> = LazyLock::new(|| {
    let (code, scores, folder) = result(&[&["trials"], TINY].concat());
    assert_eq!(code, 0, "{scores}");
    (scores, Mutex::new(Some(folder)))
});

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Returns every answer below a folder by case, without wall times.
fn answers(folder: &Path) -> BTreeMap<String, Value> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .map(|path| {
            let mut answer = json(&path.join("diagnosis.json"));
            let fields = answer.as_object_mut().unwrap();
            fields.remove("seconds");
            fields.remove("stages");
            (path.file_name().unwrap().to_string_lossy().into_owned(), answer)
        })
        .collect()
}

fn without_times(mut scores: Value) -> Value {
    let fields = scores.as_object_mut().unwrap();
    fields.remove("seconds");
    fields.remove("seconds_per_case");
    let bars = fields["bars"].as_array_mut().unwrap();
    bars.retain(|bar| bar["unit"] != "s");
    scores
}

fn written(folder: &Path) -> BTreeMap<String, SystemTime> {
    answers(folder)
        .into_keys()
        .map(|id| {
            let file = folder.join(&id).join("diagnosis.json");
            (id, file.metadata().unwrap().modified().unwrap())
        })
        .collect()
}

/// Returns the exit code and the messages on standard error.
fn said(arguments: &[&str]) -> (i32, String) {
    let output = trainer(arguments);
    (output.status.code().unwrap(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Sends SIGINT to a scoring that has opened its first cases.
fn scoring_stops_when_told(out: &str) {
    let spoken = tempfile::NamedTempFile::new().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_trainer"))
        .args(["trials", "--score", out, "--threads", "1"])
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(spoken.reopen().unwrap())
        .spawn()
        .unwrap();
    let said = || std::fs::read_to_string(spoken.path()).unwrap();
    while !said().contains("cases opened") {
        assert!(child.try_wait().unwrap().is_none(), "{}", said());
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130), "{}", said());
    assert!(said().contains("every answer is kept"), "{}", said());
}

#[test]
fn trials_are_blind_sealed_and_resumable() {
    let (scores, folder) = (WHOLE.0.clone(), WHOLE.1.lock().unwrap().take().unwrap());
    assert_eq!(scores["schema"], "ringdown.trials/1");
    assert_eq!((number(&scores, "/cases"), number(&scores, "/unanswered")), (8.0, 0.0));
    let root = folder.path();
    let out = root.to_str().unwrap();
    let full = root.join("answers/full");

    // The inputs of the diagnosis do not reveal what they hide, and the truth was sealed before.
    for case in std::fs::read_dir(root.join("cases/full")).unwrap() {
        for file in std::fs::read_dir(case.unwrap().path()).unwrap() {
            let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
            for word in ["friction", "drag", "gravity", "backlash", "bank", "hidden", "detectability"] {
                assert!(!text.contains(word), "{word}");
            }
        }
    }
    let events = std::fs::read_to_string(root.join("events.jsonl")).unwrap();
    let order: Vec<String> = events
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap()["event"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(order, ["start", "sealed", "opened", "end"]);
    let manifest = json(&root.join("manifest.json"));
    for line in manifest["cases"].as_array().unwrap() {
        let id = line["id"].as_str().unwrap();
        let text = std::fs::read_to_string(root.join(format!("truth/{id}.json"))).unwrap();
        assert_eq!(line["truth_digest"], truth::digest(&text));
    }
    assert_eq!(std::fs::read_to_string(root.join("cases.csv")).unwrap().lines().count(), 9);
    assert!(std::fs::read_to_string(root.join("report.html")).unwrap().contains("Targets and results"));

    // Scoring again from the files alone gives the same scores; with a changed truth it is refused, and the
    // truth is named.
    let again = trainer(&["trials", "--score", out, "--json"]);
    assert_eq!(again.status.code(), Some(0));
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    let first_scores = without_times(scores);
    assert_eq!(without_times(again), first_scores);
    scoring_stops_when_told(out);
    let truth = root.join("truth/000003.json");
    let text = std::fs::read_to_string(&truth).unwrap();
    std::fs::write(&truth, text.replacen("\"miscalibrated\": ", "\"miscalibrated\":  ", 1)).unwrap();
    let (code, message) = said(&["trials", "--score", out]);
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("truth/000003.json: the seal is broken"), "{message}");

    // Without any truth on the disk the diagnosis gives the same answers, to the bit.
    std::fs::remove_dir_all(root.join("truth")).unwrap();
    let blind = root.join("blind");
    let (cases, blind_out) = (root.join("cases/full"), blind.to_str().unwrap());
    let (code, message) =
        said(&["diagnose", "--batch", cases.to_str().unwrap(), "--out", blind_out, "--quiet"]);
    assert_eq!(code, 0, "{message}");
    assert_eq!(answers(&blind), answers(&full));

    // After two answers are removed, resuming computes these two and leaves the others unchanged.
    let before = written(&full);
    for id in ["000002", "000006"] {
        std::fs::remove_dir_all(full.join(id)).unwrap();
    }
    let resume = [&["trials"], TINY, &["--out", out, "--resume"]].concat();
    let resumed = trainer(&[&resume[..], &["--json"]].concat());
    assert_eq!(resumed.status.code(), Some(0), "{}", String::from_utf8_lossy(&resumed.stderr));
    let resumed: Value = serde_json::from_slice(&resumed.stdout).unwrap();
    assert_eq!(without_times(resumed), first_scores);
    for (id, time) in written(&full) {
        assert_eq!(time == before[&id], !["000002", "000006"].contains(&id.as_str()), "{id}");
    }

    // Now the truths are open, so that no further answer would be blind.
    std::fs::remove_dir_all(full.join("000002")).unwrap();
    let (code, message) = said(&resume);
    assert!(code == 2 && message.contains("the truths are open, and 1 answers are missing"), "{message}");

    // Only the values matter, not the place where each was written: the folder's own configuration is the
    // original one.
    let own = root.join("config.toml");
    let (code, message) = said(&["trials", own.to_str().unwrap(), "--out", out, "--resume"]);
    assert!(code == 2 && message.contains("the truths are open"), "{message}");

    // Another configuration is another experiment.
    let (code, message) = said(&[&resume[..], &["trials.single=4"]].concat());
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("config.toml") && message.contains("single = 3"), "{message}");
    let (code, message) = said(&resume[..resume.len() - 1]);
    assert!(code == 2 && message.contains("--resume"), "{message}");
}

/// Shares run at the same time on one folder: each case is made once, no truth is opened before the last
/// answer, and the scores are those of one process.
#[test]
fn shares_give_the_scores_of_one_process_and_the_last_one_opens_the_seals() {
    let whole = WHOLE.0.clone();
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("trials").to_str().unwrap().to_owned();
    let words =
        |share: &'static str| [&["trials"], TINY, &["--shard", share, "--json", "--out", &out]].concat();
    let first = trainer(&words("1/3"));
    assert_eq!(first.status.code(), Some(0), "{}", String::from_utf8_lossy(&first.stderr));
    let told: Value = serde_json::from_slice(&first.stdout).unwrap();
    assert_eq!(
        (&told["task"], &told["shard"], &told["cases"]),
        (&"trials-share".into(), &"1/3".into(), &8.into())
    );
    let answered = answers(&Path::new(&out).join("answers/full")).len() as u64;
    assert!(answered > 0 && told["open"].as_u64() == Some(8 - answered), "{told}");
    assert!(!Path::new(&out).join("truth").exists() && !Path::new(&out).join("result.json").exists());

    let others = ["2/3", "3/3"].map(|share| {
        Command::new(env!("CARGO_BIN_EXE_trainer"))
            .args(words(share))
            .current_dir(root())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    });
    for mut other in others {
        assert_eq!(other.wait().unwrap().code(), Some(0));
    }
    let scores = json(&Path::new(&out).join("result.json"));
    // The command to run a failed case again contains the folder's name.
    let without_commands = |scores: Value| {
        let mut scores = without_times(scores);
        for failure in scores["failures"].as_array_mut().unwrap() {
            failure.as_object_mut().unwrap().remove("command");
        }
        scores
    };
    assert_eq!(without_commands(scores), without_commands(whole));
    let events = std::fs::read_to_string(Path::new(&out).join("events.jsonl")).unwrap();
    let count = |event: &str| events.matches(&format!("\"event\":\"{event}\"")).count();
    assert_eq!((count("start"), count("sealed"), count("opened"), count("end")), (1, 1, 1, 1), "{events}");
}

#[test]
fn what_is_no_trials_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (code, message) = said(&["trials", "--score", folder.path().to_str().unwrap()]);
    assert!(code == 2 && message.contains("manifest.json is missing"), "{message}");
}

/// For a law too small to be detected, `unknown` would be right, but nothing is reported.
#[test]
fn a_gate_that_is_missed_fails_the_run_and_its_scoring() {
    let scratch = tempfile::tempdir().unwrap();
    let gate = |out: &Path, unknown: &str| {
        let shown = out.display().to_string();
        let least = format!("gate.unknown={unknown}");
        let own = [
            "configs/trials-gate.toml",
            "trials.composite=0",
            "trials.none=1",
            "trials.foreign=1",
            "trials.detectabilities=[0.2]",
            "record.seconds=8",
            &least,
            "--out",
            &shown,
            "--quiet",
        ];
        said(&[&["trials"], &own[..]].concat()).0
    };
    let (missed, met) = (scratch.path().join("missed"), scratch.path().join("met"));
    assert_eq!((gate(&missed, "1.0"), gate(&met, "0.0")), (1, 0));
    for (folder, code, state) in [(&missed, 1, "not met"), (&met, 0, "met")] {
        assert_eq!(said(&["trials", "--score", folder.to_str().unwrap(), "--quiet"]).0, code);
        let rows = &json(&folder.join("result.json"))["gate"];
        let row =
            rows.as_array().unwrap().iter().find(|row| row["metric"].as_str().unwrap().contains("unknown"));
        assert_eq!(row.unwrap()["state"], state);
    }
}
