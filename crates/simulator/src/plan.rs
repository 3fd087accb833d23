//! Plan of a simulation: the systems and records to be drawn, as configured.

use crate::number::{Number, NumberKey, bad_value, declare, dotted, read, read_all};
use crate::schema::SECTIONS;
use dynamics::chain::Observed;
use dynamics::{Coordinate, Description, Effect, REGISTRY, Range, Units};
use serde::Deserialize;
use settings::{Default, Document, Field, Kind, Resolved, Section, SettingsError};
use truth::{Excitation, Sampling, Waveform};

/// Simulation as configured: priors of systems, starts and measurement chains, each key checked.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Start of the run folder's name.
    pub name: String,
    /// Root of every random draw.
    pub seed: u64,
    /// Number of systems to draw.
    pub systems: usize,
    /// Number of records of each system.
    pub records: usize,
    /// Every value in force, whether given or by default.
    pub resolved: Resolved,
    pub(crate) effects_per_system: Option<usize>,
    pub(crate) nominal: PlannedNominal,
    pub(crate) effects: Vec<PlannedEffect>,
    pub(crate) start: [Number; 2],
    pub(crate) observed: Observed,
    pub(crate) noise: Number,
    pub(crate) sampling: Sampling,
    pub(crate) excitation: Option<Excitation>,
    pub(crate) calibration: Calibration,
}

/// Nominal oscillator: inertia, damping, stiffness, rest angle, input gain.
#[derive(Debug, Clone)]
pub(crate) struct PlannedNominal {
    pub(crate) coefficients: [Number; 5],
    pub(crate) coordinate: Coordinate,
    pub(crate) sensor_resolution: Option<f64>,
}

/// Effect that a system may have.
#[derive(Debug, Clone)]
pub(crate) struct PlannedEffect {
    pub(crate) effect: Effect,
    pub(crate) probability: f64,
    pub(crate) parameters: Vec<Number>,
    /// Hidden states at the start.
    pub(crate) start: Option<Vec<f64>>,
}

/// Standard deviations of the believed coefficients about the true ones; relative, except for the rest angle.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Calibration {
    pub(crate) inertia: f64,
    pub(crate) damping: f64,
    pub(crate) stiffness: f64,
    pub(crate) rest_angle: f64,
}

#[derive(Deserialize)]
struct Top {
    name: String,
    seed: u64,
}

#[derive(Deserialize)]
struct Simulate {
    systems: usize,
    records: usize,
    effects_per_system: Option<usize>,
}

#[derive(Deserialize)]
struct RecordKeys {
    rate_hz: f64,
    seconds: f64,
    first_stamp_s: f64,
    stamp_decimals: u8,
    value_decimals: u8,
}

#[derive(Deserialize)]
struct InputKeys {
    waveform: String,
    amplitude: f64,
    frequency_hz: f64,
    end_frequency_hz: f64,
}

#[derive(Deserialize)]
struct NominalKeys {
    coordinate: Coordinate,
    sensor_resolution: Option<f64>,
}

#[derive(Deserialize)]
struct SensorKeys {
    observes: Observed,
}

#[derive(Deserialize)]
struct EffectKeys {
    probability: f64,
    start: Option<Vec<f64>>,
}

/// Keys of the nominal oscillator that are never drawn.
pub(crate) const NOMINAL_CHOICES: [Field; 2] = [
    Field::new("coordinate", Kind::Choice(&["angle", "displacement"]), Default::Text("angle"))
        .meaning("What moves: an angle in rad, or a displacement in m."),
    Field::new("sensor_resolution", Kind::Float { min: 1e-15, max: f64::MAX }, Default::Absent)
        .unit("rad or m")
        .meaning("The sensor's resolution as stated in nominal.toml; it changes no sample."),
];

pub(crate) const PROBABILITY: Field =
    Field::new("probability", Kind::Float { min: 0.0, max: 1.0 }, Default::Float(1.0))
        .meaning("Chance that a system has the effect; with simulate.effects_per_system its weight.");

/// Hidden states of an effect at the start of a simulated motion.
pub(crate) const HIDDEN_START: Field = Field::new(
    "start",
    Kind::Floats { min: f64::MIN, max: f64::MAX, at_least: 1, at_most: dynamics::MOST_HIDDEN },
    Default::Absent,
)
.meaning("Its hidden states at the start of a simulated motion; left out, it is relaxed and moves along.");

pub(crate) const EFFECT_ID: Field = Field::new("id", Kind::Text, Default::Required)
    .meaning("The effect, as `trainer list effects` names it.");

pub(crate) fn nominal_keys(units: ConfiguredUnits) -> [NumberKey; 5] {
    use dynamics::Quantity::{Damping, Inertia, Position, Stiffness};
    let key = |key, range, default, quantity: dynamics::Quantity, meaning| NumberKey {
        key,
        range,
        default,
        unit: units.of(quantity),
        meaning,
    };
    [
        key(
            "inertia",
            Range::POSITIVE,
            Default::Required,
            Inertia,
            "Moment of inertia, or mass; 1 where everything is per unit of inertia.",
        ),
        key("damping", Range::NON_NEGATIVE, Default::Required, Damping, "Viscous damping."),
        key("stiffness", Range::NON_NEGATIVE, Default::Required, Stiffness, "Stiffness of the spring."),
        key("rest_angle", Range::ANY, Default::Float(0.0), Position, "Where the spring is relaxed."),
        NumberKey {
            key: "input_gain",
            range: Range::ANY,
            default: Default::Float(1.0),
            unit: "torque or force per unit of the input",
            meaning: "Torque or force that a unit of the input exerts.",
        },
    ]
}

