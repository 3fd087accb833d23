//! Files and commands given in the wrong place, answered with the intended command line.

use settings::{Document, nearest};
use std::path::Path;
use workflow::{is_log, is_run, logs};

/// Returns a message for a command line whose intention is clear from its first words, but which no command
/// accepts; `None` if it is to be parsed as usual.
pub(crate) fn remedy(words: &[String], commands: &[String]) -> Option<String> {
    let (first, rest) = words.split_first()?;
    if first.starts_with('-') {
        return of_a_diagnosis(words);
    }
    if first == "diagnose" {
        return configuration_among_records(rest)
            .or_else(|| record_as_nominal(rest))
            .or_else(|| absent(rest));
    }
    if first == "init" {
        return toml_as_log(rest).or_else(|| absent(rest));
    }
    if first == "simulate" {
        return nominal_as_plan(rest);
    }
    if commands.contains(first) {
        return None;
    }
    let path = Path::new(first);
    if !path.exists() && path.extension().is_none() && !first.contains(['/', '\\']) {
        let known = nearest(first, commands)?;
        return Some(format!("`{first}` is neither a command nor a file; did you mean `trainer {known}`?"));
    }
    if path.is_dir() {
        return folder(path, first);
    }
    if is_nominal(path) {
        return Some(format!(
            "{first} describes a nominal simulator; compare records with it by `trainer diagnose RECORD --nominal {first}`"
        ));
    }
    is_log(path).then(|| {
        format!(
            "{first} is a record, not a configuration; look at it with `trainer init {first}`, estimate its damping with \
             `trainer configs/ols.toml data.path={first}`, or diagnose a simulator with \
             `trainer diagnose {first} --nominal NOMINAL.toml`"
        )
    })
}

/// Handles a finished run, or a folder of logs, given as a configuration.
fn folder(path: &Path, shown: &str) -> Option<String> {
    if is_run(path) {
        return Some(format!(
            "{shown} is the folder of a run; `trainer report {shown}` makes its report again, and its configuration is \
             {shown}/config.toml"
        ));
    }
    logs(path).is_ok().then(|| {
        format!(
            "{shown} is a folder of logs, not a configuration; look at them with `trainer init {shown}`, or diagnose a \
             simulator with `trainer diagnose {shown} --nominal NOMINAL.toml`"
        )
    })
}

/// Handles a TOML file among the records of a diagnosis.
fn configuration_among_records(words: &[String]) -> Option<String> {
    for (word, path) in positional(words) {
        if path.extension().is_none_or(|extension| extension != "toml") {
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

/// Handles an option of `trainer diagnose` without that command in front.
fn of_a_diagnosis(words: &[String]) -> Option<String> {
    let option = words.iter().find(|word| ["--nominal", "--batch", "--rigs"].contains(&word.as_str()))?;
    Some(format!(
        "{option} is an option of `trainer diagnose`; write `trainer diagnose RECORD --nominal FILE`"
    ))
}

/// Handles a record in the place of the nominal simulator.
fn record_as_nominal(words: &[String]) -> Option<String> {
    let after = words.iter().zip(words.iter().skip(1)).find(|(option, _)| *option == "--nominal");
    let joined = words.iter().find_map(|word| word.strip_prefix("--nominal="));
    let file = after.map(|(_, file)| file.as_str()).or(joined)?;
    is_log(Path::new(file)).then(|| {
        format!(
            "{file} is a record, not a nominal simulator; --nominal takes a TOML file with inertia, damping, stiffness and \
             rest_angle: `trainer init {file}` writes one"
        )
    })
}

/// Handles a nominal simulator without an inertia, as `trainer init` writes it, in the place of a plan of
/// records.
fn nominal_as_plan(words: &[String]) -> Option<String> {
    let (word, path) = positional(words).next()?;
    let document = Document::parse("", &std::fs::read_to_string(path).ok()?).ok()?;
    (is_nominal(path) && document.get("inertia").is_none()).then(|| {
        format!(
            "{word} describes a nominal simulator by its frequency; a simulation needs inertia, damping, stiffness and rest_angle \
             in [nominal], as in configs/default-record.toml and in the repaired.toml of a diagnosis"
        )
    })
}

/// Handles a TOML file in the place of a log.
fn toml_as_log(words: &[String]) -> Option<String> {
    let (word, path) =
        positional(words).find(|(_, path)| path.extension().is_some_and(|end| end == "toml"))?;
    let (what, call) = match is_nominal(path) {
        true => ("describes a nominal simulator", format!("trainer diagnose RECORD --nominal {word}")),
        false => ("is a configuration", format!("trainer {word}")),
    };
    Some(format!("{word} {what}, not a log; `trainer init LOG` looks at a log, `{call}` uses this file"))
}

/// Handles a missing record, with the nearest name in its folder.
fn absent(words: &[String]) -> Option<String> {
    let (word, path) = positional(words).find(|(_, path)| !path.exists())?;
    let own = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(own).ok()?;
    let mut known: Vec<String> = entries
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
        .filter(|name| is_log(&own.join(name)))
        .collect();
    known.sort();
    let shown = own.join(nearest(&path.file_name()?.to_string_lossy(), &known)?);
    let shown = shown.strip_prefix(".").unwrap_or(&shown).display();
    Some(format!("{word}: there is no such file; did you mean {shown}?"))
}

/// Returns the words that are not options and do not follow one. A word after an option without a value is
/// missed, and no message is given for it.
fn positional(words: &[String]) -> impl Iterator<Item = (&str, &Path)> {
    let before = std::iter::once("").chain(words.iter().map(String::as_str));
    let follows_none = |(before, word): &(&str, &String)| {
        let is_value = before.starts_with("--") && !before.contains('=');
        !is_value && !word.starts_with('-')
    };
    before.zip(words).filter(follows_none).map(|(_, word)| (word.as_str(), Path::new(word)))
}

/// Returns `true` if a file is TOML with the keys of a nominal simulator.
fn is_nominal(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let known = ["inertia", "stiffness", "natural_frequency", "period"];
    Document::parse("", &text).is_ok_and(|document| {
        document.get("task").is_none() && known.iter().any(|key| document.get(key).is_some())
    })
}
