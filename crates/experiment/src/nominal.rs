//! `nominal.toml`: the nominal simulator of a system.
//!
//! The oscillator stands at the top of the file or, as in a configuration of `trainer simulate`, in
//! `[nominal]`. The effects that the simulator has stand in `[[effects]]`. Such a configuration also holds
//! tables about the records to be simulated. They do not describe the system and are ignored here, except
//! that a table `[input]` marks the system as driven. A repaired simulator can therefore be read as a nominal
//! one without changes.

#![allow(clippy::indexing_slicing, reason = "the number of alternatives is checked when compiled")]

use crate::actuator;
use dynamics::{
    Active, Actuator, Coefficients, Coordinate, DynamicsError, Effect, KnownEffect, Nominal,
    NominalSimulator, REGISTRY, Units,
};
use serde::Deserialize;
use settings::{Default, Document, Field, Kind, Origin, Resolved, Section, SettingsError};
use std::f64::consts::TAU;

/// Nominal simulator as stated by its file.
#[derive(Debug, Clone)]
pub struct StatedNominal {
    /// The oscillator.
    pub nominal: Nominal,
    /// The oscillator with the effects that the simulator already has.
    pub simulator: NominalSimulator,
    /// `true` if the file mentions an input; the records must then have one.
    pub driven: bool,
    /// Inner loop of a servo joint, with the joint alone; `nominal` and `simulator` are the joint with the loop.
    pub actuator: Option<Servo>,
}

/// Joint with an inner loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Servo {
    /// The loop.
    pub actuator: Actuator,
    /// The joint without it.
    pub joint: NominalSimulator,
}

impl From<NominalSimulator> for StatedNominal {
    /// A simulator without an input.
    fn from(simulator: NominalSimulator) -> Self {
        Self { nominal: *simulator.nominal(), simulator, driven: false, actuator: None }
    }
}

impl StatedNominal {
    /// Returns the simulator driven by an input with a gain, in the unit of torque (force) per unit of the input.
    ///
    /// # Errors
    /// [`DynamicsError`] for a gain that is not finite.
    pub fn driven_by(self, input_gain: f64) -> Result<Self, DynamicsError> {
        if let Some(Servo { actuator, joint }) = &self.actuator {
            let simulator = actuator.drive(joint, input_gain)?;
            return Ok(Self { nominal: *simulator.nominal(), simulator, driven: true, ..self });
        }
        let coefficients = Coefficients { input_gain, ..self.nominal.coefficients() };
        let nominal = self.nominal.with_coefficients(coefficients)?;
        let simulator = NominalSimulator::new(nominal, self.simulator.effects().to_vec())?;
        Ok(Self { nominal, simulator, driven: true, actuator: None })
    }
}

#[derive(Deserialize)]
struct Keys {
    coordinate: Coordinate,
    inertia: Option<f64>,
    damping: Option<f64>,
    damping_ratio: Option<f64>,
    stiffness: Option<f64>,
    natural_frequency: Option<f64>,
    natural_frequency_rad_s: Option<f64>,
    period: Option<f64>,
    rest_angle: f64,
    input_gain: f64,
    sensor_resolution: Option<f64>,
}

#[derive(Deserialize)]
struct EffectKeys {
    recalibrate: bool,
}

const NUMBER: Field = Field::new("", Kind::Float { min: f64::MIN, max: f64::MAX }, Default::Absent)
    .unit("SI, or divided by the inertia");
const POSITIVE: Kind = Kind::Float { min: f64::MIN_POSITIVE, max: f64::MAX };
const NON_NEGATIVE: Kind = Kind::Float { min: 0.0, max: f64::MAX };

/// Keys of the oscillator.
pub const NOMINAL: Section<'static> = Section { name: "", fields: FIELDS };

/// Keys of each `[[effects]]` table, except its parameters.
pub const KNOWN_EFFECT: Section<'static> = Section { name: "effects", fields: EFFECT };

/// Keys that state how fast the oscillator swings; a file states exactly one.
pub const NOMINAL_SWINGS: [&str; 4] = ["stiffness", "natural_frequency", "natural_frequency_rad_s", "period"];
/// Keys that state how fast the oscillator decays; a file states exactly one.
pub const NOMINAL_DECAYS: [&str; 2] = ["damping", "damping_ratio"];

/// Tables of a simulation's configuration that do not describe the system.
const OF_RECORDS: [&str; 6] = ["simulate", "record", "start", "sensor", "input", "calibration"];

