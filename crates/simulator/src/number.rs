//! Number of a configuration that may be drawn: `torque = 7e-5`, or `torque = { from = 1e-5, to = 1e-4 }`.

use crate::prior::Prior;
use crate::schema::PRIOR;
use dynamics::Range;
use seed::Seed;
use serde::Deserialize;
use settings::{Default, Document, Field, Kind, Origin, Resolved, SettingsError};

/// Declaration of a number that may be drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NumberKey {
    pub(crate) key: &'static str,
    pub(crate) range: Range,
    pub(crate) default: Default,
    pub(crate) unit: &'static str,
    pub(crate) meaning: &'static str,
}

/// Number that may be drawn, as configured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Number {
    key: &'static str,
    range: Range,
    prior: Prior,
}

#[derive(Deserialize)]
struct PriorKeys {
    from: Option<f64>,
    to: Option<f64>,
    scale: Option<String>,
    mean: Option<f64>,
    deviation: Option<f64>,
}

impl Number {
    /// Draws a value from the number's own branch of the seed tree.
    pub(crate) fn draw(&self, seed: &Seed) -> f64 {
        self.prior.draw(&self.range, &mut seed.child(self.key).generator())
    }
}

/// Returns the dotted name of a key in a table; the table at the top has no name.
pub(crate) fn dotted(table: &str, key: &str) -> String {
    if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") }
}

fn is_drawn(document: &Document, table: &str, key: &NumberKey) -> bool {
    document.tables_below(table).iter().any(|name| name == key.key)
}

/// Returns the fields of those numbers in a table that are values or absent, and the sections of those that
/// are drawn.
pub(crate) fn declare(
    document: &Document,
    table: &str,
    keys: &[NumberKey],
) -> (Vec<Field>, Vec<(String, Vec<Field>)>) {
    let mut fields = Vec::new();
    let mut sections = Vec::new();
    for key in keys {
        if is_drawn(document, table, key) {
            let unit = |field: &Field| if field.key == "scale" { "" } else { key.unit };
            let prior = PRIOR.iter().map(|field| field.unit(unit(field)));
            sections.push((dotted(table, key.key), prior.collect()));
        } else {
            // The bounds of a `Kind` are inclusive.
            let min = match key.range {
                Range { minimum: 0.0, closed: false, .. } => f64::MIN_POSITIVE,
                Range { minimum, .. } => minimum,
            };
            fields.push(
                Field::new(key.key, Kind::Float { min, max: key.range.maximum }, key.default)
                    .unit(key.unit)
                    .meaning(key.meaning),
            );
        }
    }
    (fields, sections)
}

/// Does the same as [`read`] for a table with a fixed number of keys.
pub(crate) fn read_all<const N: usize>(
    document: &Document,
    resolved: &Resolved,
    table: &str,
    keys: &[NumberKey; N],
) -> Result<[Number; N], SettingsError> {
    read(document, resolved, table, keys)?.try_into().map_err(|read: Vec<Number>| {
        let problem = format!("{} numbers in place of {N}", read.len());
        SettingsError::Declaration { section: table.to_owned(), problem }
    })
}

/// Reads a table's numbers, in the order of their declarations.
pub(crate) fn read(
    document: &Document,
    resolved: &Resolved,
    table: &str,
    keys: &[NumberKey],
) -> Result<Vec<Number>, SettingsError> {
    keys.iter()
        .map(|key| {
            let prior = if is_drawn(document, table, key) {
                read_prior(document, resolved, table, key)?
            } else {
                Prior::Fixed(read_value(document, resolved, table, key)?)
            };
            Ok(Number { key: key.key, range: key.range, prior })
        })
        .collect()
}

fn read_value(
    document: &Document,
    resolved: &Resolved,
    table: &str,
    key: &NumberKey,
) -> Result<f64, SettingsError> {
    let name = dotted(table, key.key);
    within(document, &name, key, resolved.float(&name)?)
}

/// Rejects an end that an open range excludes, which the declaration of a key cannot express.
fn within(document: &Document, name: &str, key: &NumberKey, value: f64) -> Result<f64, SettingsError> {
    if key.range.contains(value) {
        return Ok(value);
    }
    let expected = key.range.to_string();
    Err(bad_value(origin(document, name), name, value.to_string(), expected, key.unit))
}

fn read_prior(
    document: &Document,
    resolved: &Resolved,
    table: &str,
    key: &NumberKey,
) -> Result<Prior, SettingsError> {
    let name = dotted(table, key.key);
    let given: PriorKeys = resolved.section(&name)?;
    let inside = |end: &str, value: f64| within(document, &dotted(&name, end), key, value);
    let scale = given.scale.as_deref().unwrap_or("linear");
    match (given.from, given.to, given.mean, given.deviation) {
        (Some(from), Some(to), None, None) if from <= to && (scale == "linear" || from > 0.0) => {
            inside("from", from)?;
            inside("to", to)?;
            Ok(if scale == "log" { Prior::LogUniform { from, to } } else { Prior::Uniform { from, to } })
        }
        (None, None, Some(mean), Some(deviation)) if given.scale.is_none() => {
            inside("mean", mean)?;
            let width = key.range.maximum - key.range.minimum;
            if deviation > width {
                let name = dotted(&name, "deviation");
                let expected = format!("at most {width}, the width of the range");
                return Err(bad_value(
                    origin(document, &name),
                    &name,
                    deviation.to_string(),
                    expected,
                    key.unit,
                ));
            }
            Ok(Prior::Normal { mean, deviation })
        }
        _ => {
            let prefix = format!("{name}.");
            let leaves = document.leaves().iter().filter(|leaf| leaf.key.starts_with(&prefix));
            let parts: Vec<String> = leaves
                .map(|leaf| format!("{} = {}", leaf.key.trim_start_matches(&prefix), leaf.value))
                .collect();
            let expected = "a number, or a prior: from and to, in order, and with scale = \"log\" above 0; \
                            or mean and deviation";
            let found = format!("{{ {} }}", parts.join(", "));
            Err(bad_value(origin(document, &prefix), &name, found, expected.to_owned(), key.unit))
        }
    }
}

/// Returns the origin of a key, or of the first one that starts with a prefix.
fn origin(document: &Document, prefix: &str) -> Origin {
    let found = document.leaves().iter().find(|leaf| leaf.key.starts_with(prefix));
    found.map_or(Origin::Default, |leaf| leaf.origin.clone())
}

/// Returns the error for a value that is rejected here and not by its declaration.
pub(crate) fn bad_value(
    origin: Origin,
    key: &str,
    found: String,
    expected: String,
    unit: &str,
) -> SettingsError {
    let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    SettingsError::BadValue { origin, key: key.to_owned(), found, expected, unit }
}
