//! `trainer completions` and `trainer man`: output that clap generates from the description of the command
//! line.

use crate::error::TrainerError;
use crate::outcome::Outcome;
use crate::terminal::console;
use clap::Command;
use clap_complete::{Shell, generate};
use clap_mangen::Man;
use runs::RunFolder;
use std::path::Path;

/// Prints the completion script of a shell.
pub(crate) fn completions(mut program: Command, shell: Shell) -> Result<Outcome, TrainerError> {
    let mut script = Vec::new();
    generate(shell, &mut program, "trainer", &mut script);
    console::result(String::from_utf8_lossy(&script).trim_end());
    Ok(Outcome::Done)
}

/// Prints the manual page, or writes one for the program and one for each command into a new or empty folder.
pub(crate) fn man(mut program: Command, folder: Option<&Path>) -> Result<Outcome, TrainerError> {
    program.build();
    let Some(path) = folder else {
        console::result(String::from_utf8_lossy(&page(program)?).trim_end());
        return Ok(Outcome::Done);
    };
    let folder = RunFolder::create_at(path)?;
    for command in program.get_subcommands() {
        folder.write(&format!("trainer-{}.1", command.get_name()), &page(command.clone())?)?;
    }
    folder.write("trainer.1", &page(program)?)?;
    Ok(Outcome::Done)
}

fn page(command: Command) -> Result<Vec<u8>, TrainerError> {
    let mut text = Vec::new();
    Man::new(command)
        .render(&mut text)
        .map_err(|error| TrainerError::System { what: "the manual page", problem: error.to_string() })?;
    Ok(text)
}
