//! Estimates of the damping ratio.

use crate::error::raised;
use crate::record::NativeRecord;
use crate::work::beside;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use ringdown_lab::contract::{
    Envelope, Estimate as Estimated, Estimator, FitContext, FitError, Prediction, Reached, Stop, Uncertainty,
};
use ringdown_lab::{Estimate, EstimateOptions, Pipeline, estimate_until, estimate_with};

/// Estimates by a method of the registry; a dictionary of [`Estimate`]'s fields.
#[pyfunction]
#[pyo3(signature = (record, method, *, pipeline, seed, max_steps, settings))]
pub(crate) fn estimate<'py>(
    py: Python<'py>,
    record: &Bound<'py, NativeRecord>,
    method: String,
    pipeline: Option<&str>,
    seed: u64,
    max_steps: Option<u64>,
    settings: String,
) -> PyResult<Bound<'py, PyDict>> {
    let record = record.get().record(py)?;
    let pipeline = crate::words::optional::<Pipeline>("pipeline", pipeline)?.unwrap_or(Pipeline::Auto);
    let options = EstimateOptions { pipeline, seed, max_steps, settings };
    let found = beside(py, None, move |watch| estimate_until(&record, &method, &options, &watch.cancel))?;
    told(py, &found.map_err(raised)?)
}

/// Estimates by an estimator written in Python: an object with `fit(times, logarithms of amplitudes)`, which gives the decay rate,
/// ln A at time 0, and the rate's standard error or `None`. Otherwise as [`estimate`].
#[pyfunction]
#[pyo3(signature = (record, name, object, *, pipeline, seed))]
pub(crate) fn estimate_own<'py>(
    py: Python<'py>,
    record: &Bound<'py, NativeRecord>,
    name: String,
    object: Py<PyAny>,
    pipeline: Option<&str>,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let record = record.get().record(py)?;
    let pipeline = crate::words::optional::<Pipeline>("pipeline", pipeline)?.unwrap_or(Pipeline::Auto);
    let options = EstimateOptions { pipeline, seed, ..EstimateOptions::default() };
    let found =
        beside(py, None, move |_| estimate_with(&record, &name, &PythonEstimator { object }, &options))?;
    told(py, &found.map_err(raised)?)
}

/// An estimator in Python.
struct PythonEstimator {
    object: Py<PyAny>,
}

impl Estimator for PythonEstimator {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimated, FitError> {
        let (times, logs) = (envelope.times_s(), envelope.log_amplitudes());
        let (rate, log_amplitude, error) = Python::attach(|py| {
            let array = |numbers: &[f64]| numbers.to_vec().into_pyarray(py);
            let told = self.object.call_method1(py, "fit", (array(times), array(logs)));
            told.and_then(|told| told.extract::<(f64, f64, Option<f64>)>(py))
                .map_err(|error| FitError::Outside { problem: error.value(py).to_string() })
        })?;
        let line = |time: &f64| log_amplitude - rate * time;
        let degrees = times.len() as f64 - 2.0;
        Ok(Estimated {
            decay_rate: rate,
            log_amplitude,
            uncertainty: error.and_then(|error| Uncertainty::students_t(rate, error, degrees)),
            stop: Stop { reached: Reached::Converged, because: "the estimator in Python gave it".to_owned() },
            steps: 0,
            parameters: 2,
            fitted_log_amplitudes: times.iter().map(line).collect(),
            predictions: context.query_times().iter().map(|time| Prediction::new(line(time), None)).collect(),
            equation: None,
            model: None,
        })
    }
}

/// An estimate as a dictionary.
fn told<'py>(py: Python<'py>, found: &Estimate) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    told.set_item("damping_ratio", found.damping_ratio)?;
    told.set_item("damping_ratio_std_error", found.damping_ratio_std_error)?;
    told.set_item("decay_rate", found.decay_rate)?;
    told.set_item("decay_rate_interval_95", found.decay_rate_interval_95.map(|[low, high]| (low, high)))?;
    told.set_item("omega_rad_s", found.omega_rad_s)?;
    told.set_item("peaks", found.peaks)?;
    told.set_item("least_squares", found.least_squares)?;
    told.set_item("error_percent", found.error_percent)?;
    told.set_item("reached", found.reached.name())?;
    told.set_item("because", &found.because)?;
    told.set_item("steps", found.steps)?;
    told.set_item("equation", found.equation.as_deref())?;
    Ok(told)
}

/// Every method: name in configurations, name in words, a sentence.
#[pyfunction]
pub(crate) fn methods() -> Vec<(&'static str, &'static str, &'static str)> {
    ringdown_lab::methods().map(|own| (own.id, own.title, own.summary)).collect()
}
