//! Measured records with raw stamps, coordinate, input, units and resolution; readers, clocks and digests.
//!
//! A [`Record`] holds the content of a file, in SI units and with the stamps as written. The interpretation
//! of the stamps is an explicit decision ([`Clock`]), and so is the sensor's step ([`Lattice`]). The origin
//! of a record ([`Source`]) is kept beside it, never in it: code that is given a record can find out neither
//! the name of its file nor whether it was measured or simulated.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod clipped;
mod clock;
mod coding;
mod columns;
mod container;
mod copies;
mod csv_file;
mod dates;
mod dialect;
mod doubts;
mod error;
mod file;
mod free;
mod heading;
mod host_log;
mod lattice;
mod line;
mod look;
mod lost;
mod names;
mod one_sided;
mod options;
mod parsed;
mod reading;
mod record;
mod recursion;
mod roles;
mod roughness;
mod runs;
mod spikes;
mod stamps;
mod statement;
mod statistics;
mod swing;
mod table;
#[cfg(test)]
mod tests;
mod text;
mod times;
mod unit;
mod words;

pub use clipped::Clipped;
pub use clock::{Clock, ClockChoice, ClockKind};
pub use columns::{CsvColumns, Filter, Missing};
pub use error::{Fault, RecordError};
pub use file::{Source, file_digest, read_file, read_text};
pub use lattice::Lattice;
pub use look::{ColumnLook, Look, Titles, look, titles};
pub use options::{Format, ReadOptions};
pub use reading::{ColumnReading, Coordinate, Reading, Whole};
pub use record::{InputRow, Quantity, Record};
pub use stamps::StampStatistics;
pub use statement::{Origin, Statements};
pub use statistics::{extremes, median, noise_level};
pub use unit::{TimeUnit, Unit};
pub use words::{counted, prefixed, two_digits};

/// Smallest number of samples of a record.
pub const FEWEST_SAMPLES: usize = 8;
