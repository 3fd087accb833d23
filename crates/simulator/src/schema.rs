//! Configuration keys of a simulation.

use settings::{Default, Field, Kind, Section};

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
    Field::new("task", Kind::Choice(&["simulate"]), Default::Text("simulate"))
        .meaning("What the configuration is for."),
    Field::new("name", Kind::Text, Default::Text("simulate")).meaning("Start of the run folder's name."),
    Field::new("seed", Kind::Integer { min: 0, max: i64::MAX }, Default::Integer(0))
        .meaning("Root of every random draw; each part draws from its own branch by name."),
];

const SIMULATE: &[Field] = &[
    Field::new("systems", Kind::Integer { min: 1, max: 1_000_000 }, Default::Integer(1))
        .meaning("How many systems to draw; each with a measurement chain of its own."),
    Field::new("records", Kind::Integer { min: 1, max: 1_000 }, Default::Integer(1))
        .meaning("Records of each system, each from a start of its own."),
    Field::new("effects_per_system", Kind::Integer { min: 0, max: 26 }, Default::Absent).meaning(
        "Exact number of effects per system, drawn from those listed with their probabilities \
                as weights; left open, each effect occurs with its own probability.",
    ),
];

const RECORD: &[Field] = &[
    Field::new("rate_hz", Kind::Float { min: 1e-6, max: 1e9 }, Default::Float(260.0))
        .unit("Hz")
        .meaning("Samples per second of the sensor's own clock.")
        .source("the paper's rig"),
    Field::new("seconds", Kind::Float { min: 1e-6, max: 1e9 }, Default::Float(25.0))
        .unit("s")
        .meaning("Length of a record."),
    Field::new("first_stamp_s", Kind::Float { min: -1e9, max: 1e9 }, Default::Float(0.0))
        .unit("s")
        .meaning("What the recorder's clock shows at the first sample."),
    Field::new(
        "stamp_decimals",
        Kind::Integer { min: 0, max: crate::MOST_DECIMALS as i64 },
        Default::Integer(6),
    )
    .meaning("Decimals of a stamp in the file; a logger of milliseconds has 3."),
    Field::new(
        "value_decimals",
        Kind::Integer { min: 0, max: crate::MOST_DECIMALS as i64 },
        Default::Integer(9),
    )
    .meaning("Decimals of a value in the file."),
];

const SENSOR: &[Field] = &[Field::new(
    "observes",
    Kind::Choice(&["position", "velocity", "acceleration"]),
    Default::Text("position"),
)
.meaning("What the sensor observes: an encoder, a gyroscope, an accelerometer.")];

const INPUT: &[Field] = &[
    Field::new("waveform", Kind::Choice(&["none", "sine", "chirp", "square"]), Default::Text("none"))
        .meaning("Shape of the measured input, held between samples; none for a free decay."),
    Field::new("amplitude", ANY, Default::Float(1.0))
        .unit("unit of the input")
        .meaning("Largest value of the input."),
    Field::new("frequency_hz", Kind::Float { min: 0.0, max: 1e9 }, Default::Float(1.0))
        .unit("Hz")
        .meaning("Frequency of the input; of a chirp, at the start."),
    Field::new("end_frequency_hz", Kind::Float { min: 0.0, max: 1e9 }, Default::Float(10.0))
        .unit("Hz")
        .meaning("Frequency of a chirp at the end of the record."),
];

const RELATIVE: Field = Field::new("", Kind::Float { min: 0.0, max: 0.3 }, Default::Float(0.0))
    .unit("relative standard deviation");

/// Standard deviations of the believed coefficients (`nominal.toml`) about the true ones. They are at most
/// 0.3, so that a believed coefficient is above 0 in all but one case of a thousand; it is then drawn again.
const CALIBRATION: &[Field] = &[
    RELATIVE.key("inertia").meaning("Error of the inertia in nominal.toml."),
    RELATIVE.key("damping").meaning("Error of the damping in nominal.toml."),
    RELATIVE.key("stiffness").meaning("Error of the stiffness in nominal.toml."),
    Field::new("rest_angle", Kind::Float { min: 0.0, max: f64::MAX }, Default::Float(0.0))
        .unit("rad or m, standard deviation")
        .meaning("Error of the rest position in nominal.toml."),
];

/// Keys that a drawn number has in place of a value.
pub(crate) const PRIOR: &[Field] = &[
    Field::new("from", ANY, Default::Absent).meaning("Lower end of a uniform prior."),
    Field::new("to", ANY, Default::Absent).meaning("Upper end of a uniform prior."),
    Field::new("scale", Kind::Choice(&["linear", "log"]), Default::Absent)
        .meaning("What is uniform between the ends: the number or its logarithm."),
    Field::new("mean", ANY, Default::Absent).meaning("Mean of a normal prior."),
    Field::new("deviation", Kind::Float { min: 0.0, max: f64::MAX }, Default::Absent)
        .meaning("Standard deviation of a normal prior."),
];
