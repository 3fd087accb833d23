//! Laws that the vocabulary does not have: one file each, with a constant `LAW` and its line in [`REGISTRY`].
//!
//! A stiffness that depends on the velocity is not among them: on a single oscillation it is a cubic
//! stiffness but for its small third harmonic, so that the vocabulary's answer would not be wrong.

mod cogging;
mod field;
mod law;
mod maxwell;
mod parametric;
mod position_damping;

pub(crate) use law::UnlistedLaw;
#[cfg(test)]
pub(crate) use maxwell::Maxwell;

use super::recalibration::Absorbed;

/// Every law outside the vocabulary.
pub(crate) static REGISTRY: &[UnlistedLaw] =
    &[field::LAW, cogging::LAW, maxwell::LAW, parametric::LAW, position_damping::LAW];

/// Laws that a case hides alone, with what the vocabulary nearest to each absorbs.
pub(crate) fn alone() -> Vec<(&'static UnlistedLaw, Absorbed)> {
    REGISTRY.iter().filter_map(|law| Some((law, law.alone?))).collect()
}
