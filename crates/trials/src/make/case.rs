//! What a case is made of.

use crate::Hidden;

/// A case: what the diagnosis is given, and what is hidden from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of its folder: a number that tells neither bank nor effect.
    pub id: String,
    /// The effect that the diagnosis is told not to consider.
    pub without: Option<String>,
    /// The records as texts of CSV files, `record-000.csv` and on.
    pub records: Vec<String>,
    /// The text of `nominal.toml`: what is believed of the system.
    pub nominal: String,
    /// Hidden truth; whoever diagnoses must not see it.
    pub hidden: Hidden,
}
