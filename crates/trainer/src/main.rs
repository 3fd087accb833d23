//! The command line: registry and wiring.

#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::disallowed_methods
    )
)]

mod agreement;
mod cautions;
mod check;
mod cite;
mod cli;
mod compare;
mod configured;
mod console;
mod diagnose;
mod environment;
mod error;
mod estimate;
mod everywhere;
mod explain;
mod fit;
mod init;
mod input;
mod interrupt;
mod known_truth;
mod learn;
mod list;
mod list_runs;
mod manual;
mod method;
mod misplaced;
mod predict;
mod progress;
mod quit;
mod rerender;
mod resume;
mod run;
mod schema;
mod side_by_side;
mod simulate;
mod summary;
mod sweep;
mod tracking;
mod trials;
mod verify;
mod watcher;

use clap::{CommandFactory, FromArgMatches};
use cli::{Arguments, Command};
use error::TrainerError;
use std::process::ExitCode;

fn main() -> ExitCode {
    let command = everywhere::everywhere(Arguments::command());
    let names: Vec<String> = command.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let words: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    if let Some(message) = misplaced::remedy(&words, &names) {
        console::error(&message);
        return ExitCode::from(2);
    }
    let arguments = Arguments::from_arg_matches(&command.get_matches());
    match dispatch(arguments.unwrap_or_else(|error| error.exit())).and_then(printed) {
        Ok(outcome) => ExitCode::from(outcome.exit_code()),
        Err(error) => {
            console::error(&error.to_string());
            ExitCode::from(error.exit_code())
        }
    }
}

/// An outcome whose result, if any was to be printed, reached standard output.
fn printed(outcome: Outcome) -> Result<Outcome, TrainerError> {
    match console::lost() {
        None => Ok(outcome),
        Some(problem) => Err(TrainerError::Unprinted { problem: problem.to_owned() }),
    }
}

/// How a command that gave a result ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// Done, and every stated check holds.
    Done,
    /// Done, but a stated check failed.
    CheckFailed,
    /// Stopped on request; the best so far is saved.
    Interrupted,
}

impl Outcome {
    fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::CheckFailed => 1,
            Self::Interrupted => 130,
        }
    }
}

fn dispatch(arguments: Arguments) -> Result<Outcome, TrainerError> {
    match arguments.command {
        Some(Command::List { what, folder, output }) => list::list(what, folder.as_deref(), output),
        Some(Command::Sweep(arguments)) => sweep::command(&arguments),
        Some(Command::Compare(arguments)) => side_by_side::command(&arguments),
        Some(Command::Check(arguments)) => check::command(&arguments),
        Some(Command::Cite(arguments)) => cite::command(&arguments),
        Some(Command::Explain(arguments)) => explain::command(&arguments),
        Some(Command::Diagnose(arguments)) => diagnose::command(&arguments),
        Some(Command::Init(arguments)) => init::command(&arguments),
        Some(Command::Schema { purpose }) => schema::command(purpose),
        Some(Command::Predict(arguments)) => learn::predict::command(&arguments),
        Some(Command::Simulate(arguments)) => simulate::command(&arguments),
        Some(Command::Trials(arguments)) => trials::command(&arguments),
        Some(Command::Verify { run, threads, output }) => verify::verify(&run, threads, output),
        Some(Command::Export(arguments)) => tracking::command(&arguments),
        Some(Command::Completions { shell }) => manual::completions(shell),
        Some(Command::Man { folder }) => manual::man(folder.as_deref()),
        Some(Command::Report { run, output }) => rerender::rerender(&run, output),
        None => run::run(&arguments.experiment),
    }
}
