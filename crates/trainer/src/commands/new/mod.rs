//! `trainer new`: skeletons of a learner and of an estimator, which compile, run and are listed at once.

mod estimator;
mod learner;
mod skeleton;

use crate::error::{NewError, TrainerError};
use crate::options::Output;
use crate::outcome::Outcome;
use clap::{Args, Subcommand};
use learner::Form;
use runs::write_file;
use serde_json::{Value, json};
use skeleton::Skeleton;
use std::path::{Path, PathBuf};

/// Arguments of `trainer new`.
#[derive(Debug, Args)]
#[command(after_help = "\
A learner learns dynamics from sets of records and is scored on records that it has not seen; an estimator
reads the damping from the peaks of one decay.

Examples:
  trainer new learner echo-state --kind sequence
  trainer new learner spline-torque --kind field
  trainer new estimator robust-line
Then:
  cargo run --release -p trainer -- configs/learn/echo-state.toml
  cargo test -p learn learners
  cargo run -p trainer -- configs/compare.toml compare.methods=robust-line,pinn,ols
  cargo test -p registry robust-line::")]
pub(crate) struct NewArguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Writes the skeleton of a learner of dynamics into a checkout of Ringdown: one file, its two lines in
    /// the registry and a configuration
    Learner {
        /// Form of the model: from past and input to the future, a torque as a function of the state, or
        /// coefficients
        #[arg(long, value_enum)]
        kind: Form,
        #[command(flatten)]
        given: Given,
    },
    /// Writes the skeleton of an estimator of the damping into a checkout of Ringdown: a crate of two files
    /// and its two lines in the registry
    Estimator {
        /// Writes a learner of this form instead, as `trainer new learner` does
        #[arg(long, value_enum, hide = true)]
        kind: Option<Form>,
        #[command(flatten)]
        given: Given,
    },
}

#[derive(Debug, Args)]
struct Given {
    /// Its identifier: lowercase letters, digits and hyphens
    name: String,
    /// The checkout [default: the one that the current folder is in]
    #[arg(long, value_name = "DIR")]
    workspace: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// Reserved words of Rust that could be names.
const KEPT: [&str; 20] = [
    "abstract", "async", "box", "crate", "do", "dyn", "enum", "final", "fn", "loop", "match", "mod", "move",
    "self", "static", "super", "trait", "type", "use", "where",
];

/// Writes the files of the skeleton.
pub(crate) fn command(arguments: &NewArguments) -> Result<Outcome, TrainerError> {
    let (given, form) = match &arguments.what {
        What::Learner { kind, given } => (given, Some(*kind)),
        What::Estimator { kind, given } => (given, *kind),
    };
    let name = &given.name;
    let is_word = |word: &str| {
        word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
            && word.chars().next().is_some_and(|first| first.is_ascii_lowercase())
    };
    if !name.split('-').all(is_word) || KEPT.contains(&name.as_str()) {
        return Err(NewError::Name { name: name.clone() }.into());
    }
    let home = checkout(given.workspace.as_deref())?;
    let skeleton = match form {
        Some(form) => learner::skeleton(&home, name, form),
        None => estimator::skeleton(&home, name),
    }?;
    // Registries are written last: until they name the files, nothing else knows of them.
    for (path, text) in skeleton.files.iter().chain(&skeleton.registries) {
        let folder = path.parent().unwrap_or(&home);
        std::fs::create_dir_all(folder).map_err(|error| NewError::NoFolder {
            folder: folder.display().to_string(),
            reason: error.to_string(),
        })?;
        write_file(path, text.as_bytes())?;
    }
    given.output.print(&result(name, &skeleton), || summary(name, &skeleton))?;
    Ok(Outcome::Done)
}

fn result(name: &str, skeleton: &Skeleton) -> Value {
    let files = skeleton.files.iter().chain(&skeleton.registries);
    let files: Vec<String> = files.map(|(path, _)| path.display().to_string()).collect();
    json!({ skeleton.what: name, "files": files })
}

fn summary(name: &str, skeleton: &Skeleton) -> String {
    let Skeleton { what, does, files, registries, next } = skeleton;
    let files = files.iter().map(|(path, _)| format!("{}: written, yours to change", path.display()));
    let registries = registries.iter().map(|(path, _)| format!("{}: its lines added", path.display()));
    let next = next.iter().map(|command| format!("  {command}"));
    let first = format!("{name}: {what}, which {does}");
    let lines: Vec<String> = [first]
        .into_iter()
        .chain(files)
        .chain(registries)
        .chain(["\nnext:".to_owned()])
        .chain(next)
        .collect();
    lines.join("\n")
}

/// Finds the checkout that contains a folder.
fn checkout(stated: Option<&Path>) -> Result<PathBuf, NewError> {
    let given = stated.unwrap_or(Path::new("."));
    let from = given.canonicalize().unwrap_or_else(|_| given.to_path_buf());
    let found = from.ancestors().find(|folder| folder.join(learner::REGISTRY).is_file());
    found.map(Path::to_path_buf).ok_or_else(|| NewError::NoCheckout { folder: from.display().to_string() })
}
