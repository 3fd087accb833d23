//! Refusal of a file of a known kind.

use thiserror::Error;

/// A file of a known kind that cannot be read. The text continues `is`.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{kind}, but {problem}; {remedy}")]
pub(crate) struct Unread {
    /// Kind of the file, with its article.
    pub(crate) kind: &'static str,
    /// Reason for which it cannot be read, as a clause.
    pub(crate) problem: String,
    /// Instruction that makes it readable.
    pub(crate) remedy: String,
}
