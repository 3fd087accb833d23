//! Simulated records.

use crate::error::raised;
use crate::nominal::NativeNominal;
use crate::record::NativeRecord;
use crate::words::options;
use crate::work::beside;
use pyo3::prelude::*;
use ringdown_lab::{Excitation, Quantity, Simulation};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Everything about a simulation but its nominal simulator.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    effects: Vec<(String, BTreeMap<String, f64>)>,
    position: f64,
    velocity: f64,
    rate_hz: f64,
    seconds: f64,
    noise: f64,
    seed: u64,
    quantity: Quantity,
    input: Option<Excitation>,
}

/// Simulates a record by options given as JSON.
#[pyfunction]
pub(crate) fn simulate(
    py: Python<'_>,
    nominal: &Bound<'_, NativeNominal>,
    wanted: &str,
) -> PyResult<NativeRecord> {
    let wanted: Wanted = options("simulate", wanted)?;
    let mut simulation = Simulation::of(&nominal.get().nominal)
        .starting(wanted.position, wanted.velocity)
        .sampled(wanted.rate_hz, wanted.seconds)
        .noise(wanted.noise)
        .observing(wanted.quantity)
        .seed(wanted.seed);
    for (id, parameters) in &wanted.effects {
        let parameters: Vec<(&str, f64)> =
            parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        simulation = simulation.with_effect(id, &parameters).map_err(raised)?;
    }
    if let Some(input) = wanted.input {
        simulation = simulation.driven_by(input);
    }
    let record = beside(py, None, move |_| simulation.run())?.map_err(raised)?;
    Ok(NativeRecord::own(record))
}

/// Every effect: identifier, equation, parameters with their meaning.
#[pyfunction]
pub(crate) fn effects() -> Vec<(&'static str, &'static str, BTreeMap<&'static str, &'static str>)> {
    let parameters = |own: &'static ringdown_lab::Description| {
        own.parameters.iter().map(|parameter| (parameter.name, parameter.meaning)).collect()
    };
    ringdown_lab::effects().map(|own| (own.id, own.equation, parameters(own))).collect()
}
