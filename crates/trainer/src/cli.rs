//! Command line: all subcommands with their arguments.

use crate::commands::cite::CiteArguments;
use crate::commands::compare::arguments::CompareArguments;
use crate::commands::diagnose::arguments::DiagnoseArguments;
use crate::commands::explain::ExplainArguments;
use crate::commands::export::ExportArguments;
use crate::commands::init::InitArguments;
use crate::commands::list::Listing;
use crate::commands::new::NewArguments;
use crate::commands::predict::PredictArguments;
use crate::commands::schema::Purpose;
use crate::commands::serve::ServeArguments;
use crate::commands::sweep::arguments::SweepArguments;
use crate::commands::trials::arguments::TrialsArguments;
use crate::configured::ConfigArguments;
use crate::options::{ExperimentArguments, Output};
use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// Estimates the damping of oscillators from records, compared with closed-form least squares, and
/// diagnoses the gap between a simulator and records.
#[derive(Debug, Parser)]
#[command(
    name = "trainer",
    version,
    args_conflicts_with_subcommands = true,
    arg_required_else_help = true,
    after_help = "\
Examples:
  trainer init log.csv                            looks at your log and says how to go on
  trainer configs/pinn.toml                       the shipped, simulated record
  trainer configs/compare.toml                    many methods side by side
  trainer configs/pinn.toml seed=3 fit.seeds=10   ten seeds from 3 on, the worst reported
  trainer configs/pinn.toml data.path=log.csv data.value=theta data.unit=deg
  trainer configs/lstm-amortized.toml fit.seeds=100 --out RUN --resume
                                                  starts, or resumes after an interruption
  trainer configs/pinn.toml --json | jq .estimate.zeta
  trainer diagnose record.csv --nominal nominal.toml
  trainer configs/learn.toml                      the dynamics, learned and judged on unseen records
  trainer predict MODEL record.csv                a learned model on a record
  trainer new learner NAME --kind sequence        a learner of your own, which trains at once
  trainer new estimator NAME                      an estimator of your own, in every comparison
  trainer simulate configs/simulate.toml          records whose truth is known, and sealed
  trainer trials configs/trials-quick.toml        the diagnosis on effects withheld from it, scored
  trainer sweep configs/pinn.toml estimator=pinn,lstm seed=0..9   every combination, resumable
  trainer compare 'reports/runs/pinn-*'           runs side by side
  trainer check configs/compare.toml seed=3       would it run? nothing is run or written
  trainer explain fit.tolerance_percent configs/pinn.toml
  trainer schema > ringdown.schema.json           for editors: #:schema ringdown.schema.json
  trainer list estimators
  trainer list learners
  trainer list effects
  trainer list runs                               what lies below reports/runs
  trainer report reports/runs/RUN
  trainer serve                                   the page on which a log is dropped
  trainer verify reports/runs/RUN                 runs it again: identical, or where it differs
  trainer cite reports/runs/RUN                   the literature that it follows, as BibTeX
  trainer export reports/runs/RUN --to tensorboard,mlflow

Exit codes: 0 done; 1 done, but a stated check failed; 2 wrong input or
usage; 130 interrupted (Ctrl-C, SIGTERM, q and Enter): fits, sweeps and trials
save the best so far, and --resume goes on; a single diagnosis saves nothing."
)]
pub(crate) struct Arguments {
    /// A command other than running a configuration.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Running a configuration.
    #[command(flatten)]
    pub(crate) experiment: ExperimentArguments,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Checks a configuration and that its data can be read; runs and writes nothing
    Check(ConfigArguments),
    /// Prints the completion script of a shell
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Prints the manual page, or writes one for each command into a folder
    Man {
        /// Folder for the pages: new or empty
        #[arg(value_name = "DIR")]
        folder: Option<PathBuf>,
    },
    /// Prints the literature that a run, or an estimator, follows, as BibTeX
    Cite(CiteArguments),
    /// Diagnoses the gap between a nominal simulator and records: where it is, which effects cause it, how far it closes
    Diagnose(Box<DiagnoseArguments>),
    /// Explains a configuration's values: what they mean and where they were set
    Explain(ExplainArguments),
    /// Looks at a log and writes a nominal simulator and a configuration to start from
    Init(Box<InitArguments>),
    /// Lists estimators, learners of dynamics, effects or runs
    List {
        /// Kind of things to list
        #[arg(value_enum, default_value_t = Listing::Estimators)]
        what: Listing,
        /// With runs, the folder that holds them, or a sweep's folder [default: reports/runs]
        #[arg(value_name = "DIR")]
        folder: Option<PathBuf>,
        #[command(flatten)]
        output: Output,
    },
    /// Writes the skeleton of something new, which compiles and trains
    New(NewArguments),
    /// Runs a learned model on a record that it never saw
    Predict(PredictArguments),
    /// Prints the JSON Schema of configurations, for editors
    Schema {
        /// Purpose of the file [default: what its key `task` says]
        #[arg(value_enum)]
        purpose: Option<Purpose>,
    },
    /// Offers the page on which a log is dropped, on this computer alone
    Serve(ServeArguments),
    /// Simulates records of systems drawn from priors; their true parameters are sealed in a separate folder
    Simulate(ExperimentArguments),
    /// Runs every combination of some keys' values, in parallel; resumable
    Sweep(Box<SweepArguments>),
    /// Compares finished runs in one table
    Compare(CompareArguments),
    /// Tests the diagnosis blind on simulated cases with sealed truths, and scores it
    Trials(Box<TrialsArguments>),
    /// Repeats a finished run from its folder and reports any difference
    Verify {
        /// The run's folder
        run: PathBuf,
        /// Threads over seeds or records; results do not depend on it [default: one for each core]
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: Option<u16>,
        #[command(flatten)]
        output: Output,
    },
    /// Writes finished runs for TensorBoard or MLflow
    Export(ExportArguments),
    /// Rebuilds the report of a finished run from its folder
    Report {
        /// The run's folder
        run: PathBuf,
        #[command(flatten)]
        output: Output,
    },
}
