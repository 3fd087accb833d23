//! What a classical method is and what it gives.

use crate::error::OracleError;
use envelope::Envelope;
use seed::Seed;

/// What a method reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    /// The residuals are orthogonal to the model's tangent space to within the stated tolerance; for a
    /// direct method, the digits are promised.
    Converged,
    /// The budget of steps ended first.
    BudgetSpent,
    /// No step improves the fit, and the residuals are not orthogonal either.
    Stalled,
}

/// What a classical method makes of an envelope.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassicalFit {
    /// λ, in 1/s.
    pub decay_rate: f64,
    /// ln A₀, at the first peak.
    pub log_amplitude: f64,
    /// Standard error of λ under independent residuals of one variance, in 1/s; `None` where the method
    /// gives none.
    pub std_error: Option<f64>,
    /// Significant digits promised for λ and ln A₀; `None` where the method promises none.
    pub promised_digits: Option<f64>,
    /// Steps taken: iterations, generations, or 1 for a direct method.
    pub steps: u64,
    /// What was reached.
    pub reached: Reached,
    /// Why it stopped there: a sentence with numbers.
    pub because: String,
}

/// One of the paper's classical methods.
#[derive(Debug, Clone, Copy)]
pub struct ClassicalRoute {
    /// Name in tables and configurations.
    pub id: &'static str,
    /// Number in the paper's Tables 1 and 4.
    pub paper_number: u8,
    /// Title.
    pub title: &'static str,
    /// What it does, in a sentence.
    pub summary: &'static str,
    /// Sources.
    pub citations: &'static [&'static str],
    /// Whether it draws from the seed, so that another seed takes another way.
    pub draws: bool,
    /// Fits an envelope.
    pub fit: fn(&Envelope, &Seed) -> Result<ClassicalFit, OracleError>,
}
