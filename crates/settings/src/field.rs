//! Declaration of a configuration key.

use toml::Value;

/// Kind of a value, with its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// `true` or `false`.
    Boolean,
    /// A whole number within inclusive bounds.
    Integer {
        /// Smallest value allowed.
        min: i64,
        /// Largest value allowed.
        max: i64,
    },
    /// A finite number within inclusive bounds. Whole numbers are accepted as well.
    Float {
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
    },
    /// Free text.
    Text,
    /// Name of a file or folder. A relative one starts from the folder of the configuration that contains it,
    /// or from the working directory if given on the command line.
    Path,
    /// One of a fixed set of words.
    Choice(&'static [&'static str]),
    /// A list of texts.
    Texts {
        /// Fewest entries allowed.
        at_least: usize,
        /// Most entries allowed.
        at_most: usize,
    },
    /// A list of whole numbers within inclusive bounds.
    Integers {
        /// Smallest value allowed for an entry.
        min: i64,
        /// Largest value allowed for an entry.
        max: i64,
        /// Fewest entries allowed.
        at_least: usize,
        /// Most entries allowed.
        at_most: usize,
    },
    /// A list of finite numbers within inclusive bounds.
    Floats {
        /// Smallest value allowed for an entry.
        min: f64,
        /// Largest value allowed for an entry.
        max: f64,
        /// Fewest entries allowed.
        at_least: usize,
        /// Most entries allowed.
        at_most: usize,
    },
}

/// Default of a key that is absent from a configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Default {
    /// No default: the key is required.
    Required,
    /// No value: the key is optional.
    Absent,
    /// A Boolean.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Float(f64),
    /// Text.
    Text(&'static str),
    /// A list of texts.
    Texts(&'static [&'static str]),
    /// A list of whole numbers.
    Integers(&'static [i64]),
    /// A list of numbers.
    Floats(&'static [f64]),
}

impl Default {
    /// Returns the default as a TOML value; `None` for [`Default::Required`] and [`Default::Absent`].
    #[must_use]
    pub fn value(&self) -> Option<Value> {
        match *self {
            Self::Required | Self::Absent => None,
            Self::Boolean(value) => Some(Value::Boolean(value)),
            Self::Integer(value) => Some(Value::Integer(value)),
            Self::Float(value) => Some(Value::Float(value)),
            Self::Text(value) => Some(Value::String(value.to_owned())),
            Self::Texts(values) => {
                Some(Value::Array(values.iter().map(|&value| Value::String(value.to_owned())).collect()))
            }
            Self::Integers(values) => {
                Some(Value::Array(values.iter().map(|&value| Value::Integer(value)).collect()))
            }
            Self::Floats(values) => {
                Some(Value::Array(values.iter().map(|&value| Value::Float(value)).collect()))
            }
        }
    }
}

/// One key of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Name of the key within its section.
    pub key: &'static str,
    /// Kind of the value.
    pub kind: Kind,
    /// Default of the key if it is absent from a configuration.
    pub default: Default,
    /// Unit of the value; empty if it has none.
    pub unit: &'static str,
    /// Meaning of the key, in one sentence.
    pub meaning: &'static str,
    /// Source of the default: a paper, a standard or a measurement.
    pub source: &'static str,
}

impl Field {
    /// Creates a key without unit, meaning and source of the default.
    #[must_use]
    pub const fn new(key: &'static str, kind: Kind, default: Default) -> Self {
        Self { key, kind, default, unit: "", meaning: "", source: "" }
    }

    /// Returns the field under another key.
    #[must_use]
    pub const fn key(self, key: &'static str) -> Self {
        Self { key, ..self }
    }

    /// Returns the field with another kind.
    #[must_use]
    pub const fn kind(self, kind: Kind) -> Self {
        Self { kind, ..self }
    }

    /// Returns the field with another default.
    #[must_use]
    pub const fn default(self, default: Default) -> Self {
        Self { default, ..self }
    }

    /// Returns the field with this unit.
    #[must_use]
    pub const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Returns the field with this meaning, a sentence.
    #[must_use]
    pub const fn meaning(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }

    /// Returns the field with this source of its default.
    #[must_use]
    pub const fn source(self, source: &'static str) -> Self {
        Self { source, ..self }
    }
}

/// A table of a configuration and the keys it may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section<'a> {
    /// Dotted name of the table; empty for the top-level keys. A configuration may name tables of its own, as
    /// in `[problem.NAME]`: [`crate::Document::tables_below`] finds them.
    pub name: &'a str,
    /// Keys of the table.
    pub fields: &'a [Field],
}

