//! A stated law with weights as a model.

use super::Library;
use crate::Coefficient;
use crate::data::DataSet;
use crate::flow::{FlowModel, Posterior, Running};
use serde_json::json;

/// The model of a law: its weights, and their standard errors where there are any.
#[must_use]
pub fn law(
    learner: &'static str,
    library: &Library,
    (weights, errors): (&[f64], Option<&[f64]>),
    posterior: Posterior,
    running: Running,
    data: &DataSet,
) -> FlowModel {
    let errors = errors.unwrap_or_default().iter().copied().map(Some).chain(std::iter::repeat(None));
    let coefficients =
        library.terms().iter().zip(weights).zip(errors).map(|((term, value), error)| Coefficient {
            name: term.name().into_owned(),
            value: *value,
            unit: term.unit(&data.unit),
            std_error: error.filter(|error| error.is_finite()),
            inclusion: None,
        });
    FlowModel {
        learner,
        coefficients: coefficients.collect(),
        equation: Some(library.equation(weights)),
        form: json!({ "terms": library.terms() }),
        field: Box::new(library.clone()),
        weights: weights.to_vec(),
        posterior,
        running,
    }
}
