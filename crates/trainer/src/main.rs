//! Executable of the command line, which is implemented in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(trainer::main_from(std::env::args_os().collect(), None))
}
