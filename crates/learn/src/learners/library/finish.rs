//! Model from a regression's terms: weights refitted to whole trajectories, superfluous terms removed.

use super::{Library, Term, law};
use crate::data::{DataSet, Trajectory};
use crate::flow::{
    Field, FieldShooter, Fit, FlowModel, LENGTHS, Posterior, Running, Shooting, first_guess, fit,
    longest_as_good, phase_name,
};
use crate::judge::validation_error;
use crate::{Context, Fitted, LearnError, Model, Stored};
use estimator::Reached;

/// Options for finishing a regression's law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finishing {
    /// `true` if weights are refitted to trajectories; otherwise the regression's weights are kept.
    pub refit: bool,
    /// Largest number of training samples used by a refit.
    pub samples: usize,
    /// Largest number of steps of each refit.
    pub most_steps: u64,
}

/// Builds a model of a law. `weights` and `inclusion` belong to the library's terms; terms that were left out
/// have a weight of 0.
///
/// With a refit, pieces grow from two periods to whole parts, and each fit starts from the previous one. The
/// longest pieces whose validation error is close to the smallest are kept. Terms whose weight is
/// insignificant are removed one by one, by the criterion of Schwarz (Annals of Statistics 6 (1978) 461) with
/// the effective number of samples that the correlation of the residuals leaves.
///
/// # Errors
/// [`LearnError`] if no length can be fitted and the regression's own law diverges.
pub fn finish(
    learner: &'static str,
    data: &DataSet,
    context: &Context<'_>,
    finishing: &Finishing,
    start: (&[Term], &[f64], &[f64]),
) -> Result<Fitted, LearnError> {
    let (terms, weights, inclusion) = start;
    let kept: Vec<(Term, f64)> =
        terms.iter().cloned().zip(weights.iter().copied()).filter(|(_, weight)| *weight != 0.0).collect();
    let share =
        |term: &Term| terms.iter().zip(inclusion).find(|(own, _)| *own == term).map(|(_, share)| *share);
    let (terms, weights): (Vec<Term>, Vec<f64>) = kept.into_iter().unzip();
    let plain = || Law { terms: terms.clone(), weights: weights.clone(), fit: None };
    let (law, steps, reached) = if finishing.refit {
        match refitted(learner, data, context, finishing, plain())? {
            Some((law, steps)) => {
                let converged = law.fit.as_ref().is_some_and(|fit| fit.converged);
                (law, steps, if converged { Reached::Converged } else { Reached::BudgetSpent })
            }
            None => (plain(), 0, Reached::Diverged),
        }
    } else {
        (plain(), 1, Reached::Converged)
    };
    let mut model = law.model(learner, data, context);
    for (coefficient, term) in model.coefficients.iter_mut().zip(&law.terms) {
        coefficient.inclusion = share(term);
    }
    Ok(Fitted { model: Box::new(model), reached, steps })
}

/// Terms with weights, and the fit that the weights come from.
#[derive(Clone)]
struct Law {
    terms: Vec<Term>,
    weights: Vec<f64>,
    fit: Option<Fit>,
}

impl Law {
    /// Returns the number of steps of its fit; 0 for a law that was not fitted.
    fn steps(&self) -> u64 {
        self.fit.as_ref().map_or(0, |fit| fit.steps)
    }

    fn library(&self) -> Library {
        Library::new(self.terms.clone())
    }

    fn model(&self, learner: &'static str, data: &DataSet, context: &Context<'_>) -> FlowModel {
        let covariance = self.fit.as_ref().and_then(Fit::covariance);
        let errors: Option<Vec<f64>> =
            covariance.as_ref().map(|all| all.diagonal().iter().map(|own| own.sqrt()).collect());
        let posterior = Posterior::of(&self.weights, covariance.as_ref(), &context.seed);
        let running = Running::new(data, self.fit.as_ref().map_or(data.noise, Fit::rms));
        law(learner, &self.library(), (&self.weights, errors.as_deref()), posterior, running, data)
    }

