//! Command line of Ringdown: registry and wiring.

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
mod own_program;
mod run_table;
mod share;
mod terminal;

use clap::{CommandFactory, FromArgMatches};
use cli::{Arguments, Command};
use commands::{
    check, cite, compare, diagnose, explain, export, init, list, manual, new, predict, report, run, schema,
    serve, simulate, sweep, trials, verify,
};
use error::TrainerError;
use outcome::Outcome;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use terminal::console;

/// Exit code for wrong input or usage.
const WRONG_USAGE: u8 = 2;

/// Runs the program with its command line, which starts with the program's own name, and returns the exit
/// code: 0 done, 1 a stated check failed, 2 wrong input or usage, 130 interrupted.
///
/// Prints to standard output and standard error, handles Ctrl-C itself, and may end the process when
/// interrupted, so it needs a process of its own. `program` is the file that starts the program, if it is not
/// the process's own executable.
#[must_use]
pub fn main_from(line: Vec<OsString>, program: Option<PathBuf>) -> u8 {
    program.into_iter().for_each(own_program::started_as);
    let command = everywhere::everywhere(Arguments::command()).name(name_of(&line));
    let names: Vec<String> = command.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let words: Vec<String> = line.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    if let Some(message) = misplaced::remedy(&words, &names) {
        console::error(&message);
        return WRONG_USAGE;
    }
    let matched = command.try_get_matches_from(line).and_then(|found| Arguments::from_arg_matches(&found));
    let arguments = match matched {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are not errors and go to standard output; clap knows which is which.
            let _ = error.print();
            return if error.use_stderr() { WRONG_USAGE } else { 0 };
        }
    };
    match dispatch(arguments).and_then(printed) {
        Ok(outcome) => outcome.exit_code(),
        Err(error) => {
            console::error(&error.to_string());
            error.exit_code()
        }
    }
}

/// Returns the program's name: that of the Python wheel, or that of the cargo build.
fn name_of(line: &[OsString]) -> &'static str {
    let stem = line.first().and_then(|own| Path::new(own).file_stem());
    if stem.is_some_and(|stem| stem == "ringdown") { "ringdown" } else { "trainer" }
}

/// Returns the outcome, or an error if a result did not reach standard output.
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
        Some(Command::Serve(arguments)) => serve::command(&arguments),
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
