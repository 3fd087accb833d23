//! Checks numeric defaults for absent values: each needs a comment with its reason.

use super::crates;
use super::source::{code_only, without_tests};
use crate::documents::files;

/// Crates in which a default of any type is usually a number.
const NUMERIC: &[&str] = &[
    "baseline",
    "bayesian",
    "diagnosis",
    "dynamics",
    "envelope",
    "envelope-matching",
    "estimator",
    "experiment",
    "export",
    "gaussian-process",
    "identify",
    "learn",
    "lstm",
    "neural",
    "neural-ode",
    "oracle",
    "pinn",
    "record",
    "scoring",
    "seed",
    "simulator",
    "sindy",
    "sparse",
    "studies",
    "symbolic",
    "transformer",
    "trials",
    "truth",
    "weak-sindy",
    "workflow",
];

/// Returns the lines, from 1, with a zero as default for an absent value and without a comment on the line or
/// the one above. `any_default` is not set for crates whose defaults are mostly texts and lists.
fn without_reason(text: &str, any_default: bool) -> Vec<usize> {
    let code = without_tests(&code_only(text));
    let (said, written): (Vec<&str>, Vec<&str>) = (text.lines().collect(), code.lines().collect());
    let after = |line: &str, call: &str| {
        line.split(call).skip(1).any(|rest| {
            let rest = rest.trim_start_matches('&');
            rest.starts_with('0') && !rest.starts_with("0..")
        })
    };
    let is_zero = |line: &str| {
        after(line, "unwrap_or(")
            || any_default && (line.contains("unwrap_or_default()") || after(line, "map_or("))
    };
    // A comment extends to the end of its line, whereas code follows a string.
    let explains = |at: usize| {
        said[at].match_indices("// ").any(|(place, _)| {
            let before = said[at][..place].chars();
            !said[at][..place].ends_with('/')
                && written[at].chars().skip(before.count()).all(char::is_whitespace)
        })
    };
    (0..written.len())
        .filter(|&at| is_zero(written[at]) && !explains(at) && !(at > 0 && explains(at - 1)))
        .map(|at| at + 1)
        .collect()
}

/// Returns the same for a file of a crate.
pub(super) fn zeros_of(crate_name: &str, text: &str) -> Vec<usize> {
    without_reason(text, NUMERIC.contains(&crate_name))
}

#[test]
fn a_zero_in_place_of_what_is_not_there_has_its_reason() {
    let mut refused = Vec::new();
    for (name, root) in crates() {
        for file in files(root.parent().unwrap().to_str().unwrap(), "rs") {
            let place = file.to_string_lossy().into_owned();
            if place.ends_with("tests.rs") || place.contains("/tests/") {
                continue;
            }
            let text = std::fs::read_to_string(&file).unwrap();
            let lines = zeros_of(&name, &text);
            refused.extend(lines.iter().map(|line| format!("{}:{line}", file.display())));
        }
    }
    assert!(
        refused.is_empty(),
        "{} zeros without a reason on the line or the one above; carry the absence, or say why zero is right:\n{}",
        refused.len(),
        refused.join("\n")
    );
}

#[test]
fn a_zero_without_a_reason_is_seen() {
    let text = "fn f() {\n    a.unwrap_or(0.0);\n    // Nothing moves.\n    b.unwrap_or(0);\n    c.unwrap_or(1.0);\n    \
                d.unwrap_or_default(); // An empty list.\n    /// Of a doc \"// no\".\n    e\n        .unwrap_or(&0);\n    \
                let s = \"// no reason\"; g.unwrap_or_default();\n    \
                h.map_or(0.0, f); i.map_or(1, f);\n    j.map_or(1, f);\n}\n#[cfg(test)]\nmod tests { fn g() { h.unwrap_or(0); } }\n";
    assert_eq!(without_reason(text, true), [2, 9, 10, 11]);
    assert_eq!(without_reason(text, false), [2, 9]);
}
