//! Configuration with every key known, typed and in range, and defaults filled in.

use crate::base::simplified;
use crate::document::{Document, FROM_WORKING_DIRECTORY, PATHS};
use crate::error::SettingsError;
use crate::field::{Field, Kind, Section};
use crate::origin::Origin;
use serde::de::DeserializeOwned;
use std::path::Path;
use toml::{Table, Value};

/// Value of one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Dotted name of the section; empty for top-level keys.
    pub section: String,
    /// Declaration of the key.
    pub field: Field,
    /// Value in use; `None` for an optional key that was not given.
    pub value: Option<Value>,
    /// Origin of the value.
    pub origin: Origin,
}

/// Every declared key with its value in use, in the order of declaration.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    settings: Vec<Setting>,
}

impl Resolved {
    /// Checks a document against the declared sections and fills in the defaults.
    ///
    /// # Errors
    /// [`SettingsError::UnknownKey`] and [`SettingsError::BadValue`], the first one in the order of the
    /// document, or else [`SettingsError::Missing`], the first one in the order of declaration.
    pub fn new(document: &Document, sections: &[Section<'_>]) -> Result<Self, SettingsError> {
        let mut settings: Vec<Setting> = sections
            .iter()
            .flat_map(|section| section.fields.iter().map(move |&field| (section.name, field)))
            .map(|(section, field)| Setting {
                section: section.to_owned(),
                field,
                value: field.default.value(),
                origin: Origin::Default,
            })
            .collect();
        for leaf in document.leaves() {
            let Some(setting) = settings.iter_mut().find(|setting| setting.key() == leaf.key) else {
                return Err(unknown_key(&leaf.key, leaf.origin.clone(), &settings));
            };
            let value = setting.field.kind.admit(&leaf.value).map_err(|expected| {
                let unit = setting.field.unit;
                SettingsError::BadValue {
                    origin: leaf.origin.clone(),
                    key: leaf.key.clone(),
                    found: leaf.value.to_string(),
                    expected,
                    unit: if unit.is_empty() { String::new() } else { format!(" ({unit})") },
                }
            })?;
            setting.value =
                Some(if setting.field.kind == Kind::Path { placed(value, &leaf.folder) } else { value });
            setting.origin = leaf.origin.clone();
        }
        let missing = settings
            .iter()
            .find(|setting| setting.value.is_none() && setting.field.default == crate::Default::Required);
        match missing {
            Some(setting) => Err(SettingsError::Missing {
                file: document.file().to_owned(),
                key: setting.key(),
                meaning: setting.field.meaning.to_owned(),
                expected: setting.field.kind.expected(),
            }),
            None => Ok(Self { settings }),
        }
    }

    /// Returns every setting, in the order of declaration.
    #[must_use]
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    /// Returns the setting with a dotted key.
    ///
    /// # Errors
    /// [`SettingsError::UnknownKey`] with the most similar known key, if one is close.
    pub fn setting(&self, key: &str) -> Result<&Setting, SettingsError> {
        self.settings
            .iter()
            .find(|setting| setting.key() == key)
            .ok_or_else(|| unknown_key(key, Origin::Override(key.to_owned()), &self.settings))
    }

    /// Returns the number with a dotted key.
    ///
    /// # Errors
    /// [`SettingsError::UnknownKey`] with the most similar known key, if one is close;
    /// [`SettingsError::Declaration`] if the key has no value or its value is not a float. Neither happens
    /// for a key declared as [`Kind::Float`](crate::Kind::Float) that is required or has a default.
    pub fn float(&self, key: &str) -> Result<f64, SettingsError> {
        let setting = self.setting(key)?;
        let number = setting.value.as_ref().and_then(Value::as_float);
        number.ok_or_else(|| SettingsError::Declaration {
            section: setting.section.clone(),
            problem: format!("`{key}` is no number"),
        })
    }

    /// Reads one section into a struct.
    ///
    /// # Errors
    /// [`SettingsError::Declaration`] if the struct and the declaration do not match: a fault of the program,
    /// which the declaring crate's tests find.
    pub fn section<T: DeserializeOwned>(&self, name: &str) -> Result<T, SettingsError> {
        let table: Table = self
            .settings
            .iter()
            .filter(|setting| setting.section == name)
            .filter_map(|setting| Some((setting.field.key.to_owned(), setting.value.clone()?)))
            .collect();
        table.try_into().map_err(|error: toml::de::Error| SettingsError::Declaration {
            section: name.to_owned(),
            problem: error.message().to_owned(),
        })
    }

    /// Returns every value in use as a line `key = value` with its dotted key, sorted by key. Equal texts
    /// mean equal configurations, wherever their values were written.
    #[must_use]
    pub fn values_text(&self) -> String {
        let line = |setting: &Setting| Some(format!("{} = {}\n", setting.key(), setting.value.as_ref()?));
        let mut lines: Vec<String> = self.settings.iter().filter_map(line).collect();
        lines.sort_unstable();
        lines.concat()
    }

    /// Returns the configuration as TOML: every value in use, with unit and origin as comments.
    ///
    /// The text resolves to the same values again. Relative paths start from the working directory; if there
    /// are any, the text sets `paths` accordingly.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        if self.settings.iter().any(is_relative_path) {
            text.push_str(&format!("{PATHS} = \"{FROM_WORKING_DIRECTORY}\"\n"));
        }
        let mut current = "";
        for setting in &self.settings {
            if setting.section != current {
                current = &setting.section;
                text.push_str(&format!("\n[{current}]\n"));
            }
            let Some(value) = &setting.value else {
                continue;
            };
            let mut remarks = Vec::new();
            if !setting.field.unit.is_empty() {
                remarks.push(setting.field.unit.to_owned());
            }
            if setting.origin != Origin::Default {
                remarks.push(format!("from {}", setting.origin));
            }
            let line = format!("{} = {value}", setting.field.key);
            if remarks.is_empty() {
                text.push_str(&format!("{line}\n"));
            } else {
                // An override may contain a line break; a comment may not.
                let remark = remarks.join("; ").replace(char::is_control, " ");
                text.push_str(&format!("{line:<36} # {remark}\n"));
            }
        }
        text
    }
}

