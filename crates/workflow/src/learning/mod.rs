//! Learning the dynamics from records: methods, and rows of results.

mod data;
mod method;
mod rows;
mod tried;

pub use data::{check_record, trajectory};
pub use method::{Judged, Method, attempt, judged, method_of, methods, truth_of};
pub use rows::{ablation_rows, described, draw, row, sort};
pub use tried::{Tried, tried};

use dynamics::System;
use experiment::StatedPart;
use learn::data::DataSet;

/// Data set that can be learned from.
pub struct Ready {
    /// Data set, split into its parts.
    pub data: DataSet,
    /// Number of records.
    pub records: usize,
    /// Records with missing cells, and how these were treated.
    pub missing: Vec<String>,
    /// System that generated simulated records; used only for scoring.
    pub truth: Option<System>,
    /// Stated parts; empty for records that are split.
    pub parts: Vec<StatedPart>,
}
