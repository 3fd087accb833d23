//! Matching of a simulated oscillator's envelope to the measured one.
//!
//! The damped oscillator θ'' + 2λθ' + ω₀²θ = 0 is integrated in time, its peaks are located on the
//! trajectory, and the logarithms of their heights are compared with the measured ones. Levenberg–Marquardt
//! adjusts ln A₀ and λ until the two envelopes match by least squares. Neither a solution of the differential
//! equation nor a law of decay is used: the integrator takes the damping as a function of the velocity.
//!
//! The measured peaks are not evenly spaced, because noise moves them. So the simulated envelope is evaluated
//! at the measured times, by linear interpolation of ln A between the simulated peaks. The measured ω is that
//! of the damped motion; ω₀² = ω² + λ² therefore keeps the simulated period at the measured one for every λ,
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

/// Registry entry of the envelope matching.
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
