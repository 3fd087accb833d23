//! Nominal simulators.

use crate::error::raised;
use crate::record::NativeRecord;
use crate::work::beside;
use pyo3::prelude::*;
use ringdown_lab::Nominal;
use std::path::PathBuf;

/// The simulator as it is.
#[pyclass(frozen, module = "ringdown_lab._native", name = "NativeNominal")]
pub(crate) struct NativeNominal {
    pub(crate) nominal: Nominal,
}

#[pymethods]
impl NativeNominal {
    /// From the text of a `nominal.toml`.
    #[staticmethod]
    fn parse(name: &str, text: &str) -> PyResult<Self> {
        Ok(Self { nominal: Nominal::parse(name, text).map_err(raised)? })
    }

    /// From a file.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        Ok(Self { nominal: Nominal::read(path).map_err(raised)? })
    }

    /// The linear oscillator nearest to a record.
    #[staticmethod]
    fn guess(py: Python<'_>, record: &Bound<'_, NativeRecord>) -> PyResult<Self> {
        let record = record.get().record(py)?;
        Ok(Self { nominal: beside(py, None, move |_| Nominal::guess(&record))?.map_err(raised)? })
    }

    /// Inertia, damping, stiffness, rest angle, input gain.
    #[getter]
    fn coefficients(&self) -> (f64, f64, f64, f64, f64) {
        let own = self.nominal.coefficients();
        (own.inertia, own.damping, own.stiffness, own.rest_angle, own.input_gain)
    }

    /// The text of a `nominal.toml`.
    fn to_toml(&self) -> String {
        self.nominal.to_toml()
    }
}
