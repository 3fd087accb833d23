//! Diagnoses the gap between a simulator and a record, prints it, and writes the report.
//!
//!     cargo run -p ringdown-lab --example diagnose_and_print [-- RECORD NOMINAL]

#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use ringdown_lab::{DiagnosisOptions, Error, Nominal, Reading, Record, diagnose};

/// Folder of the simulated record that the project ships, with the nominal simulator that lacks an effect.
const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../experiments/default-record");

// ANCHOR: main
fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1).filter(|argument| !argument.starts_with('-'));
    let record = arguments.next().unwrap_or(format!("{SHIPPED}/record.csv"));
    let nominal = arguments.next().unwrap_or(format!("{SHIPPED}/nominal.toml"));

    let nominal = Nominal::read(nominal)?;
    let record = Record::read(record, &nominal.reading(Reading::default()))?;
    let diagnosis = diagnose(&[record], &nominal, &DiagnosisOptions::default())?;

    println!("{}", diagnosis.verdict().summary);
    for class in diagnosis.classes().iter().filter(|class| class.probability > 0.1) {
        println!("{:12} probability {:.2}", class.id, class.probability);
    }
    for effect in diagnosis.effects().iter().filter(|effect| effect.gap_share.is_some()) {
        for (name, parameter) in &effect.parameters {
            let [low, high] = parameter.interval_95;
            println!(
                "{}: {name} = {:.3e} {} [{low:.3e}, {high:.3e}]",
                effect.title, parameter.value, parameter.unit
            );
        }
    }
    let gap = diagnosis.gap();
    println!("error in {}: {:.5} recalibrated, {:.5} repaired", gap.unit, gap.recalibrated, gap.repaired);

    let report = std::env::temp_dir().join("ringdown-diagnosis.html");
    diagnosis.report(&report)?;
    println!("report: {}", report.display());
    Ok(())
}
// ANCHOR_END: main
