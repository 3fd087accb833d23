//! Dynamics learned from records, by the workspace's learners and by ones written in Python.

use crate::error::raised;
use crate::nominal::NativeNominal;
use crate::record::NativeRecord;
use crate::words::options;
use crate::work::{beside, on_threads};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use ringdown_lab::learning::{
    Ahead, Context, DataSet, Fitted, LearnError, Learner, Model, Past, Predicted, Reached, Step, Trajectory,
};
use ringdown_lab::{LearnOptions, OwnLearner};
use serde::Deserialize;

/// Steps between two lines of progress.
const TOLD_EVERY: u64 = 10;

/// [`LearnOptions`] as Python gives them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    learners: Option<Vec<String>>,
    baselines: Option<Vec<String>>,
    name: String,
    seed: u64,
    max_steps: Option<u64>,
    ablations: bool,
    data: String,
    settings: String,
}

/// Learns by options given as JSON; `own` holds learners written in Python by name. Returns the result as JSON.
#[pyfunction]
#[pyo3(signature = (records, nominal, wanted, own, *, threads, progress))]
pub(crate) fn learn(
    py: Python<'_>,
    records: Vec<Bound<'_, NativeRecord>>,
    nominal: Option<&Bound<'_, NativeNominal>>,
    wanted: &str,
    own: Vec<(String, Py<PyAny>)>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let records = records.iter().map(|record| record.get().record(py)).collect::<PyResult<Vec<_>>>()?;
    let nominal = nominal.map(|nominal| nominal.get().nominal.clone());
    let Wanted { learners, baselines, name, seed, max_steps, ablations, data, settings } =
        options("learn", wanted)?;
    let options = LearnOptions { learners, baselines, name, seed, max_steps, ablations, data, settings };
    let own: Vec<(String, PythonLearner)> =
        own.into_iter().map(|(id, object)| (id, PythonLearner { object })).collect();
    let found = beside(py, progress, move |watch| {
        let own: Vec<OwnLearner<'_>> = own.iter().map(|(id, learner)| OwnLearner { id, learner }).collect();
        let observe = |method: &str, step: &Step| {
            if step.step.is_multiple_of(TOLD_EVERY) {
                watch.tell(&format!(
                    "{method}: {}, step {}, training error {:.3e}",
                    step.phase, step.step, step.train
                ));
            }
        };
        on_threads(threads, || {
            ringdown_lab::learn(&records, nominal.as_ref(), &options, &own, &watch.cancel, &observe)
        })
    })??;
    let found = found.map_err(raised)?;
    serde_json::to_string(&found).map_err(|error| crate::error::RingdownError::new_err(error.to_string()))
}

/// A learner in Python: an object with `fit(train, validation, about)` that gives a model with `predict(past, ahead)`.
struct PythonLearner {
    object: Py<PyAny>,
}

/// Columns of a stretch: times, values, input.
type Columns<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Option<Bound<'py, PyArray1<f64>>>);

fn columns<'py>(py: Python<'py>, times_s: &[f64], values: &[f64], input: Option<&[f64]>) -> Columns<'py> {
    let array = |numbers: &[f64]| numbers.to_vec().into_pyarray(py);
    (array(times_s), array(values), input.map(array))
}

/// What Python raised, in the words of a learner's failure.
fn failed(py: Python<'_>, error: &PyErr) -> LearnError {
    LearnError::Unsolvable { what: "the learner in Python", problem: error.value(py).to_string() }
}

impl Learner for PythonLearner {
    fn fit(&self, data: &DataSet, context: &Context<'_>) -> Result<Fitted, LearnError> {
        context.check()?;
        Python::attach(|py| {
            let part = |part: &[Trajectory]| -> Vec<Columns<'_>> {
                part.iter().map(|own| columns(py, own.times_s(), own.values(), own.input())).collect()
            };
            let about = (data.warm_up_s, data.period_s, data.noise, data.unit.as_str(), context.max_steps);
            let model = self
                .object
                .call_method1(py, "fit", (part(&data.train), part(&data.validation), about))
                .map_err(|error| failed(py, &error))?;
            let parameters = model.getattr(py, "parameters").and_then(|count| count.extract::<usize>(py));
            let parameters = parameters.map_err(|error| failed(py, &error))?;
            let model = Box::new(PythonModel { object: model, parameters });
            Ok(Fitted { model, reached: Reached::Converged, steps: 0 })
        })
    }
}

/// The model that a learner in Python gave; its `predict` holds it to a value for each time.
struct PythonModel {
    object: Py<PyAny>,
    parameters: usize,
}

impl Model for PythonModel {
    fn free_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        Python::attach(|py| {
            let past = columns(py, past.times_s, past.values, past.input);
            let array = |numbers: &[f64]| numbers.to_vec().into_pyarray(py);
            let to = (array(ahead.times_s), ahead.input.map(array));
            let told = self.object.call_method1(py, "predict", (past, to));
            let told = told.and_then(|told| told.extract::<(Vec<f64>, Option<Vec<f64>>)>(py));
            let (values, std) = told.map_err(|error| failed(py, &error))?;
            Ok(Predicted { values, std })
        })
    }

    fn banded_run(&self, past: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        self.free_run(past, ahead)
    }

    fn parameters(&self) -> usize {
        self.parameters
    }
}
