//! Log of a run's events with their times, `events.jsonl`, in which any change of a line is detected.
//!
//! Every line ends in a digest of itself and of the previous digest. Only the last line can have been cut
//! short by a crash, and it then lacks a line break; it is skipped and reported. Any other mismatch is an
//! error.

use crate::digest::hexadecimal;
use crate::disk::Disk;
use crate::error::RunError;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::io::ErrorKind;
use std::path::Path;

/// Name of the log file.
pub(crate) const EVENTS: &str = "events.jsonl";

/// Event, one line of the log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Time in UTC.
    pub time: String,
    /// Name of the event, such as `start`.
    pub event: String,
    /// Data that belong to the event.
    #[serde(default)]
    pub details: Value,
}

/// Log of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EventLog {
    /// Events of the complete lines, in order.
    pub events: Vec<Event>,
    /// Number of the last line, counted from 1, if a crash cut it short.
    pub torn_line: Option<usize>,
    /// Complete lines as text.
    text: String,
    /// Digest of the last complete line.
    digest: String,
}

impl EventLog {
    /// Returns the last event with the given name.
    #[must_use]
    pub fn last(&self, event: &str) -> Option<&Event> {
        self.events.iter().rev().find(|known| known.event == event)
    }

    /// Reads a log; a missing file gives an empty log.
    pub(crate) fn read(path: &Path) -> Result<Self, RunError> {
        let bytes = match std::fs::read(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::default()),
            other => other.map_err(RunError::io(path, "read"))?,
        };
        Self::parse(path, &bytes)
    }

    fn parse(path: &Path, bytes: &[u8]) -> Result<Self, RunError> {
        let mut log = Self::default();
        for (at, line) in lines(bytes).enumerate() {
            let Some(line) = line.strip_suffix(b"\n") else {
                log.torn_line = Some(at + 1);
                break;
            };
            let refused = |problem: &str| RunError::Log {
                path: path.to_owned(),
                line: at + 1,
                problem: problem.to_owned(),
            };
            let line = str::from_utf8(line).map_err(|_| refused("it is no text"))?;
            let (body, stated) = line
                .strip_suffix("\"}")
                .and_then(|line| line.rsplit_once(",\"digest\":\""))
                .ok_or_else(|| refused("it does not end in a digest"))?;
            let digest = chained(&log.digest, body);
            if digest != stated {
                return Err(refused("its digest does not match its text"));
            }
            log.events.push(event(line.as_bytes()).map_err(|error| refused(&error.to_string()))?);
            log.text.push_str(line);
            log.text.push('\n');
            log.digest = digest;
        }
        Ok(log)
    }

    /// Appends a line to the file. An incomplete last line is replaced.
    ///
    /// The file is locked meanwhile: the shares of a sweep write into one log, and each line's digest depends
    /// on the previous line.
    pub(crate) fn append(path: &Path, disk: &Disk, event: &Event) -> Result<(), RunError> {
        let mut file = disk.open_to_append(path).map_err(RunError::io(path, "open"))?;
        file.lock().map_err(RunError::io(path, "lock"))?;
        let log = Self::read(path)?;
        let text = serde_json::to_string(event).map_err(|error| RunError::Encoding {
            name: path.display().to_string(),
            problem: error.to_string(),
        })?;
        let body = text.strip_suffix('}').unwrap_or(&text);
        let line = format!("{body},\"digest\":\"{}\"}}\n", chained(&log.digest, body));
        if log.torn_line.is_some() {
            // Truncated in place: a process that waits for the lock waits for this file, and would write into
            // a file that is no longer in use if another one replaced it.
            disk.shorten(&file, log.text.len() as u64).map_err(RunError::io(path, "shorten"))?;
        }
        disk.write(&mut file, line.as_bytes()).map_err(RunError::io(path, "write"))?;
        disk.flush(&file).map_err(RunError::io(path, "flush"))?;
        match path.parent() {
            Some(folder) if log.events.is_empty() => {
                disk.flush_folder(folder).map_err(RunError::io(path, "flush the folder of"))
            }
            _ => Ok(()),
        }
    }
}

