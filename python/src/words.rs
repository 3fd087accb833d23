//! Words and options from Python as typed values.

use crate::error::ConfigError;
use pyo3::PyResult;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde::de::IntoDeserializer;
use serde::de::value::Error;

/// A word such as `deg` as what it names; `what` is the argument it was given for.
pub(crate) fn word<'de, T: Deserialize<'de>>(what: &str, text: &'de str) -> PyResult<T> {
    T::deserialize(IntoDeserializer::<Error>::into_deserializer(text))
        .map_err(|error| ConfigError::new_err(format!("{what}: {error}")))
}

/// The same for a word that may be left out.
pub(crate) fn optional<'de, T: Deserialize<'de>>(what: &str, text: Option<&'de str>) -> PyResult<Option<T>> {
    text.map(|text| word(what, text)).transpose()
}

/// Options given as JSON.
pub(crate) fn options<T: DeserializeOwned>(what: &str, json: &str) -> PyResult<T> {
    serde_json::from_str(json).map_err(|error| ConfigError::new_err(format!("{what}: {error}")))
}