    /// Fits the same law to pieces; `None` if the motion diverges.
    fn fitted(
        &self,
        data: &DataSet,
        pieces: &[Trajectory],
        context: &Context<'_>,
        shooting: &Shooting<'_>,
    ) -> Result<Option<Self>, LearnError> {
        let library = self.library();
        let starts = pieces.iter().map(|piece| first_guess(piece, data.period_s)).collect();
        let shooter = FieldShooter::new(&library, data);
        match fit(&shooter, shooting, self.weights.clone(), starts, context) {
            Ok(found) => {
                Ok(Some(Self { terms: self.terms.clone(), weights: found.weights.clone(), fit: Some(found) }))
            }
            Err(LearnError::Diverged { .. }) => Ok(None),
            Err(other) => Err(other),
        }
    }

    /// Returns the index of the least significant term, if its weight is insignificant enough to be removed.
    fn superfluous(&self) -> Option<usize> {
        let fit = self.fit.as_ref()?;
        let covariance = fit.covariance()?;
        let price = (fit.samples as f64 / fit.correlation).max(8.0).ln();
        let sizes = self.weights.iter().zip(covariance.diagonal().iter().copied().collect::<Vec<_>>());
        let (place, size) = sizes
            .map(|(weight, variance)| weight * weight / variance)
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        (size < price && self.terms.len() > 1).then_some(place)
    }

    fn without(&self, place: usize) -> Self {
        let mut shorter = Self { fit: None, ..self.clone() };
        shorter.terms.remove(place);
        shorter.weights.remove(place);
        shorter
    }
}

/// Refits the law on pieces of each length, removes superfluous terms, and returns the law of the length
/// chosen by validation, with the total number of steps.
fn refitted(
    learner: &'static str,
    data: &DataSet,
    context: &Context<'_>,
    finishing: &Finishing,
    plain: Law,
) -> Result<Option<(Law, u64)>, LearnError> {
    let (mut found, mut steps, mut from): (Vec<(f64, Law)>, u64, Law) = (Vec::new(), 0, plain);
    for periods in LENGTHS {
        let pieces = data.training_pieces(data.period_s * periods, finishing.samples);
        let phase = phase_name(periods);
        let shooting = Shooting {
            pieces: &pieces,
            noise: data.noise,
            penalty: None,
            most_steps: finishing.most_steps,
            phase: &phase,
        };
        let Some(mut law) = from.fitted(data, &pieces, context, &shooting)? else { break };
        steps += law.steps();
        while let Some(place) = law.superfluous() {
            let Some(shorter) = law.without(place).fitted(data, &pieces, context, &shooting)? else { break };
            steps += shorter.steps();
            law = shorter;
        }
        let error = validation_error(&law.model(learner, data, context), data);
        // Longer pieces may need a term that these pieces are too short to determine.
        let weight_of =
            |term: &Term| law.terms.iter().zip(&law.weights).find(|(own, _)| *own == term).map(|(_, w)| *w);
        // A removed term starts again from a weight of zero.
        from.weights = from.terms.iter().map(|term| weight_of(term).unwrap_or(0.0)).collect();
        found.push((error, law));
    }
    Ok(longest_as_good(found).map(|law| (law, steps)))
}

/// Restores the model of a sparse learner from a file.
///
/// # Errors
/// [`LearnError::Stored`] for a file of another form.
pub fn restore(learner: &'static str, stored: &Stored) -> Result<Box<dyn Model>, LearnError> {
    let field = |form: &serde_json::Value| -> Result<Box<dyn Field>, LearnError> {
        let problem =
            |error: String| LearnError::Stored { problem: format!("the terms of the law: {error}") };
        let terms = form.get("terms").cloned().ok_or_else(|| problem("there are none".to_owned()))?;
        let terms: Vec<Term> = serde_json::from_value(terms).map_err(|error| problem(error.to_string()))?;
        Ok(Box::new(Library::new(terms)))
    };
    Ok(Box::new(FlowModel::restore(learner, stored, field)?))
}