const FIELDS: &[Field] = &[
    NUMBER
        .key("coordinate")
        .kind(Kind::Choice(&["angle", "displacement"]))
        .default(Default::Text("angle"))
        .meaning("What moves: an angle in rad, or a displacement in m."),
    NUMBER.key("inertia").kind(POSITIVE).meaning(
        "Moment of inertia, or mass; 1 where everything is per unit of inertia, as it is by \
                default beside a frequency or a period.",
    ),
    NUMBER.key("damping").kind(NON_NEGATIVE).meaning("Viscous damping; damping_ratio is an alternative."),
    NUMBER
        .key("damping_ratio")
        .kind(NON_NEGATIVE)
        .unit("1")
        .meaning("Damping over the critical damping 2·√(stiffness·inertia), in place of damping."),
    NUMBER.key("stiffness").kind(NON_NEGATIVE).meaning(
        "Stiffness of the spring; 0 for a drive without one, or a pendulum that only its \
                weight holds. natural_frequency, natural_frequency_rad_s and period are \
                alternatives.",
    ),
    NUMBER
        .key("natural_frequency")
        .kind(POSITIVE)
        .unit("Hz")
        .meaning("Frequency of the undamped oscillator without effects, in place of stiffness."),
    NUMBER
        .key("natural_frequency_rad_s")
        .kind(POSITIVE)
        .unit("rad/s")
        .meaning("The same as an angular frequency, in place of stiffness."),
    NUMBER
        .key("period")
        .kind(POSITIVE)
        .unit("s")
        .meaning("Period of the undamped oscillator without effects, in place of stiffness."),
    NUMBER
        .key("rest_angle")
        .default(Default::Float(0.0))
        .unit("rad or m")
        .meaning("Where the spring is relaxed."),
    NUMBER
        .key("input_gain")
        .default(Default::Float(1.0))
        .unit("torque or force per unit of the input")
        .meaning("Torque or force that a unit of the input exerts."),
    NUMBER
        .key("sensor_resolution")
        .kind(POSITIVE)
        .unit("rad or m")
        .meaning("The sensor's stated resolution."),
];

/// Keys at the top of a configuration of `trainer simulate`.
const OF_SIMULATION: &[Field] = &[
    NUMBER.key("task").kind(Kind::Choice(&["simulate"])),
    NUMBER.key("name").kind(Kind::Text),
    NUMBER.key("seed").kind(Kind::Integer { min: 0, max: i64::MAX }),
];

const EFFECT: &[Field] = &[
    NUMBER
        .key("start")
        .kind(Kind::Floats { min: f64::MIN, max: f64::MAX, at_least: 1, at_most: dynamics::MOST_HIDDEN })
        .meaning("Its hidden states at the start of a simulated motion. A diagnosis finds its own."),
    NUMBER
        .key("id")
        .kind(Kind::Text)
        .default(Default::Required)
        .meaning("An effect that the simulator has, as `trainer list effects` names it."),
    NUMBER
        .key("recalibrate")
        .kind(Kind::Boolean)
        .default(Default::Boolean(true))
        .meaning("Whether a recalibration may move its parameters; false holds them as stated."),
    NUMBER.key("probability").kind(Kind::Float { min: 1.0, max: 1.0 }).default(Default::Float(1.0)).meaning(
        "Always 1: a nominal simulator has the effect. In a simulation, an effect occurs with \
                this probability.",
    ),
];

