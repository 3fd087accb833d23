//! Tests of whole fits, shared by all networks that are trained on one envelope.

#[path = "../../../neural/testing/reconstruction.rs"]
mod reconstruction;

use crate::config::TransformerConfig as Config;

const WEIGHT: &str = "encoder.layers.0.mha.query.weight";
