//! Registry of the learners; each method has one file.

pub mod bayesian;
pub mod gaussian_process;
pub mod grey_box;
pub mod library;
pub mod lstm;
pub mod neural_ode;
pub mod neural_state_space;
pub mod pinn;
pub mod sindy;
pub mod state_space;
pub mod symbolic;
pub mod temporal_convolution;
pub mod torque;
pub mod transformer;
pub mod weak_sindy;

use crate::Entry;

/// All learners, in the order of tables.
pub static LEARNERS: &[Entry] = &[
    sindy::ENTRY,
    weak_sindy::ENTRY,
    neural_ode::ENTRY,
    gaussian_process::ENTRY,
    bayesian::ENTRY,
    pinn::ENTRY,
    symbolic::ENTRY,
    grey_box::ENTRY,
    lstm::ENTRY,
    transformer::ENTRY,
    temporal_convolution::ENTRY,
    state_space::ENTRY,
    neural_state_space::ENTRY,
];

/// Returns the learner with an identifier; `None` if there is none.
#[must_use]
pub fn find(id: &str) -> Option<&'static Entry> {
    LEARNERS.iter().find(|entry| entry.id == id)
}

#[cfg(test)]
mod tests;
