//! Records: arrays that stay Python's own, or files that were read.

use crate::error::{RecordError, raised};
use crate::words::{optional, options, word};
use numpy::{IntoPyArray, PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use ringdown_lab::{
    Arrays, ClockChoice, CsvColumns, Filter, Format, Missing, Origin, Quantity, ReadOptions, Reading, Record,
    TimeUnit, Unit,
};
use serde::Deserialize;
use std::path::PathBuf;

/// One run of an oscillator. From arrays it holds on to these and copies nothing.
#[pyclass(frozen, module = "ringdown_lab._native", name = "NativeRecord")]
pub(crate) struct NativeRecord {
    held: Held,
}

enum Held {
    /// NumPy's own buffers, in the unit given.
    Arrays {
        time: Py<PyArray1<f64>>,
        values: Py<PyArray1<f64>>,
        input: Option<Py<PyArray1<f64>>>,
        about: Box<Arrays>,
    },
    /// A record in SI units that was read or simulated.
    Own(Box<Record>),
}

/// Options for reading a file, by the command line's names.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
#[derive(Default)]
struct ReadingWords {
    format: Format,
    clock: ClockChoice,
    time: Option<String>,
    value: Option<String>,
    input: Option<String>,
    unit: Option<Unit>,
    input_unit: Option<Unit>,
    time_unit: Option<TimeUnit>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    run: Option<usize>,
    counts_per_turn: Option<f64>,
    r#where: Option<Filter>,
    missing: Missing,
    quantity: Option<Quantity>,
    sample_rate: Option<f64>,
    origin: Option<Origin>,
    remove_mean: bool,
}

impl ReadingWords {
    fn reading(self) -> Reading {
        Reading {
            options: ReadOptions {
                format: self.format,
                columns: CsvColumns {
                    time: self.time,
                    value: self.value,
                    input: self.input,
                    unit: self.unit,
                    input_unit: self.input_unit,
                    time_unit: self.time_unit,
                    sample_rate_hz: self.sample_rate,
                    run: self.run,
                    counts_per_turn: self.counts_per_turn,
                    filter: self.r#where,
                    missing: self.missing,
                },
                quantity: self.quantity,
                from_s: self.from_s,
                to_s: self.to_s,
                ..ReadOptions::default()
            },
            clock: self.clock,
            origin: self.origin,
            remove_mean: self.remove_mean,
        }
    }
}

impl NativeRecord {
    pub(crate) fn own(record: Record) -> Self {
        Self { held: Held::Own(Box::new(record)) }
    }

    /// The record in SI units, for a computation.
    pub(crate) fn record(&self, py: Python<'_>) -> PyResult<Record> {
        match &self.held {
            Held::Own(record) => Ok(Record::clone(record)),
            Held::Arrays { time, values, input, about } => {
                let (time, values) = (time.bind(py).readonly(), values.bind(py).readonly());
                let input = input.as_ref().map(|input| input.bind(py).readonly());
                let input = input.as_ref().map(|input| slice(&about.name, "input", input)).transpose()?;
                let about = Arrays { input: input.map(<[f64]>::to_vec), ..Arrays::clone(about) };
                let time = slice(&about.name, "time", &time)?.to_vec();
                let values = slice(&about.name, "values", &values)?.to_vec();
                Record::new(time, values, about).map_err(raised)
            }
        }
    }
}

/// The numbers of an array, where they lie.
fn slice<'a>(name: &str, column: &str, array: &'a PyReadonlyArray1<'_, f64>) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(|_| {
        RecordError::new_err(format!(
            "{name}: {column} is not contiguous; pass numpy.ascontiguousarray({column})"
        ))
    })
}

