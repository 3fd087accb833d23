//! Tests of whole fits, shared by all networks that are trained on one envelope.

#[path = "../../../neural/testing/reconstruction.rs"]
mod reconstruction;

use crate::config::LstmConfig as Config;

const WEIGHT: &str = "lstm.forget_gate.hidden_transform.weight";
