//! The program: its command line is the library's.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(trainer::main_from(std::env::args_os().collect(), None))
}
