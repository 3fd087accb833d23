//! The arguments of `trainer sweep`.

use crate::options::{Output, RunOptions};
use crate::share::ShareOptions;
use clap::Args;
use std::path::PathBuf;

/// Every combination of some keys' values.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer sweep configs/pinn.toml seed=0..9                 ten runs: a range includes both its ends
  trainer sweep configs/pinn.toml estimator=pinn,lstm seed=0..9 --out SWEEP
                                   twenty: each estimator with each seed
  trainer sweep configs/pinn.toml 'estimator.hidden=[16],[32,32]' fit.max_steps=50,500
                                   a comma inside brackets belongs to the value
  trainer sweep configs/pinn.toml estimator=pinn,lstm seed=0..9 --out SWEEP --resume
                                   what is missing, if the configuration is the same
  trainer sweep --out SWEEP --resume --failed               what is missing and what failed, from the folder alone
  trainer sweep configs/pinn.toml seed=0..999 --out SWEEP --shard 2/8
                                   the second of eight shares; all may run at once on one folder
  trainer sweep configs/pinn.toml seed=0..999 --launcher slurm --shards 20
                                   a job array with one task for each share
  trainer sweep configs/pinn.toml seed=0..999 --launcher slurm --slurm-option partition=long \\
      --slurm-option time=2:00:00 --slurm-at-once 4 --slurm-setup 'module load gcc' --json
                                   with what the cluster asks for; prints the job's number

estimator=NAME chooses the estimator and leaves out what the file sets for another one.

Every combination is resolved and checked before the first one runs, and frozen: SWEEP/sweep.json
lists the runs, each with its digest, its state and its folder below SWEEP/runs, which `trainer
report` reads. SWEEP/report.html, table.csv and table.md put them side by side.

Exit codes: 0 done; 1 a run failed, or is outside its stated tolerance; 2 wrong input or usage,
nothing was run; 130 interrupted, what is done is kept. With --as-task 0 instead of 1.")]
pub(crate) struct SweepArguments {
    /// The experiment that every combination starts from: a TOML file
    #[arg(required_unless_present = "resume")]
    pub(crate) config: Option<PathBuf>,
    /// What to vary: KEY=V1,V2 or KEY=A..B, both ends included
    #[arg(value_name = "KEY=VALUES")]
    pub(crate) axes: Vec<String>,
    #[command(flatten)]
    pub(crate) run: RunOptions,
    /// With --resume, runs again what failed
    #[arg(long, requires = "resume")]
    pub(crate) failed: bool,
    #[command(flatten)]
    pub(crate) share: ShareOptions,
    #[command(flatten)]
    pub(crate) output: Output,
}

impl SweepArguments {
    /// As many threads as asked for, or one for each core.
    pub(super) fn threads(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        self.run.threads.map_or_else(cores, usize::from)
    }
}
