//! Errors of submitting shares to a batch system.

use thiserror::Error;

/// Reason why shares were not submitted to a batch system.
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