impl Setting {
    /// Returns the dotted key.
    #[must_use]
    pub fn key(&self) -> String {
        if self.section.is_empty() {
            self.field.key.to_owned()
        } else {
            format!("{}.{}", self.section, self.field.key)
        }
    }
}

/// Returns a path relative to the working directory.
fn placed(value: Value, folder: &str) -> Value {
    match value.as_str() {
        Some(path) if !folder.is_empty() && Path::new(path).is_relative() => {
            Value::String(simplified(&Path::new(folder).join(path)).display().to_string())
        }
        _ => value,
    }
}

fn is_relative_path(setting: &Setting) -> bool {
    let path = setting.value.as_ref().and_then(Value::as_str);
    setting.field.kind == Kind::Path && path.is_some_and(|path| Path::new(path).is_relative())
}

fn unknown_key(key: &str, origin: Origin, settings: &[Setting]) -> SettingsError {
    let keys: Vec<String> = settings.iter().map(Setting::key).collect();
    let section = key.rsplit_once('.').map_or("", |(section, _)| section);
    let known = settings.iter().filter(|setting| setting.section == section).map(Setting::key).collect();
    SettingsError::UnknownKey { origin, nearest: nearest(key, &keys), key: key.to_owned(), known }
}

/// Returns the known name with the most similar spelling; `None` if more than a third of the letters differ.
#[must_use]
pub fn nearest(name: &str, known: &[String]) -> Option<String> {
    known
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .min_by_key(|(distance, _)| *distance)
        // With more than a third of the letters different it is hardly a typing error.
        .filter(|(distance, _)| *distance * 3 <= name.chars().count())
        .map(|(_, candidate)| candidate.clone())
}

impl SettingsError {
    /// Creates the error for an unknown name among names known at run time, and suggests the most similar
    /// one.
    #[must_use]
    pub fn unknown_name(origin: Origin, what: &str, found: &str, known: Vec<String>) -> Self {
        Self::UnknownName {
            origin,
            what: what.to_owned(),
            found: found.to_owned(),
            nearest: nearest(found, &known),
            known,
        }
    }
}
