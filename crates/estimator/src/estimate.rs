//! What an estimator gives.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// What a fit reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    /// The method's own condition for a solution holds.
    Converged,
    /// The budget ended first.
    BudgetSpent,
    /// The loss stopped being finite or grew without bound; the best state before is reported.
    Diverged,
    /// Somebody asked to stop; the best state so far is reported.
    Interrupted,
    /// No step improves the fit, and the method's own condition does not hold either.
    Stalled,
}

impl Reached {
    /// The name as results write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::BudgetSpent => "budget_spent",
            Self::Diverged => "diverged",
            Self::Interrupted => "interrupted",
            Self::Stalled => "stalled",
        }
    }
}

/// What a fit reached, and why it stopped there.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// What it reached.
    pub reached: Reached,
    /// A sentence with numbers; where the fit did not converge, with what to do.
    pub because: String,
}

/// How well a decay rate is known, as the method itself states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Standard error of λ, in 1/s.
    pub std_error: f64,
    /// 95 % interval of λ, in 1/s.
    pub interval_95: [f64; 2],
}

impl Uncertainty {
    /// A symmetric interval by Student's t.
    ///
    /// `decay_rate` and `std_error` in 1/s; `degrees_of_freedom` above 0. `None` where a number is not
    /// finite or not positive.
    #[must_use]
    pub fn students_t(decay_rate: f64, std_error: f64, degrees_of_freedom: f64) -> Option<Self> {
        let usable = decay_rate.is_finite() && std_error.is_finite() && std_error >= 0.0;
        let quantile =
            StudentsT::new(0.0, 1.0, degrees_of_freedom).ok().filter(|_| usable)?.inverse_cdf(0.975);
        let half_width = quantile * std_error;
        Some(Self { std_error, interval_95: [decay_rate - half_width, decay_rate + half_width] })
    }
}

/// What a fitted estimator says of a peak it may not have seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// ln A at the time asked about, the amplitude in the record's unit: finite.
    pub log_amplitude: f64,
    /// Standard deviation of a **measured** ln A about it, scatter and the fit's own uncertainty
    /// together, where the method states one.
    pub std_error: Option<f64>,
}

/// A trained model as a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFile {
    /// Name of the file, such as `weights.safetensors`.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// What an estimator found.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Decay rate λ, in 1/s: finite, of either sign (an envelope may grow).
    pub decay_rate: f64,
    /// ln A at the first peak, the amplitude in the record's unit: finite.
    pub log_amplitude: f64,
    /// How well λ is known, where the method states it.
    pub uncertainty: Option<Uncertainty>,
    /// What the fit reached and why it stopped.
    pub stop: Stop,
    /// Training steps taken.
    pub steps: u64,
    /// Number of trained parameters.
    pub parameters: usize,
    /// The fitted function ln A at the envelope's times.
    pub fitted_log_amplitudes: Vec<f64>,
    /// The fitted function at [`FitContext::query_times`](crate::FitContext::query_times), one for each
    /// time asked about.
    pub predictions: Vec<Prediction>,
    /// The law that the method discovered, in the record's units, where it discovers laws.
    pub equation: Option<String>,
    /// The trained model, where there is something to keep.
    pub model: Option<ModelFile>,
}
