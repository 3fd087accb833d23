//! `task = "learn"`: learners of dynamics, trained on sets of records and scored on unseen records.

use crate::experiment::DataSettings;
use crate::json_schema::{asking_for_task, put};
use crate::parts::{self, PART, StatedPart};
use crate::prediction::all_known;
use crate::schema::{DATA, TOP};
use dynamics::Hold;
use learn::Entry;
use learn::baselines::BASELINES;
use learn::data::{Making, Split, SplitKind};
use serde::Deserialize;
use serde_json::{Value, json};
use settings::{Default, Document, Field, Kind, Resolved, Section, SettingsError, json_schema};
use toml::Table;

/// Name of the task.
const TASK: &str = "learn";

/// Learning study whose keys have all been checked.
pub struct LearnStudy {
    /// Prefix of the run folder's name.
    pub name: String,
    /// Root seed of every random draw.
    pub seed: u64,
    /// Learners, baselines and budget.
    pub settings: LearnSettings,
    /// Data sets, in the order of the document.
    pub problems: Vec<LearningProblem>,
    /// All configuration values in force, defaults included.
    pub resolved: Resolved,
}

/// Section `learn`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearnSettings {
    /// Names of the learners, all known; `None` for all learners.
    pub learners: Option<Vec<String>>,
    /// Names of the baselines, all known; `None` for all baselines.
    pub baselines: Option<Vec<String>>,
    problems: Option<Vec<String>>,
    /// Upper limit on the steps of every fit; `None` for each learner's own limit.
    pub max_steps: Option<u64>,
    /// Number of seeds with which the learners of `redrawn` are trained: the study's own and the next ones.
    pub seeds: u64,
    /// Names of the learners that are trained with every seed, all known.
    pub redrawn: Vec<String>,
    /// `true` if each learner is also scored with everything that it learned set to zero, and with noise as
    /// its input.
    pub ablations: bool,
}

/// Section `problem.NAME`: a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct LearningProblem {
    /// The NAME.
    pub id: String,
    /// Title for tables and reports.
    pub title: String,
    /// Source of the records.
    pub source: LearnSource,
    /// File of the nominal simulator; `None` if the configuration names none.
    pub nominal: Option<String>,
    /// Decimation factor: one sample in every `every` is used.
    pub every: usize,
    /// `true` if the means of the observed column and of the input are subtracted.
    pub remove_mean: bool,
    split: SplitKeys,
}

/// Source of records.
#[derive(Debug, Clone, PartialEq)]
pub enum LearnSource {
    /// Path of a simulation's configuration; its first system gives the records.
    Simulation(String),
    /// Record files in a folder.
    Files {
        /// The folder.
        folder: String,
        /// File names; each may contain the wildcard `*`.
        records: Vec<String>,
        /// Options for reading the files.
        reading: Box<DataSettings>,
    },
    /// Ranges of rows in the files of a folder, with their uses.
    Parts {
        /// The folder.
        folder: String,
        /// The parts, in the order of the document.
        parts: Vec<StatedPart>,
        /// Options for reading the files.
        reading: Box<DataSettings>,
    },
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct SplitKeys {
    split: SplitKind,
    test_records: usize,
    validation_records: usize,
    test_share: f64,
    validation_share: f64,
    hold: HoldKey,
    init: Option<usize>,
    warm_up_s: Option<f64>,
    period_s: Option<f64>,
    noise: Option<f64>,
}

/// Interpolation of the input between its samples; `Auto` determines it from the records.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum HoldKey {
    Auto,
    Zero,
    Linear,
    #[serde(rename = "band-limited")]
    BandLimited,
}

impl HoldKey {
    fn stated(self) -> Option<Hold> {
        match self {
            Self::Auto => None,
            Self::Zero => Some(Hold::Zero),
            Self::Linear => Some(Hold::Linear),
            Self::BandLimited => Some(Hold::BandLimited),
        }
    }
}

