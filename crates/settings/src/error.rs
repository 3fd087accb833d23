//! What can be wrong with a configuration.

use crate::origin::Origin;
use thiserror::Error;

/// A configuration that cannot be used: where, what was found, what was expected.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SettingsError {
    /// The text is not TOML.
    #[error("{file}:{line}:{column}: not valid TOML: {problem}")]
    Syntax {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the parser says.
        problem: String,
    },
    /// A key that nobody declared.
    #[error("{origin}: unknown key `{key}`{}", suggest(nearest.as_deref(), known))]
    UnknownKey {
        /// Where it was written.
        origin: Origin,
        /// The dotted key.
        key: String,
        /// The declared key that is spelled most alike, if one is close.
        nearest: Option<String>,
        /// Every key declared in the same section.
        known: Vec<String>,
    },
    /// A value of the wrong kind or out of range.
    #[error("{origin}: `{key}` is {found}; expected {expected}{unit}")]
    BadValue {
        /// Where it was written.
        origin: Origin,
        /// The dotted key.
        key: String,
        /// The value as written.
        found: String,
        /// What the declaration admits.
        expected: String,
        /// The unit in words, with a leading blank; empty where there is none.
        unit: String,
    },
    /// A word that is none of those known, where the set is not fixed at compile time.
    #[error("{origin}: unknown {what} \"{found}\"{}", suggest(nearest.as_deref(), known))]
    UnknownName {
        /// Where it was written.
        origin: Origin,
        /// What kind of thing is named, such as `estimator`.
        what: String,
        /// The name as written.
        found: String,
        /// The known name that is spelled most alike, if one is close.
        nearest: Option<String>,
        /// Every known name.
        known: Vec<String>,
    },
    /// A key that the file has for something else than the command line chose.
    #[error("{origin}: `{key}` is no key of `{chosen}`; {remedy}")]
    ForeignKey {
        /// Where it was written.
        origin: Origin,
        /// The dotted key.
        key: String,
        /// What was chosen.
        chosen: String,
        /// What to do.
        remedy: String,
    },
    /// A key that has to be given is absent.
    #[error("{file}: `{key}` is missing: {meaning} Expected {expected}.")]
    Missing {
        /// Name of the file.
        file: String,
        /// The dotted key.
        key: String,
        /// What the key means.
        meaning: String,
        /// What the declaration admits.
        expected: String,
    },
    /// An override that is not of the form `key=value`.
    #[error("command line: `{argument}` is no override; write KEY=VALUE, for example seed=3")]
    BadOverride {
        /// The argument as given.
        argument: String,
    },
    /// A file that another stands on is not to be had.
    #[error("{origin}: the base {file} cannot be read: {problem}")]
    Base {
        /// Where it was named.
        origin: Origin,
        /// The file.
        file: String,
        /// Why it cannot be read.
        problem: String,
    },
    /// A file stands on itself.
    #[error("{origin}: `base` leads back to where it started: {}", files.join(", "))]
    BaseCircle {
        /// Where the way down closes.
        origin: Origin,
        /// The files on the way.
        files: Vec<String>,
    },
    /// Values that are each as declared and do not go together.
    #[error("{file}: cannot be used: {problem}")]
    Refused {
        /// Name of the file.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// The checked table does not fit the struct that reads it: a fault of the program.
    #[error(
        "section `{section}` does not fit its declaration: {problem} (a fault of the program, please report it)"
    )]
    Declaration {
        /// The section.
        section: String,
        /// What serde says.
        problem: String,
    },
}

fn suggest(nearest: Option<&str>, known: &[String]) -> String {
    match nearest {
        Some(nearest) => format!("; did you mean `{nearest}`?"),
        None if known.is_empty() => String::new(),
        None => format!("; known are {}", known.join(", ")),
    }
}
