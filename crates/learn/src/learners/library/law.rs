//! Model of a stated law with weights.

use super::Library;
use crate::Coefficient;
use crate::data::DataSet;
use crate::flow::{FlowModel, Posterior, Running};
use serde_json::json;
use settings::{Default, Field, Kind};

/// Setting for the terms of a law that is stated rather than searched.
pub(crate) const LAW: Field = Field::new(
    "library",
    Kind::Texts { at_least: 1, at_most: 10 },
    Default::Texts(&["theta", "theta_dot", "sign(theta_dot)", "theta_dot*|theta_dot|", "theta^3", "u"]),
)
.meaning(
    "The terms of the law, by the names of SINDy's library; every one is in it. \"u\" is \
                left out where records have no input.",
);

/// Builds the model of a law from its weights and their optional standard errors.
#[must_use]
pub fn law(
    learner: &'static str,
    library: &Library,
    (weights, errors): (&[f64], Option<&[f64]>),
    posterior: Posterior,
    running: Running,
    data: &DataSet,
) -> FlowModel {
    let errors = errors.into_iter().flatten().copied().map(Some).chain(std::iter::repeat(None));
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