impl LearningProblem {
    /// Returns the options for making the data set that the configuration states, of records with a sample rate in
    /// Hz. The caller supplies the nominal simulator and the unit.
    #[must_use]
    pub fn making(&self, rate_hz: f64) -> Making {
        let keys = &self.split;
        // Half an interval more than the last sample, so that rounding leaves none out.
        let of_samples = |samples: usize| (samples as f64 - 0.5) / rate_hz;
        Making {
            split: Split {
                kind: keys.split,
                test_records: keys.test_records,
                validation_records: keys.validation_records,
                test_share: keys.test_share,
                validation_share: keys.validation_share,
            },
            unit: String::new(),
            nominal: None,
            hold: keys.hold.stated(),
            warm_up_s: keys.init.map(of_samples).or(keys.warm_up_s),
            period_s: keys.period_s,
            noise: keys.noise,
        }
    }
}

#[derive(Deserialize)]
struct Head {
    title: Option<String>,
    simulation: Option<String>,
    folder: Option<String>,
    records: Option<Vec<String>>,
    nominal: Option<String>,
    every: usize,
    remove_mean: bool,
}

#[derive(Deserialize)]
struct Top {
    name: Option<String>,
    seed: u64,
}

const TASK_FIELD: Field = Field::new("task", Kind::Choice(&[TASK]), Default::Required)
    .meaning("What to do: learn the dynamics from records, and judge on records never seen.");

fn top() -> Vec<Field> {
    TOP.iter().map(|field| if field.key == "task" { TASK_FIELD } else { *field }).collect()
}

const LEARN: &[Field] = &[
    Field::new("learners", Kind::Texts { at_least: 0, at_most: 100 }, Default::Absent)
        .meaning("Which learners, by name; left open, all there are."),
    Field::new("baselines", Kind::Texts { at_least: 0, at_most: 100 }, Default::Absent).meaning(
        "Which baselines: persistence, nominal, recalibrated, arx, repaired (which runs a \
                diagnosis, the slowest); left open, all there are.",
    ),
    Field::new("problems", Kind::Texts { at_least: 1, at_most: 1000 }, Default::Absent)
        .meaning("Which data sets, by name; left open, every section problem.NAME."),
    Field::new("max_steps", Kind::Integer { min: 0, max: i64::MAX }, Default::Absent).meaning(
        "Cap on the steps of every fit, in addition to a learner's own; 0 leaves networks \
                untrained.",
    ),
    Field::new("seeds", Kind::Integer { min: 1, max: 1000 }, Default::Integer(1)).meaning(
        "Seeds with which the learners in redrawn are trained: the study's own and the next ones; the table has the \
                scores of the first, and the median and the range over all.",
    ),
    Field::new("redrawn", Kind::Texts { at_least: 0, at_most: 100 }, Default::Texts(&[])).meaning(
        "Learners that are trained with every seed, by name: those whose result depends on random numbers.",
    ),
    Field::new("ablations", Kind::Boolean, Default::Boolean(true)).meaning(
        "Whether each learner's model is judged twice more: with everything that it learned \
                set to zero, and with noise in place of past and input.",
    ),
];

