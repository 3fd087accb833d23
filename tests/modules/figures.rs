//! Figures of every crate, counted from its sources: code, tests, documentation, cycles, long functions.
//!
//!     cargo test -p trainer --test acceptance modules::figures -- --nocapture

#![allow(clippy::print_stdout, reason = "its table is what it is run for")]

use super::graph::Graph;
use super::source::{code_only, without_tests};
use super::{LONGEST, crates};
use crate::documents::files;
use std::path::Path;

/// Lines of sources by content. A line with only a comment or blanks counts neither as code nor as tests.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
struct Lines {
    /// Code that is compiled outside of tests.
    code: usize,
    /// Code of tests.
    tests: usize,
    /// Lines with `///` and `//!`, except those of tests.
    documents: usize,
}

impl Lines {
    /// Counts the lines of a file's text; a file of tests has only test code.
    fn of(text: &str, is_test: bool) -> Self {
        let written = code_only(text);
        let kept = if is_test { String::new() } else { without_tests(&written) };
        let filled = |code: &str| code.lines().filter(|line| !line.trim().is_empty()).count();
        let is_document = |line: &&str| ["///", "//!"].iter().any(|mark| line.trim_start().starts_with(mark));
        let code = filled(&kept);
        // Documentation is counted up to the tests, which come last in a file.
        let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
        let documents = if is_test { 0 } else { text[..end].lines().filter(is_document).count() };
        Self { code, tests: filled(&written) - code, documents }
    }

    fn with(self, other: Self) -> Self {
        Self {
            code: self.code + other.code,
            tests: self.tests + other.tests,
            documents: self.documents + other.documents,
        }
    }

    /// Returns the lines of documentation per hundred lines of code.
    fn density(self) -> f64 {
        100.0 * self.documents as f64 / self.code.max(1) as f64
    }
}

/// Figures of a crate.
struct Figures {
    lines: Lines,
    /// Number of modules that are part of a cycle.
    circular: usize,
    /// Number of functions with more than [`LONGEST`] lines.
    long: usize,
    /// Longest function and its number of lines.
    longest: (String, usize),
}

impl Figures {
    fn of(root: &Path) -> Self {
        let graph = Graph::read(root);
        let mut functions: Vec<(String, usize)> =
            graph.functions().map(|(place, name, lines)| (format!("{place}::{name}"), lines)).collect();
        functions.sort_by_key(|(_, lines)| *lines);
        let mut lines = Lines::default();
        for file in files(root.parent().unwrap().to_str().unwrap(), "rs") {
            let place = file.to_string_lossy().into_owned();
            let is_test = place.ends_with("tests.rs") || place.contains("/tests/");
            let text = std::fs::read_to_string(&file).unwrap();
            lines = lines.with(Lines::of(&text, is_test));
        }
        Self {
            lines,
            circular: graph.circles().iter().map(Vec::len).sum(),
            long: functions.iter().filter(|(_, lines)| *lines > LONGEST).count(),
            longest: functions.pop().unwrap_or_default(),
        }
    }
}

#[test]
fn every_crate_is_counted() {
    let found: Vec<(String, Figures)> =
        crates().into_iter().map(|(name, root)| (name, Figures::of(&root))).collect();
    println!(
        "| crate | code | tests | documents per 100 | modules in circles | functions over {LONGEST} | longest function |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, own) in &found {
        let Figures { lines, circular, long, longest } = own;
        println!(
            "| `{name}` | {} | {} | {:.0} | {circular} | {long} | `{}`, {} |",
            lines.code,
            lines.tests,
            lines.density(),
            longest.0,
            longest.1
        );
        assert!(lines.code > 0 && lines.documents > 0, "{name} holds nothing");
    }
    let all = found.iter().fold(Lines::default(), |all, (_, own)| all.with(own.lines));
    println!("| all | {} | {} | {:.0} | | | |", all.code, all.tests, all.density());
    assert!(all.code > 50_000, "{all:?}");
}

#[test]
fn lines_are_counted_once() {
    let text = "//! Of a module.\n\n/// Of a function.\nfn f() {\n    // Why.\n    let text = \"/// no document\n\";\n}\n\
                #[cfg(test)]\nmod tests {\n    /// Of a test.\n    fn g() {}\n}\n";
    assert_eq!(Lines::of(text, false), Lines { code: 4, tests: 4, documents: 2 });
    assert_eq!(Lines::of(text, true), Lines { code: 0, tests: 8, documents: 0 });
}
