//! Settings of the estimator.

use crate::network::{FEATURES, SAID, Size};
use neural::{Lbfgs, Reconstruction};
use serde::Deserialize;
use settings::{Default, Field, Kind};

/// Settings of the transformer. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct TransformerConfig {
    /// Number of layers of attention and feed-forward.
    pub layers: usize,
    /// Number of attention heads.
    pub heads: usize,
    /// Width of a head; the width of the network is the number of heads times this.
    pub head_width: usize,
    /// Width between the two linear maps of the feed-forward part.
    pub feed_forward_width: usize,
    /// Options of the training.
    #[serde(flatten)]
    pub training: Reconstruction,
    /// Factor on the random start values of the weights before the head.
    pub initial_scale: f64,
}

impl TransformerConfig {
    /// Returns the dimensions of the network that is trained on the one envelope it reads.
    pub(crate) fn size(&self) -> Size {
        Size {
            features: FEATURES,
            layers: self.layers,
            heads: self.heads,
            head_width: self.head_width,
            feed_forward_width: self.feed_forward_width,
            says: SAID,
        }
    }
}

/// Number of layers of self-attention and feed-forward, each followed by a layer norm.
pub(crate) const LAYERS: Field = Field::new("layers", Kind::Integer { min: 1, max: 8 }, Default::Integer(1))
    .meaning("Layers, each of self-attention and feed-forward, each followed by a layer norm.")
    .source("1 to 4 agree to rounding; one trains fastest");

/// Number of attention heads.
pub(crate) const HEADS: Field = Field::new("heads", Kind::Integer { min: 1, max: 16 }, Default::Integer(4))
    .meaning("Heads of the attention.")
    .source("a small transformer for a short sequence");

/// Width of a head; the width of the network is the number of heads times this.
pub(crate) const HEAD_WIDTH: Field =
    Field::new("head_width", Kind::Integer { min: 1, max: 64 }, Default::Integer(4))
        .meaning("Width of a head; the network's own width is heads times this.")
        .source("a small transformer for a short sequence");

/// Width between the two linear maps of the feed-forward part, where the tanh is applied.
pub(crate) const FEED_FORWARD_WIDTH: Field =
    Field::new("feed_forward_width", Kind::Integer { min: 1, max: 1024 }, Default::Integer(32))
        .meaning("Width between the two linear maps of the feed-forward part, with tanh there.")
        .source("twice the network's width");

/// Factor on the random start values of the weights before the head.
pub(crate) const INITIAL_SCALE: Field =
    Field::new("initial_scale", Kind::Float { min: 1e-3, max: 10.0 }, Default::Float(1.0))
        .meaning("Factor on the drawn start values of the weights before the head.")
        .source("Glorot, Bengio 2010");

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    LAYERS,
    HEADS,
    HEAD_WIDTH,
    FEED_FORWARD_WIDTH,
    Reconstruction::longest_sequence(1000, 256, "the attention costs as the square of the length"),
    Lbfgs::MAX_STEPS,
    Lbfgs::MEMORY,
    Lbfgs::GRADIENT_TOLERANCE,
    INITIAL_SCALE,
];