/// Checks a document and builds the simulator that it states.
///
/// # Errors
/// [`SettingsError`] with line and column; [`SettingsError::Refused`] for numbers that no oscillator can
/// have.
pub fn resolve_nominal(document: &Document) -> Result<StatedNominal, SettingsError> {
    let inside = document.leaves().iter().any(|leaf| leaf.key.starts_with("nominal."));
    let table = if inside { "nominal" } else { "" };
    // A repaired simulator always states its gain, so only a table for the input shows that it is driven.
    let driven = if inside {
        document.leaves().iter().any(|leaf| leaf.key.starts_with("input."))
    } else {
        document.get("input_gain").is_some()
    };
    let mut own = document.clone();
    for table in OF_RECORDS {
        own.clear_table(table);
    }
    let effects = effects(&own)?;
    let units = units(&own, table);
    let parameters: Vec<(String, Vec<Field>)> = effects
        .iter()
        .map(|(table, effect)| (format!("{table}.parameters"), parameter_fields(*effect, units)))
        .collect();
    let mut sections =
        vec![Section { name: "", fields: OF_SIMULATION }, Section { name: table, fields: NOMINAL.fields }];
    sections.extend(effects.iter().map(|(table, _)| Section { name: table, fields: EFFECT }));
    sections.extend(parameters.iter().map(|(table, fields)| Section { name: table, fields }));
    let has_loop = !inside && actuator::is_stated(&own);
    let loops = if has_loop { actuator::sections(&own) } else { Vec::new() };
    sections.extend(loops.iter().map(|(table, fields)| Section { name: table, fields }));
    let resolved = Resolved::new(&own, &sections)?;
    let refused = |problem: String| SettingsError::Refused { file: document.file().to_owned(), problem };
    let keys: Keys = resolved.section(table)?;
    let nominal = nominal(&own, table, &keys, has_loop)?;
    let known = effects.iter().zip(&parameters).map(|((table, effect), (parameters, _))| {
        let EffectKeys { recalibrate } = resolved.section(table)?;
        let keys = effect.description().parameters.iter().map(|parameter| dotted(parameters, parameter.name));
        let values: Vec<f64> = keys.map(|key| resolved.float(&key)).collect::<Result<_, _>>()?;
        let active = Active::of(*effect, &values).map_err(|error| refused(error.to_string()))?;
        Ok(KnownEffect { active, recalibrate })
    });
    let known = known.collect::<Result<_, SettingsError>>()?;
    let simulator = NominalSimulator::new(nominal, known).map_err(|error| refused(error.to_string()))?;
    if !has_loop {
        return Ok(StatedNominal { nominal, simulator, driven, actuator: None });
    }
    let actuator = actuator::actuator(&own, &resolved)?;
    let gain = actuator.gain();
    // Until the records have told an unknown gain, any number stands in for it.
    let driven =
        actuator.drive(&simulator, gain.unwrap_or(1.0)).map_err(|error| refused(error.to_string()))?;
    let servo = Servo { actuator, joint: simulator };
    let nominal = *driven.nominal();
    Ok(StatedNominal { nominal, simulator: driven, driven: gain.is_some(), actuator: Some(servo) })
}

fn dotted(table: &str, key: &str) -> String {
    if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") }
}

/// Units of the numbers, for messages: per inertia if the inertia is 1 or not given, otherwise SI.
fn units(document: &Document, table: &str) -> Units {
    let value = |key: &str| document.get(&dotted(table, key)).map(|leaf| &leaf.value);
    let coordinate = match value("coordinate").and_then(|value| value.as_str()) {
        Some("displacement") => Coordinate::Displacement,
        _ => Coordinate::Angle,
    };
    let inertia = value("inertia").map(ToString::to_string).and_then(|number| number.parse::<f64>().ok());
    if inertia.unwrap_or(1.0) == 1.0 { Units::PerInertia(coordinate) } else { Units::Si(coordinate) }
}

/// Reads the `[[effects]]` tables: the name of each table and its effect.
fn effects(document: &Document) -> Result<Vec<(String, Effect)>, SettingsError> {
    let mut found: Vec<(String, Effect)> = Vec::new();
    for table in document.tables_below("effects") {
        let table = format!("effects.{table}");
        let key = format!("{table}.id");
        let ids = || REGISTRY.iter().map(|effect| effect.id().to_owned()).collect::<Vec<_>>();
        let Some(leaf) = document.get(&key) else {
            return Err(SettingsError::Missing {
                file: document.file().to_owned(),
                key,
                meaning: "An effect that the simulator has.".to_owned(),
                expected: format!("one of {}", ids().join(", ")),
            });
        };
        let id = leaf.value.as_str().map_or_else(|| leaf.value.to_string(), str::to_owned);
        let Ok(effect) = Effect::find(&id) else {
            return Err(SettingsError::unknown_name(leaf.origin.clone(), "effect", &id, ids()));
        };
        if found.iter().any(|(_, other)| *other == effect) {
            let expected = "each effect once";
            return Err(bad_value(leaf.origin.clone(), &key, &format!("{id} again"), expected));
        }
        found.push((table, effect));
    }
    Ok(found)
}

fn parameter_fields(effect: Effect, units: Units) -> Vec<Field> {
    let field = |parameter: &dynamics::Parameter| Field {
        key: parameter.name,
        // A kind's bounds are inclusive; the effect itself refuses the endpoints of an open range.
        kind: Kind::Float { min: parameter.range.minimum, max: parameter.range.maximum },
        default: parameter.default.map_or(Default::Required, Default::Float),
        unit: parameter.quantity.unit(units),
        meaning: parameter.meaning,
        ..NUMBER
    };
    effect.description().parameters.iter().map(field).collect()
}

