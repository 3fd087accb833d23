//! Methods, classical or learned, behind one interface.

use crate::error::TrainerError;
use envelope::Envelope;
use estimator::{
    Ablation, Cancel, Checkpoints, Entry, Estimand, Estimate, Estimator, FitContext, Observer, Silent, Tag,
};
use experiment::Single;
use oracle::classical::{self, CLASSICAL, ClassicalRoute};
use registry::ESTIMATORS;
use results::Family;
use seed::Seed;
use settings::{Document, Resolved, Section, SettingsError};
use std::sync::Arc;
use studies::StudiedMethod;
use workflow::estimate::of_line;

/// Method that estimates a decay rate.
pub(crate) enum Method {
    Classical(&'static ClassicalRoute),
    Learned(Entry, Arc<dyn Estimator>),
}

/// Request to a fit, in addition to the method, the envelope and the seed.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    /// Times at which the fitted function is evaluated, in seconds after the first peak.
    pub(crate) query_times: &'a [f64],
    /// Cap on the steps of an iterative method.
    pub(crate) max_steps: Option<u64>,
    pub(crate) cancel: &'a Cancel,
}

impl Method {
    /// Returns all methods, learned ones with their default settings: those of the paper in its order, then
    /// the others.
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

    /// Returns the named methods, or all of them.
    pub(crate) fn named(names: Option<&[String]>) -> Result<Vec<Self>, SettingsError> {
        let mut methods = Self::all()?;
        if let Some(names) = names {
            methods.retain(|method| names.iter().any(|name| name == method.id()));
        }
        Ok(methods)
    }

    /// Returns the method of an experiment with a single one.
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

    /// Returns a one-sentence description of the method.
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

    /// Returns the family of the method: classical or learned.
    pub(crate) fn family(&self) -> Family {
        match self {
            Self::Classical(_) => Family::Classical,
            Self::Learned(..) => Family::Learned,
        }
    }

    /// Returns the method in the form used by a study's tables.
    pub(crate) fn studied(&self) -> StudiedMethod {
        StudiedMethod { number: self.number(), id: self.id(), title: self.title(), family: self.family() }
    }

    /// Returns the number in the paper's tables; `None` for a method outside the paper.
    pub(crate) fn number(&self) -> Option<u8> {
        match self {
            Self::Classical(route) => Some(route.paper_number),
            Self::Learned(entry, _) => entry.paper_number,
        }
    }

    /// Returns `true` if the result depends on the seed.
    pub(crate) fn draws(&self) -> bool {
        match self {
            Self::Classical(route) => route.draws,
            Self::Learned(entry, _) => entry.has(Tag::Seeded),
        }
    }

    /// Returns the relation of the method's converged value to least squares.
    pub(crate) fn estimand(&self) -> Estimand {
        match self {
            Self::Classical(_) => Estimand::LeastSquares,
            Self::Learned(entry, _) => entry.estimand(),
        }
    }

    /// Returns `true` for the deliberately weak baseline: plain gradient descent takes the paper's fixed number of
    /// steps in unscaled seconds, which do not suffice for a long record, whatever its quality.
    pub(crate) fn has_fixed_steps(&self) -> bool {
        self.id() == classical::gradient_descent::ROUTE.id
    }

    /// Returns `true` if an error passes. A value that may differ from least squares passes at any finite
    /// distance.
    pub(crate) fn passes(&self, error_percent: f64, tolerance_percent: f64) -> bool {
        match self.estimand() {
            Estimand::Own => error_percent.is_finite(),
            _ => scoring::passes(error_percent, tolerance_percent),
        }
    }

    /// Returns `true` if the method has a learned part that can be removed.
    pub(crate) fn has_ablations(&self) -> bool {
        matches!(self, Self::Learned(entry, _) if entry.has(Tag::Ablation))
    }

    /// Pretrains as [`Self::pretrained`] does, without progress output and checkpoints.
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

    /// Fits without a part of the method and returns λ in 1/s.
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

    /// Pretrains the method: does the part of its work that does not depend on an envelope.
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
    /// A classical method has no steps to cap, watch or stop: the slowest takes milliseconds.
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
                of_line(envelope, fit, request.query_times)
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
