//! Why shares were not handed to a batch system.

use crate::share::Problem;
use results::LaunchedArray;
use std::path::Path;
use thiserror::Error;

/// Why shares were not handed to a batch system.
#[derive(Debug, Error)]
pub(crate) enum LaunchError {
    #[error(
        "{script} is written, but there is no sbatch on this machine; where there is Slurm, submit it with: {command}"
    )]
    NoSlurm { script: String, command: String },
    #[error(
        "sbatch refused {script}: {complaint}{submitted}. Give what the cluster asks for by --slurm-option NAME=VALUE \
         (partition, account, time, mem, qos; `sinfo` and `sacctmgr show assoc` list them) or fewer --shards, and --resume"
    )]
    Refused { script: String, complaint: String, submitted: String },
    #[error("{option} shares the cases of a batch; a single diagnosis has none: use it with --batch CASES")]
    NoBatch { option: &'static str },
}

impl LaunchError {
    /// Of an array of this script, after some others were submitted.
    pub(crate) fn new(problem: Problem, script: &Path, command: &str, before: &[LaunchedArray]) -> Self {
        let script = script.display().to_string();
        match problem {
            Problem::Absent => Self::NoSlurm { script, command: command.to_owned() },
            Problem::Refused(complaint) => {
                let jobs: Vec<String> =
                    before.iter().filter_map(|array| array.job).map(|job| job.to_string()).collect();
                let submitted = match jobs.is_empty() {
                    true => String::new(),
                    false => format!("; job {} before it is submitted and goes on", jobs.join(", ")),
                };
                Self::Refused { script, complaint, submitted }
            }
        }
    }
}