const PROBLEM: &[Field] = &[
    Field::new("title", Kind::Text, Default::Absent)
        .meaning("Title in tables and reports; left open, the section's name."),
    Field::new("simulation", Kind::Path, Default::Absent).meaning(
        "A configuration of a simulation; the records are those of its first system, and the \
                truth is known to the judge.",
    ),
    Field::new("folder", Kind::Path, Default::Absent).meaning("The folder of the record files."),
    Field::new("records", Kind::Texts { at_least: 1, at_most: 10_000 }, Default::Absent)
        .meaning("Names of record files in the folder, which may hold *; the last ones are tested on."),
    Field::new("nominal", Kind::Path, Default::Absent)
        .meaning("The nominal simulator's file; left open, that of the simulation, or none."),
    Field::new("every", Kind::Integer { min: 1, max: 1_000_000 }, Default::Integer(1))
        .meaning("Uses one of every so many samples."),
    Field::new("remove_mean", Kind::Boolean, Default::Boolean(false)).meaning(
        "Subtracts the mean of the observed column and of the input: for channels with an \
                arbitrary zero.",
    ),
    Field::new("split", Kind::Choice(&["record", "time", "both"]), Default::Text("record")).meaning(
        "What is tested on: whole records, the end of every record, or the end of records not \
                learned from.",
    ),
    Field::new("test_records", Kind::Integer { min: 0, max: 100_000 }, Default::Integer(1))
        .meaning("By record: number of records, the last ones, to test on."),
    Field::new("validation_records", Kind::Integer { min: 0, max: 100_000 }, Default::Integer(0)).meaning(
        "By record: number of records before those that are used to choose among models; with \
                0, the end of the training records is used.",
    ),
    Field::new("test_share", Kind::Float { min: 0.01, max: 0.9 }, Default::Float(0.3))
        .meaning("By time: share of a record at its end that is tested on."),
    Field::new("validation_share", Kind::Float { min: 0.01, max: 0.9 }, Default::Float(0.2)).meaning(
        "Share at the end of a training part that is used to choose among models if no whole \
                record is.",
    ),
    Field::new("hold", Kind::Choice(&["auto", "zero", "linear", "band-limited"]), Default::Text("auto"))
        .meaning(
            "Input between samples: it keeps its value, goes straight to the next, or follows a smooth curve; auto: \
                    whichever a law of all terms follows best.",
        ),
    Field::new("init", Kind::Integer { min: 5, max: 1_000_000 }, Default::Absent).unit("samples").meaning(
        "Number of samples at the start of a part from which its start state is found, and which do not count; \
                replaces warm_up_s.",
    ),
    Field::new("warm_up_s", Kind::Float { min: 1e-9, max: 1e9 }, Default::Absent)
        .unit("s")
        .meaning("Length of the past that a prediction starts from; left open, a period."),
    Field::new("period_s", Kind::Float { min: 1e-9, max: 1e9 }, Default::Absent)
        .unit("s")
        .meaning("Typical period of the motion; left open, read from the training records."),
    Field::new("noise", Kind::Float { min: 1e-300, max: 1e9 }, Default::Absent)
        .unit("unit of the positions")
        .meaning("Standard deviation of the sensor's noise; left open, read from the training records."),
];

/// Returns the keys of a problem: its own, and those for reading its files.
fn problem_fields() -> Vec<Field> {
    let reading = DATA.iter().filter(|field| field.key != "path").copied();
    PROBLEM.iter().copied().chain(reading).collect()
}

/// Returns `true` if the document asks for this task.
#[must_use]
pub fn is_learning(document: &Document) -> bool {
    document.get("task").is_some_and(|leaf| leaf.value.as_str() == Some(TASK))
}

/// Checks a document with `task = "learn"`, with overrides applied, against the schema and the known
/// learners.
///
/// # Errors
/// [`SettingsError`], with file, line and column or the override that caused it.
pub fn resolve_learning(document: &Document, learners: &[Entry]) -> Result<LearnStudy, SettingsError> {
    let ids = document.tables_below("problem");
    if ids.is_empty() {
        return Err(SettingsError::Missing {
            file: document.file().to_owned(),
            key: "problem.NAME".to_owned(),
            meaning: "A study needs data sets.".to_owned(),
            expected: "a section [problem.NAME] for each, as in configs/learn.toml".to_owned(),
        });
    }
    let names: Vec<String> = ids.iter().map(|id| format!("problem.{id}")).collect();
    let parts: Vec<String> = names.iter().flat_map(|name| parts::sections(document, name)).collect();
    let (top_fields, problem) = (top(), problem_fields());
    let mut sections =
        vec![Section { name: "", fields: &top_fields }, Section { name: "learn", fields: LEARN }];
    sections.extend(learners.iter().map(|entry| Section { name: entry.id, fields: entry.fields }));
    sections.extend(names.iter().map(|name| Section { name, fields: &problem }));
    sections.extend(parts.iter().map(|name| Section { name, fields: PART }));
    let resolved = Resolved::new(document, &sections)?;

    let top: Top = resolved.section("")?;
    let settings: LearnSettings = resolved.section("learn")?;
    let known: Vec<String> = learners.iter().map(|entry| entry.id.to_owned()).collect();
    all_known(document, "learn.learners", "learner", settings.learners.as_deref(), &known)?;
    all_known(document, "learn.redrawn", "learner", Some(&settings.redrawn), &known)?;
    let known: Vec<String> = BASELINES.iter().map(|baseline| baseline.id.to_owned()).collect();
    all_known(document, "learn.baselines", "baseline", settings.baselines.as_deref(), &known)?;
    all_known(document, "learn.problems", "problem", settings.problems.as_deref(), &ids)?;
    for entry in learners {
        (entry.build)(&resolved)?;
    }
    let wanted =
        |id: &str| settings.problems.as_ref().is_none_or(|names| names.iter().any(|name| name == id));
    let problems = ids
        .iter()
        .zip(&names)
        .filter(|(id, _)| wanted(id))
        .map(|(id, section)| read(document, &resolved, id, section))
        .collect::<Result<_, _>>()?;
    Ok(LearnStudy {
        name: top.name.unwrap_or_else(|| TASK.to_owned()),
        seed: top.seed,
        settings,
        problems,
        resolved,
    })
}

