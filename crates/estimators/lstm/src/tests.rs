//! Tests of whole fits: those that every network trained on one envelope has to pass.

#[path = "../../../neural/testing/reconstruction.rs"]
mod reconstruction;

use crate::config::LstmConfig as Config;

const WEIGHT: &str = "lstm.forget_gate.hidden_transform.weight";
