//! A law with the slopes of its trajectory.

use sparse::{Column, Law, Scaled};

/// A law whose trajectory is known between the peaks as well, by its slopes there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sloped {
    /// The law with its trajectory at the peaks.
    pub(crate) law: Law,
    /// dx/ds of the trajectory at the peaks.
    pub(crate) slopes: Vec<f64>,
}

impl Sloped {
    /// Nothing decays.
    pub(crate) fn null(scaled: &Scaled) -> Self {
        Self { law: Law::null(scaled), slopes: vec![0.0; scaled.peaks()] }
    }

    /// A law with its trajectory and the slopes.
    pub(crate) fn new(
        constant: f64,
        terms: Vec<(Column, f64)>,
        trajectory: Vec<f64>,
        slopes: Vec<f64>,
        scaled: &Scaled,
    ) -> Self {
        Self { law: Law::new(constant, terms, trajectory, scaled), slopes }
    }

    /// This law moved a share of the way toward another with the same terms.
    pub(crate) fn toward(&self, other: &Self, share: f64, scaled: &Scaled) -> Self {
        let mix = |(own, theirs): (&f64, &f64)| own + share * (theirs - own);
        Self {
            law: self.law.toward(&other.law, share, scaled),
            slopes: self.slopes.iter().zip(&other.slopes).map(mix).collect(),
        }
    }
}
