//! Model from a corrected field, for any form of correction.

use super::{Base, Corrected, Correction, Progress, progressive};
use crate::data::DataSet;
use crate::flow::{Field, Fit, FlowModel, Penalty, Posterior, Running};
use crate::judge::validation_error;
use crate::linear::inverse;
use crate::{Context, Fitted, LearnError, Model, Stored};
use estimator::Reached;
use nalgebra::{DMatrix, DVector};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Correction that can be stored in a file.
pub trait Kept: Correction + Clone + Serialize + DeserializeOwned + 'static {}

impl<C: Correction + Clone + Serialize + DeserializeOwned + 'static> Kept for C {}

/// Stored form from which a field is rebuilt.
#[derive(Serialize, Deserialize)]
struct Form<C> {
    base: Base,
    #[serde(alias = "network", alias = "basis")]
    correction: C,
}

/// Builds a model from a corrected field and its weights.
#[must_use]
pub fn model<C: Kept>(
    learner: &'static str,
    field: &Corrected<C>,
    weights: &[f64],
    posterior: Posterior,
    running: Running,
) -> FlowModel {
    let form = Form { base: field.base, correction: field.correction.clone() };
    FlowModel {
        learner,
        // A model without a form is not stored (`FlowModel::stored`).
        form: serde_json::to_value(form).unwrap_or(serde_json::Value::Null),
        field: Box::new(field.clone()),
        weights: weights.to_vec(),
        posterior,
        running,
        coefficients: Vec::new(),
        equation: None,
    }
}

/// Restores a model from its file.
///
/// # Errors
/// [`LearnError::Stored`] for a file of another form.
pub fn restored<C: Kept>(learner: &'static str, stored: &Stored) -> Result<Box<dyn Model>, LearnError> {
    let field = |form: &serde_json::Value| -> Result<Box<dyn Field>, LearnError> {
        let form: Form<C> = serde_json::from_value(form.clone())
            .map_err(|error| LearnError::Stored { problem: format!("the form of the torque: {error}") })?;
        Ok(Box::new(Corrected { base: form.base, correction: form.correction }))
    };
    Ok(Box::new(FlowModel::restore(learner, stored, field)?))
}

/// Fits a field on growing pieces. Returns the fit chosen by validation, with the total number of steps.
///
/// # Errors
/// As [`progressive`].
pub fn fit<C: Kept>(
    learner: &'static str,
    field: &Corrected<C>,
    data: &DataSet,
    context: &Context<'_>,
    how: (&Penalty, Progress),
    start: Vec<f64>,
) -> Result<(Fit, u64), LearnError> {
    let validate = |weights: &[f64]| {
        let running = Running::new(data, data.noise);
        validation_error(&model(learner, field, weights, Posterior::default(), running), data)
    };
    progressive(field, data, context, how, start, &validate)
}

/// Builds the model of a fit, with bands by Laplace's approximation.
#[must_use]
pub fn finished<C: Kept>(
    learner: &'static str,
    field: &Corrected<C>,
    data: &DataSet,
    context: &Context<'_>,
    (fit, steps, penalty): (&Fit, u64, &Penalty),
) -> Fitted {
    let posterior = laplace(fit, penalty, context);
    let reached = if fit.converged { Reached::Converged } else { Reached::BudgetSpent };
    let whole = model(learner, field, &fit.weights, posterior, Running::new(data, fit.rms()));
    Fitted { model: Box::new(whole), reached, steps }
}

/// Draws weights from Laplace's approximation of the posterior.
fn laplace(fit: &Fit, penalty: &Penalty, context: &Context<'_>) -> Posterior {
    let precision = DMatrix::from_diagonal(&DVector::from_column_slice(&penalty.precision));
    let covariance = inverse(&(&fit.information / fit.variance() + precision));
    Posterior::of(&fit.weights, covariance.as_ref(), &context.seed)
}