fn read(
    document: &Document,
    resolved: &Resolved,
    id: &str,
    section: &str,
) -> Result<LearningProblem, SettingsError> {
    let head: Head = resolved.section(section)?;
    let parts = parts::read(document, resolved, section)?;
    if head.remove_mean && !parts.is_empty() {
        let setting = resolved.setting(&format!("{section}.remove_mean"))?;
        return Err(SettingsError::BadValue {
            origin: setting.origin.clone(),
            key: setting.key(),
            found: "true".to_owned(),
            expected: "false beside stated parts: the mean of a file is that of its test rows too".to_owned(),
            unit: String::new(),
        });
    }
    let source = match (head.simulation, head.folder, head.records) {
        (Some(simulation), _, None) if parts.is_empty() => LearnSource::Simulation(simulation),
        (None, Some(folder), Some(records)) if parts.is_empty() => {
            let reading = Box::new(reading(resolved, section)?);
            LearnSource::Files { folder, records, reading }
        }
        (None, Some(folder), None) if !parts.is_empty() => {
            let reading = Box::new(reading(resolved, section)?);
            LearnSource::Parts { folder, parts, reading }
        }
        _ => {
            return Err(SettingsError::Missing {
                file: document.file().to_owned(),
                key: format!("{section}.simulation"),
                meaning: "A data set comes from a simulation or from files.".to_owned(),
                expected: "either simulation, or folder and records, or folder and sections .part.PART"
                    .to_owned(),
            });
        }
    };
    Ok(LearningProblem {
        id: id.to_owned(),
        title: head.title.unwrap_or_else(|| id.to_owned()),
        source,
        nominal: head.nominal,
        every: head.every,
        remove_mean: head.remove_mean,
        split: resolved.section(section)?,
    })
}

/// Reads the keys of a problem that control how its files are read.
fn reading(resolved: &Resolved, section: &str) -> Result<DataSettings, SettingsError> {
    let own = resolved.settings().iter().filter(|setting| setting.section == section);
    let of_reading = own.filter(|setting| DATA.iter().any(|field| field.key == setting.field.key));
    let values =
        of_reading.filter_map(|setting| Some((setting.field.key.to_owned(), setting.value.clone()?)));
    let table: Table = values.chain([("path".to_owned(), toml::Value::String(String::new()))]).collect();
    table.try_into().map_err(|error: toml::de::Error| SettingsError::Declaration {
        section: section.to_owned(),
        problem: error.message().to_owned(),
    })
}

/// Returns the JSON Schema of `task = "learn"`, with the keys of each learner under its name.
#[must_use]
pub fn learn_schema(learners: &[Entry]) -> Value {
    let (top_fields, problem) = (top(), problem_fields());
    let mut sections =
        vec![Section { name: "", fields: &top_fields }, Section { name: "learn", fields: LEARN }];
    sections.extend(learners.iter().map(|entry| Section { name: entry.id, fields: entry.fields }));
    let mut root = json_schema::tables(&sections);
    json_schema::insert(&mut root, "", "task", json!({ "const": TASK }));
    let mut each = json_schema::table(&problem);
    let part = json!({ "type": "object", "additionalProperties": json_schema::table(PART) });
    json_schema::insert(&mut each, "", "part", part);
    let problems = json!({ "type": "object", "additionalProperties": each });
    json_schema::insert(&mut root, "", "problem", problems);
    let mut required = asking_for_task(json_schema::requirements(&sections));
    json_schema::require(&mut required, "", "problem");
    if let Some(object) = required.as_object_mut() {
        let each = json!({ "minProperties": 1 });
        put(object.entry("properties").or_insert_with(|| json!({})), "problem", each);
    }
    json_schema::with_base(root, required)
}
