//! Classical method and its result.

use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// State in which a method ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    /// The residuals are orthogonal to the model's tangent space to within the stated tolerance; for a direct
    /// method, the digits are promised.
    Converged,
    /// The budget of steps was spent before convergence.
    BudgetSpent,
    /// No step improves the fit, and the residuals are not orthogonal either.
    Stalled,
}

/// Result of a classical method on an envelope.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassicalFit {
    /// Decay rate λ, in 1/s.
    pub decay_rate: f64,
    /// ln A₀ at the first peak, with the amplitude in the record's unit.
    pub log_amplitude: f64,
    /// Standard error of λ for independent residuals of one variance, in 1/s; `None` if the method gives
    /// none.
    pub std_error: Option<f64>,
    /// Significant digits promised for λ and ln A₀; `None` if the method promises none.
    pub promised_digits: Option<f64>,
    /// Number of steps taken: iterations, generations, or 1 for a direct method.
    pub steps: u64,
    /// State in which the method ended.
    pub reached: Reached,
    /// Reason why the method ended, as a sentence with numbers.
    pub because: String,
}

/// One of the paper's classical methods.
#[derive(Debug, Clone, Copy)]
pub struct ClassicalRoute {
    /// Name in tables and configurations.
    pub id: &'static str,
    /// Number in the paper's Tables 1 and 4.
    pub paper_number: u8,
    /// Human-readable name.
    pub title: &'static str,
    /// The method, in one sentence.
    pub summary: &'static str,
    /// Literature that the method follows.
    pub citations: &'static [&'static str],
    /// `true` if the method draws from the seed, so that another seed gives another computation.
    pub draws: bool,
    /// Fits an envelope.
    pub fit: fn(&Envelope, &Seed) -> Result<ClassicalFit, OracleError>,
}
