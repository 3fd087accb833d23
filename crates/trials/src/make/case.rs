//! Cases of trials.

use crate::Hidden;

/// A case: the files that the diagnosis gets, and the truth that is hidden from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of the folder: a number that reveals neither bank nor effect.
    pub id: String,
    /// Identifier of the effect that the diagnosis is told not to consider; `None` for no such effect.
    pub without: Option<String>,
    /// Records as texts of CSV files, `record-000.csv` and so on.
    pub records: Vec<String>,
    /// Text of `nominal.toml`, the nominal simulator.
    pub nominal: String,
    /// Hidden truth, which the diagnosis must not see.
    pub hidden: Hidden,
}