/// Splits a text into lines, each with its line break if it has one.
fn lines(bytes: &[u8]) -> impl DoubleEndedIterator<Item = &[u8]> {
    bytes.split_inclusive(|byte| *byte == b'\n')
}

fn event(line: &[u8]) -> Result<Event, serde_json::Error> {
    serde_json::from_slice(line)
}

/// Returns the readable events of a log, for displaying them: damaged and incomplete lines are skipped.
/// Resuming a run requires [`EventLog::read`].
pub(crate) fn readable(bytes: &[u8]) -> impl DoubleEndedIterator<Item = Event> {
    lines(bytes).filter_map(|line| event(line).ok())
}

/// Computes the digest of a line: the first 64 bits of the SHA-256 of the previous line's digest followed by
/// the line's text.
fn chained(before: &str, body: &str) -> String {
    let whole = hexadecimal(&Sha256::digest(format!("{before}\n{body}")));
    whole.chars().take(16).collect()
}

#[cfg(test)]
mod tests {
    use super::{Event, EventLog, readable};
    use crate::disk::Disk;
    use crate::error::RunError;
    use crate::faults::{Faults, Lasts, Refusal};
    use serde_json::json;
    use std::path::Path;
    use std::sync::Arc;

    #[test]
    fn what_cannot_be_read_is_not_taken_for_an_empty_log() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(EventLog::read(folder.path()), Err(RunError::Io { .. })));
    }

    /// The folder is flushed for a new file, because of its name; the name of an existing file is already on
    /// disk.
    #[test]
    fn the_folder_is_flushed_for_the_first_line_only() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let operations = || {
            let faults = Arc::new(Faults::none());
            let event = Event { time: String::new(), event: "x".into(), details: json!(null) };
            EventLog::append(&path, &Disk::failing(Arc::clone(&faults)), &event).unwrap();
            faults.asked()
        };
        let first = operations();
        assert_eq!([operations(), operations()], [first - 1; 2]);
    }

    /// Whichever operation fails while an incomplete line is replaced, the complete lines stay, and the next
    /// attempt appends its own.
    #[test]
    fn no_failure_takes_a_whole_line_along_with_a_torn_one() {
        let event = Event { time: String::new(), event: "resume".into(), details: json!(null) };
        for refusal in [Refusal::Device, Refusal::Full] {
            for first in 0.. {
                let folder = tempfile::tempdir().unwrap();
                let path = folder.path().join("events.jsonl");
                let whole = three_lines(&path);
                std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();
                let faults = Arc::new(Faults::new(first, refusal, Lasts::Once));
                let failed = EventLog::append(&path, &Disk::failing(Arc::clone(&faults)), &event).is_err();
                assert_eq!(failed, first < faults.asked());
                let log = EventLog::read(&path).unwrap();
                let names: Vec<&str> = log.events.iter().map(|event| event.event.as_str()).collect();
                assert_eq!(names[..2], ["start", "one\ntwo"]);
                if !failed {
                    assert_eq!((&names[2..], log.torn_line), (&["resume"][..], None));
                    // Four operations: open, shorten, write, flush.
                    assert_eq!(first, 4);
                    break;
                }
                EventLog::append(&path, &Disk::default(), &event).unwrap();
                assert_eq!(EventLog::read(&path).unwrap().last("resume"), Some(&event));
            }
        }
    }

    #[test]
    fn several_writers_keep_one_chain() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        std::thread::scope(|scope| {
            for writer in 0..4 {
                let path = &path;
                scope.spawn(move || {
                    for number in 0..25 {
                        let details = json!({ "writer": writer, "number": number });
                        let event = Event { time: String::new(), event: "share".into(), details };
                        EventLog::append(path, &Disk::default(), &event).unwrap();
                    }
                });
            }
        });
        assert_eq!(EventLog::read(&path).unwrap().events.len(), 100);
    }

    fn three_lines(path: &Path) -> Vec<u8> {
        for name in ["start", "one\ntwo", "end"] {
            let event =
                Event { time: "2026-01-01T00:00:00Z".into(), event: name.into(), details: json!({"π": 1}) };
            EventLog::append(path, &Disk::default(), &event).unwrap();
        }
        std::fs::read(path).unwrap()
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        assert_eq!(EventLog::read(&path).unwrap(), EventLog::default());
        three_lines(&path);
        let log = EventLog::read(&path).unwrap();
        assert_eq!((log.events.len(), log.torn_line), (3, None));
        assert_eq!(log.last("one\ntwo").unwrap().details, json!({"π": 1}));
        assert!(log.last("two").is_none());
    }

    /// Flips every bit of every byte: each is reported with its line, except in the last line break, without
    /// which the line counts as incomplete.
    #[test]
    fn a_flipped_bit_anywhere_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let whole = three_lines(&path);
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.clone();
                bytes[at] ^= 1 << bit;
                match EventLog::parse(&path, &bytes) {
                    Err(RunError::Log { line, .. }) => assert!((1..=3).contains(&line)),
                    Ok(log) => {
                        assert_eq!((at + 1, log.torn_line), (whole.len(), Some(3)), "byte {at} bit {bit}");
                        assert_eq!(log.events.len(), 2);
                    }
                    Err(other) => panic!("{other}"),
                }
            }
        }
    }

    #[test]
    fn cut_short_anywhere_the_whole_lines_stay_and_the_torn_one_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let whole = three_lines(&path);
        for length in 0..whole.len() {
            let log = EventLog::parse(&path, &whole[..length]).unwrap();
            let lines = whole[..length].iter().filter(|byte| **byte == b'\n').count();
            let torn = length > 0 && whole[length - 1] != b'\n';
            assert_eq!((log.events.len(), log.torn_line), (lines, torn.then_some(lines + 1)));
        }
        // The next line replaces the incomplete one in the same file, which another writer has open and waits
        // for.
        std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();
        let waiting = std::fs::File::open(&path).unwrap();
        let event = Event { time: String::new(), event: "resume".into(), details: json!(null) };
        EventLog::append(&path, &Disk::default(), &event).unwrap();
        assert_eq!(std::io::read_to_string(waiting).unwrap(), std::fs::read_to_string(&path).unwrap());
        let log = EventLog::read(&path).unwrap();
        let names: Vec<&str> = log.events.iter().map(|event| event.event.as_str()).collect();
        assert_eq!((names, log.torn_line), (vec!["start", "one\ntwo", "resume"], None));
    }

    #[test]
    fn whoever_only_shows_a_log_gets_the_lines_that_are_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let mut bytes = three_lines(&path);
        assert!(readable(&bytes).eq(EventLog::read(&path).unwrap().events));
        let second = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        bytes[second] = b'!';
        bytes.truncate(bytes.len() - 1);
        let names = |bytes: &[u8]| readable(bytes).map(|event| event.event).collect::<Vec<_>>();
        assert_eq!(names(&bytes), ["start", "end"]);
        bytes.truncate(bytes.len() - 1);
        assert_eq!(names(&bytes), ["start"]);
        assert!(names(b"").is_empty());
    }

    #[test]
    fn a_line_taken_out_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let text = String::from_utf8(three_lines(&path)).unwrap();
        let without: String =
            text.lines().filter(|line| !line.contains("two")).map(|line| format!("{line}\n")).collect();
        let message = EventLog::parse(&path, without.as_bytes()).unwrap_err().to_string();
        assert!(message.contains("events.jsonl:2: the line has been changed"), "{message}");
        assert!(message.contains("its digest does not match its text"), "{message}");
    }
}
