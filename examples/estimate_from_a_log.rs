//! Estimates the damping ratio from a log, by several methods.
//!
//!     cargo run -p ringdown-lab --example estimate_from_a_log [-- LOG]

#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use ringdown_lab::{Error, EstimateOptions, Reading, Record, estimate};

/// Simulated record that the project ships.
const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../experiments/default-record/record.csv");

// ANCHOR: main
fn main() -> Result<(), Error> {
    let log = std::env::args().nth(1).filter(|argument| !argument.starts_with('-'));
    let record = Record::read(log.as_deref().unwrap_or(SHIPPED), &Reading::default())?;
    println!("{} samples, {}", record.len(), record.reading());

    for method in ["ols", "sindy", "gaussian-process"] {
        let found = estimate(&record, method, &EstimateOptions::default())?;
        let error =
            found.damping_ratio_std_error.map_or("none stated".to_owned(), |error| format!("{error:.1e}"));
        println!(
            "{method}: ζ = {:.6}, standard error {error}, {}",
            found.damping_ratio,
            found.reached.in_words()
        );
        if let Some(law) = &found.equation {
            println!("    it found the law {law}");
        }
    }
    Ok(())
}
// ANCHOR_END: main
