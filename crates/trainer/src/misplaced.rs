//! Files and commands given in the wrong place, answered with the call that is meant.

use settings::{Document, nearest};
use std::path::Path;

/// The message for a command line whose first words say what is meant, though no command takes them so; `None` where the
/// command line is to be parsed as usual.
pub(crate) fn remedy(words: &[String], commands: &[String]) -> Option<String> {
    let (first, rest) = words.split_first()?;
    if first.starts_with('-') {
        return None;
    }
    if first == "diagnose" {
        return configuration_among_records(rest);
    }
    if commands.contains(first) {
        return None;
    }
    let path = Path::new(first);
    if !path.exists() && path.extension().is_none() && !first.contains(['/', '\\']) {
        let known = nearest(first, commands)?;
        return Some(format!("`{first}` is no command and no file; did you mean `trainer {known}`?"));
    }
    if path.is_dir() {
        return folder(path, first);
    }
    if is_nominal(path) {
        return Some(format!(
            "{first} describes a nominal simulator; compare records with it by `trainer diagnose RECORD --nominal {first}`"
        ));
    }
    is_record(path).then(|| {
        format!(
            "{first} is a record, not a configuration; look at it with `trainer init {first}`, estimate its damping with \
             `trainer configs/ols.toml data.path={first}`, or diagnose a simulator with \
             `trainer diagnose {first} --nominal NOMINAL.toml`"
        )
    })
}

/// A finished run given as a configuration.
fn folder(path: &Path, shown: &str) -> Option<String> {
    let holds = |name: &str| path.join(name).is_file();
    let is_run = holds("result.json") || holds("diagnosis.json");
    is_run.then(|| {
        format!(
            "{shown} is the folder of a run; `trainer report {shown}` makes its report again, and its configuration is \
             {shown}/config.toml"
        )
    })
}

/// A TOML file among the records of a diagnosis.
fn configuration_among_records(words: &[String]) -> Option<String> {
    let mut previous = "";
    for word in words {
        let is_value = previous.starts_with("--") && !previous.contains('=');
        previous = word;
        let path = Path::new(word);
        if is_value || word.starts_with('-') || path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        return Some(if is_nominal(path) {
            format!(
                "{word} describes a nominal simulator, not a record; write `trainer diagnose RECORD --nominal {word}`"
            )
        } else {
            format!(
                "{word} is a configuration, not a record; `trainer {word}` runs it, and \
                 `trainer diagnose RECORD --nominal NOMINAL.toml` diagnoses"
            )
        });
    }
    None
}

/// Whether a file is TOML with the keys of a nominal simulator.
fn is_nominal(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let known = ["inertia", "stiffness", "natural_frequency", "period"];
    Document::parse("", &text).is_ok_and(|document| {
        document.get("task").is_none() && known.iter().any(|key| document.get(key).is_some())
    })
}

/// Whether a file looks like a record: by its name, since a broken configuration is to be told as one.
fn is_record(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    path.is_file() && ["csv", "tsv", "txt", "log", "dat"].contains(&extension.to_lowercase().as_str())
}
