//! A method, classical or learned, behind one face.

use crate::error::TrainerError;
use envelope::Envelope;
use estimator::{
    Ablation, Cancel, Checkpoints, Entry, Estimand, Estimate, Estimator, FitContext, Observer, Prediction,
    Reached, Silent, Stop, Tag, Uncertainty,
};
use experiment::Single;
use oracle::classical::{self, CLASSICAL, ClassicalFit, ClassicalRoute};
use registry::ESTIMATORS;
use results::Family;
use seed::Seed;
use settings::{Document, Resolved, Section, SettingsError};
use std::sync::Arc;
use studies::StudiedMethod;

/// A method that gives a decay rate.
pub(crate) enum Method {
    Classical(&'static ClassicalRoute),
    Learned(Entry, Arc<dyn Estimator>),
}

/// What a fit is asked for besides the method, the envelope and the seed.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    /// Times at which the fitted function is asked for, in seconds after the first peak.
    pub(crate) query_times: &'a [f64],
    /// Cap on the steps of an iterative method.
    pub(crate) max_steps: Option<u64>,
    pub(crate) cancel: &'a Cancel,
}

impl Method {
    /// Every method there is, learned ones with their default settings: the paper's in its order, the
    /// others after them.
    pub(crate) fn all() -> Result<Vec<Self>, SettingsError> {
        let mut methods: Vec<Self> = CLASSICAL.iter().map(Self::Classical).collect();
        for entry in ESTIMATORS {
            let section = [Section { name: "estimator", fields: entry.fields }];
            let defaults = Resolved::new(&Document::default(), &section)?;
            methods.push(Self::Learned(*entry, (entry.build)(&defaults)?.into()));
        }
        methods.sort_by_key(|method| method.number().unwrap_or(u8::MAX));
        Ok(methods)
    }

    /// The methods named, or all that there are.
    pub(crate) fn named(names: Option<&[String]>) -> Result<Vec<Self>, SettingsError> {
        let mut methods = Self::all()?;
        if let Some(names) = names {
            methods.retain(|method| names.iter().any(|name| name == method.id()));
        }
        Ok(methods)
    }

    /// The method of an experiment with one.
    pub(crate) fn of(single: &Single) -> Result<Self, TrainerError> {
        match single {
            Single::Learned { entry, estimator } => Ok(Self::Learned(*entry, Arc::clone(estimator))),
            Single::Classical(id) => CLASSICAL
                .iter()
                .find(|route| route.id == id)
                .map(Self::Classical)
                .ok_or_else(|| TrainerError::System { what: "the method", problem: id.clone() }),
        }
    }

