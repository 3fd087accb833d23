//! Diagnosis of a robot: recordings of several joints and a model, one question for each joint, and a check of the
//! whole model.

mod closed_loop;
mod joint;
mod read;
mod result;

pub use joint::{JointAnswer, JointQuestion};
pub use read::{LoadedRecording, RobotOptions, RobotQuestion};
