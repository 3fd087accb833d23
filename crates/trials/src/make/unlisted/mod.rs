//! Laws outside the vocabulary: one file each, with a constant `LAW` and a line in [`REGISTRY`].
//!
//! A stiffness that depends on the velocity is not among them. On a single oscillation it equals a cubic
//! stiffness except for a small third harmonic, so the vocabulary's answer would not be wrong.

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

/// All laws outside the vocabulary.
pub(crate) static REGISTRY: &[UnlistedLaw] =
    &[field::LAW, cogging::LAW, maxwell::LAW, parametric::LAW, position_damping::LAW];

/// Returns the laws that a case hides alone, with what the nearest effects of the vocabulary absorb of each.
pub(crate) fn alone() -> Vec<(&'static UnlistedLaw, Absorbed)> {
    REGISTRY.iter().filter_map(|law| Some((law, law.alone?))).collect()
}
