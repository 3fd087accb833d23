//! Arguments of `trainer compare`.

use crate::options::Output;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Finished runs in one table.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer compare reports/runs/pinn-A reports/runs/pinn-B
  trainer compare 'reports/runs/pinn-*' --sort error       a quoted pattern
  trainer compare SWEEP OTHER                              all runs of sweeps
  trainer compare reports/runs --sort seconds --reverse    every run in a folder, the slowest first
  trainer compare SWEEP --format csv > table.csv
  trainer compare SWEEP --out DIR                          report.html, table.{csv,md,tex}, result.json

The columns are the configuration keys in which the runs differ, the estimate, its standard error,
the error (distance from closed-form least squares on the same envelope), steps, seconds and the state
in which the fit ended. A folder that cannot be read is a row with the reason; the others are shown.")]
pub(crate) struct CompareArguments {
    /// Run folders, sweep folders, folders of runs, or quoted patterns with * ? [ ]
    #[arg(value_name = "RUN", required = true)]
    pub(crate) runs: Vec<String>,
    /// Sorts by a column: run, method, zeta, error, worst, steps, seconds, state, or a configuration key
    #[arg(long, value_name = "KEY")]
    pub(crate) sort: Option<String>,
    /// With --sort, the largest first
    #[arg(long, requires = "sort")]
    pub(crate) reverse: bool,
    /// Form of the output
    #[arg(long, value_enum, conflicts_with = "json")]
    pub(crate) format: Option<Format>,
    /// Writes report.html, table.csv, table.md, table.tex and result.json to a new or empty folder
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Format in which a table is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Aligned columns
    Text,
    /// Comma-separated values, every digit
    Csv,
    /// GitHub Markdown
    #[value(alias = "md")]
    Markdown,
    /// LaTeX table with the rules of booktabs
    #[value(alias = "tex")]
    Latex,
    /// HTML page
    Html,
}
