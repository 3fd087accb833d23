//! Arguments of `trainer sweep`.

use crate::options::{Output, RunOptions};
use crate::share::ShareOptions;
use clap::{Args, ValueEnum};
use experiment::sweep::Sampler;
use std::path::PathBuf;

/// Default number of trials of a search.
const TRIALS: usize = 50;

/// Runs every combination of some keys' values.
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

A search tries some points instead of all combinations, and names the best:
  trainer sweep configs/learn/lstm.toml --search random --trials 50 learn.baselines=[] \
      'lstm.learning_rate={from=1e-4,to=1e-2,scale=\"log\"}' lstm.units=8..64
                                   by the error on the validation part, which is what a study is chosen by
  trainer sweep STUDY.toml --search tpe --trials 50 --minimize validation.free_run_rmse
                                   where the ranges stand in the file; points follow the results so far
  trainer sweep STUDY.toml --search random --trials 50 --halving 4 --keep-one-in 3
                                   all for 4 epochs, the best third of them for 12, and so on
  trainer sweep configs/pinn.toml --search random --trials 20 estimator.hidden=[16],[32],[32,32] \
      fit.max_steps=20..200 --minimize seconds

A range is A..B or {from=A,to=B,scale=\"log\"}, both ends included, of whole numbers where both ends are. The best
trial's configuration is SWEEP/best.toml. Trials depend on the seed and on results, not on --threads.

estimator=NAME chooses the estimator and leaves out what the file sets for another one.

Every combination is resolved and checked before the first one runs, and frozen: SWEEP/sweep.json
lists the runs, each with its digest, its state and its folder below SWEEP/runs, which `trainer
report` reads. SWEEP/report.html, table.csv, table.md and table.tex put them side by side.

Exit codes: 0 done; 1 a run failed, or is outside its stated tolerance; 2 wrong input or usage,
nothing was run; 130 interrupted, what is done is kept. With --as-task 0 instead of 1. A search ends with 1 only
where no trial has a result.")]
pub(crate) struct SweepArguments {
    /// The experiment that every combination starts from: a TOML file
    #[arg(required_unless_present = "resume")]
    pub(crate) config: Option<PathBuf>,
    /// Keys to vary: KEY=V1,V2 or KEY=A..B, both ends included; in a search also
    /// KEY={from=A,to=B,scale="log"}
    #[arg(value_name = "KEY=VALUES")]
    pub(crate) axes: Vec<String>,
    #[command(flatten)]
    pub(crate) run: RunOptions,
    /// With --resume, repeats the failed runs
    #[arg(long, requires = "resume")]
    pub(crate) failed: bool,
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    #[command(flatten)]
    pub(crate) share: ShareOptions,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Options for choosing points, and for the measure by which they are judged.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Search")]
pub(crate) struct SearchOptions {
    /// Tries points drawn from ranges and choices instead of every combination
    #[arg(long, value_enum, value_name = "SAMPLER")]
    pub(crate) search: Option<SearchSampler>,
    /// With --search, total number of points [default: 50]
    #[arg(long, value_name = "N", requires = "search", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub(crate) trials: Option<u16>,
    /// Number in result.json to minimize, by its dotted path [default: validation.over_noise of a study of learners,
    /// else error_percent]
    #[arg(long, value_name = "PATH", conflicts_with = "maximize")]
    pub(crate) minimize: Option<String>,
    /// Number in result.json to maximize
    #[arg(long, value_name = "PATH")]
    pub(crate) maximize: Option<String>,
    /// With --search tpe, points proposed at once; results depend on it, not on the threads
    #[arg(long, value_name = "N", requires = "search", default_value_t = 4,
          value_parser = clap::value_parser!(u16).range(1..=1_000))]
    pub(crate) batch: u16,
    /// Successive halving: every trial trains for this many steps of its trace (epochs of a sequence model),
    /// the best continue
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) halving: Option<u64>,
    /// With --halving, one in N trials continues, for N times as many steps
    #[arg(long, value_name = "N", requires = "halving", default_value_t = 3,
          value_parser = clap::value_parser!(u16).range(2..=100))]
    pub(crate) keep_one_in: u16,
}

/// Method of choosing points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SearchSampler {
    /// Independent random points
    Random,
    /// Tree-structured Parzen estimator: near the best so far
    Tpe,
}

impl From<SearchSampler> for Sampler {
    fn from(sampler: SearchSampler) -> Self {
        match sampler {
            SearchSampler::Random => Self::Random,
            SearchSampler::Tpe => Self::Tpe,
        }
    }
}

impl SearchOptions {
    /// Returns `true` if a best run is asked for.
    pub(super) fn is_one(&self) -> bool {
        self.search.is_some() || self.minimize.is_some() || self.maximize.is_some() || self.halving.is_some()
    }

    pub(super) fn trials(&self) -> usize {
        self.trials.map_or(TRIALS, usize::from)
    }
}

impl SweepArguments {
    /// Returns the number of threads asked for, or one for each core.
    pub(super) fn threads(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        self.run.threads.map_or_else(cores, usize::from)
    }
}
