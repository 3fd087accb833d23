//! Checks of the modules of each crate: no cycles, no very long functions.

mod figures;
mod graph;
mod known;
mod source;

use crate::support::root;
use graph::Graph;
use known::{LONG, TANGLED};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Most lines of a function, from `fn` to its closing brace, without a reason in [`LONG`].
const LONGEST: usize = 60;

/// Most lines of a function with a reason.
const FAR_TOO_LONG: usize = 100;

#[test]
fn modules_of_a_crate_form_no_circle() {
    let crates = crates();
    assert!(crates.len() > 20);
    let circles: Vec<String> = (crates.iter())
        .flat_map(|(name, file)| {
            Graph::read(file)
                .circles()
                .into_iter()
                .map(move |circle| format!("{name}: {}", circle.join(", ")))
        })
        .collect();
    assert!(circles.is_empty(), "modules that need each other:\n{}", circles.join("\n"));
}

#[test]
fn folders_of_a_crate_form_no_circle() {
    let mut known: BTreeSet<&str> = TANGLED.iter().copied().collect();
    let mut circles = Vec::new();
    for (name, file) in &crates() {
        let own = Graph::read(file).folder_circles();
        if !own.is_empty() && !known.remove(name.as_str()) {
            circles.extend(own.into_iter().map(|circle| format!("{name}: {}", circle.join(", "))));
        }
    }
    assert!(circles.is_empty(), "folders that need each other:\n{}", circles.join("\n"));
    assert!(known.is_empty(), "without a circle by now, so no longer to be listed: {known:?}");
}

#[test]
fn functions_are_short_or_have_a_reason() {
    let mut reasons: BTreeSet<(String, String)> =
        LONG.iter().map(|(name, function, _)| ((*name).to_owned(), (*function).to_owned())).collect();
    let mut refused = Vec::new();
    for (name, file) in &crates() {
        for (place, function, lines) in Graph::read(file).functions() {
            if lines <= LONGEST {
                continue;
            }
            let function = format!("{place}::{function}");
            let has_reason = reasons.remove(&(name.clone(), function.clone()));
            if !has_reason || lines > FAR_TOO_LONG {
                refused.push(format!("{name}::{function}: {lines} lines"));
            }
        }
    }
    assert!(refused.is_empty(), "to be divided, or given a reason:\n{}", refused.join("\n"));
    assert!(reasons.is_empty(), "short by now, so no longer to be listed: {reasons:?}");
}

/// Writes a crate of some files.
fn written(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

/// Returns the cycles among the modules of a crate of some files.
fn circles_of(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    Graph::read(&written(files).path().join("lib.rs")).circles()
}

#[test]
fn a_circle_is_seen_through_imports_paths_and_parents() {
    let circle = vec![vec!["a".to_owned(), "b".to_owned()]];
    let root = ("lib.rs", "mod a; mod b;");
    let imports = [root, ("a.rs", "use crate::b::{B, C as D};"), ("b.rs", "use super::a::A;")];
    assert_eq!(circles_of(&imports), circle);
    let paths = [root, ("a.rs", "fn f() { crate::b::f(); }"), ("b.rs", "fn f() { super::a::f(); }")];
    assert_eq!(circles_of(&paths), circle);
    let parent = [
        ("lib.rs", "mod a;"),
        ("a/mod.rs", "mod b; fn f() { b::g(); }"),
        ("a/b.rs", "fn g() { super::f(); }"),
    ];
    assert_eq!(circles_of(&parent), [["a".to_owned(), "a::b".to_owned()]]);
}

#[test]
fn a_circle_of_folders_is_seen_though_its_modules_form_none() {
    let files = [
        ("lib.rs", "mod a; mod b;"),
        ("a/mod.rs", "mod one; mod two;"),
        ("a/one.rs", "use crate::b::one::B;"),
        ("a/two.rs", "struct A;"),
        ("b/mod.rs", "mod one; mod two;"),
        ("b/one.rs", "struct B;"),
        ("b/two.rs", "use crate::a::two::A;"),
    ];
    let folder = written(&files);
    let graph = Graph::read(&folder.path().join("lib.rs"));
    assert!(graph.circles().is_empty());
    assert_eq!(graph.folder_circles(), [["a", "b"]]);
}

#[test]
fn what_is_only_said_makes_no_circle() {
    let one_way = "use crate::b::B;";
    let said = [
        ("lib.rs", "mod a; mod b; pub use a::A;"),
        ("a.rs", one_way),
        (
            "b.rs",
            "//! See crate::a::A.\nconst TEXT: &str = \"crate::a::A\";\n#[cfg(test)]\nmod tests { use crate::a::A; }",
        ),
    ];
    assert!(circles_of(&said).is_empty());
    // A re-export is no use, and a name that is used through one counts for its owner.
    let through = [
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "pub use crate::b::B;"),
        ("b.rs", "use crate::c::C;"),
        ("c.rs", "struct C;"),
    ];
    assert!(circles_of(&through).is_empty());
    // A name that ends in `use` is no import.
    let named = [("lib.rs", "mod a;\npub struct Pause {\n    a: u8,\n}\n"), ("a.rs", "fn f() {}")];
    assert!(circles_of(&named).is_empty());
    let back =
        [("lib.rs", "pub mod a; mod b; pub use b::B;"), ("a.rs", "use crate::B;"), ("b.rs", "struct B;")];
    assert!(circles_of(&back).is_empty());
}

#[test]
fn lines_of_a_function_are_counted_without_its_tests() {
    let text = "fn long(text: &str) -> [u8; 2] {\n    let brace = '}';\n    // }\n    \"}\";\n}\n#[cfg(test)]\nfn test() {\n}\n";
    let code = source::without_tests(&source::code_only(text));
    assert_eq!(source::functions(&code), [("long".to_owned(), 5)]);
}

/// Returns the roots of the workspace's crates by name.
fn crates() -> BTreeMap<String, PathBuf> {
    let mut found = BTreeMap::new();
    for folder in ["crates", "crates/estimators"] {
        for entry in std::fs::read_dir(Path::new(&root()).join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let source = ["src/lib.rs", "src/main.rs"].map(|file| path.join(file));
            if let Some(file) = source.into_iter().find(|file| file.exists()) {
                let name = path.file_name().unwrap().to_string_lossy().into_owned();
                found.insert(name, file);
            }
        }
    }
    found
}
