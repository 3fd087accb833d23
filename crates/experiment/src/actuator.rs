//! `[actuator]` of a `nominal.toml`: the inner loop of a joint.

use dynamics::{Actuator, Command, Hold, Stated};
use settings::{Default, Document, Field, Kind, Resolved, Section, SettingsError};

/// Table of the inner loop.
pub(crate) const TABLE: &str = "actuator";

const NON_NEGATIVE: Kind = Kind::Float { min: 0.0, max: f64::MAX };
const ABOVE_ZERO: Kind = Kind::Float { min: f64::MIN_POSITIVE, max: f64::MAX };

/// Keys of `[actuator]`.
pub const ACTUATOR: Section<'static> = Section { name: TABLE, fields: FIELDS };

/// Keys whose numbers may be known, known within a tolerance, or unknown.
pub const ACTUATOR_STATED: [&str; 3] = ["proportional", "derivative", "delay"];

const FIELDS: &[Field] = &[
    Field::new("kind", Kind::Choice(&["position", "velocity", "torque"]), Default::Required)
        .meaning("Quantity that is commanded."),
    Field::new("proportional", ABOVE_ZERO, Default::Absent)
        .unit("N m/rad")
        .meaning("Gain of the position error: a number, { value = …, tolerance = … }, or \"unknown\"."),
    Field::new("derivative", NON_NEGATIVE, Default::Absent)
        .unit("N m s/rad")
        .meaning("Gain of the velocity, stated like proportional."),
    Field::new("derivative_on", Kind::Choice(&["measurement", "error"]), Default::Text("measurement"))
        .meaning(
            "What the loop differentiates: the measured motion alone, or its error and so the \
                command.",
        ),
    Field::new("integral", Kind::Float { min: 0.0, max: 0.0 }, Default::Float(0.0))
        .unit("N m/(rad s)")
        .meaning("Gain of the integrated error; a loop with one cannot be simulated yet."),
    Field::new("delay", NON_NEGATIVE, Default::Absent)
        .unit("s")
        .meaning("Time from a command to its action, stated like proportional; 0 by default."),
    Field::new("hold", Kind::Choice(&["zero-order", "linear"]), Default::Absent)
        .meaning("Command between its samples; without it the records decide."),
    Field::new("torque_limit", ABOVE_ZERO, Default::Absent)
        .unit("N m")
        .meaning("Largest torque of the drive."),
    Field::new("no_load_speed", ABOVE_ZERO, Default::Absent)
        .unit("rad/s")
        .meaning("Speed at which the largest torque has fallen to 0."),
    Field::new("dead_band", ABOVE_ZERO, Default::Absent)
        .unit("rad")
        .meaning("Half the width of the position errors that cause no torque."),
    Field::new("gear_ratio", ABOVE_ZERO, Default::Float(1.0))
        .unit("1")
        .meaning("Turns of the rotor for one of the joint."),
    Field::new("rotor_inertia", NON_NEGATIVE, Default::Float(0.0))
        .unit("kg m^2")
        .meaning("Inertia of the rotor about its own axis."),
];

const TOLERANT: &[Field] = &[
    Field::new("value", NON_NEGATIVE, Default::Required).meaning("Most probable value."),
    Field::new("tolerance", ABOVE_ZERO, Default::Required).meaning("Half the width of its 95 % interval."),
];

const UNKNOWN: Kind = Kind::Choice(&["unknown"]);

/// Form in which a document states a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Absent,
    Number,
    Word,
    Tolerant,
}

fn form(document: &Document, key: &str) -> Form {
    let dotted = format!("{TABLE}.{key}");
    match document.get(&dotted) {
        Some(leaf) if leaf.value.is_str() => Form::Word,
        Some(_) => Form::Number,
        None if document.leaves().iter().any(|leaf| leaf.key.starts_with(&format!("{dotted}."))) => {
            Form::Tolerant
        }
        None => Form::Absent,
    }
}

