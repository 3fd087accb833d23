//! `trainer new`: the skeleton of a learner, which compiles, trains and is listed at once.

use crate::error::{NewError, TrainerError};
use crate::options::Output;
use crate::outcome::Outcome;
use ::learn::learners::LEARNERS;
use clap::{Args, Subcommand, ValueEnum};
use runs::write_file;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `trainer new`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer new estimator echo-state --kind sequence
  trainer new estimator spline-torque --kind field
Then:
  cargo run --release -p trainer -- configs/learn/echo-state.toml
  cargo test -p learn learners")]
pub(crate) struct NewArguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Writes the skeleton of an estimator of dynamics into a checkout of Ringdown: one file, its two lines
    /// in the registry and a configuration
    Estimator {
        /// Its identifier: lowercase letters, digits and hyphens
        name: String,
        /// Form of the model: from past and input to the future, a torque as a function of the state, or
        /// coefficients
        #[arg(long, value_enum)]
        kind: Form,
        /// The checkout [default: the one that the current folder is in]
        #[arg(long, value_name = "DIR")]
        workspace: Option<PathBuf>,
        #[command(flatten)]
        output: Output,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// A network from a window of the past and the input to the future
    Sequence,
    /// A torque as a function of position and velocity
    Field,
    /// Coefficients of a stated law
    Regressor,
}

impl Form {
    fn template(self) -> &'static str {
        match self {
            Self::Sequence => include_str!("sequence.txt"),
            Self::Field => include_str!("field.txt"),
            Self::Regressor => include_str!("regressor.txt"),
        }
    }
}

/// Path of the learners' registry in a checkout.
const REGISTRY: &str = "crates/learn/src/learners/mod.rs";

/// Line after which the registry's entries begin.
const ENTRIES: &str = "pub static LEARNERS: &[Entry] = &[\n";

/// Reserved words of Rust that could be names.
const KEPT: [&str; 20] = [
    "abstract", "async", "box", "crate", "do", "dyn", "enum", "final", "fn", "loop", "match", "mod", "move",
    "self", "static", "super", "trait", "type", "use", "where",
];

/// Writes the files of the skeleton.
pub(crate) fn command(arguments: &NewArguments) -> Result<Outcome, TrainerError> {
    let What::Estimator { name, kind, workspace, output } = &arguments.what;
    let is_word = |word: &str| {
        word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
            && word.chars().next().is_some_and(|first| first.is_ascii_lowercase())
    };
    if !name.split('-').all(is_word) || KEPT.contains(&name.as_str()) {
        return Err(NewError::Name { name: name.clone() }.into());
    }
    let home = checkout(workspace.as_deref())?;
    let module = name.replace('-', "_");
    let registry_path = home.join(REGISTRY);
    let source_path = home.join(format!("crates/learn/src/learners/{module}.rs"));
    let config_path = home.join(format!("configs/learn/{name}.toml"));
    let registry = read(&registry_path)?;
    let is_taken = LEARNERS.iter().any(|entry| entry.id == name)
        || registry.contains(&format!("mod {module};"))
        || [&source_path, &config_path].into_iter().any(|path| path.exists());
    if is_taken {
        return Err(NewError::Taken { name: name.clone() }.into());
    }
    let registered = registered(&registry, &module)
        .ok_or_else(|| NewError::Registry { file: registry_path.display().to_string() })?;
    // The registry is written last: until it names the file, nothing else knows of it.
    write_file(&source_path, filled(kind.template(), name).as_bytes())?;
    write_file(&config_path, filled(include_str!("config.txt"), name).as_bytes())?;
    write_file(&registry_path, registered.as_bytes())?;
    let shown = |path: &Path| path.display().to_string();
    let files = [&source_path, &config_path, &registry_path].map(|path| shown(path));
    let result = json!({ "estimator": name, "files": files });
    output.print(&result, || {
        let [source, config, registry] = &files;
        format!(
            "{source}: written, yours to change\n{config}: written\n{registry}: two lines\n\nnext:\n  cargo run --release -p \
             trainer -- configs/learn/{name}.toml\n  cargo test -p learn learners"
        )
    })?;
    Ok(Outcome::Done)
}

/// Finds the checkout that contains a folder.
fn checkout(stated: Option<&Path>) -> Result<PathBuf, NewError> {
    let given = stated.unwrap_or(Path::new("."));
    let from = given.canonicalize().unwrap_or_else(|_| given.to_path_buf());
    let found = from.ancestors().find(|folder| folder.join(REGISTRY).is_file());
    found.map(Path::to_path_buf).ok_or_else(|| NewError::NoCheckout { folder: from.display().to_string() })
}

fn read(path: &Path) -> Result<String, NewError> {
    let file = path.display().to_string();
    std::fs::read_to_string(path).map_err(|error| NewError::Unreadable { file, reason: error.to_string() })
}

/// Adds a module and its entry to the registry's text; `None` if the registry has an unexpected form.
fn registered(registry: &str, module: &str) -> Option<String> {
    let line = format!("pub mod {module};\n");
    let modules = registry.lines().filter(|line| line.starts_with("pub mod "));
    let next = modules.map(|own| format!("{own}\n")).find(|own| own.as_str() > line.as_str());
    let with_module = match &next {
        Some(next) => registry.replacen(next.as_str(), &format!("{line}{next}"), 1),
        None => {
            let last = registry.lines().rfind(|line| line.starts_with("pub mod "))?;
            registry.replacen(&format!("{last}\n"), &format!("{last}\n{line}"), 1)
        }
    };
    let (before, after) = with_module.split_once(ENTRIES)?;
    let (entries, rest) = after.split_once("];")?;
    Some(format!("{before}{ENTRIES}{entries}    {module}::ENTRY,\n];{rest}"))
}

/// Fills a name into a template.
fn filled(template: &str, name: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters
            .next()
            .map(|first| first.to_ascii_uppercase().to_string() + letters.as_str())
            .unwrap_or_default()
    };
    let type_name: String = name.split('-').map(capital).collect();
    let title = capital(&name.replace('-', " "));
    template.replace("NewType", &type_name).replace("NEW-TITLE", &title).replace("new-id", name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_registry_gets_a_module_in_its_place_and_an_entry_at_its_end() {
        let before = include_str!("../../../../learn/src/learners/mod.rs");
        for (module, next) in [("echo_state", "pub mod gaussian_process;"), ("zigzag", "\nuse crate::Entry;")]
        {
            let after = registered(before, module).unwrap();
            assert!(after.contains(&format!("pub mod {module};\n{next}")), "{after}");
            assert!(after.contains(&format!("    {module}::ENTRY,\n];")), "{after}");
            assert_eq!(after.lines().count(), before.lines().count() + 2);
        }
        assert!(registered("pub mod a;\n", "b").is_none());
    }

    #[test]
    fn no_placeholder_is_left() {
        for kind in [Form::Sequence, Form::Field, Form::Regressor] {
            let text = filled(kind.template(), "echo-state");
            assert!(text.contains("pub struct EchoState") && text.contains("\"echo-state\""));
            assert!(!text.contains("NewType") && !text.contains("NEW-TITLE") && !text.contains("new-id"));
        }
    }
}
