//! Errors in a configuration.

use crate::origin::Origin;
use thiserror::Error;

/// Reason why a configuration cannot be used, with the place, what was found and what was expected.
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
        /// Message of the parser.
        problem: String,
    },
    /// A key that is not declared.
    #[error("{origin}: unknown key `{key}`{}", suggest(nearest.as_deref(), known))]
    UnknownKey {
        /// Place where the key was written.
        origin: Origin,
        /// Dotted key.
        key: String,
        /// Declared key with the most similar spelling, if one is close.
        nearest: Option<String>,
        /// Every key declared in the same section.
        known: Vec<String>,
    },
    /// A value of the wrong kind or out of range.
    #[error("{origin}: `{key}` is {found}; expected {expected}{unit}")]
    BadValue {
        /// Place where the value was written.
        origin: Origin,
        /// Dotted key.
        key: String,
        /// Value as written.
        found: String,
        /// Values that the declaration allows.
        expected: String,
        /// Unit in words, with a leading space; empty if the value has none.
        unit: String,
    },
    /// A name that is not among the known ones, where these are known only at run time.
    #[error("{origin}: unknown {what} \"{found}\"{}", suggest(nearest.as_deref(), known))]
    UnknownName {
        /// Place where the name was written.
        origin: Origin,
        /// Kind of the named thing, such as `estimator`.
        what: String,
        /// Name as written.
        found: String,
        /// Known name with the most similar spelling, if one is close.
        nearest: Option<String>,
        /// Every known name.
        known: Vec<String>,
    },
    /// A name of a thing of another kind than the expected one.
    #[error("{origin}: `{found}` is {is}; {remedy}")]
    OtherKind {
        /// Place where the name was written.
        origin: Origin,
        /// Name as written.
        found: String,
        /// Kind of the named thing, and the kind that was expected.
        is: String,
        /// Advice to the user.
        remedy: String,
    },
    /// A key of the file that does not belong to the choice on the command line.
    #[error("{origin}: `{key}` is no key of `{chosen}`; {remedy}")]
    ForeignKey {
        /// Place where the key was written.
        origin: Origin,
        /// Dotted key.
        key: String,
        /// Choice on the command line.
        chosen: String,
        /// Advice to the user.
        remedy: String,
    },
    /// A required key is absent.
    #[error("{file}: `{key}` is missing: {meaning} Expected {expected}.")]
    Missing {
        /// Name of the file.
        file: String,
        /// Dotted key.
        key: String,
        /// Meaning of the key.
        meaning: String,
        /// Values that the declaration allows.
        expected: String,
    },
    /// An override that is not of the form `key=value`.
    #[error("command line: `{argument}` is no override; write KEY=VALUE, for example seed=3")]
    BadOverride {
        /// Argument as given.
        argument: String,
    },
    /// A base file cannot be read.
    #[error("{origin}: the base {file} cannot be read: {problem}")]
    Base {
        /// Place where the file was named.
        origin: Origin,
        /// Name of the file.
        file: String,
        /// Reason why it cannot be read.
        problem: String,
    },
    /// A file is a base of itself, directly or through others.
    #[error("{origin}: `base` leads back to where it started: {}", files.join(", "))]
    BaseCircle {
        /// Place that names a file of the chain again.
        origin: Origin,
        /// Files of the chain.
        files: Vec<String>,
    },
    /// Values that are valid each by itself but not together.
    #[error("{file}: cannot be used: {problem}")]
    Refused {
        /// Name of the file.
        file: String,
        /// Description of the conflict.
        problem: String,
    },
    /// The checked table does not fit the struct that is read from it: a fault of the program.
    #[error(
        "section `{section}` does not fit its declaration: {problem} (a fault of the program, please report it)"
    )]
    Declaration {
        /// Name of the section.
        section: String,
        /// Message of serde.
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