impl Kind {
    /// Converts a value to the declared kind: whole numbers become floats where floats are declared.
    ///
    /// # Errors
    /// A sentence that says what was expected, for instance `a number from 0 to 1`.
    pub fn admit(&self, value: &Value) -> Result<Value, String> {
        let admitted = match (self, value) {
            (Self::Boolean, Value::Boolean(_)) | (Self::Text | Self::Path, Value::String(_)) => {
                Some(value.clone())
            }
            (&Self::Integer { min, max }, &Value::Integer(number)) => {
                (min..=max).contains(&number).then(|| value.clone())
            }
            (&Self::Float { min, max }, value) => float_within(value, min, max),
            (Self::Choice(words), Value::String(text)) => {
                words.contains(&text.as_str()).then(|| value.clone())
            }
            (&Self::Texts { at_least, at_most }, Value::Array(entries)) => {
                let fits = (at_least..=at_most).contains(&entries.len())
                    && entries.iter().all(|entry| matches!(entry, Value::String(_)));
                fits.then(|| value.clone())
            }
            // On a command line `a,b` is easier to write than `["a","b"]`.
            (Self::Texts { .. }, Value::String(text)) => {
                let parts = text.split(',').map(|part| Value::String(part.trim().to_owned()));
                return self.admit(&Value::Array(parts.collect()));
            }
            (&Self::Integers { min, max, at_least, at_most }, Value::Array(entries)) => {
                let fits = (at_least..=at_most).contains(&entries.len())
                    && entries
                        .iter()
                        .all(|entry| matches!(entry, Value::Integer(n) if (min..=max).contains(n)));
                fits.then(|| value.clone())
            }
            (&Self::Floats { min, max, at_least, at_most }, Value::Array(entries)) => (at_least..=at_most)
                .contains(&entries.len())
                .then(|| entries.iter().map(|entry| float_within(entry, min, max)).collect())
                .flatten()
                .map(Value::Array),
            _ => None,
        };
        admitted.ok_or_else(|| self.expected())
    }

    /// Returns a description of the values that the kind allows.
    #[must_use]
    pub fn expected(&self) -> String {
        match self {
            Self::Boolean => "true or false".to_owned(),
            Self::Integer { min, max } => format!("a whole number {}", range(min, max)),
            Self::Float { min, max } => format!("a finite number {}", range(min, max)),
            Self::Text | Self::Path => "text in quotes".to_owned(),
            Self::Choice(words) => {
                let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                format!("one of {}", quoted.join(", "))
            }
            Self::Texts { at_least, at_most } => {
                format!("a list of {at_least} to {at_most} texts in quotes")
            }
            Self::Integers { min, max, at_least, at_most } => {
                format!("a list of {at_least} to {at_most} whole numbers, each {}", range(min, max))
            }
            Self::Floats { min, max, at_least, at_most } => {
                format!("a list of {at_least} to {at_most} finite numbers, each {}", range(min, max))
            }
        }
    }
}

fn float_within(value: &Value, min: f64, max: f64) -> Option<Value> {
    // A whole number beyond 2^53 would change when converted to a float; no key needs such numbers.
    const LARGEST_EXACT: u64 = 1 << 53;
    let number = match *value {
        Value::Float(number) => number,
        Value::Integer(number) if number.unsigned_abs() <= LARGEST_EXACT => number as f64,
        _ => return None,
    };
    (number.is_finite() && (min..=max).contains(&number)).then_some(Value::Float(number))
}

/// Returns `from MIN to MAX` without the bounds that exclude nothing, or `above 0` if every positive number
/// is allowed.
fn range<T: std::fmt::Display + Bound>(min: &T, max: &T) -> String {
    match (min.is_open(), max.is_open()) {
        (true, true) => "of any size".to_owned(),
        (true, false) => format!("up to {max}"),
        (false, true) if min.is_least_positive() => "above 0".to_owned(),
        (false, false) if min.is_least_positive() => format!("above 0, up to {max}"),
        (false, true) => format!("from {min} up"),
        (false, false) => format!("from {min} to {max}"),
    }
}

trait Bound {
    /// Returns `true` if this lower bound allows every positive normal number and nothing else; never for
    /// whole numbers.
    fn is_least_positive(&self) -> bool;
    fn is_open(&self) -> bool;
}

impl Bound for i64 {
    fn is_least_positive(&self) -> bool {
        false
    }

    fn is_open(&self) -> bool {
        matches!(*self, i64::MIN | i64::MAX)
    }
}

impl Bound for f64 {
    fn is_least_positive(&self) -> bool {
        *self > 0.0 && *self <= f64::MIN_POSITIVE
    }

    fn is_open(&self) -> bool {
        self.abs() == f64::MAX || self.is_infinite()
    }
}

#[cfg(test)]
mod tests {
    use super::{Kind, Value};

    /// The magnitude of `i64::MIN` is no `i64`, and no float represents the neighbors of these numbers.
    #[test]
    fn whole_numbers_that_a_float_would_change_are_no_floats() {
        let kind = Kind::Float { min: f64::MIN, max: f64::MAX };
        for number in [i64::MIN, i64::MIN + 1, i64::MAX, (1 << 53) + 1, -(1 << 53) - 1] {
            assert_eq!(kind.admit(&Value::Integer(number)), Err(kind.expected()), "{number}");
        }
        for number in [1 << 53, -(1 << 53)] {
            assert_eq!(kind.admit(&Value::Integer(number)), Ok(Value::Float(number as f64)));
        }
    }
}
