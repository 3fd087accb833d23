//! From a document to an experiment.

use crate::schema::{COMPARE, SECTIONS, estimator_name_field};
use envelope::{EnvelopeError, Extraction, PaperPipeline, RecommendedPipeline};
use estimator::{Entry, Estimator};
use record::{
    Clock, ClockChoice, CsvColumns, Filter, Format, Missing, Origin, Quantity, ReadOptions, Record,
    Statements, TimeUnit, Unit,
};
use serde::Deserialize;
use settings::{Document, Field, Resolved, Section, SettingsError};
use std::sync::Arc;
use toml::Value;

/// An experiment with every key checked.
pub struct Experiment {
    /// Start of the run folder's name.
    pub name: String,
    /// Root of every random draw.
    pub seed: u64,
    /// The record.
    pub data: DataSettings,
    /// The way to its envelope.
    pub envelope: EnvelopeSettings,
    /// The fits.
    pub fit: FitSettings,
    /// How often what was computed is kept.
    pub checkpoint: CheckpointSettings,
    /// What to do.
    pub task: Task,
    /// Every value in force.
    pub resolved: Resolved,
}

/// What to do with the record.
pub enum Task {
    /// Fit one estimator.
    Estimate(Single),
    /// Compare many methods.
    Compare(Comparison),
}

/// One method.
pub enum Single {
    /// An estimator of the registry.
    Learned {
        /// Its line there.
        entry: Entry,
        /// The estimator, built from its settings.
        estimator: Arc<dyn Estimator>,
    },
    /// A classical method, by its name. It has no settings.
    Classical(String),
}

/// The section `compare`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// Names of the methods, each known; `None` for all of the paper's.
    pub methods: Option<Vec<String>>,
    /// Moment of inertia, in kg·m², where it is known.
    pub inertia_kg_m2: Option<f64>,
    /// Whose statements the numbers are held against.
    pub claims: Claims,
}

/// Whose statements a comparison's numbers are held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Claims {
    /// Nobody's.
    None,
    /// The paper's.
    Paper,
}

/// The keys at the top.
#[derive(Deserialize)]
pub(crate) struct Top {
    pub(crate) task: String,
    pub(crate) name: Option<String>,
    pub(crate) seed: u64,
}

/// The section `data`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataSettings {
    /// The record file.
    pub path: String,
    /// Where the record can be had, where the configuration says so.
    pub source: Option<String>,
    format: Format,
    quantity: Option<Quantity>,
    /// Which clock to believe.
    pub clock: ClockChoice,
    time: Option<String>,
    value: Option<String>,
    angle: Option<String>,
    input: Option<String>,
    unit: Option<Unit>,
    input_unit: Option<Unit>,
    time_unit: Option<TimeUnit>,
    #[serde(rename = "where")]
    filter: Option<Filter>,
    missing: Missing,
    sample_rate_hz: Option<f64>,
    origin: Option<Origin>,
    stated_rate_hz: Option<f64>,
    stated_samples: Option<usize>,
}

impl DataSettings {
    /// How to read the file.
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
                filter: self.filter.clone(),
                missing: self.missing,
            },
            quantity: self.quantity,
            ..ReadOptions::default()
        }
    }

    /// What the configuration states of the record.
    #[must_use]
    pub fn statements(&self) -> Statements {
        Statements { origin: self.origin, sample_rate_hz: self.stated_rate_hz, samples: self.stated_samples }
    }
}

/// Which pipeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pipeline {
    /// [`PaperPipeline`].
    Paper,
    /// [`RecommendedPipeline`].
    Recommended,
}

impl Pipeline {
    /// The name as configurations and results write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Recommended => "recommended",
        }
    }
}

/// The sections `envelope` and below.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvelopeSettings {
    /// The pipeline in force.
    pub pipeline: Pipeline,
    /// Settings of the paper's.
    pub paper: PaperPipeline,
    /// Settings of the recommended one.
    pub recommended: RecommendedPipeline,
}

impl EnvelopeSettings {
    /// Sends a record through a pipeline.
    ///
    /// # Errors
    /// As the pipeline.
    pub fn extract(
        &self,
        pipeline: Pipeline,
        record: &Record,
        clock: &Clock,
    ) -> Result<Extraction, EnvelopeError> {
        match pipeline {
            Pipeline::Paper => self.paper.extract(record, clock),
            Pipeline::Recommended => self.recommended.extract(record, clock),
        }
    }
}

/// The section `fit`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSettings {
    /// How many seeds to fit.
    pub seeds: u64,
    /// Cap on the training steps.
    pub max_steps: Option<u64>,
    /// Largest error against the oracle that passes, in percent.
    pub tolerance_percent: f64,
}

/// The section `checkpoint`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckpointSettings {
    /// Seconds between two checkpoints.
    pub interval_s: f64,
    /// Steps between two checkpoints, in place of the time.
    pub interval_steps: Option<u64>,
}

#[derive(Deserialize)]
struct PipelineName {
    pipeline: Pipeline,
}

/// Checks a document, overrides applied, against the schema and what there is to choose from: the
/// registry of estimators, and the names of the classical methods.
///
/// # Errors
/// [`SettingsError`], with file, line and column or the override that caused it.
pub fn resolve(
    document: &Document,
    registry: &[Entry],
    classical: &[&str],
) -> Result<Experiment, SettingsError> {
    let compares = document.get("task").is_some_and(|leaf| leaf.value.as_str() == Some("compare"));
    // A method's keys can only be checked once it is known which method it is.
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
    let pipeline: PipelineName = resolved.section("envelope")?;
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
        envelope: pipelines(&resolved, pipeline.pipeline)?,
        fit: resolved.section("fit")?,
        checkpoint: resolved.section("checkpoint")?,
        task,
        resolved,
    })
}

/// The settings of both pipelines, one of them in force.
pub(crate) fn pipelines(resolved: &Resolved, pipeline: Pipeline) -> Result<EnvelopeSettings, SettingsError> {
    Ok(EnvelopeSettings {
        pipeline,
        paper: resolved.section("envelope.paper")?,
        recommended: resolved.section("envelope.recommended")?,
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

/// A method that a configuration names.
enum Named {
    Learned(Entry),
    Classical(String),
}

/// Where the command line sets `estimator.name` alone, the file's keys for its own estimator are left over:
/// an unknown key among these is told with the choice that leaves them out.
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

/// The method that `estimator.name` names.
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
