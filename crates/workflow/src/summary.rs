//! A record's summary, as results state it.

use record::{Clock, Record, Source, Statements};
use runs::result::DataSummary;

/// Summary of a record file: what it states of itself and what was found, under the clock in force and the one that is
/// believed. What `stated` leaves open, the file answers.
#[must_use]
pub fn summarize(
    record: &Record,
    source: &Source,
    clock: &Clock,
    believed: &Clock,
    stated: Statements,
) -> DataSummary {
    let statements = stated.or(&source.statements);
    let mut findings = source.findings.clone();
    findings.extend(statements.contradictions(record.len(), clock));
    DataSummary {
        path: source.path.clone(),
        digest: source.digest.clone(),
        origin: statements.origin.unwrap_or_default().name().to_owned(),
        samples: record.len(),
        clock: clock.kind.name().to_owned(),
        clock_reason: clock.reason.clone(),
        believed_clock: believed.kind.name().to_owned(),
        believed_clock_reason: believed.reason.clone(),
        sample_period_s: 1.0 / clock.sample_rate_hz,
        sample_rate_hz: clock.sample_rate_hz,
        sample_rate_std_error_hz: clock.sample_rate_std_error_hz,
        resolution: record.lattice().map(|lattice| lattice.step),
        unit: record.unit().to_owned(),
        findings,
        reading: source.reading.clone(),
    }
}
