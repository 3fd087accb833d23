//! Cost of listing a thousand run folders, one of which is damaged.
//!
//!     cargo bench -p runs
//!
//! The list is checked before it is timed: 999 finished runs and one corrupt run.

#![allow(missing_docs, clippy::unwrap_used, clippy::disallowed_methods, reason = "a benchmark")]

use divan::{Bencher, black_box};
use results::RunState;
use runs::{KeptRun, list_runs};
use serde_json::{Value, json};
use std::path::Path;

fn main() {
    divan::main();
}

/// Result with ten seeds and four pipelines, about as long as the results of the shipped configurations.
fn result() -> Value {
    let seed = |seed: u64| {
        json!({ "seed": seed, "decay_rate": 0.191_836_585, "zeta": 0.009_159_522, "error_percent": 3.8e-6,
                "reached": "converged", "steps": 101, "seconds": 0.2 })
    };
    let pipeline = |name: &str| {
        json!({ "pipeline": name, "clock": "host", "in_force": false, "outcome": { "fit": {
                "peaks": 69, "omega_rad_s": 21.8, "decay_rate": 0.19, "zeta": 0.009, "zeta_std_error": 2e-4,
                "r_squared": 0.96 } } })
    };
    json!({
        "schema": "ringdown.result/1", "task": "estimate", "estimator": "pinn",
        "estimator_title": "Physics-informed neural network", "seed": 0,
        "data": { "path": "record.csv", "digest": "sha256:00", "origin": "simulated", "samples": 7625,
                  "clock": "host", "clock_reason": "as asked for", "believed_clock": "uniform-index",
                  "believed_clock_reason": "the stamps arrive in bursts of the host's reading loop",
                  "sample_period_s": 0.00385, "sample_rate_hz": 259.6, "sample_rate_std_error_hz": 0.02,
                  "resolution": 0.00153, "unit": "rad", "findings": ["time stamps repeat: 445 bursts"] },
        "envelope": { "pipeline": "paper", "peaks": 69, "samples": 14_000, "period_s": 0.288, "omega_rad_s": 21.8,
                      "offset": 0.01, "first_peak_s": 0.1 },
        "oracle": { "decay_rate": 0.19, "log_amplitude": -0.5, "r_squared": 0.96, "zeta": 0.009, "std_error": 0.004,
                    "interval_95": [0.18, 0.2], "zeta_std_error": 2e-4, "zeta_interval_95": [0.0087, 0.0095],
                    "condition": 2.6, "promised_digits": 28.0, "residual_autocorrelation": 0.5 },
        "estimate": { "decay_rate": 0.19, "log_amplitude": -0.5, "zeta": 0.009, "std_error": 0.004,
                      "interval_95": [0.18, 0.2], "zeta_std_error": 2e-4, "zeta_interval_95": [0.0087, 0.0095],
                      "reached": "converged", "stopped_because": "no step lowers the loss any more" },
        "error_percent": 3.8e-6, "tolerance_percent": 0.1, "pass": true, "seconds": 0.2, "steps": 101,
        "parameters": 324, "seeds": (0..10).map(seed).collect::<Vec<_>>(), "worst_error_percent": 3.8e-6,
        "pipelines": (["paper", "a", "b", "c"].map(pipeline))
    })
}

fn fill(root: &Path) {
    let text = serde_json::to_string_pretty(&result()).unwrap();
    let keys: String = (0..40).map(|key| format!("key_{key} = {key} # from a.toml:{key}:1\n")).collect();
    let config = format!("task = \"estimate\"\nseed = 0\n[fit]\n{keys}[estimator]\nname = \"pinn\"\n");
    for number in 0..1000 {
        let folder = root.join(format!("pinn-{number:04}"));
        std::fs::create_dir(&folder).unwrap();
        let whole = if number == 500 { text.get(..100).unwrap() } else { &text };
        let event = format!(
            "{{\"time\":\"2026-01-01T00:00:00.{number:03}Z\",\"event\":\"start\",\"details\":{{}}}}\n"
        );
        for (name, content) in [("result.json", whole), ("config.toml", &config), ("events.jsonl", &event)] {
            std::fs::write(folder.join(name), content).unwrap();
        }
    }
}

fn count(listed: &[KeptRun], state: RunState) -> usize {
    listed.iter().filter(|run| run.state == state).count()
}

#[divan::bench(sample_count = 20)]
fn a_thousand_runs(bencher: Bencher<'_, '_>) {
    let root = tempfile::tempdir().unwrap();
    fill(root.path());
    let listed = list_runs(root.path()).unwrap();
    assert_eq!((count(&listed, RunState::Done), count(&listed, RunState::Corrupt)), (999, 1));
    assert_eq!(listed.first().map(|run| run.name.as_str()), Some("pinn-0999"));
    bencher.bench(|| black_box(list_runs(root.path()).unwrap()));
}
