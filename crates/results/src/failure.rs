//! Reason for a missing outcome of a method.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Reason for a missing outcome of a method; serialized as a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum Failure {
    /// The run was interrupted before the method began.
    NotBegun,
    /// The method failed with this message.
    Reason(String),
}

/// Sentence for [`Failure::NotBegun`] in files.
const NOT_BEGUN: &str = "interrupted before it began";

impl Failure {
    /// Returns the failure with the message of an error.
    #[must_use]
    pub fn of(error: &impl fmt::Display) -> Self {
        Self::Reason(error.to_string())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::NotBegun => NOT_BEGUN,
            Self::Reason(reason) => reason,
        })
    }
}

impl From<String> for Failure {
    fn from(sentence: String) -> Self {
        if sentence == NOT_BEGUN { Self::NotBegun } else { Self::Reason(sentence) }
    }
}

impl From<&str> for Failure {
    fn from(sentence: &str) -> Self {
        sentence.to_owned().into()
    }
}

impl From<Failure> for String {
    fn from(failure: Failure) -> Self {
        failure.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::Failure;

    #[test]
    fn a_file_holds_its_sentence() {
        for (failure, sentence) in [
            (Failure::NotBegun, "interrupted before it began"),
            (Failure::Reason("needs 8 peaks".into()), "needs 8 peaks"),
        ] {
            assert_eq!(serde_json::to_value(&failure).unwrap(), sentence);
            assert_eq!(serde_json::from_value::<Failure>(sentence.into()).unwrap(), failure);
        }
    }
}
