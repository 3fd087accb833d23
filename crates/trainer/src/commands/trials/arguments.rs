//! Arguments of `trainer trials`.

use crate::options::{ExperimentArguments, Output, RunOptions};
use crate::share::ShareOptions;
use clap::Args;
use std::path::PathBuf;

/// Withheld-effect trials: creates cases whose truth is sealed, diagnoses them blind, opens the seals, and
/// scores the answers.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer trials configs/trials-quick.toml          a few cases of every bank
  trainer trials configs/trials.toml --out DIR      all of them
  trainer trials configs/trials.toml --out DIR --resume
                                   after an interruption: only the missing answers are computed
  trainer trials --score DIR       opens the seals and scores again, from the files alone
  trainer trials configs/trials.toml --check        exit code 1 where a bar is missed beyond chance
  trainer trials configs/trials-gate.toml           exit code 1 where a value of [gate] is missed
  trainer trials configs/trials.toml --out DIR --shard 2/8
                                   the second of eight shares; all may run at once on one folder, and the one that
                                   gives the last answer opens the seals and scores
  trainer trials configs/trials.toml --out DIR --launcher slurm --shards 50
                                   a job array with one task for each share
  trainer report DIR               the report again

DIR holds cases/GROUP/ID/ (what the diagnosis is given), manifest.json (digests of records and
truths, written before the first diagnosis), answers/GROUP/ID/diagnosis.json, truth/ID.json (written
after the last diagnosis), failed.json (why cases have no answer), result.json, cases.csv and
report.html. GROUP is `full`, or `without-EFFECT` where the diagnosis is told not to consider an
effect. Each group is diagnosed by a process of its own, which gets that group's folder of cases and
nothing else.

Exit codes: 0 scored, whatever the scores; 1 where a score misses a value that the configuration's
[gate] asks for, and with --check where the whole 95 % interval of a score lies on the wrong side of
its bar; 2 wrong input or usage, or a broken seal; 130 interrupted: everything so far is kept. With
--as-task 0 instead of 1.")]
pub(crate) struct TrialsArguments {
    /// The trials: a TOML file
    #[arg(required_unless_present = "score", conflicts_with = "score")]
    pub(crate) config: Option<PathBuf>,
    /// Values that override the file's, by dotted key: trials.single=100 seed=3
    #[arg(value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    #[command(flatten)]
    pub(crate) run: RunOptions,
    /// Opens the seals of these trials and scores their answers again
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "resume", "seed", "launcher"])]
    pub(crate) score: Option<PathBuf>,
    /// Ends with exit code 1 if the whole 95 % interval of a score lies on the wrong side of its bar
    #[arg(long)]
    pub(crate) check: bool,
    #[command(flatten)]
    pub(crate) share: ShareOptions,
    #[command(flatten)]
    pub(crate) output: Output,
}

impl From<&ExperimentArguments> for TrialsArguments {
    /// Converts the arguments of a configuration that was named without the command.
    fn from(arguments: &ExperimentArguments) -> Self {
        Self {
            config: arguments.config.clone(),
            overrides: arguments.overrides.clone(),
            run: arguments.run.clone(),
            score: None,
            check: false,
            share: ShareOptions::default(),
            output: arguments.output,
        }
    }
}
