//! Skeleton of a learner of dynamics.

use super::skeleton::{Skeleton, below_last, filled, read, registered};
use crate::error::NewError;
use clap::ValueEnum;
use learn::learners::LEARNERS;
use std::path::Path;

/// Form of a learner's model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Form {
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
pub(super) const REGISTRY: &str = "crates/learn/src/learners/mod.rs";

/// Returns the files of a new learner.
///
/// # Errors
/// [`NewError`] if the name is taken, or the registry has an unexpected form.
pub(super) fn skeleton(home: &Path, name: &str, form: Form) -> Result<Skeleton, NewError> {
    let module = name.replace('-', "_");
    let source = home.join(format!("crates/learn/src/learners/{module}.rs"));
    let config = home.join(format!("configs/learn/{name}.toml"));
    let is_known = LEARNERS.iter().any(|entry| entry.id == name)
        || read(&home.join(REGISTRY))?.contains(&format!("mod {module};"));
    if is_known || source.exists() || config.exists() {
        return Err(NewError::Taken { what: "a learner", name: name.to_owned() });
    }
    Ok(Skeleton {
        what: "learner",
        does: "learns dynamics from sets of records",
        files: vec![
            (source, filled(form.template(), name)),
            (config, filled(include_str!("config.txt"), name)),
        ],
        registries: vec![registered(home.join(REGISTRY), |text| with_learner(text, &module))?],
        next: vec![
            format!("cargo run --release -p trainer -- configs/learn/{name}.toml"),
            "cargo test -p learn learners".to_owned(),
        ],
    })
}

/// Adds a module, in its alphabetic place, and its entry to the registry's text; `None` if the registry has
/// an unexpected form.
fn with_learner(registry: &str, module: &str) -> Option<String> {
    let line = format!("pub mod {module};");
    let is_before = |other: &str| other.starts_with("pub mod ") && other < line.as_str();
    let is_entry = |other: &str| other.starts_with("    ") && other.ends_with("::ENTRY,");
    let with_module = below_last(registry, &line, |other| is_before(other))
        .or_else(|| Some(registry.replacen("pub mod ", &format!("{line}\npub mod "), 1)))?;
    below_last(&with_module, &format!("    {module}::ENTRY,"), is_entry)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_registry_gets_a_module_in_its_place_and_an_entry_at_its_end() {
        let before = include_str!("../../../../learn/src/learners/mod.rs");
        for (module, next) in [
            ("aardvark", "pub mod bayesian;"),
            ("echo_state", "pub mod gaussian_process;"),
            ("zigzag", "\nuse crate::Entry;"),
        ] {
            let after = with_learner(before, module).unwrap();
            assert!(after.contains(&format!("pub mod {module};\n{next}")), "{after}");
            assert!(after.contains(&format!("    {module}::ENTRY,\n];")), "{after}");
            assert_eq!(after.lines().count(), before.lines().count() + 2);
        }
        assert!(with_learner("pub mod a;\n", "b").is_none());
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
