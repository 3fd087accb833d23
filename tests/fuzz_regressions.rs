//! Replay of the fuzzer's findings and of its corpus: nothing panics.

use crate::support::root;
use registry::ESTIMATORS;

#[path = "fuzz/checkpoints.rs"]
mod checkpoints;
#[path = "fuzz/targets.rs"]
mod targets;

/// Feeds every file of the target's two folders.
fn replay(target: &str, feed: impl Fn(&[u8])) {
    let mut fed = 0;
    for kind in ["corpus", "regressions"] {
        let folder = root().join("tests/fuzz").join(kind).join(target);
        // Some targets have had no regression.
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            feed(&std::fs::read(entry.unwrap().path()).unwrap());
            fed += 1;
        }
    }
    assert!(fed > 0, "{target} has no corpus");
}

#[test]
fn configurations() {
    replay("configuration", |data| targets::configuration(data, ESTIMATORS));
}

#[test]
fn overrides() {
    replay("overrides", |data| targets::overrides(data, ESTIMATORS));
}

#[test]
fn records_with_columns() {
    replay("csv", targets::csv);
}

#[test]
fn host_logs() {
    replay("host_log", targets::host_log);
}

#[test]
fn nominal_simulators() {
    replay("nominal", targets::nominal);
}

#[test]
fn results_of_runs() {
    replay("results", targets::results);
}

#[test]
fn states_of_fits_in_progress() {
    let networks =
        ["pinn", "lstm-amortized"].map(|id| *ESTIMATORS.iter().find(|entry| entry.id == id).unwrap());
    replay("checkpoint", |data| checkpoints::checkpoint(data, &networks));
}