/// Returns the one of several keys that a file states.
///
/// # Errors
/// The file states two of the keys, or none of them.
fn one_of<const N: usize>(
    document: &Document,
    table: &str,
    keys: &[&str; N],
) -> Result<String, SettingsError> {
    const { assert!(N > 0, "there is an alternative") };
    let mut stated = keys.iter().filter(|key| document.get(&dotted(table, key)).is_some());
    let alternatives = keys.join(", ");
    let Some(first) = stated.next() else {
        let key = keys[0];
        let field = FIELDS.iter().find(|field| field.key == key);
        return Err(SettingsError::Missing {
            file: document.file().to_owned(),
            key: dotted(table, key),
            meaning: field.map_or("", |field| field.meaning).to_owned(),
            expected: format!("one of {alternatives}"),
        });
    };
    match stated.next().and_then(|second| document.get(&dotted(table, second))) {
        None => Ok((*first).to_owned()),
        Some(second) => {
            let expected = format!("one of {alternatives}, and `{first}` is stated already: take one away");
            Err(bad_value(second.origin.clone(), &second.key, &second.value.to_string(), &expected))
        }
    }
}

/// Builds the oscillator. Beside an actuator, damping and stiffness are the joint's own, and 0 where they are not
/// stated.
fn nominal(document: &Document, table: &str, keys: &Keys, has_loop: bool) -> Result<Nominal, SettingsError> {
    let none_of =
        |keys: &[&str]| has_loop && keys.iter().all(|key| document.get(&dotted(table, key)).is_none());
    let (undamped, springless) = (none_of(&NOMINAL_DECAYS), none_of(&NOMINAL_SWINGS));
    let by_damping = undamped || one_of(document, table, &NOMINAL_DECAYS)? == "damping";
    let by_stiffness = springless || one_of(document, table, &NOMINAL_SWINGS)? == "stiffness";
    let missing = |key: &str| {
        let field = FIELDS.iter().find(|field| field.key == key);
        SettingsError::Missing {
            file: document.file().to_owned(),
            key: dotted(table, key),
            meaning: field.map_or("", |field| field.meaning).to_owned(),
            expected: field.map_or_else(String::new, |field| field.kind.expected()),
        }
    };
    let given = |value: Option<f64>, key: &str, default: f64| match value {
        Some(value) => Ok(value),
        // A frequency or a period determines everything per unit of inertia.
        None if !by_stiffness => Ok(default),
        None => Err(missing(key)),
    };
    let inertia = given(keys.inertia, "inertia", 1.0)?;
    let omega = keys.natural_frequency_rad_s.or(keys.natural_frequency.map(|frequency| TAU * frequency));
    let omega = omega.or(keys.period.map(|period| TAU / period));
    let absent = |is_absent: bool| is_absent.then_some(0.0);
    let stiffness = keys
        .stiffness
        .or(absent(springless))
        .or(omega.map(|omega| inertia * omega * omega))
        .ok_or_else(|| missing("stiffness"))?;
    if !by_damping && stiffness == 0.0 {
        let leaf = document.get(&dotted(table, "damping_ratio"));
        let found = leaf.map_or_else(String::new, |leaf| leaf.value.to_string());
        let expected = "damping in its place: without a spring no damping is critical";
        let origin = leaf.map_or(Origin::Default, |leaf| leaf.origin.clone());
        return Err(bad_value(origin, &dotted(table, "damping_ratio"), &found, expected));
    }
    let critical = 2.0 * (stiffness * inertia).sqrt();
    let damping = keys
        .damping
        .or(absent(undamped))
        .or(keys.damping_ratio.map(|ratio| ratio * critical))
        .ok_or_else(|| missing("damping"))?;
    let Keys { rest_angle, input_gain, .. } = *keys;
    let made =
        Nominal::from_coefficients(Coefficients { inertia, damping, stiffness, rest_angle, input_gain })
            .map(|nominal| nominal.with_coordinate(keys.coordinate))
            .and_then(|nominal| match keys.sensor_resolution {
                Some(resolution) => nominal.with_sensor_resolution(resolution),
                None => Ok(nominal),
            });
    made.map_err(|error| SettingsError::Refused {
        file: document.file().to_owned(),
        problem: error.to_string(),
    })
}

fn bad_value(origin: Origin, key: &str, found: &str, expected: &str) -> SettingsError {
    SettingsError::BadValue {
        origin,
        key: key.to_owned(),
        found: found.to_owned(),
        expected: expected.to_owned(),
        unit: String::new(),
    }
}
