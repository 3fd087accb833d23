//! Content of a file's text, before it becomes a record.

#![allow(clippy::indexing_slicing, reason = "`Record::new` refuses a record without samples")]

use crate::error::Fault;
use crate::free::{FreeSwing, free_swings};
use crate::options::ReadOptions;
use crate::reading::{Coordinate, Reading, Whole};
use crate::record::{InputRow, Record};
use crate::statement::Statements;
use crate::unit::{Dimension, Unit};

/// Data collected by the reader of one format.
pub(crate) struct Parsed {
    unit: Unit,
    stamps_s: Vec<f64>,
    values: Vec<f64>,
    input: Vec<f64>,
    /// Row number of each sample, if some rows hold no value and leave gaps.
    pub(crate) rows: Option<Vec<usize>>,
    /// Input at rows without a value.
    pub(crate) input_rows: Vec<InputRow>,
    statements: Statements,
    pub(crate) findings: Vec<String>,
    pub(crate) reading: Reading,
    /// Kind of the file if it is no text with columns.
    pub(crate) kind: Option<&'static str>,
}

impl Parsed {
    pub(crate) fn new(unit: Unit, statements: Statements, reading: Reading) -> Self {
        Self {
            unit,
            stamps_s: Vec::new(),
            values: Vec::new(),
            input: Vec::new(),
            rows: None,
            input_rows: Vec::new(),
            statements,
            findings: Vec::new(),
            reading,
            kind: None,
        }
    }

    /// Adds a sample. Stamps are checked here and not in [`Record::new`] because the line in the file is
    /// still known.
    pub(crate) fn push(
        &mut self,
        line: u64,
        stamp: f64,
        value: f64,
        input: Option<f64>,
    ) -> Result<(), Fault> {
        if let Some(&previous) = self.stamps_s.last().filter(|&&previous| stamp < previous) {
            return Err(Fault::TimeDecreases { line, previous, stamp });
        }
        self.stamps_s.push(stamp);
        self.values.push(value);
        self.input.extend(input);
        Ok(())
    }

    pub(crate) fn finish(
        self,
        options: &ReadOptions,
    ) -> Result<(Record, Statements, Vec<String>, Reading), Fault> {
        let input = (!self.input.is_empty()).then_some(self.input);
        let quantity = options.quantity.unwrap_or(self.reading.quantity);
        let record = Record::new(self.stamps_s, self.values, input, quantity, self.unit.si())?;
        let span = record.stamps_s()[record.len() - 1] - record.stamps_s()[0];
        let record = match self.rows {
            Some(rows) => record.with_rows(rows).with_input_rows(self.input_rows),
            None => record,
        };
        let rate_hz = (record.len() + record.empty_rows() - 1) as f64 / span;
        let coordinate = match self.unit.dimension() {
            Dimension::Angle => Coordinate::Angle,
            _ => Coordinate::Displacement,
        };
        let mut findings = self.findings;
        // A stated start is believed; before a stated end the swing still has to be found.
        let swings = match (options.from_s, options.to_s) {
            (Some(_), _) => Vec::new(),
            (None, None) => free_swings(&record),
            (None, to_s) => free_swings(&record.clone().between(None, to_s)?.0),
        };
        let part = largest_part(&record, &swings);
        findings.extend(part.map(|part| part_said(&record, &swings, part)));
        let [from_s, to_s] = part.map_or([options.from_s, options.to_s], |part| part.map(Some));
        let free = || swings.iter().filter_map(|swing| ends(&record, swing)).collect();
        let whole = from_s.or(to_s).map(|_| Whole::new(&record, free()));
        let (record, part_s) = record.between(from_s, to_s)?;
        let reading =
            Reading { quantity, coordinate, part_s, whole, ..self.reading }.worded(rate_hz, self.kind);
        // A stated number of samples is that of the whole file.
        let samples = self.statements.samples.filter(|_| part_s.is_none());
        Ok((record, Statements { samples, ..self.statements }, findings, reading))
    }
}

/// Returns the stamps, in seconds, between which the free swing with the most half swings lies.
fn largest_part(record: &Record, swings: &[FreeSwing]) -> Option<[f64; 2]> {
    let largest = swings.iter().max_by_key(|swing| swing.half_swings)?;
    ends(record, largest)
}

fn ends(record: &Record, swing: &FreeSwing) -> Option<[f64; 2]> {
    let [from, to] = swing.samples;
    Some([*record.stamps_s().get(from)?, *record.stamps_s().get(to)?])
}

/// Returns a sentence on the part of a record that is read, and on its other free swings.
fn part_said(record: &Record, swings: &[FreeSwing], [from, to]: [f64; 2]) -> String {
    let others = swings.iter().filter_map(|swing| ends(record, swing)).filter(|other| *other != [from, to]);
    let others: Vec<String> = others.map(|[from, to]| format!("{from:.3} s to {to:.3} s")).collect();
    let also = if others.is_empty() {
        String::new()
    } else {
        format!(", and so it does from {}", others.join(" and from "))
    };
    format!(
        "it swings freely from {from:.3} s to {to:.3} s, which was read{also}; the rest is at rest, handled, struck or stopped; \
         `data.from_s` and `data.to_s` take another part"
    )
}
