//! From files to what a diagnosis may see: no name and no path among it.

use super::arguments::{FormatChoice, Reading};
use crate::error::{TrainerError, in_options};
use diagnosis::Observations;
use dynamics::Coordinate;
use dynamics::chain::Observed;
use experiment::StatedNominal;
use record::{
    Clock, ClockChoice, CsvColumns, Fault, Format, Quantity, ReadOptions, Record, Statements, Unit,
};
use results::RecordRow;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::Error;
use std::path::Path;

/// A record as the diagnosis sees it, and what people are told of it.
pub(crate) struct Given {
    pub(crate) observations: Observations,
    pub(crate) row: RecordRow,
    pub(crate) quantity: Quantity,
    pub(crate) driven: bool,
    pub(crate) rate_hz: f64,
}

/// Reads a record by the options and, where these are silent, by its header and the nominal simulator.
pub(crate) fn read(path: &Path, reading: &Reading, stated: &StatedNominal) -> Result<Given, TrainerError> {
    let name = path.display().to_string();
    let fault = |fault: Fault| TrainerError::DiagnosedRecord(fault.in_file(&name));
    if path.is_dir() {
        return Err(fault(Fault::Folder));
    }
    let bytes =
        std::fs::read(path).map_err(|error| fault(Fault::Unreadable { problem: error.to_string() }))?;
    let options = read_options(reading, Some(stated.nominal.coordinate()), stated.driven);
    let (record, source) =
        record::read_text(&name, &bytes, &options).map_err(TrainerError::DiagnosedRecord)?;
    check_unit(&name, &record, stated.nominal.coordinate())?;
    if stated.driven && record.input().is_none() {
        return Err(TrainerError::MissingInput { file: name, columns: header(&bytes) });
    }
    let record = if reading.remove_mean { centered(&record).map_err(fault)? } else { record };
    let choice = word(&reading.clock).unwrap_or_default();
    let clock_of = |choice: ClockChoice| Clock::new(&record, choice).map_err(fault);
    let (clock, believed) = (clock_of(choice)?, clock_of(ClockChoice::Auto)?);
    let stated = Statements { origin: reading.origin.as_deref().and_then(word), ..Statements::default() };
    let summary = results::DataSummary::new(&record, &source, &clock, &believed, stated);
    let (first, last) = (clock.times_s.first(), clock.times_s.last());
    Ok(Given {
        observations: Observations::new(&record, &clock),
        row: RecordRow {
            path: summary.path,
            digest: summary.digest,
            origin: summary.origin,
            samples: summary.samples,
            duration_s: first.zip(last).map_or(0.0, |(first, last)| last - first),
            clock: summary.clock,
            clock_reason: summary.clock_reason,
            findings: summary.findings.iter().map(|finding| in_options(finding)).collect(),
            reading: summary.reading,
        },
        quantity: record.quantity(),
        driven: record.input().is_some(),
        rate_hz: clock.sample_rate_hz,
    })
}

/// The first line that is neither empty nor a comment.
fn header(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    lines.find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or_default().to_owned()
}

/// Options as the reader takes them; what moves, where that is known; and whether an input drives it.
pub(crate) fn read_options(reading: &Reading, coordinate: Option<Coordinate>, driven: bool) -> ReadOptions {
    ReadOptions {
        format: match reading.format {
            FormatChoice::Auto => Format::Auto,
            FormatChoice::Csv => Format::Csv,
            FormatChoice::HostLog => Format::HostLog,
        },
        columns: CsvColumns {
            time: reading.time.clone(),
            value: reading.value.clone(),
            input: reading.input.clone(),
            unit: reading.unit.as_deref().and_then(word),
            input_unit: reading.input_unit.as_deref().and_then(word),
            time_unit: reading.time_unit.as_deref().and_then(word),
            sample_rate_hz: reading.sample_rate,
            filter: reading.filter.as_deref().and_then(word),
            missing: word(&reading.missing).unwrap_or_default(),
        },
        quantity: reading.quantity.map(super::arguments::QuantityChoice::quantity),
        coordinate: coordinate.map(|coordinate| match coordinate {
            Coordinate::Angle => record::Coordinate::Angle,
            Coordinate::Displacement => record::Coordinate::Displacement,
        }),
        driven,
    }
}

/// What a simulator calls what moves in a record.
pub(crate) fn coordinate_of(coordinate: record::Coordinate) -> Coordinate {
    match coordinate {
        record::Coordinate::Angle => Coordinate::Angle,
        record::Coordinate::Displacement => Coordinate::Displacement,
    }
}

/// Symbol of the unit that records of a coordinate are in.
fn usual_unit(coordinate: Coordinate, quantity: Quantity) -> &'static str {
    match (coordinate, quantity) {
        (Coordinate::Angle, Quantity::Position) => "rad",
        (Coordinate::Angle, Quantity::Velocity) => "rad/s",
        (Coordinate::Angle, Quantity::Acceleration) => "rad/s^2",
        (Coordinate::Displacement, Quantity::Position) => "m",
        (Coordinate::Displacement, Quantity::Velocity) => "m/s",
        (Coordinate::Displacement, Quantity::Acceleration) => "m/s^2",
    }
}

/// A record whose unit cannot be that of the nominal coordinate is of another system, or mislabeled. A voltage stands
/// for a displacement, whatever its derivative.
fn check_unit(file: &str, record: &Record, coordinate: Coordinate) -> Result<(), TrainerError> {
    let expected = usual_unit(coordinate, record.quantity());
    let voltage = record.unit() == Unit::Volt.si() && coordinate == Coordinate::Displacement;
    if record.unit() == expected || voltage {
        return Ok(());
    }
    Err(TrainerError::OtherUnit { file: file.to_owned(), found: record.unit(), expected })
}

/// The record with the means of the observed column and of the input taken away.
pub(crate) fn centered(record: &Record) -> Result<Record, Fault> {
    let center = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|value| value - mean).collect()
    };
    Record::new(
        record.stamps_s().to_vec(),
        center(record.values()),
        record.input().map(center),
        record.quantity(),
        record.unit(),
    )
}

/// A word as configurations write it; the command line admits no other.
fn word<'de, T: Deserialize<'de>>(text: &'de str) -> Option<T> {
    let deserializer = IntoDeserializer::<Error>::into_deserializer(text);
    T::deserialize(deserializer).ok()
}

/// What a simulator would call what the sensor observes.
pub(crate) fn observed(quantity: Quantity) -> Observed {
    match quantity {
        Quantity::Position => Observed::Position,
        Quantity::Velocity => Observed::Velocity,
        Quantity::Acceleration => Observed::Acceleration,
    }
}
