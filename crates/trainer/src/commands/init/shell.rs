//! Words and paths of the commands that `init` prints.

use crate::commands::diagnose::arguments::Reading;
use serde_json::Value;
use std::path::{Component, Path, PathBuf};

/// Formats the given reading options as options of the diagnosis.
pub(super) fn given(reading: &Reading) -> String {
    let stated = serde_json::to_value(reading).unwrap_or_default();
    let usual = serde_json::to_value(Reading::default()).unwrap_or_default();
    let Value::Object(stated) = stated else { return String::new() };
    let changed = stated.iter().filter(|(key, value)| usual.get(key.as_str()) != Some(value));
    let option = |(key, value): (&String, &Value)| {
        let name = match key.as_str() {
            "filter" => "where".to_owned(),
            "from_s" => "from".to_owned(),
            "to_s" => "to".to_owned(),
            key => key.replace('_', "-"),
        };
        match value {
            Value::Bool(_) => format!(" --{name}"),
            Value::String(text) => {
                format!(" --{name} {}", word(text))
            }
            other => format!(" --{name} {other}"),
        }
    };
    changed.map(option).collect()
}

/// Quotes a word for a shell.
fn word(text: &str) -> String {
    let plain = |sign: char| sign.is_alphanumeric() || "-_./=:,+%@".contains(sign);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

/// Quotes a path for a shell.
pub(super) fn path_word(path: &Path) -> String {
    word(&path.display().to_string())
}

/// Returns the path of a file relative to a folder; absolute if the folder is not clearly below the working
/// directory.
pub(super) fn path_from(folder: &Path, file: &Path) -> PathBuf {
    if file.is_absolute() {
        return file.to_owned();
    }
    let below = folder.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !below {
        return std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    }
    let depth = folder.components().filter(|part| matches!(part, Component::Normal(_))).count();
    std::iter::repeat_n("..", depth).collect::<PathBuf>().join(file)
}

#[cfg(test)]
mod tests {
    use super::{given, path_from, word};
    use crate::commands::diagnose::arguments::Reading;
    use std::path::{Path, PathBuf};

    #[test]
    fn options_that_were_given_are_given_again() {
        let reading = Reading {
            value: Some("phi 2".to_owned()),
            filter: Some("joint=elbow".to_owned()),
            remove_mean: true,
            sample_rate: Some(50.0),
            ..Reading::default()
        };
        assert_eq!(given(&Reading::default()), "");
        assert_eq!(given(&reading), " --value 'phi 2' --where joint=elbow --sample-rate 50.0 --remove-mean");
    }

    #[test]
    fn words_are_safe_in_a_shell() {
        assert_eq!(word("a/b.csv"), "a/b.csv");
        assert_eq!(word("it's $5"), r"'it'\''s $5'");
    }

    #[test]
    fn the_way_back_to_the_log_is_found() {
        assert_eq!(path_from(Path::new("rig/a"), Path::new("logs/x.csv")), PathBuf::from("../../logs/x.csv"));
        assert!(path_from(Path::new("../rig"), Path::new("x.csv")).is_absolute());
    }
}
