//! Work that was handed to a batch system.

use serde::{Deserialize, Serialize};

/// The `schema` field of a launch.
pub const LAUNCH_SCHEMA: &str = "ringdown.launch/1";

/// Shares that were handed to a batch system, or are ready for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LaunchResult {
    /// Always [`LAUNCH_SCHEMA`].
    pub schema: String,
    /// The batch system: `"slurm"`.
    pub launcher: String,
    /// The folder that all shares write to.
    pub folder: String,
    /// The job script.
    pub script: String,
    /// Runs or cases.
    pub parts: usize,
    /// Shares, each of which is one task.
    pub shares: usize,
    /// `false` where the script was only to be written.
    pub submitted: bool,
    /// The job arrays, more than one where there are more shares than the cluster allows in one.
    pub arrays: Vec<LaunchedArray>,
}

/// A job array.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LaunchedArray {
    /// Number of the job; `null` before it is submitted.
    pub job: Option<u64>,
    /// Its tasks.
    pub tasks: usize,
    /// The share of its first task, from 1.
    pub first_share: usize,
    /// The command that submits it.
    pub command: String,
}
