//! `nominal.toml`: what is believed of a system.

use dynamics::{Coefficients, Coordinate, DynamicsError, Nominal};
use serde::Deserialize;
use settings::{Default, Document, Field, Kind, Resolved, Section, SettingsError};

/// A nominal simulator as its file has it.
#[derive(Debug, Clone)]
pub struct StatedNominal {
    /// The simulator.
    pub nominal: Nominal,
    /// Whether the file speaks of an input: the records have to have one then.
    pub driven: bool,
}

#[derive(Deserialize)]
struct Keys {
    coordinate: Coordinate,
    inertia: f64,
    damping: f64,
    stiffness: f64,
    rest_angle: f64,
    input_gain: f64,
    sensor_resolution: Option<f64>,
}

const NUMBER: Field = Field {
    key: "",
    kind: Kind::Float { min: f64::MIN, max: f64::MAX },
    default: Default::Required,
    unit: "SI, or divided by the inertia",
    meaning: "",
    source: "",
};
const POSITIVE: Kind = Kind::Float { min: f64::MIN_POSITIVE, max: f64::MAX };
const NON_NEGATIVE: Kind = Kind::Float { min: 0.0, max: f64::MAX };

/// The keys of the file.
pub const NOMINAL: Section<'static> = Section { name: "", fields: FIELDS };

const FIELDS: &[Field] = &[
    Field {
        key: "coordinate",
        kind: Kind::Choice(&["angle", "displacement"]),
        default: Default::Text("angle"),
        unit: "",
        meaning: "What moves: an angle in rad, or a displacement in m.",
        ..NUMBER
    },
    Field {
        key: "inertia",
        kind: POSITIVE,
        meaning: "Moment of inertia, or mass; 1 where everything is per unit of inertia.",
        ..NUMBER
    },
    Field { key: "damping", kind: NON_NEGATIVE, meaning: "Viscous damping.", ..NUMBER },
    Field {
        key: "stiffness",
        kind: NON_NEGATIVE,
        meaning: "Stiffness; 0 for a drive without a spring.",
        ..NUMBER
    },
    Field { key: "rest_angle", unit: "rad or m", meaning: "Where the spring is relaxed.", ..NUMBER },
    Field {
        key: "input_gain",
        default: Default::Float(1.0),
        unit: "torque or force per unit of the input",
        meaning: "What a unit of the input exerts.",
        ..NUMBER
    },
    Field {
        key: "sensor_resolution",
        kind: POSITIVE,
        default: Default::Absent,
        unit: "rad or m",
        meaning: "The sensor's stated resolution.",
        ..NUMBER
    },
];

/// Checks a document and makes the simulator that it states.
///
/// # Errors
/// [`SettingsError`] with line and column; [`SettingsError::Refused`] for numbers that no oscillator has.
pub fn resolve_nominal(document: &Document) -> Result<StatedNominal, SettingsError> {
    let resolved = Resolved::new(document, &[NOMINAL])?;
    let keys: Keys = resolved.section("")?;
    nominal(&keys)
        .map(|nominal| StatedNominal { nominal, driven: document.get("input_gain").is_some() })
        .map_err(|error| SettingsError::Refused {
            file: document.file().to_owned(),
            problem: error.to_string(),
        })
}

fn nominal(keys: &Keys) -> Result<Nominal, DynamicsError> {
    let nominal = Nominal::from_coefficients(Coefficients {
        inertia: keys.inertia,
        damping: keys.damping,
        stiffness: keys.stiffness,
        rest_angle: keys.rest_angle,
        input_gain: keys.input_gain,
    })?
    .with_coordinate(keys.coordinate);
    match keys.sensor_resolution {
        Some(resolution) => nominal.with_sensor_resolution(resolution),
        None => Ok(nominal),
    }
}
