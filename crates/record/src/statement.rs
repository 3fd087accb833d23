//! Statements of a file or a configuration about a record, and their comparison with the stamps.

use crate::clock::Clock;
use serde::{Deserialize, Serialize};

/// Origin of a record's numbers, as stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// From a sensor.
    Measured,
    /// From a program.
    Simulated,
    /// Not stated.
    #[default]
    Unstated,
}

impl Origin {
    /// Names of all origins in files and configurations.
    pub const NAMES: &'static [&'static str] = &["measured", "simulated", "unstated"];

    /// Returns the name used in files and configurations.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Simulated => "simulated",
            Self::Unstated => "unstated",
        }
    }

    /// Returns the common origin of several records; unstated if the origins differ or there are no records.
    ///
    /// ```
    /// use record::Origin;
    ///
    /// assert_eq!(Origin::shared([Origin::Measured, Origin::Measured]), Origin::Measured);
    /// assert_eq!(Origin::shared([Origin::Measured, Origin::Simulated]), Origin::Unstated);
    /// ```
    #[must_use]
    pub fn shared(origins: impl IntoIterator<Item = Self>) -> Self {
        let mut origins = origins.into_iter();
        let Some(first) = origins.next() else { return Self::Unstated };
        if origins.all(|other| other == first) { first } else { Self::Unstated }
    }
}

/// Statements about a record. They are compared with the record and never used in its place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Statements {
    /// Origin of the numbers.
    pub origin: Option<Origin>,
    /// Sampling rate, in hertz.
    pub sample_rate_hz: Option<f64>,
    /// Number of samples.
    pub samples: Option<usize>,
}

impl Statements {
    /// Reads one comment line of a CSV file, without its `#`: `origin: simulated`, `sample_rate_hz: 260`,
    /// `samples: 6500`. Other comments are ignored.
    pub(crate) fn read_comment(&mut self, comment: &str) {
        let Some((key, value)) = comment.split_once(':') else {
            return;
        };
        let word = value.split_whitespace().next().unwrap_or("");
        match key.trim() {
            "origin" => {
                self.origin = match word {
                    "measured" => Some(Origin::Measured),
                    "simulated" => Some(Origin::Simulated),
                    _ => self.origin,
                }
            }
            "sample_rate_hz" => self.sample_rate_hz = word.parse().ok().or(self.sample_rate_hz),
            "samples" => self.samples = word.parse().ok().or(self.samples),
            _ => {}
        }
    }

    /// Returns these statements, with gaps filled from `others`.
    #[must_use]
    pub fn or(self, others: &Self) -> Self {
        Self {
            origin: self.origin.or(others.origin),
            sample_rate_hz: self.sample_rate_hz.or(others.sample_rate_hz),
            samples: self.samples.or(others.samples),
        }
    }

    /// Compares the statements with the record; returns one sentence for each that does not hold.
    ///
    /// A rate is contradicted if it is off by more than one part in a hundred *and* by more than four
    /// standard errors: labels are rounded ("about 100 Hz"), and a short record determines its rate poorly.
    #[must_use]
    pub fn contradictions(&self, samples: usize, clock: &Clock) -> Vec<String> {
        let mut found = Vec::new();
        if let Some(stated) = self.samples.filter(|&stated| stated != samples) {
            found.push(format!("the file holds {samples} samples, not the stated {stated}"));
        }
        if let Some(stated) = self.sample_rate_hz {
            let off = (stated - clock.sample_rate_hz).abs();
            if off > 0.01 * clock.sample_rate_hz && off > 4.0 * clock.sample_rate_std_error_hz {
                found.push(format!(
                    "the stamps give a sampling rate of {:.2} ± {:.2} Hz, not the stated {stated} Hz",
                    clock.sample_rate_hz, clock.sample_rate_std_error_hz
                ));
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use crate::{Clock, ClockChoice, CsvColumns, ReadOptions, read_text};

    /// A stated rate, on the command line or in the file, is compared with the stamps.
    #[test]
    fn a_rate_beside_stamps_is_checked() {
        let rows: String = (0..200).map(|i| format!("{:.2},{}\n", 0.01 * f64::from(i), i % 7)).collect();
        let said = |rate: Option<f64>| {
            let columns = CsvColumns { sample_rate_hz: rate, ..CsvColumns::default() };
            let options = ReadOptions { columns, ..ReadOptions::default() };
            let text = format!("time_s,angle_rad\n{rows}");
            let (record, source) = read_text("r.csv", text.as_bytes(), &options).unwrap();
            let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
            source.statements.contradictions(record.len(), &clock)
        };
        assert!(said(None).is_empty() && said(Some(100.3)).is_empty());
        let found = said(Some(50.0));
        assert!(found.len() == 1 && found[0].contains("not the stated 50 Hz"), "{found:?}");
    }
}
