//! Settings shared by all sequence models.

use neural::{DeviceKind, Precision};
use serde::Deserialize;
use settings::{Default, Field, Kind as Value};

const OWN: Field = Field::new("", Value::Text, Default::Absent);

/// Settings of the training and of the windows. Ranges and defaults are stated in the fields below.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Settings {
    /// Largest number of samples per period.
    pub samples_per_period: usize,
    /// Number of samples of the past that a model reads; `None` for those of the warm-up.
    pub past: Option<usize>,
    /// Length of a block in periods.
    pub block_periods: f64,
    /// Number of blocks in a free run during training.
    pub blocks: usize,
    /// Largest number of windows in an epoch.
    pub windows: usize,
    /// Largest number of epochs.
    pub epochs: u64,
    /// Number of windows in a batch.
    pub batch: usize,
    /// Largest learning rate.
    pub learning_rate: f64,
    /// Weight decay per step, divided by the learning rate.
    pub weight_decay: f64,
    /// Number of epochs without a better validation error after which training stops.
    pub patience: u64,
    /// Device for training.
    pub device: DeviceKind,
    /// Floating-point precision of the device.
    pub precision: Precision,
}

const SHARED: [Field; 12] = [
    OWN.key("samples_per_period")
        .kind(Value::Integer { min: 8, max: 1_000 })
        .default(Default::Integer(48))
        .meaning(
            "Most samples of a typical period that the model sees; records sampled faster are \
                thinned out.",
        ),
    OWN.key("past").kind(Value::Integer { min: 5, max: 96 }).unit("samples").meaning(
        "Samples of the past that the model reads, thinned out as above; where a prediction starts from fewer, the \
                first of these is repeated before them. Left open, those of the warm-up.",
    ),
    OWN.key("block_periods")
        .kind(Value::Float { min: 0.01, max: 100.0 })
        .default(Default::Float(0.5))
        .unit("periods")
        .meaning("Length of the block that is predicted at once; at least eight samples."),
    OWN.key("blocks")
        .kind(Value::Integer { min: 1, max: 1_000 })
        .default(Default::Integer(6))
        .meaning("Blocks of a free run in training."),
    OWN.key("windows")
        .kind(Value::Integer { min: 1, max: 1_000_000 })
        .default(Default::Integer(1_024))
        .meaning("Most windows of an epoch; if there are more, evenly spaced ones are used."),
    OWN.key("epochs")
        .kind(Value::Integer { min: 0, max: 1_000_000 })
        .default(Default::Integer(20))
        .meaning("Most passes over the windows."),
    OWN.key("batch")
        .kind(Value::Integer { min: 1, max: 100_000 })
        .default(Default::Integer(32))
        .meaning("Windows of a batch."),
    OWN.key("learning_rate")
        .kind(Value::Float { min: 1e-9, max: 1.0 })
        .default(Default::Float(5e-3))
        .meaning(
            "Largest learning rate of Adam; it rises over a twentieth of the steps and falls \
                along a half cosine.",
        )
        .source("Kingma, Ba 2015"),
    OWN.key("weight_decay")
        .kind(Value::Float { min: 0.0, max: 1.0 })
        .default(Default::Float(1e-3))
        .meaning("Decay of the weights per step, over the learning rate.")
        .source("Loshchilov, Hutter 2019"),
    OWN.key("patience")
        .kind(Value::Integer { min: 1, max: 1_000_000 })
        .default(Default::Integer(10))
        .meaning(
            "Training ends after this many epochs without a better free run over the validation \
                part.",
        ),
    OWN.key("device").kind(Value::Choice(&["cpu", "wgpu", "cuda"])).default(Default::Text("cpu")).meaning(
        "Device that trains: the processor, or a graphics card where the program was built \
                with `--features wgpu` or `--features cuda`. A trained model predicts on the \
                processor.",
    ),
    OWN.key("precision").kind(Value::Choice(&["f64", "f32"])).default(Default::Text("f64")).meaning(
        "Precision that the device computes in: doubles, or single precision, one for the \
                whole study.",
    ),
];

/// Declares a key for a count: range, default and meaning.
#[must_use]
pub const fn count(key: &'static str, [min, max]: [i64; 2], default: i64, meaning: &'static str) -> Field {
    OWN.key(key).kind(Value::Integer { min, max }).default(Default::Integer(default)).meaning(meaning)
}

/// Joins an architecture's own keys with the shared ones; `ALL` must be twelve more than `N`.
#[must_use]
pub const fn with_shared<const N: usize, const ALL: usize>(own: [Field; N]) -> [Field; ALL] {
    let mut all = [OWN; ALL];
    let mut at = 0;
    while at < ALL {
        #[expect(
            clippy::indexing_slicing,
            reason = "evaluated while compiling, where a wrong ALL is an error"
        )]
        let field = if at < N { own[at] } else { SHARED[at - N] };
        #[expect(clippy::indexing_slicing, reason = "as above")]
        {
            all[at] = field;
        }
        at += 1;
    }
    all
}
