//! Shares of work and their launchers: the parts common to `sweep`, `trials` and `diagnose --batch`.

mod script;
mod slurm;

use crate::outcome::Outcome;
use clap::{Args, ValueEnum};
use experiment::sweep::Shard;
use script::SlurmOption;

pub(crate) use slurm::{Work, launch};

/// Options for shares and their launcher.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Many machines")]
pub(crate) struct ShareOptions {
    /// Works on the I-th of N shares only; all may run at once on one folder, and a repeated one does no harm
    #[arg(long, value_name = "I/N", requires = "out")]
    pub(crate) shard: Option<Shard>,
    /// Exit code 0 once the share is worked through, whatever the results of its runs or cases: for batch
    /// systems, where another code means that the task has to be run again
    #[arg(long)]
    pub(crate) as_task: bool,
    /// Hands the shares to a batch system instead of working here
    #[arg(long, value_enum, conflicts_with = "shard")]
    pub(crate) launcher: Option<Launcher>,
    /// With --launcher, the number of shares
    #[arg(long, value_name = "N", requires = "launcher", default_value_t = 8,
          value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub(crate) shards: u16,
    /// With --launcher, writes the job script and the commands that submit it, and submits nothing
    #[arg(long, requires = "launcher")]
    pub(crate) write_only: bool,
    /// With --launcher, an option of sbatch, without its dashes: partition=long, time=2:00:00, mem=4G, account=lab, exclusive
    #[arg(long, value_name = "NAME[=VALUE]", requires = "launcher", value_parser = SlurmOption::parse)]
    pub(crate) slurm_option: Vec<SlurmOption>,
    /// With --launcher, a line of shell before the program starts: 'module load gcc'
    #[arg(long, value_name = "LINE", requires = "launcher", value_parser = script::line)]
    pub(crate) slurm_setup: Vec<String>,
    /// With --launcher, words before the program's own: 'apptainer exec image.sif'
    #[arg(long, value_name = "WORDS", requires = "launcher", value_parser = script::line)]
    pub(crate) slurm_prefix: Option<String>,
    /// With --launcher, maximum number of tasks that run at the same time
    #[arg(long, value_name = "N", requires = "launcher", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) slurm_at_once: Option<u16>,
}

impl ShareOptions {
    /// Returns the share in force: all of the work if none is named.
    pub(crate) fn shard(&self) -> Shard {
        self.shard.unwrap_or(Shard::ALL)
    }

    /// Returns the outcome of a command: with `--as-task`, a failed check counts as done.
    pub(crate) fn outcome(&self, outcome: Outcome) -> Outcome {
        if self.as_task && outcome == Outcome::CheckFailed { Outcome::Done } else { outcome }
    }
}

/// Options of the launcher, with and without a value; they are not passed to the tasks.
const OF_THE_LAUNCH: ([&str; 7], [&str; 4]) = (
    [
        "--launcher",
        "--shards",
        "--slurm-option",
        "--slurm-setup",
        "--slurm-prefix",
        "--slurm-at-once",
        "--threads",
    ],
    ["--write-only", "--as-task", "--json", "--resume"],
);

/// Removes the launcher's options from the words of a command line.
pub(crate) fn without_launcher(words: &[String]) -> Vec<String> {
    let (valued, flags) = OF_THE_LAUNCH;
    let mut kept = Vec::new();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let name = word.split('=').next().unwrap_or(word);
        if valued.contains(&name) {
            if !word.contains('=') {
                words.next();
            }
        } else if !flags.contains(&word.as_str()) {
            kept.push(word.clone());
        }
    }
    kept
}

/// Batch system that runs the shares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Launcher {
    /// Slurm job arrays, submitted with sbatch
    Slurm,
}

#[cfg(test)]
mod tests {
    use super::{Launcher, ShareOptions, without_launcher};
    use clap::{Args, ValueEnum};

    fn words(line: &str) -> Vec<String> {
        line.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn the_tasks_of_a_launch_do_not_launch() {
        let line = "diagnose --batch A --launcher slurm --out B --slurm-option=time=1 --threads 2 --slurm-setup x=y --json \
                    --unit deg --without a,b --write-only";
        let line = line.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(
            without_launcher(&words(&line)),
            words("diagnose --batch A --out B --unit deg --without a,b")
        );
    }

    /// An option added to these must be removed from the words of the tasks as well.
    #[test]
    fn every_option_of_the_launch_is_known() {
        let command = ShareOptions::augment_args(clap::Command::new("x"));
        for argument in command.get_arguments() {
            let option = format!("--{}", argument.get_long().unwrap());
            if option != "--shard" {
                let value = if argument.get_action().takes_values() { " slurm" } else { "" };
                assert_eq!(without_launcher(&words(&format!("x {option}{value} y"))), ["x", "y"], "{option}");
            }
        }
        assert!(Launcher::from_str("slurm", false).is_ok());
    }
}
