use super::{RunFolder, default_root};
use crate::disk::Disk;
use crate::error::RunError;
use crate::faults::{Faults, Lasts, Refusal};
use std::sync::Arc;

#[test]
fn two_runs_never_share_a_folder() {
    let root = tempfile::tempdir().unwrap();
    let one = RunFolder::create(root.path(), "a/b c").unwrap();
    let other = RunFolder::create(root.path(), "a/b c").unwrap();
    assert_ne!(one.path(), other.path());
    let name = one.path().file_name().unwrap().to_string_lossy().into_owned();
    assert!(name.starts_with("a-b-c-2"), "{name}");
}

#[test]
fn a_folder_with_something_in_it_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let folder = RunFolder::create_at(&root.path().join("new")).unwrap();
    folder.write("model/x.bin", b"1").unwrap();
    let path = folder.path().to_owned();
    drop(folder);
    let again = RunFolder::create_at(&path);
    assert!(matches!(again, Err(RunError::Occupied { .. })));
    assert!(matches!(RunFolder::check_free(&path), Err(RunError::Occupied { .. })));
    assert!(RunFolder::check_free(&root.path().join("absent")).is_ok());
    assert_eq!(std::fs::read(path.join("model/x.bin")).unwrap(), b"1");
}

#[test]
fn a_file_in_the_way_is_an_error_with_its_name() {
    let root = tempfile::tempdir().unwrap();
    let file = root.path().join("file");
    std::fs::write(&file, "x").unwrap();
    let message = RunFolder::create_at(&file).unwrap_err().to_string();
    assert!(message.contains("file: cannot create"), "{message}");
}

#[test]
fn a_run_spans_its_events_and_a_line_cut_short_is_none() {
    let root = tempfile::tempdir().unwrap();
    let line = |second: u8| format!("{{\"time\":\"2026-01-01T00:00:{second:02}.5Z\",\"event\":\"x\"}}\n");
    std::fs::write(root.path().join("events.jsonl"), line(1) + &line(3) + "{\"time\":").unwrap();
    let (began, ended) = RunFolder::open(root.path()).span_ms().unwrap();
    assert_eq!((began, ended - began), (1_767_225_601_500, 2000));
    std::fs::write(root.path().join("events.jsonl"), "").unwrap();
    assert!(matches!(RunFolder::open(root.path()).span_ms(), Err(RunError::Encoding { .. })));
}

#[test]
fn events_are_lines() {
    let root = tempfile::tempdir().unwrap();
    let folder = RunFolder::create_at(root.path()).unwrap();
    folder.record_event("one", &1).unwrap();
    folder.record_event("two", &"a\nb").unwrap();
    let text = std::fs::read_to_string(root.path().join("events.jsonl")).unwrap();
    assert_eq!(text.lines().count(), 2);
    let log = folder.events().unwrap();
    assert_eq!(log.events.len(), 2);
    assert_eq!(log.last("two").unwrap().details, "a\nb");
}

/// Each operation of a write fails in turn: afterwards the file has either its old content or all of its new
/// content.
#[test]
fn a_write_that_fails_anywhere_leaves_the_old_file_or_the_new_one() {
    for refusal in [Refusal::Device, Refusal::Full] {
        let mut met = Vec::new();
        for first in 0.. {
            let root = tempfile::tempdir().unwrap();
            let path = root.path().join("result.json");
            std::fs::write(&path, "old").unwrap();
            let faults = Arc::new(Faults::new(first, refusal, Lasts::Once));
            let mut folder = RunFolder::open(root.path());
            folder.disk = Disk::failing(Arc::clone(&faults));
            let outcome = folder.write("result.json", b"the new content");
            let content = std::fs::read_to_string(&path).unwrap();
            let Err(error) = outcome else {
                assert_eq!(content, "the new content");
                assert_eq!(faults.asked(), first);
                break;
            };
            let message = error.to_string();
            assert!(message.contains("result.json: cannot "), "{message}");
            let expected = if message.contains("folder of") { "the new content" } else { "old" };
            assert_eq!(content, expected, "{message}");
            assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 1, "{message}");
            met.push(message);
        }
        for action in ["create:", "write:", "permissions of:", "flush:", "into place:", "the folder of:"] {
            assert!(met.iter().any(|message| message.contains(action)), "{action} {met:?}");
        }
    }
}

#[test]
fn what_a_killed_program_was_writing_is_taken_away_and_nothing_else() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("run");
    let folder = RunFolder::create_at(&path).unwrap();
    folder.write_checkpoint("pinn-0.state", b"half way").unwrap();
    for name in [".tmpX1", "checkpoints/.tmpX2", "checkpoints/tmp"] {
        std::fs::write(path.join(name), "x").unwrap();
    }
    assert!(matches!(RunFolder::resume_on(&Disk::default(), &path), Err(RunError::Locked { .. })));
    drop(folder);
    let folder = RunFolder::resume_on(&Disk::default(), &path).unwrap();
    assert_eq!(folder.checkpoints().unwrap(), ["pinn-0.state", "tmp"]);
    assert!(!path.join(".tmpX1").exists());
    assert_eq!(folder.read_checkpoint("pinn-0.state").unwrap().unwrap(), b"half way");
    assert_eq!(folder.read_checkpoint("other").unwrap(), None);
    let message = folder.read_checkpoint("tmp").unwrap_err().to_string();
    assert!(message.contains("checkpoints/tmp: the checkpoint is damaged"), "{message}");
    folder.remove("checkpoints/tmp").unwrap();
    folder.remove("checkpoints/tmp").unwrap();
    assert_eq!(folder.checkpoints().unwrap(), ["pinn-0.state"]);
    // A checkpoint that exists and cannot be read is not treated as missing.
    std::fs::create_dir(folder.checkpoint_path("a folder")).unwrap();
    assert!(matches!(folder.read_checkpoint("a folder"), Err(RunError::Io { .. })));
    folder.remove_checkpoints().unwrap();
    assert!(folder.checkpoints().unwrap().is_empty());
}

