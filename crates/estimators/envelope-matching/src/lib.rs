//! The simulated oscillator's envelope matched to the measured one.
//!
//! The damped oscillator θ'' + 2λθ' + ω₀²θ = 0 is integrated in time, its peaks are located on the
//! trajectory, and their heights, in logarithms, are compared with the measured ones. Levenberg–Marquardt
//! moves ln A₀ and λ until the two envelopes match in the sense of least squares. No solution of the
//! differential equation enters, and no law of decay: the integrator takes the damping as a function of
//! the velocity.
//!
//! The measured peaks are not evenly spaced (noise moves them), so the simulated envelope is read at the
//! measured times, between the simulated peaks along the straight line in ln A. The measured ω is that
//! of the damped motion; ω₀² = ω² + λ² then keeps the simulated period at the measured one for every λ,
//! and the motion an oscillation.
//!
//! Reference: Feldman, Mechanical Systems and Signal Processing 25 (2011) 735, for the identification of a
//! vibrating system from its envelope; Gragg, SIAM J. Numer. Anal. 2 (1965) 384, for the integrator.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod config;
mod dual;
mod fit;
mod matching;
mod oscillator;
#[cfg(test)]
mod tests;

pub use config::EnvelopeMatchingConfig;

use estimator::{Entry, Estimator, Tag};

/// The registry's line.
pub const ENTRY: Entry = Entry {
    id: "envelope-matching",
    paper_number: Some(19),
    title: "Envelope matching",
    summary: "A damped oscillator is simulated; its envelope is matched to the measured one over ln A0 and the \
              decay rate.",
    tags: &[Tag::Iterative, Tag::Seeded, Tag::Interval],
    citations: &[
        "Feldman, Mechanical Systems and Signal Processing 25 (2011) 735-802",
        "Gragg, SIAM Journal on Numerical Analysis 2 (1965) 384-403",
        "Marquardt, SIAM Journal on Applied Mathematics 11 (1963) 431-441",
    ],
    fields: config::FIELDS,
    build: |settings| {
        let config: EnvelopeMatchingConfig = settings.section("estimator")?;
        Ok(Box::new(config) as Box<dyn Estimator>)
    },
};