#[pymethods]
impl NativeRecord {
    #[new]
    #[pyo3(signature = (time, values, input, *, name, unit, quantity, input_unit, clock, origin))]
    #[expect(clippy::too_many_arguments, reason = "named arguments of a Python function")]
    fn new<'py>(
        py: Python<'py>,
        time: Bound<'py, PyArray1<f64>>,
        values: Bound<'py, PyArray1<f64>>,
        input: Option<Bound<'py, PyArray1<f64>>>,
        name: String,
        unit: &str,
        quantity: Option<&str>,
        input_unit: Option<&str>,
        clock: &str,
        origin: &str,
    ) -> PyResult<Self> {
        let about = Arrays {
            unit: word("unit", unit)?,
            quantity: optional("quantity", quantity)?,
            input: None,
            input_unit: optional("input_unit", input_unit)?,
            clock: word("clock", clock)?,
            origin: word("origin", origin)?,
            name,
        };
        {
            let (time, values) = (time.readonly(), values.readonly());
            let input = input.as_ref().map(|input| input.readonly());
            let time = slice(&about.name, "time", &time)?;
            let values = slice(&about.name, "values", &values)?;
            let input = input.as_ref().map(|input| slice(&about.name, "input", input)).transpose()?;
            py.detach(|| Record::check(&about.name, time, values, input)).map_err(raised)?;
        }
        let (time, values, input) = (time.unbind(), values.unbind(), input.map(Bound::unbind));
        Ok(Self { held: Held::Arrays { time, values, input, about: Box::new(about) } })
    }

    /// Reads a file by options given as JSON; `nominal` says which columns and units to look for.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        reading: &str,
        nominal: Option<&Bound<'_, crate::nominal::NativeNominal>>,
    ) -> PyResult<Self> {
        let reading = reading_for(reading, nominal)?;
        py.detach(|| Record::read(path, &reading)).map(Self::own).map_err(raised)
    }

    /// Reads a record from the bytes of a file.
    #[staticmethod]
    fn parse(
        py: Python<'_>,
        name: &str,
        bytes: &Bound<'_, PyBytes>,
        reading: &str,
        nominal: Option<&Bound<'_, crate::nominal::NativeNominal>>,
    ) -> PyResult<Self> {
        let (reading, bytes) = (reading_for(reading, nominal)?, bytes.as_bytes());
        py.detach(|| Record::parse(name, bytes, &reading)).map(Self::own).map_err(raised)
    }

    /// Stamps in seconds.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        match &self.held {
            Held::Arrays { time, .. } => time.bind(py).clone(),
            Held::Own(record) => record.stamps_s().to_vec().into_pyarray(py),
        }
    }

    /// Observed values in `unit`.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        match &self.held {
            Held::Arrays { values, .. } => values.bind(py).clone(),
            Held::Own(record) => record.values().to_vec().into_pyarray(py),
        }
    }

    /// The input, where there is one.
    #[getter]
    fn input<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        match &self.held {
            Held::Arrays { input, .. } => input.as_ref().map(|input| input.bind(py).clone()),
            Held::Own(record) => record.input().map(|input| input.to_vec().into_pyarray(py)),
        }
    }

    /// Unit of `values`.
    #[getter]
    fn unit(&self) -> &'static str {
        match &self.held {
            Held::Arrays { about, .. } => about.unit.symbol(),
            Held::Own(record) => record.unit(),
        }
    }

    /// `position`, `velocity` or `acceleration`.
    #[getter]
    fn quantity(&self) -> &'static str {
        match &self.held {
            Held::Arrays { about, .. } => about.observed_quantity().name(),
            Held::Own(record) => record.quantity().name(),
        }
    }

    /// The name in messages and results.
    #[getter]
    fn name(&self) -> &str {
        match &self.held {
            Held::Arrays { about, .. } => &about.name,
            Held::Own(record) => record.name(),
        }
    }

    /// Account of how the record was read.
    #[getter]
    fn reading(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.record(py)?.reading().to_owned())
    }

    /// CSV text with so many decimals.
    fn to_csv(&self, py: Python<'_>, decimals: u8) -> PyResult<String> {
        Ok(self.record(py)?.to_csv(decimals))
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        match &self.held {
            Held::Arrays { time, .. } => time.bind(py).len().unwrap_or_default(),
            Held::Own(record) => record.len(),
        }
    }
}

/// The options of reading, given as JSON.
pub(crate) fn reading_of(json: &str) -> PyResult<Reading> {
    Ok(options::<ReadingWords>("reading options", json)?.reading())
}

fn reading_for(json: &str, nominal: Option<&Bound<'_, crate::nominal::NativeNominal>>) -> PyResult<Reading> {
    let reading = reading_of(json)?;
    Ok(match nominal {
        Some(nominal) => nominal.get().nominal.reading(reading),
        None => reading,
    })
}
