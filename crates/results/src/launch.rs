//! Results of handing work to a batch system.

use serde::{Deserialize, Serialize};

/// The `schema` field of a launch.
pub const LAUNCH_SCHEMA: &str = "ringdown.launch/1";

/// Shares of a run that were submitted to a batch system or are ready for submission.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LaunchResult {
    /// Always [`LAUNCH_SCHEMA`].
    pub schema: String,
    /// Name of the batch system: `"slurm"`.
    pub launcher: String,
    /// Folder that all shares write to.
    pub folder: String,
    /// Path of the job script.
    pub script: String,
    /// Number of runs or cases.
    pub parts: usize,
    /// Number of shares; each is one task.
    pub shares: usize,
    /// `false` if the script was only written and not submitted.
    pub submitted: bool,
    /// Job arrays; more than one if there are more shares than the cluster allows in one array.
    pub arrays: Vec<LaunchedArray>,
}

/// A job array.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LaunchedArray {
    /// Job number; `null` before the submission.
    pub job: Option<u64>,
    /// Number of tasks in the array.
    pub tasks: usize,
    /// Share of the array's first task, from 1.
    pub first_share: usize,
    /// Command that submits the array.
    pub command: String,
}
