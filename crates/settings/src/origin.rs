//! Origin of a value.

use std::fmt;

/// Origin of a value: a file, the command line or the declaration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// Place in a file.
    File {
        /// Name of the file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
    },
    /// Override on the command line, as given.
    Override(String),
    /// Default of the declaration.
    Default,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { file, line, column } => write!(f, "{file}:{line}:{column}"),
            Self::Override(argument) => write!(f, "command line: `{argument}`"),
            Self::Default => f.write_str("default"),
        }
    }
}