/// Returns `true` if a document has the table.
pub(crate) fn is_stated(document: &Document) -> bool {
    document.leaves().iter().any(|leaf| leaf.key.starts_with("actuator."))
}

/// Returns the tables and keys that a document with an actuator may hold.
pub(crate) fn sections(document: &Document) -> Vec<(String, Vec<Field>)> {
    let own = FIELDS
        .iter()
        .filter(|field| form(document, field.key) != Form::Tolerant || !ACTUATOR_STATED.contains(&field.key));
    let own = own.map(|field| {
        let is_word = ACTUATOR_STATED.contains(&field.key) && form(document, field.key) == Form::Word;
        if is_word { field.kind(UNKNOWN) } else { *field }
    });
    let tolerant = ACTUATOR_STATED.into_iter().filter(|key| form(document, key) == Form::Tolerant);
    let tolerant = tolerant.map(|key| (format!("{TABLE}.{key}"), TOLERANT.to_vec()));
    std::iter::once((TABLE.to_owned(), own.collect())).chain(tolerant).collect()
}

fn command(kind: Option<&str>) -> Command {
    match kind {
        Some("velocity") => Command::Velocity,
        Some("torque") => Command::Torque,
        _ => Command::Position,
    }
}

/// Reads the table.
pub(crate) fn actuator(document: &Document, resolved: &Resolved) -> Result<Actuator, SettingsError> {
    let text = |key: &str| -> Result<Option<String>, SettingsError> {
        let setting = resolved.setting(&format!("{TABLE}.{key}"))?;
        Ok(setting.value.as_ref().and_then(|value| value.as_str()).map(str::to_owned))
    };
    let number = |key: &str| resolved.float(&format!("{TABLE}.{key}"));
    let stated = |key: &str| match form(document, key) {
        Form::Absent => Ok(None),
        Form::Number => number(key).map(|value| Some(Stated::Known(value))),
        Form::Word => Ok(Some(Stated::Unknown)),
        Form::Tolerant => Ok(Some(Stated::About {
            value: number(&format!("{key}.value"))?,
            tolerance: number(&format!("{key}.tolerance"))?,
        })),
    };
    let optional = |key: &str| match form(document, key) {
        Form::Absent => Ok(None),
        _ => number(key).map(Some),
    };
    let command = command(text("kind")?.as_deref());
    let needs = |key: &str, needed: bool, for_what: &str| match (stated(key)?, needed) {
        (Some(stated), true) => Ok(stated),
        (None, false) => Ok(Stated::Known(0.0)),
        (None, true) => Err(SettingsError::Missing {
            file: document.file().to_owned(),
            key: format!("{TABLE}.{key}"),
            meaning: FIELDS
                .iter()
                .find(|field| field.key == key)
                .map_or("", |field| field.meaning)
                .to_owned(),
            expected: "a number, { value = …, tolerance = … }, or \"unknown\"".to_owned(),
        }),
        (Some(_), false) => Err(SettingsError::Refused {
            file: document.file().to_owned(),
            problem: format!("`{TABLE}.{key}` stands beside {for_what}; leave it out"),
        }),
    };
    let kind = format!("`kind = \"{}\"`", command.name());
    Ok(Actuator {
        command,
        proportional: needs(
            "proportional",
            command == Command::Position,
            &format!("{kind}, which has no position error"),
        )?,
        derivative: needs("derivative", command != Command::Torque, &format!("{kind}, which has no loop"))?,
        on_error: text("derivative_on")?.as_deref() == Some("error"),
        // A command without a stated delay acts at once.
        delay: stated("delay")?.unwrap_or(Stated::Known(0.0)),
        hold: text("hold")?.map(|hold| if hold == "linear" { Hold::Linear } else { Hold::Zero }),
        torque_limit: optional("torque_limit")?,
        no_load_speed: optional("no_load_speed")?,
        dead_band: optional("dead_band")?,
        reflected_inertia: number("rotor_inertia")? * number("gear_ratio")?.powi(2),
    })
}
