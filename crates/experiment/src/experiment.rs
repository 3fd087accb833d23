//! Resolution of a configuration document into an experiment.

use crate::pipelines::{self, EnvelopeSettings};
use crate::schema::{COMPARE, SECTIONS, estimator_name_field};
use estimator::{Entry, Estimator};
use record::{
    ClockChoice, CsvColumns, Filter, Format, Missing, Origin, Quantity, ReadOptions, Statements, TimeUnit,
    Unit,
};
use serde::Deserialize;
use settings::{Document, Field, Resolved, Section, SettingsError};
use std::sync::Arc;
use toml::Value;

/// Experiment whose keys have all been checked.
pub struct Experiment {
    /// Prefix of the run folder's name.
    pub name: String,
    /// Root seed of every random draw.
    pub seed: u64,
    /// Record file, and options for reading it.
    pub data: DataSettings,
    /// Pipeline that turns the record into an envelope.
    pub envelope: EnvelopeSettings,
    /// Number of fits, their budget, and the tolerance.
    pub fit: FitSettings,
    /// Interval between checkpoints.
    pub checkpoint: CheckpointSettings,
    /// Task to run.
    pub task: Task,
    /// All configuration values in force, defaults included.
    pub resolved: Resolved,
}

/// Task to run on the record.
pub enum Task {
    /// Fit one estimator.
    Estimate(Single),
    /// Compare many methods.
    Compare(Comparison),
}

/// The method of a single estimate.
pub enum Single {
    /// Estimator from the registry.
    Learned {
        /// Registry entry of the estimator.
        entry: Entry,
        /// The estimator, built from its settings.
        estimator: Arc<dyn Estimator>,
    },
    /// Classical method, by name. It has no settings.
    Classical(String),
}

/// Section `compare`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// Names of the methods, all known; `None` for all methods of the paper.
    pub methods: Option<Vec<String>>,
    /// Moment of inertia, in kg·m²; `None` if unknown.
    pub inertia_kg_m2: Option<f64>,
    /// Source of the statements that the results are checked against.
    pub claims: Claims,
}

/// Source of the statements that a comparison's numbers are checked against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Claims {
    /// No source: nothing is checked.
    None,
    /// The paper.
    Paper,
}

/// Keys at the top of the document.
#[derive(Deserialize)]
pub(crate) struct Top {
    pub(crate) task: String,
    pub(crate) name: Option<String>,
    pub(crate) seed: u64,
}

/// Section `data`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataSettings {
    /// Path of the record file.
    pub path: String,
    /// Place to obtain the record from; `None` if the configuration does not state it.
    pub source: Option<String>,
    format: Format,
    quantity: Option<Quantity>,
    /// Choice of the clock to trust.
    pub clock: ClockChoice,
    time: Option<String>,
    value: Option<String>,
    angle: Option<String>,
    input: Option<String>,
    unit: Option<Unit>,
    input_unit: Option<Unit>,
    time_unit: Option<TimeUnit>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    run: Option<usize>,
    counts_per_turn: Option<f64>,
    #[serde(rename = "where")]
    filter: Option<Filter>,
    missing: Missing,
    sample_rate_hz: Option<f64>,
    origin: Option<Origin>,
    stated_rate_hz: Option<f64>,
    stated_samples: Option<usize>,
}

impl DataSettings {
    /// Returns the options for reading the record file.
    #[must_use]
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            format: self.format,
            columns: CsvColumns {
                time: self.time.clone(),
                value: self.value.clone().or_else(|| self.angle.clone()),
                input: self.input.clone(),
                unit: self.unit,
                input_unit: self.input_unit,
                time_unit: self.time_unit,
                sample_rate_hz: self.sample_rate_hz,
                run: self.run,
                counts_per_turn: self.counts_per_turn,
                filter: self.filter.clone(),
                missing: self.missing,
            },
            quantity: self.quantity,
            from_s: self.from_s,
            to_s: self.to_s,
            ..ReadOptions::default()
        }
    }

    /// Returns the same settings with another observed column and another input, where they are stated.
    #[must_use]
    pub fn with_columns(&self, value: Option<&String>, input: Option<&String>) -> Self {
        let own = self.clone();
        Self { value: value.cloned().or(own.value), input: input.cloned().or(own.input), ..self.clone() }
    }

    /// Returns what the configuration states about the record: origin, sample rate and number of samples.
    #[must_use]
    pub fn statements(&self) -> Statements {
        Statements { origin: self.origin, sample_rate_hz: self.stated_rate_hz, samples: self.stated_samples }
    }
}

/// Section `fit`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSettings {
    /// Number of seeds to fit.
    pub seeds: u64,
    /// Upper limit on the training steps; `None` for the estimator's own limit.
    pub max_steps: Option<u64>,
    /// Largest passing error relative to the oracle, in percent.
    pub tolerance_percent: f64,
}

/// Section `checkpoint`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckpointSettings {
    /// Seconds between two checkpoints.
    pub interval_s: f64,
    /// Steps between two checkpoints; replaces the time interval if given.
    pub interval_steps: Option<u64>,
}

