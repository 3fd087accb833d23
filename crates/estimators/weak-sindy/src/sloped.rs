//! Law with the slopes of its trajectory.

use sparse::{Column, Law, Scaled};

/// Law whose trajectory is also known between the peaks, by its slopes at the peaks.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sloped {
    /// Law with its trajectory at the peaks.
    pub(crate) law: Law,
    /// Slopes dx/ds of the trajectory at the peaks.
    pub(crate) slopes: Vec<f64>,
}

impl Sloped {
    /// Creates the law of no decay.
    pub(crate) fn null(scaled: &Scaled) -> Self {
        Self { law: Law::null(scaled), slopes: vec![0.0; scaled.peaks()] }
    }

    /// Creates a law with its trajectory and the slopes.
    pub(crate) fn new(
        constant: f64,
        terms: Vec<(Column, f64)>,
        trajectory: Vec<f64>,
        slopes: Vec<f64>,
        scaled: &Scaled,
    ) -> Self {
        Self { law: Law::new(constant, terms, trajectory, scaled), slopes }
    }

    /// Moves this law a share of the way toward another one with the same terms.
    pub(crate) fn toward(&self, other: &Self, share: f64, scaled: &Scaled) -> Self {
        let mix = |(own, theirs): (&f64, &f64)| own + share * (theirs - own);
        Self {
            law: self.law.toward(&other.law, share, scaled),
            slopes: self.slopes.iter().zip(&other.slopes).map(mix).collect(),
        }
    }
}
