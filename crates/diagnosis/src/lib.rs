//! Diagnosis of the gap between records and a nominal simulator: the place of the gap, the unmodeled effects
//! that cause it, and how far it shrinks once these effects are added.
//!
//! The diagnosis is blind by construction: its only inputs are [`Observations`] (times by a believed clock,
//! values, input) and the nominal simulator. It has no access to the source of a record. [`diagnose`] returns
//! a [`Diagnosis`].
//!
//! # How an answer comes about
//! The folders are layers, each of which names only those before it: `noise`, `data`, `residual`, `model`, `fit`,
//! `linear`, `sets`, `measurement` and `search`, `evidence`, `explain`, `stages`.
//!
//! 1. **Measurement chain** (`measurement`, `noise`): the believed clock, outliers, the sensor's step, the noise
//!    floor from second differences. Findings that stamps and values show directly are stated as they are.
//! 2. **Segments** (`data`): records are cut into about six periods each, every segment with a start state of its
//!    own, so that a fit cannot lose count of the swings.
//! 3. **Calibration** (`fit`): the nominal simulator is fitted as it is (start states only), then with its
//!    coefficients free. What that leaves is the gap to be explained.
//! 4. **Proposals** (`search`): a Kalman smoother gives the motion without any law (`search::smoothed`), and the weak
//!    form of the equation of motion proposes sets of laws along it, each law at a dense grid of shapes
//!    (`search::weak_form`). To first order, every candidate's effect on the readings, projected on what
//!    calibration and start states cannot imitate, proposes further ones (`linear::dictionary`). Nothing is decided
//!    on a proposal.
//! 5. **Search** (`search::beam`): proposed sets are fitted in full, from pieces of one or two periods up to the
//!    segments. The best set of each size is extended, its members are replaced, generalized and simplified. The
//!    search goes on while the best set leaves more than 1.3 times the noise, and is repeated on joined segments as
//!    long as the sets follow the motion there.
//! 6. **Weights** (`sets::weights`, `sets::likelihood`): the log evidence of a set is the gain in
//!    likelihood of its residuals, by segments and bands, where a residual that persists counts once; minus the
//!    price of its parameters, and of its effects by the size of the vocabulary, their shapes and their flexibility.
//! 7. **Classes** (`evidence::inclusion`): the evidence for a class is that of the best set with it minus that of the
//!    best set without it, in which everything else may take its place. Together with the second witness (half
//!    swings) and the ratio of the held-out errors it becomes a probability whose meaning was learned from simulated
//!    rigs (`evidence::probability`).
//! 8. **Held-out error** (`evidence::held_out`): blocks of every segment take turns at being left out of the fit of
//!    the coefficients. What no set explains shows as a free torque, a line or a band of the residual
//!    (`evidence::left_over`), and decides between `none`, `calibration` and `unknown`.
//! 9. **Explanation** (`explain`): shares, maps, rivals, the repaired simulator and the next experiment.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod answer;
mod data;
mod diagnose;
mod error;
mod evidence;
mod explain;
mod fit;
#[cfg(test)]
mod fixtures;
mod linear;
mod matrices;
mod measurement;
mod model;
mod noise;
#[cfg(test)]
#[allow(clippy::print_stdout, reason = "what a trial finds is read, not only checked")]
mod repaired_tests;
mod residual;
mod search;
mod sets;
mod settings;
mod stages;
#[cfg(test)]
#[allow(clippy::print_stdout, reason = "what a trial finds is read, not only checked")]
mod trials;

pub use answer::{
    Calibrated, Diagnosis, EffectClass, EffectProbability, Experiment, Finding, Kind, KnownRow,
    MeasuringChain, ParameterEstimate, RepairedSimulator, Rivalry, Series, StartState, Status, Undetermined,
    Verdict,
};
pub use data::observations::Observations;
pub use diagnose::{diagnose, diagnose_watched};
pub use error::DiagnosisError;
pub use explain::backbone::{SurfaceCell, Swing, backbone, surface};
pub use explain::repaired::rounded;
pub use explain::single_effect::single_effect;
pub use model::vocabulary::{evidence_class, is_flexible};
pub use settings::Settings;
pub use stages::Stage;
