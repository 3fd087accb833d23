//! The recipe of CONTRIBUTING.md for a new estimator, followed to the letter in a copy of the workspace.

use crate::support::root;
use std::fs;
use std::path::Path;
use std::process::Command;

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

fn edit(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{} has no `{from}`", path.display());
    fs::write(path, text.replacen(from, to, 1)).unwrap();
}

/// An estimator of one's own: the decay from the first to the last peak. A copied baseline becomes it by
/// changing its name, its tags and its answer.
#[test]
fn a_new_estimator_takes_four_files_and_passes_the_battery() {
    let scratch = tempfile::tempdir().unwrap();
    let home = scratch.path();
    for name in ["Cargo.toml", "Cargo.lock"] {
        fs::copy(root().join(name), home.join(name)).unwrap();
    }
    // The trainer's tests lie outside the copied folder.
    copy(&root().join("crates"), &home.join("crates"));
    copy(&root().join("tests"), &home.join("tests"));

    // Steps 1 and 2.
    let own = home.join("crates/estimators/endpoints");
    copy(&home.join("crates/estimators/baseline"), &own);
    edit(&own.join("Cargo.toml"), "estimator-baseline", "estimator-endpoints");
    let method = own.join("src/lib.rs");
    edit(&method, "id: \"baseline\"", "id: \"endpoints\"");
    edit(&method, "&[Tag::Null]", "&[]");
    edit(&method, ", Tag};", "};");
    edit(
        &method,
        "decay_rate: 0.0",
        "decay_rate: match (envelope.times_s().last(), logs.first(), logs.last()) {
                (Some(span), Some(first), Some(last)) => (first - last) / span,
                _ => 0.0,
            }",
    );
    // Steps 3 and 4.
    let registry = home.join("crates/registry");
    edit(
        &registry.join("Cargo.toml"),
        "[dependencies]\n",
        "[dependencies]\nestimator-endpoints.path = \"../estimators/endpoints\"\n",
    );
    edit(
        &registry.join("src/lib.rs"),
        "estimator_baseline::ENTRY,",
        "estimator_baseline::ENTRY, estimator_endpoints::ENTRY,",
    );

    // In the workspace's own target folder, and for the whole workspace: cargo joins the features of all
    // that it is asked to build, so that only then the libraries built already serve.
    let battery = |filter: &str| {
        Command::new(env!("CARGO"))
            .args(["test", "--offline", "--workspace", "--test", "battery", "--", filter])
            .env("CARGO_TARGET_DIR", root().join("target"))
            .current_dir(home)
            .output()
            .unwrap()
    };
    let exact = battery("endpoints::it_recovers_a_pure_exponential");
    let text = String::from_utf8_lossy(&exact.stdout).into_owned();
    assert!(exact.status.success(), "{text}{}", String::from_utf8_lossy(&exact.stderr));
    assert!(text.contains("1 passed"), "{text}");
    // Two peaks are not all of them: the battery sees it.
    let rough = battery("endpoints::it_agrees_with_least_squares");
    assert!(!rough.status.success(), "{}", String::from_utf8_lossy(&rough.stdout));
}