/// Checks a document, with overrides applied, against the schema, the registry of estimators and the names of
/// the classical methods.
///
/// # Errors
/// [`SettingsError`], with file, line and column or the override that caused it.
pub fn resolve(
    document: &Document,
    registry: &[Entry],
    classical: &[&str],
) -> Result<Experiment, SettingsError> {
    let compares = document.get("task").is_some_and(|leaf| leaf.value.as_str() == Some("compare"));
    // The method has to be known before its keys can be checked.
    let method = if compares { None } else { Some(find_method(document, registry, classical)?) };
    let own_fields = match &method {
        Some(Named::Learned(entry)) => entry.fields,
        _ => &[],
    };
    let fields: Vec<Field> =
        std::iter::once(estimator_name_field()).chain(own_fields.iter().copied()).collect();
    let own = if compares { COMPARE } else { Section { name: "estimator", fields: &fields } };
    let sections: Vec<Section<'_>> = SECTIONS.iter().copied().chain([own]).collect();
    let resolved = Resolved::new(document, &sections).map_err(|error| of_another(error, document))?;

    let top: Top = resolved.section("")?;
    let task = match method {
        Some(Named::Learned(entry)) => {
            Task::Estimate(Single::Learned { entry, estimator: (entry.build)(&resolved)?.into() })
        }
        Some(Named::Classical(id)) => Task::Estimate(Single::Classical(id)),
        None => Task::Compare(comparison(document, &resolved, registry, classical)?),
    };
    let default_name = match &task {
        Task::Estimate(Single::Learned { entry, .. }) => entry.id.to_owned(),
        Task::Estimate(Single::Classical(id)) => id.clone(),
        Task::Compare(_) => top.task,
    };
    Ok(Experiment {
        name: top.name.unwrap_or(default_name),
        seed: top.seed,
        data: resolved.section("data")?,
        envelope: pipelines::settings(&resolved)?,
        fit: resolved.section("fit")?,
        checkpoint: resolved.section("checkpoint")?,
        task,
        resolved,
    })
}

fn comparison(
    document: &Document,
    resolved: &Resolved,
    registry: &[Entry],
    classical: &[&str],
) -> Result<Comparison, SettingsError> {
    let comparison: Comparison = resolved.section(COMPARE.name)?;
    let known: Vec<String> =
        classical.iter().copied().chain(registry.iter().map(|entry| entry.id)).map(str::to_owned).collect();
    let origin =
        || document.get("compare.methods").map_or(settings::Origin::Default, |leaf| leaf.origin.clone());
    match comparison.methods.iter().flatten().find(|name| !known.contains(name)) {
        Some(name) => Err(SettingsError::unknown_name(origin(), "method", name, known)),
        None => Ok(comparison),
    }
}

/// Method named by a configuration.
enum Named {
    Learned(Entry),
    Classical(String),
}

/// Turns an unknown key of another estimator into an error that names the remedy.
///
/// If the command line overrides `estimator.name` alone, the file's keys for its own estimator remain and are
/// unknown to the chosen one; `estimator=NAME` drops them.
fn of_another(error: SettingsError, document: &Document) -> SettingsError {
    let name =
        document.get("estimator.name").filter(|name| matches!(name.origin, settings::Origin::Override(_)));
    match (error, name.and_then(|name| name.value.as_str())) {
        (
            SettingsError::UnknownKey { origin: origin @ settings::Origin::File { .. }, key, .. },
            Some(chosen),
        ) if key.starts_with("estimator.") => {
            let remedy = format!(
                "choose with estimator={chosen} instead of estimator.name={chosen}, which leaves out what the file sets for \
                 another estimator"
            );
            SettingsError::ForeignKey { origin, key, chosen: chosen.to_owned(), remedy }
        }
        (error, _) => error,
    }
}

/// Finds the method named by `estimator.name`.
fn find_method(document: &Document, registry: &[Entry], classical: &[&str]) -> Result<Named, SettingsError> {
    let ids = || {
        let learned = registry.iter().map(|entry| entry.id);
        learned.chain(classical.iter().copied()).map(str::to_owned).collect::<Vec<_>>()
    };
    let Some(leaf) = document.get("estimator.name") else {
        return Err(SettingsError::Missing {
            file: document.file().to_owned(),
            key: "estimator.name".to_owned(),
            meaning: estimator_name_field().meaning.to_owned(),
            expected: format!("one of {}", ids().join(", ")),
        });
    };
    let found = match &leaf.value {
        Value::String(name) => name.clone(),
        other => other.to_string(),
    };
    if let Some(entry) = registry.iter().find(|entry| entry.id == found) {
        return Ok(Named::Learned(*entry));
    }
    if classical.contains(&found.as_str()) {
        return match document.get("fit.max_steps") {
            Some(cap) => Err(SettingsError::BadValue {
                origin: cap.origin.clone(),
                key: "fit.max_steps".to_owned(),
                found: cap.value.to_string(),
                expected: format!("to be left out, since {found} is a classical method and takes no cap"),
                unit: String::new(),
            }),
            None => Ok(Named::Classical(found)),
        };
    }
    Err(SettingsError::unknown_name(leaf.origin.clone(), "estimator", &found, ids()))
}
