//! Gate: values that the scores of trials have to reach, from their configuration.

use super::bars::{Side, row, share};
use super::classes::{false_alarms, is_composite, leading_named, leading_sure, precision, recall, unknown};
use super::judgment::Judgment;
use super::regret::missed;
use super::statistics::NO_NUMBER;
use crate::make::SECTIONS;
use results::{BarRow, Reliability, TrialsResult};
use serde::Deserialize;
use settings::{Document, Resolved, SettingsError};

/// Limits of scores: the keys of a configuration's section `gate`, each from 0 to 1. `false_alarms`,
/// `calibration_error` and `regret` are upper limits, the others lower limits. Absent keys set no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
pub struct Gate {
    leading_named: Option<f64>,
    leading_sure: Option<f64>,
    recall: Option<f64>,
    precision: Option<f64>,
    unknown: Option<f64>,
    false_alarms: Option<f64>,
    calibration_error: Option<f64>,
    regret: Option<f64>,
}

impl Gate {
    /// Reads the gate of a trial configuration.
    ///
    /// # Errors
    /// [`SettingsError`], with file, line and column, if the document is no trial configuration.
    pub fn of(document: &Document) -> Result<Self, SettingsError> {
        Resolved::new(document, SECTIONS)?.section("gate")
    }
}

/// Size × noise from which an effect beside others should be named.
const LARGE: f64 = 10.0;

impl Gate {
    /// Returns one row for each limit, with the measured score.
    pub(crate) fn rows(&self, judged: &[Judgment<'_>], reliability: &[Reliability]) -> Vec<BarRow> {
        let composite: Vec<&Judgment<'_>> = judged.iter().filter(|judgment| is_composite(judgment)).collect();
        let least = |name: &str, bar: Option<f64>, found| Some(share(name, Side::AtLeast(bar?), &found));
        let large = [LARGE, f64::INFINITY];
        let error = |bar: Option<f64>| {
            let of = |row: &&Reliability| row.subject == "classes" && row.banks.ends_with("composite");
            let found = reliability.iter().find(of);
            let (found, count) = found.map_or((NO_NUMBER, 0), |row| (row.calibration_error, row.count));
            Some(row("gate: calibration error of classes", "", Side::AtMost(bar?), found, count))
        };
        let alarms = |bar: Option<f64>| {
            let found = false_alarms(judged.iter());
            Some(share("gate: false alarms where nothing is missing", Side::AtMost(bar?), &found))
        };
        let regret = |bar: Option<f64>| {
            let found = missed(composite.iter().copied());
            Some(share("gate: regret above 1.1", Side::AtMost(bar?), &found))
        };
        [
            least("gate: leading class named", self.leading_named, leading_named(&composite)),
            least("gate: leading class at 0.9 or more", self.leading_sure, leading_sure(&composite)),
            least("gate: class named of effects from 10 × noise", self.recall, recall(&composite, large)),
            least("gate: named classes that act", self.precision, precision(&composite)),
            least("gate: `unknown` where nothing has a name", self.unknown, unknown(judged.iter())),
            alarms(self.false_alarms),
            error(self.calibration_error),
            regret(self.regret),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// Returns `true` if some score misses its limit. Chance is no excuse, because the bank is fixed.
#[must_use]
pub fn misses_the_gate(result: &TrialsResult) -> bool {
    result.gate.iter().any(|row| row.state == "not met")
}
