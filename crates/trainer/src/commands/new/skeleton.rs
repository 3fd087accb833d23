//! Parts of a skeleton, whatever it is of.

use crate::error::NewError;
use std::path::{Path, PathBuf};

/// Files that make a method part of the project.
pub(super) struct Skeleton {
    /// Kind of the method.
    pub(super) what: &'static str,
    /// Sentence on what the method does.
    pub(super) does: &'static str,
    /// Paths and texts of new files.
    pub(super) files: Vec<(PathBuf, String)>,
    /// Paths and texts of registries that get lines for the method.
    pub(super) registries: Vec<(PathBuf, String)>,
    /// Commands to continue with.
    pub(super) next: Vec<String>,
}

pub(super) fn read(path: &Path) -> Result<String, NewError> {
    let file = path.display().to_string();
    std::fs::read_to_string(path).map_err(|error| NewError::Unreadable { file, reason: error.to_string() })
}

/// Reads a registry and returns its path with its text after a change; the change returns `None` for a
/// registry of an unexpected form.
pub(super) fn registered(
    path: PathBuf,
    change: impl FnOnce(&str) -> Option<String>,
) -> Result<(PathBuf, String), NewError> {
    let text =
        change(&read(&path)?).ok_or_else(|| NewError::Registry { file: path.display().to_string() })?;
    Ok((path, text))
}

/// Inserts a line into a text below the last of the lines that have a property.
pub(super) fn below_last(text: &str, line: &str, is_above: impl Fn(&str) -> bool) -> Option<String> {
    let mut lines: Vec<&str> = text.lines().collect();
    let last = lines.iter().rposition(|line| is_above(line))?;
    lines.insert(last + 1, line);
    Some(lines.join("\n") + "\n")
}

/// Fills a name into a template.
pub(super) fn filled(template: &str, name: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters
            .next()
            .map(|first| first.to_ascii_uppercase().to_string() + letters.as_str())
            .unwrap_or_default()
    };
    let type_name: String = name.split('-').map(capital).collect();
    let title = capital(&name.replace('-', " "));
    template.replace("NewType", &type_name).replace("NEW-TITLE", &title).replace("new-id", name)
}
