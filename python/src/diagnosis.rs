//! Diagnoses.

use crate::error::raised;
use crate::nominal::NativeNominal;
use crate::record::NativeRecord;
use crate::work::{beside, on_threads};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use ringdown_lab::{Diagnosis, DiagnosisOptions, diagnose_watched};
use std::collections::BTreeMap;

/// A diagnosis.
#[pyclass(frozen, module = "ringdown_lab._native", name = "NativeDiagnosis")]
pub(crate) struct NativeDiagnosis {
    diagnosis: Diagnosis,
}

#[pymethods]
impl NativeDiagnosis {
    /// The content of `diagnosis.json`.
    fn to_json(&self) -> PyResult<String> {
        self.diagnosis.to_json().map_err(raised)
    }

    /// The repaired simulator as files, by name.
    fn files(&self) -> BTreeMap<&'static str, String> {
        self.diagnosis.files().into_iter().collect()
    }

    /// The repaired simulator as a nominal one.
    fn repaired_nominal(&self) -> PyResult<NativeNominal> {
        Ok(NativeNominal { nominal: self.diagnosis.repaired_nominal().map_err(raised)? })
    }

    /// The report as one page.
    fn report_html(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.diagnosis.report_html()).map_err(raised)
    }

    /// Columns of `series.csv`, by name.
    fn series<'py>(&self, py: Python<'py>) -> BTreeMap<&'static str, Bound<'py, PyArray1<f64>>> {
        let rows = self.diagnosis.series();
        let column = |of: fn(&ringdown_lab::result::SeriesRow) -> f64| -> Bound<'py, PyArray1<f64>> {
            rows.iter().map(of).collect::<Vec<f64>>().into_pyarray(py)
        };
        SERIES.iter().map(|(name, of)| (*name, column(*of))).collect()
    }
}

type Column = (&'static str, fn(&ringdown_lab::result::SeriesRow) -> f64);

const SERIES: &[Column] = &[
    ("record", |row| row.record as f64),
    ("segment", |row| row.segment as f64),
    ("time_s", |row| row.time_s),
    ("observed", |row| row.observed),
    ("nominal", |row| row.nominal),
    ("recalibrated", |row| row.recalibrated),
    ("repaired", |row| row.repaired),
];

/// Options, with the defaults of the command line.
pub(crate) fn options_of(
    false_alarm: Option<f64>,
    most_effects: Option<usize>,
    without: Vec<String>,
    seed: u64,
) -> DiagnosisOptions {
    let usual = DiagnosisOptions::default();
    DiagnosisOptions {
        false_alarm: false_alarm.unwrap_or(usual.false_alarm),
        most_effects: most_effects.unwrap_or(usual.most_effects),
        without,
        seed,
    }
}

/// Diagnoses records.
#[pyfunction]
#[pyo3(signature = (records, nominal, *, false_alarm, most_effects, without, seed, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "named arguments of a Python function")]
pub(crate) fn diagnose(
    py: Python<'_>,
    records: Vec<Bound<'_, NativeRecord>>,
    nominal: &Bound<'_, NativeNominal>,
    false_alarm: Option<f64>,
    most_effects: Option<usize>,
    without: Vec<String>,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<NativeDiagnosis> {
    let records = records.iter().map(|record| record.get().record(py)).collect::<PyResult<Vec<_>>>()?;
    let nominal = nominal.get().nominal.clone();
    let options = options_of(false_alarm, most_effects, without, seed);
    let diagnosis = beside(py, progress, move |watch| {
        let goes_on = |stage: &'static str| watch.tell(stage);
        on_threads(threads, || diagnose_watched(&records, &nominal, &options, &goes_on))
    })??;
    let diagnosis = diagnosis.map_err(raised)?;
    Ok(NativeDiagnosis { diagnosis })
}
