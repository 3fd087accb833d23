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

mod cli;
mod commands;
mod configured;
mod error;
mod everywhere;
mod fits;
mod folders;
mod misplaced;
mod options;
mod outcome;
mod run_table;
mod terminal;

use clap::{CommandFactory, FromArgMatches};
use cli::{Arguments, Command};
use commands::{
    check, cite, compare, diagnose, explain, export, init, list, manual, new, predict, report, run, schema,
    simulate, sweep, trials, verify,
};
use error::TrainerError;
use outcome::Outcome;
use std::process::ExitCode;
use terminal::console;

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

fn dispatch(arguments: Arguments) -> Result<Outcome, TrainerError> {
    match arguments.command {
        Some(Command::List { what, folder, output }) => list::list(what, folder.as_deref(), output),
        Some(Command::Sweep(arguments)) => sweep::command(&arguments),
        Some(Command::Compare(arguments)) => compare::command(&arguments),
        Some(Command::Check(arguments)) => check::command(&arguments),
        Some(Command::Cite(arguments)) => cite::command(&arguments),
        Some(Command::Explain(arguments)) => explain::command(&arguments),
        Some(Command::Diagnose(arguments)) => diagnose::command(&arguments),
        Some(Command::Init(arguments)) => init::command(&arguments),
        Some(Command::Schema { purpose }) => schema::command(purpose),
        Some(Command::New(arguments)) => new::command(&arguments),
        Some(Command::Predict(arguments)) => predict::command(&arguments),
        Some(Command::Simulate(arguments)) => simulate::command(&arguments),
        Some(Command::Trials(arguments)) => trials::command(&arguments),
        Some(Command::Verify { run, threads, output }) => verify::command(&run, threads, output),
        Some(Command::Export(arguments)) => export::command(&arguments),
        Some(Command::Completions { shell }) => manual::completions(Arguments::command(), shell),
        Some(Command::Man { folder }) => manual::man(Arguments::command(), folder.as_deref()),
        Some(Command::Report { run, output }) => report::command(&run, output),
        None => run::run(&arguments.experiment),
    }
}