#[test]
fn a_folder_at_work_is_named_before_it_is_called_occupied() {
    let root = tempfile::tempdir().unwrap();
    let first = RunFolder::create_at(root.path()).unwrap();
    for _ in 0..2 {
        let message = RunFolder::create_at(root.path()).unwrap_err().to_string();
        assert!(message.contains("is working in it"), "{message}");
        first.write("config.toml", b"").unwrap();
    }
    drop(first);
    assert!(matches!(RunFolder::create_at(root.path()), Err(RunError::Occupied { .. })));
}

#[test]
fn what_a_folder_holds_besides_its_lock_is_told() {
    let root = tempfile::tempdir().unwrap();
    let folder = RunFolder::create_at(root.path()).unwrap();
    assert!(folder.holds_only(&[]).unwrap());
    folder.write("config.toml", b"").unwrap();
    assert!(folder.holds_only(&["config.toml", "events.jsonl"]).unwrap());
    assert!(!folder.holds_only(&["events.jsonl"]).unwrap());
}

/// Git ignores the default folder of runs.
#[test]
fn kept_runs_are_not_part_of_the_project() {
    let ignored = include_str!("../../../../.gitignore");
    let root = default_root();
    assert!(ignored.lines().any(|line| line.trim_start_matches('/') == root.display().to_string()));
}

/// Fields of [`Texts`](crate::Texts) and the files that they hold.
const TEXTS: [(&str, &str); 8] = [
    ("config", "config.toml"),
    ("result", "result.json"),
    ("trace", "trace.csv"),
    ("envelope", "envelope.csv"),
    ("predictions", "predictions.csv"),
    ("series", "series.csv"),
    ("environment", "environment.json"),
    ("name", ""),
];

fn texts(folder: &RunFolder) -> Vec<(&'static str, String)> {
    let found = folder.texts().unwrap();
    let texts = [
        found.config,
        found.result,
        found.trace,
        found.envelope,
        found.predictions,
        found.series,
        found.environment,
        found.name,
    ];
    TEXTS.into_iter().map(|(name, _)| name).zip(texts).collect()
}

#[test]
fn a_report_is_made_of_the_folder_s_files_and_tables_may_be_absent() {
    let root = tempfile::tempdir().unwrap();
    let folder = RunFolder::create_at(&root.path().join("a run")).unwrap();
    let files = || TEXTS.into_iter().filter(|(_, file)| !file.is_empty());
    let tables = |file: &str| file.ends_with(".csv");
    for (_, file) in files().filter(|(_, file)| !tables(file)) {
        assert!(matches!(folder.texts(), Err(RunError::Io { .. })), "without {file}");
        folder.write(file, file.as_bytes()).unwrap();
        assert_eq!(folder.read(file).unwrap(), file.as_bytes());
    }
    for (name, text) in texts(&folder) {
        let (_, file) = TEXTS.into_iter().find(|(known, _)| *known == name).unwrap();
        let expected = if name == "name" {
            "a run"
        } else if tables(file) {
            ""
        } else {
            file
        };
        assert_eq!(text, expected, "{name}");
    }
    for (_, file) in files().filter(|(_, file)| tables(file)) {
        folder.write(file, file.as_bytes()).unwrap();
    }
    for (name, text) in texts(&folder).into_iter().filter(|(name, _)| *name != "name") {
        assert!(TEXTS.contains(&(name, text.as_str())), "{name}: {text}");
    }
    // A table that exists and cannot be read is not treated as missing.
    std::fs::remove_file(folder.path().join("trace.csv")).unwrap();
    std::fs::create_dir(folder.path().join("trace.csv")).unwrap();
    assert!(folder.texts().unwrap_err().to_string().contains("trace.csv"));
    assert!(matches!(folder.read("absent"), Err(RunError::Io { .. })));
}

#[test]
fn a_diagnosis_is_shown_by_its_own_files() {
    let root = tempfile::tempdir().unwrap();
    let folder = RunFolder::create_at(root.path()).unwrap();
    for (file, text) in [("diagnosis.json", "a"), ("environment.json", "b"), ("result.json", "not this one")]
    {
        folder.write(file, text.as_bytes()).unwrap();
    }
    let found = folder.texts().unwrap();
    assert_eq!((found.result.as_str(), found.environment.as_str(), found.config.as_str()), ("a", "b", ""));
    folder.write("repaired.toml", b"c").unwrap();
    assert_eq!(folder.texts().unwrap().config, "c");
}