pub(crate) fn start_keys(units: ConfiguredUnits) -> [NumberKey; 2] {
    let key = |key, default, quantity: dynamics::Quantity, meaning| NumberKey {
        key,
        range: Range::ANY,
        default,
        unit: units.of(quantity),
        meaning,
    };
    [
        key("position", Default::Required, dynamics::Quantity::Position, "Where the motion starts."),
        key("velocity", Default::Float(0.0), dynamics::Quantity::Velocity, "Velocity at the start."),
    ]
}

pub(crate) fn noise_key(units: ConfiguredUnits) -> NumberKey {
    NumberKey {
        key: "noise",
        range: Range::NON_NEGATIVE,
        default: Default::Float(0.0),
        unit: units.of(dynamics::Quantity::Observed),
        meaning: "Standard deviation of the sensor's white noise.",
    }
}

pub(crate) fn parameter_keys(description: &Description, units: ConfiguredUnits) -> Vec<NumberKey> {
    let key = |parameter: &dynamics::Parameter| NumberKey {
        key: parameter.name,
        range: parameter.range,
        default: parameter.default.map_or(Default::Required, Default::Float),
        unit: units.of(parameter.quantity),
        meaning: parameter.meaning,
    };
    description.parameters.iter().map(key).collect()
}

impl Plan {
    /// Checks a document with its overrides applied, and creates the plan.
    ///
    /// The nominal oscillator is in `[nominal]`, or at the top as in a plain `nominal.toml`.
    ///
    /// # Errors
    /// Returns [`SettingsError`], with file, line and column or the override that caused it.
    pub fn resolve(document: &Document) -> Result<Self, SettingsError> {
        let nominal_table = if document.get("inertia").is_some() { "" } else { "nominal" };
        let units = ConfiguredUnits::of_document(document, nominal_table);
        let effects = named_effects(document)?;
        let parameters: Vec<Vec<NumberKey>> =
            effects.iter().map(|(_, effect)| parameter_keys(effect.description(), units)).collect();

        let sections = declared(document, nominal_table, units, &effects, &parameters);
        let sections: Vec<Section<'_>> =
            sections.iter().map(|(name, fields)| Section { name, fields }).collect();
        let resolved = Resolved::new(document, &sections)?;

        let top: Top = resolved.section("")?;
        let simulate: Simulate = resolved.section("simulate")?;
        let choices: NominalKeys = resolved.section(nominal_table)?;
        let sensor: SensorKeys = resolved.section("sensor")?;
        let planned = effects.into_iter().zip(&parameters).map(|((table, effect), keys)| {
            let EffectKeys { probability, start } = resolved.section(&table)?;
            let parameters = read(document, &resolved, &dotted(&table, "parameters"), keys)?;
            Ok(PlannedEffect { effect, probability, parameters, start })
        });
        let effects = planned.collect::<Result<Vec<_>, SettingsError>>()?;
        let [noise] = read_all(document, &resolved, "sensor", &[noise_key(units)])?;
        enough_effects(document, &effects, simulate.effects_per_system)?;
        Ok(Self {
            name: top.name,
            seed: top.seed,
            systems: simulate.systems,
            records: simulate.records,
            effects_per_system: simulate.effects_per_system,
            nominal: PlannedNominal {
                coefficients: read_all(document, &resolved, nominal_table, &nominal_keys(units))?,
                coordinate: choices.coordinate,
                sensor_resolution: choices.sensor_resolution,
            },
            effects,
            start: read_all(document, &resolved, "start", &start_keys(units))?,
            observed: sensor.observes,
            noise,
            sampling: sampling(&resolved)?,
            excitation: excitation(&resolved)?,
            calibration: resolved.section("calibration")?,
            resolved,
        })
    }

    /// Returns the effects that a system may have.
    pub fn effects(&self) -> impl Iterator<Item = Effect> + '_ {
        self.effects.iter().map(|planned| planned.effect)
    }

    /// Returns sampling and notation of every record.
    #[must_use]
    pub fn sampling(&self) -> Sampling {
        self.sampling
    }
}

/// Units of the numbers, for messages and comments: per inertia if the inertia is given as exactly 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConfiguredUnits {
    units: Units,
    observed: Observed,
}

