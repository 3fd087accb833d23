//! Configuration keys of a simulation.

use settings::{Default, Field, Kind, Section};

/// Field without unit and source, to be refined by struct update.
pub(crate) const PLAIN: Field =
    Field { key: "", kind: Kind::Text, default: Default::Absent, unit: "", meaning: "", source: "" };

const ANY: Kind = Kind::Float { min: f64::MIN, max: f64::MAX };

/// Sections with fixed keys; those of the numbers that may be drawn are made in [`crate::plan`].
pub(crate) const SECTIONS: &[Section<'static>] = &[
    Section { name: "", fields: TOP },
    Section { name: "simulate", fields: SIMULATE },
    Section { name: "record", fields: RECORD },
    Section { name: "sensor", fields: SENSOR },
    Section { name: "input", fields: INPUT },
    Section { name: "calibration", fields: CALIBRATION },
];

const TOP: &[Field] = &[
    Field {
        key: "task",
        kind: Kind::Choice(&["simulate"]),
        default: Default::Text("simulate"),
        meaning: "What the configuration is for.",
        ..PLAIN
    },
    Field {
        key: "name",
        default: Default::Text("simulate"),
        meaning: "Start of the run folder's name.",
        ..PLAIN
    },
    Field {
        key: "seed",
        kind: Kind::Integer { min: 0, max: i64::MAX },
        default: Default::Integer(0),
        meaning: "Root of every random draw; each part draws from its own branch by name.",
        ..PLAIN
    },
];

const SIMULATE: &[Field] = &[
    Field {
        key: "systems",
        kind: Kind::Integer { min: 1, max: 1_000_000 },
        default: Default::Integer(1),
        meaning: "How many systems to draw; each with a measurement chain of its own.",
        ..PLAIN
    },
    Field {
        key: "records",
        kind: Kind::Integer { min: 1, max: 1_000 },
        default: Default::Integer(1),
        meaning: "Records of each system, each from a start of its own.",
        ..PLAIN
    },
    Field {
        key: "effects_per_system",
        kind: Kind::Integer { min: 0, max: 26 },
        meaning: "Exact number of effects per system, drawn from those listed with their probabilities as \
                  weights; left open, each effect occurs with its own probability.",
        ..PLAIN
    },
];

const RECORD: &[Field] = &[
    Field {
        key: "rate_hz",
        kind: Kind::Float { min: 1e-6, max: 1e9 },
        default: Default::Float(260.0),
        unit: "Hz",
        meaning: "Samples per second of the sensor's own clock.",
        source: "the paper's rig",
    },
    Field {
        key: "seconds",
        kind: Kind::Float { min: 1e-6, max: 1e9 },
        default: Default::Float(25.0),
        unit: "s",
        meaning: "Length of a record.",
        ..PLAIN
    },
    Field {
        key: "first_stamp_s",
        kind: Kind::Float { min: -1e9, max: 1e9 },
        default: Default::Float(0.0),
        unit: "s",
        meaning: "What the recorder's clock shows at the first sample.",
        ..PLAIN
    },
    Field {
        key: "stamp_decimals",
        kind: Kind::Integer { min: 0, max: crate::MOST_DECIMALS as i64 },
        default: Default::Integer(6),
        meaning: "Decimals of a stamp in the file; a logger of milliseconds has 3.",
        ..PLAIN
    },
    Field {
        key: "value_decimals",
        kind: Kind::Integer { min: 0, max: crate::MOST_DECIMALS as i64 },
        default: Default::Integer(9),
        meaning: "Decimals of a value in the file.",
        ..PLAIN
    },
];

const SENSOR: &[Field] = &[Field {
    key: "observes",
    kind: Kind::Choice(&["position", "velocity", "acceleration"]),
    default: Default::Text("position"),
    meaning: "What the sensor observes: an encoder, a gyroscope, an accelerometer.",
    ..PLAIN
}];

const INPUT: &[Field] = &[
    Field {
        key: "waveform",
        kind: Kind::Choice(&["none", "sine", "chirp", "square"]),
        default: Default::Text("none"),
        meaning: "Shape of the measured input, held between samples; none for a free decay.",
        ..PLAIN
    },
    Field {
        key: "amplitude",
        kind: ANY,
        default: Default::Float(1.0),
        unit: "unit of the input",
        meaning: "Largest value of the input.",
        ..PLAIN
    },
    Field {
        key: "frequency_hz",
        kind: Kind::Float { min: 0.0, max: 1e9 },
        default: Default::Float(1.0),
        unit: "Hz",
        meaning: "Frequency of the input; of a chirp, at the start.",
        ..PLAIN
    },
    Field {
        key: "end_frequency_hz",
        kind: Kind::Float { min: 0.0, max: 1e9 },
        default: Default::Float(10.0),
        unit: "Hz",
        meaning: "Frequency of a chirp at the end of the record.",
        ..PLAIN
    },
];

const RELATIVE: Field = Field {
    kind: Kind::Float { min: 0.0, max: 0.3 },
    default: Default::Float(0.0),
    unit: "relative standard deviation",
    ..PLAIN
};

/// Standard deviations of the believed coefficients (`nominal.toml`) about the true ones. They are at most
/// 0.3, so that a believed coefficient is above 0 in all but one case of a thousand; it is then drawn again.
const CALIBRATION: &[Field] = &[
    Field { key: "inertia", meaning: "Error of the inertia in nominal.toml.", ..RELATIVE },
    Field { key: "damping", meaning: "Error of the damping in nominal.toml.", ..RELATIVE },
    Field { key: "stiffness", meaning: "Error of the stiffness in nominal.toml.", ..RELATIVE },
    Field {
        key: "rest_angle",
        kind: Kind::Float { min: 0.0, max: f64::MAX },
        default: Default::Float(0.0),
        unit: "rad or m, standard deviation",
        meaning: "Error of the rest position in nominal.toml.",
        ..PLAIN
    },
];

/// Keys that a drawn number has in place of a value.
pub(crate) const PRIOR: &[Field] = &[
    Field { key: "from", kind: ANY, meaning: "Lower end of a uniform prior.", ..PLAIN },
    Field { key: "to", kind: ANY, meaning: "Upper end of a uniform prior.", ..PLAIN },
    Field {
        key: "scale",
        kind: Kind::Choice(&["linear", "log"]),
        meaning: "What is uniform between the ends: the number or its logarithm.",
        ..PLAIN
    },
    Field { key: "mean", kind: ANY, meaning: "Mean of a normal prior.", ..PLAIN },
    Field {
        key: "deviation",
        kind: Kind::Float { min: 0.0, max: f64::MAX },
        meaning: "Standard deviation of a normal prior.",
        ..PLAIN
    },
];
