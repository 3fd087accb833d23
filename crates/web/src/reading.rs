//! Options of the page for reading logs: keys of the section `data` of a configuration, and `remove_mean`.

use experiment::{Experiment, SECTIONS, resolve};
use serde_json::{Map, Value, json};
use settings::{Document, Field, Kind};
use workflow::Reading;

/// Name of the options in messages.
const FORM: &str = "the form";
/// Ordinary least squares.
const METHOD: &str = "ols";

/// Keys of the section that have no meaning for a dropped log.
const LEFT_OUT: &[&str] = &["path", "source", "angle", "stated_rate_hz", "stated_samples"];
/// Keys that name a column.
const COLUMNS: &[&str] = &["time", "value", "input"];

/// Lists the options with the names that they have on the command line.
pub(crate) fn offered() -> Vec<Value> {
    let data = SECTIONS.iter().filter(|section| section.name == "data").flat_map(|section| section.fields);
    let shown = |field: &Field| {
        let choices = match field.kind {
            Kind::Choice(choices) => Some(choices),
            _ => None,
        };
        let option = field.key.trim_end_matches("_hz").trim_end_matches("_s").replace('_', "-");
        json!({
            "key": field.key,
            "option": option,
            "kind": if matches!(field.kind, Kind::Integer { .. } | Kind::Float { .. }) { "number" } else { "text" },
            "choices": choices,
            "column": COLUMNS.contains(&field.key),
            "meaning": field.meaning.trim_start_matches("csv: "),
        })
    };
    let mean = json!({
        "key": "remove_mean",
        "option": "remove-mean",
        "kind": "flag",
        "choices": null,
        "column": false,
        "meaning": "subtracts the means of the observed column and of the input, for channels with an arbitrary zero.",
    });
    data.filter(|field| !LEFT_OUT.contains(&field.key)).map(shown).chain([mean]).collect()
}

/// Converts options into those of a reading.
///
/// # Errors
/// A message for an unknown key or a wrong value.
pub(crate) fn reading(options: &Map<String, Value>) -> Result<Reading, String> {
    let remove_mean = options.get("remove_mean").and_then(Value::as_bool) == Some(true);
    let data = experiment(options)?.data;
    Ok(Reading {
        options: data.read_options(),
        clock: data.clock,
        origin: data.statements().origin,
        remove_mean,
    })
}

/// Returns the configuration of an estimate by least squares that reads logs by the options.
///
/// # Errors
/// As [`reading`].
pub(crate) fn experiment(options: &Map<String, Value>) -> Result<Experiment, String> {
    let mut options = options.clone();
    options.remove("remove_mean");
    let said = |error: settings::SettingsError| workflow::in_options(&error.to_string());
    let data = toml::Value::try_from(options).map_err(|error| error.to_string())?;
    let method = toml::Table::from_iter([("name".to_owned(), METHOD.into())]);
    let table = [("data".to_owned(), data), ("estimator".to_owned(), toml::Value::Table(method))];
    let document = Document::parse(FORM, &toml::Table::from_iter(table).to_string()).map_err(said)?;
    resolve(&document, &[], &[METHOD]).map_err(said)
}