    pub(crate) fn id(&self) -> &'static str {
        match self {
            Self::Classical(route) => route.id,
            Self::Learned(entry, _) => entry.id,
        }
    }

    pub(crate) fn title(&self) -> &'static str {
        match self {
            Self::Classical(route) => route.title,
            Self::Learned(entry, _) => entry.title,
        }
    }

    /// What it does, in a sentence.
    pub(crate) fn summary(&self) -> &'static str {
        match self {
            Self::Classical(route) => route.summary,
            Self::Learned(entry, _) => entry.summary,
        }
    }

    pub(crate) fn citations(&self) -> &'static [&'static str] {
        match self {
            Self::Classical(route) => route.citations,
            Self::Learned(entry, _) => entry.citations,
        }
    }

    /// Where it comes from.
    pub(crate) fn family(&self) -> Family {
        match self {
            Self::Classical(_) => Family::Classical,
            Self::Learned(..) => Family::Learned,
        }
    }

    /// The method as a study's tables name it.
    pub(crate) fn studied(&self) -> StudiedMethod {
        StudiedMethod { number: self.number(), id: self.id(), title: self.title(), family: self.family() }
    }

    /// Number in the paper's tables.
    pub(crate) fn number(&self) -> Option<u8> {
        match self {
            Self::Classical(route) => Some(route.paper_number),
            Self::Learned(entry, _) => entry.paper_number,
        }
    }

    /// Whether another seed takes another way.
    pub(crate) fn draws(&self) -> bool {
        match self {
            Self::Classical(route) => route.draws,
            Self::Learned(entry, _) => entry.has(Tag::Seeded),
        }
    }

    /// Relation of its converged value to least squares.
    pub(crate) fn estimand(&self) -> Estimand {
        match self {
            Self::Classical(_) => Estimand::LeastSquares,
            Self::Learned(entry, _) => entry.estimand(),
        }
    }

    /// Whether an error passes: a value that may differ from least squares is held to no distance from it.
    pub(crate) fn passes(&self, error_percent: f64, tolerance_percent: f64) -> bool {
        match self.estimand() {
            Estimand::Own => error_percent.is_finite(),
            _ => scoring::passes(error_percent, tolerance_percent),
        }
    }

    /// Whether it has a learned part that can be taken away.
    pub(crate) fn has_ablations(&self) -> bool {
        matches!(self, Self::Learned(entry, _) if entry.has(Tag::Ablation))
    }

    /// As [`Self::pretrained`], told to nobody and kept nowhere.
    pub(crate) fn pretrained_quietly(&self, seed: u64, request: &Request<'_>) -> Result<Self, TrainerError> {
        let (entry, estimator) = match self {
            Self::Classical(route) => return Ok(Self::Classical(route)),
            Self::Learned(entry, estimator) => (entry, estimator),
        };
        let context =
            FitContext::new(Seed::new(seed).child(entry.id), request.max_steps, &Silent, request.cancel);
        let trained = estimator.pretrain(&context);
        let trained = trained.map_err(|source| TrainerError::Fit { estimator: entry.id, seed, source })?;
        Ok(Self::Learned(*entry, trained.map_or_else(|| Arc::clone(estimator), Into::into)))
    }

    /// λ in 1/s of a fit without a part of the method.
    pub(crate) fn fit_without(
        &self,
        ablation: Ablation,
        envelope: &Envelope,
        seed: u64,
        request: &Request<'_>,
    ) -> Result<f64, TrainerError> {
        let not_finite = TrainerError::NotFinite { estimator: self.id(), seed };
        let Self::Learned(entry, estimator) = self else { return Err(not_finite) };
        let branch = Seed::new(seed).child(entry.id);
        let context = FitContext::new(branch, request.max_steps, &Silent, request.cancel).ablating(ablation);
        let estimate = estimator.fit(envelope, &context).map_err(|source| TrainerError::Fit {
            estimator: entry.id,
            seed,
            source,
        })?;
        if estimate.decay_rate.is_finite() { Ok(estimate.decay_rate) } else { Err(not_finite) }
    }

    /// The same method with the part of its work done that no envelope enters.
    pub(crate) fn pretrained(
        self,
        seed: u64,
        max_steps: Option<u64>,
        cancel: &Cancel,
        checkpoints: &dyn Checkpoints,
    ) -> Result<Self, TrainerError> {
        let Self::Learned(entry, estimator) = &self else { return Ok(self) };
        let context = FitContext::new(Seed::new(seed).child(entry.id), max_steps, &Silent, cancel)
            .checkpointing_to(checkpoints);
        let trained = estimator.pretrain(&context).map_err(|source| TrainerError::Fit {
            estimator: entry.id,
            seed,
            source,
        })?;
        Ok(match trained {
            Some(trained) => Self::Learned(*entry, trained.into()),
            None => self,
        })
    }

    /// Fits an envelope.
    ///
    /// A classical method takes no steps that could be capped, watched or stopped: the longest takes
    /// milliseconds.
    pub(crate) fn fit(
        &self,
        envelope: &Envelope,
        seed: u64,
        request: &Request<'_>,
        observer: &dyn Observer,
        checkpoints: Option<&dyn Checkpoints>,
    ) -> Result<Estimate, TrainerError> {
        let branch = Seed::new(seed).child(self.id());
        let estimate = match self {
            Self::Classical(route) => {
                let fit = (route.fit)(envelope, &branch).map_err(|source| TrainerError::Classical {
                    method: route.id,
                    seed,
                    source,
                })?;
                described(envelope, fit, request.query_times)
            }
            Self::Learned(entry, estimator) => {
                let mut context = FitContext::new(branch, request.max_steps, observer, request.cancel)
                    .predicting_at(request.query_times);
                if let Some(checkpoints) = checkpoints {
                    context = context.checkpointing_to(checkpoints);
                }
                estimator.fit(envelope, &context).map_err(|source| TrainerError::Fit {
                    estimator: entry.id,
                    seed,
                    source,
                })?
            }
        };
        if estimate.decay_rate.is_finite() && estimate.log_amplitude.is_finite() {
            Ok(estimate)
        } else {
            Err(TrainerError::NotFinite { estimator: self.id(), seed })
        }
    }
}

/// A classical method's line as an estimate.
fn described(envelope: &Envelope, fit: ClassicalFit, query_times: &[f64]) -> Estimate {
    let times = envelope.times_s();
    let degrees = times.len() as f64 - 2.0;
    let predictions = fit.predictions(envelope, query_times).into_iter();
    let predictions = predictions.map(|line| Prediction::new(line.log_amplitude, line.std_error)).collect();
    let reached = match fit.reached {
        classical::Reached::Converged => Reached::Converged,
        classical::Reached::BudgetSpent => Reached::BudgetSpent,
        classical::Reached::Stalled => Reached::Stalled,
    };
    Estimate {
        decay_rate: fit.decay_rate,
        log_amplitude: fit.log_amplitude,
        uncertainty: fit
            .std_error
            .and_then(|std_error| Uncertainty::students_t(fit.decay_rate, std_error, degrees)),
        stop: Stop { reached, because: fit.because },
        steps: fit.steps,
        // Intercept and slope.
        parameters: 2,
        fitted_log_amplitudes: times.iter().map(|t| fit.log_amplitude - fit.decay_rate * t).collect(),
        predictions,
        equation: None,
        model: None,
    }
}
