//! Options shared by several commands.

use crate::error::TrainerError;
use crate::terminal::console;
use clap::Args;
use rayon::ThreadPool;
use runs::{Disk, RunFolder, default_root};
use serde::Serialize;
use std::path::PathBuf;

/// Runs the experiment of a configuration.
#[derive(Debug, Args)]
pub(crate) struct ExperimentArguments {
    /// The experiment: a TOML file
    pub(crate) config: Option<PathBuf>,
    /// Values that override the file's, by dotted key: estimator.hidden=[64] seed=3
    #[arg(value_name = "KEY=VALUE")]
    pub(crate) overrides: Vec<String>,
    #[command(flatten)]
    pub(crate) run: RunOptions,
    #[command(flatten)]
    pub(crate) output: Output,
    /// Disk on which folders are created: the system's disk or, in tests, one that fails.
    #[arg(skip)]
    pub(crate) disk: Disk,
}

/// Options of every command that runs a configuration.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct RunOptions {
    /// Folder for the output: new or empty [default: a new one below reports/runs]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Resumes the run in the folder of --out, with the same result to the bit; starts it if the folder is new
    #[arg(long, requires = "out")]
    pub(crate) resume: bool,
    /// Overrides the configuration's seed
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Threads over seeds, records, cases or runs; results do not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Options for the printed output.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct Output {
    /// Prints no progress and no table
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Prints the result alone, as JSON, on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

impl ExperimentArguments {
    /// Creates the folder that the arguments name, or a new one below the default root.
    pub(crate) fn new_folder(&self, name: &str) -> Result<RunFolder, TrainerError> {
        Ok(match &self.run.out {
            Some(path) => RunFolder::create_at_on(&self.disk, path)?,
            None => RunFolder::create_on(&self.disk, &default_root(), name)?,
        })
    }

    /// Creates a pool with the number of threads asked for.
    pub(crate) fn thread_pool(&self) -> Result<ThreadPool, TrainerError> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.run.threads.map_or(0, usize::from))
            .build()
            .map_err(|error| TrainerError::System { what: "threads", problem: error.to_string() })
    }
}

impl Output {
    /// Prints a result as JSON, as the given text, or not at all, depending on the options.
    pub(crate) fn print(
        self,
        result: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), TrainerError> {
        if self.json {
            let json = serde_json::to_string_pretty(result)
                .map_err(|error| TrainerError::System { what: "the result", problem: error.to_string() })?;
            console::result(&json);
        } else if !self.quiet {
            console::text(&text());
        }
        Ok(())
    }
}