impl ConfiguredUnits {
    pub(crate) fn of_document(document: &Document, nominal_table: &str) -> Self {
        let value = |key: &str| document.get(key).map(|leaf| &leaf.value);
        let coordinate = match value(&dotted(nominal_table, "coordinate")).and_then(|value| value.as_str()) {
            Some("displacement") => Coordinate::Displacement,
            _ => Coordinate::Angle,
        };
        let inertia = value(&dotted(nominal_table, "inertia")).map(ToString::to_string);
        let units = match inertia.and_then(|number| number.parse::<f64>().ok()) {
            Some(1.0) => Units::PerInertia(coordinate),
            _ => Units::Si(coordinate),
        };
        let observed = match value("sensor.observes").and_then(|value| value.as_str()) {
            Some("velocity") => Observed::Velocity,
            Some("acceleration") => Observed::Acceleration,
            _ => Observed::Position,
        };
        Self { units, observed }
    }

    fn of(self, quantity: dynamics::Quantity) -> &'static str {
        quantity.unit_seen(self.units, self.observed)
    }
}

/// Returns every section with its keys, including numbers that may be drawn and parameters of effects.
fn declared(
    document: &Document,
    nominal_table: &str,
    units: ConfiguredUnits,
    effects: &[(String, Effect)],
    parameters: &[Vec<NumberKey>],
) -> Vec<(String, Vec<Field>)> {
    let mut sections: Vec<(String, Vec<Field>)> =
        SECTIONS.iter().map(|section| (section.name.to_owned(), section.fields.to_vec())).collect();
    let mut add = |table: &str, choices: &[Field], keys: &[NumberKey]| {
        let (fields, priors) = declare(document, table, keys);
        let all = choices.iter().copied().chain(fields);
        match sections.iter_mut().find(|(name, _)| name == table) {
            Some((_, known)) => known.extend(all),
            None => sections.push((table.to_owned(), all.collect())),
        }
        sections.extend(priors);
    };
    add(nominal_table, &NOMINAL_CHOICES, &nominal_keys(units));
    add("start", &[], &start_keys(units));
    add("sensor", &[], &[noise_key(units)]);
    for ((table, _), keys) in effects.iter().zip(parameters) {
        add(table, &[EFFECT_ID, PROBABILITY, HIDDEN_START], &[]);
        add(&dotted(table, "parameters"), &[], keys);
    }
    sections
}

/// Rejects a number of effects per system that exceeds the list of effects.
fn enough_effects(
    document: &Document,
    effects: &[PlannedEffect],
    wanted: Option<usize>,
) -> Result<(), SettingsError> {
    let possible = effects.iter().filter(|planned| planned.probability > 0.0).count();
    let Some(wanted) = wanted.filter(|&wanted| wanted > possible) else { return Ok(()) };
    let key = "simulate.effects_per_system";
    let origin = document.get(key).map_or(settings::Origin::Default, |leaf| leaf.origin.clone());
    let expected = format!("at most {possible}, the effects listed with a probability above 0");
    Err(bad_value(origin, key, wanted.to_string(), expected, ""))
}

/// Returns the tables `[[effects]]`, each with the effect that it names.
fn named_effects(document: &Document) -> Result<Vec<(String, Effect)>, SettingsError> {
    let mut found: Vec<(String, Effect)> = Vec::new();
    for table in document.tables_below("effects") {
        let table = dotted("effects", &table);
        let key = dotted(&table, "id");
        let ids = || REGISTRY.iter().map(|effect| effect.id().to_owned()).collect::<Vec<_>>();
        let Some(leaf) = document.get(&key) else {
            return Err(SettingsError::Missing {
                file: document.file().to_owned(),
                key,
                meaning: EFFECT_ID.meaning.to_owned(),
                expected: format!("one of {}", ids().join(", ")),
            });
        };
        let id = leaf.value.as_str().map_or_else(|| leaf.value.to_string(), str::to_owned);
        let Ok(effect) = Effect::find(&id) else {
            return Err(SettingsError::unknown_name(leaf.origin.clone(), "effect", &id, ids()));
        };
        if found.iter().any(|(_, other)| *other == effect) {
            let expected = "each effect once".to_owned();
            return Err(bad_value(leaf.origin.clone(), &key, format!("{} again", leaf.value), expected, ""));
        }
        found.push((table, effect));
    }
    Ok(found)
}

fn sampling(resolved: &Resolved) -> Result<Sampling, SettingsError> {
    let keys: RecordKeys = resolved.section("record")?;
    Ok(Sampling {
        rate_hz: keys.rate_hz,
        // `generate` rejects too many or too few samples.
        samples: (keys.rate_hz * keys.seconds).round().min(1e15) as usize,
        first_stamp_s: keys.first_stamp_s,
        stamp_decimals: keys.stamp_decimals,
        value_decimals: keys.value_decimals,
    })
}

fn excitation(resolved: &Resolved) -> Result<Option<Excitation>, SettingsError> {
    let keys: InputKeys = resolved.section("input")?;
    let waveform = match keys.waveform.as_str() {
        "sine" => Waveform::Sine,
        "chirp" => Waveform::Chirp,
        "square" => Waveform::Square,
        _ => return Ok(None),
    };
    let end = if waveform == Waveform::Chirp { keys.end_frequency_hz } else { keys.frequency_hz };
    Ok(Some(Excitation {
        waveform,
        amplitude: keys.amplitude,
        frequency_hz: keys.frequency_hz,
        end_frequency_hz: end,
    }))
}
