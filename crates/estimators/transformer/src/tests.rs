//! Tests of whole fits: those that every network trained on one envelope has to pass.

#[path = "../../../neural/testing/reconstruction.rs"]
mod reconstruction;

use crate::config::TransformerConfig as Config;

const WEIGHT: &str = "encoder.layers.0.mha.query.weight";
