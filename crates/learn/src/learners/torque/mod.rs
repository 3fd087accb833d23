//! Torques learned as functions: the nominal oscillator, linear terms, dry friction, and a correction of any
//! form.

mod corrected;
mod learned;
mod pretraining;
mod progressive;

pub use corrected::{Base, Corrected, Correction};
pub use learned::{Kept, finished, fit, model, restored};
pub use pretraining::pretrained;
pub use progressive::{Progress, progressive};
