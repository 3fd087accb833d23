//! Skeleton of an estimator of the damping.

use super::skeleton::{Skeleton, below_last, filled, registered};
use crate::error::NewError;
use oracle::classical::CLASSICAL;
use registry::ESTIMATORS;
use std::path::Path;

/// Manifest of the null estimator, which becomes that of a new one.
const MANIFEST: &str = include_str!("../../../../estimators/baseline/Cargo.toml");

/// Returns the files of a new estimator.
///
/// # Errors
/// [`NewError`] if the name is taken, or a registry has an unexpected form.
pub(super) fn skeleton(home: &Path, name: &str) -> Result<Skeleton, NewError> {
    let folder = home.join("crates/estimators").join(name);
    let is_known =
        ESTIMATORS.iter().any(|entry| entry.id == name) || CLASSICAL.iter().any(|own| own.id == name);
    if is_known || folder.exists() {
        return Err(NewError::Taken { what: "an estimator", name: name.to_owned() });
    }
    let dependency = format!("estimator-{name}.path = \"../estimators/{name}\"");
    let entry = format!("    estimator_{}::ENTRY,", name.replace('-', "_"));
    let with_dependency = |text: &str| below_last(text, &dependency, |line| line.starts_with("estimator-"));
    let with_entry = |text: &str| below_last(text, &entry, |line| line.starts_with("    estimator_"));
    Ok(Skeleton {
        what: "estimator",
        does: "reads the damping from the peaks of a decay",
        files: vec![
            (folder.join("Cargo.toml"), manifest(name)),
            (folder.join("src/lib.rs"), filled(include_str!("estimator.txt"), name)),
        ],
        registries: vec![
            registered(home.join("crates/registry/Cargo.toml"), with_dependency)?,
            registered(home.join("crates/registry/src/lib.rs"), with_entry)?,
        ],
        next: vec![
            format!("cargo test -p registry {name}::"),
            format!("cargo run -p trainer -- configs/compare.toml compare.methods={name},pinn,ols"),
        ],
    })
}

fn manifest(name: &str) -> String {
    let line = |line: &str| match line.split_once(" = ") {
        Some(("name", _)) => format!("name = \"estimator-{name}\"\n"),
        Some(("description", _)) => format!("description = \"The estimator {name}.\"\n"),
        Some(("estimator.workspace", _)) => format!("{line}\nrand.workspace = true\n"),
        _ => format!("{line}\n"),
    };
    MANIFEST.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_placeholder_is_left() {
        let text = filled(include_str!("estimator.txt"), "robust-line");
        assert!(text.contains("struct RobustLine") && text.contains("\"robust-line\""), "{text}");
        assert!(
            !text.contains("NewType") && !text.contains("NEW-TITLE") && !text.contains("new-id"),
            "{text}"
        );
        let manifest: toml::Table = manifest("robust-line").parse().unwrap();
        assert_eq!(manifest["package"]["name"].as_str(), Some("estimator-robust-line"));
        assert!(manifest["dependencies"].get("rand").is_some());
    }
}
