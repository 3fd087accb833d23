//! `task = "predict"`: many methods on several problems, scored on held-out peaks.

use crate::experiment::{CheckpointSettings, DataSettings, Top};
use crate::pipelines::{self, EnvelopeSettings, Pipeline};
use crate::schema::{CHECKPOINT, DATA, PAPER, RECOMMENDED, SAMPLES, TOP};
use estimator::Entry;
use serde::Deserialize;
use settings::{Default, Document, Field, Kind, Origin, Resolved, Section, SettingsError};

/// Name of the task.
const TASK: &str = "predict";

/// Study of held-out prediction whose keys have all been checked.
pub struct PredictionStudy {
    /// Prefix of the run folder's name.
    pub name: String,
    /// Root seed of every random draw.
    pub seed: u64,
    /// Methods, number of draws, and rules for holding out peaks.
    pub settings: PredictionSettings,
    /// Interval between checkpoints.
    pub checkpoint: CheckpointSettings,
    /// Problems to study, in the order of the document.
    pub problems: Vec<Problem>,
    /// Settings of the pipelines.
    pub envelope: EnvelopeSettings,
    /// All configuration values in force, defaults included.
    pub resolved: Resolved,
}

/// Section `predict`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PredictionSettings {
    /// Names of the methods, all known; `None` for all methods.
    pub methods: Option<Vec<String>>,
    problems: Option<Vec<String>>,
    /// Number of draws of a simulated problem.
    pub draws: usize,
    /// Number of draws for methods that use random numbers themselves; at most `draws`.
    pub draws_seeded: usize,
    /// Interpolation: number of successive peaks in a block.
    pub block_peaks: usize,
    /// Interpolation: one of every `every` successive blocks is held out.
    pub every: usize,
    /// Extrapolation: share of the peaks that is held out at the end.
    pub last_share: f64,
    /// Significance level for adjusted p-values.
    pub significance: f64,
    /// Upper limit on the training steps; `None` for each method's own limit.
    pub max_steps: Option<u64>,
}

/// Section `problem.NAME`.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The NAME.
    pub id: String,
    /// Title for tables and reports.
    pub title: String,
    /// Source of the envelope.
    pub source: ProblemSource,
}

/// Source of a problem's envelope.
#[derive(Debug, Clone, PartialEq)]
pub enum ProblemSource {
    /// Law of decay with added scatter.
    Simulated(SimulatedProblem),
    /// Record file.
    Record {
        /// The record, and options for reading it.
        data: Box<DataSettings>,
        /// Pipeline that extracts the envelope.
        pipeline: Pipeline,
    },
}

/// Simulated problem. Amplitudes are angles, in rad.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SimulatedProblem {
    /// Law of decay.
    pub kind: Law,
    /// Amplitude of the first peak, in rad.
    pub amplitude: f64,
    /// Period, in seconds.
    pub period_s: f64,
    /// Number of peaks; there are two per period.
    pub peaks: usize,
    /// Decay rate λ of the viscous part, in 1/s.
    pub decay_rate: f64,
    /// Half-width of the dead zone, in rad; 0 if the law has none.
    #[serde(default)]
    pub dead_zone: f64,
    /// Rate q of the quadratic damping, in 1/(s rad); 0 if the law has none.
    #[serde(default)]
    pub quadratic_rate: f64,
    /// Quantity that the scatter is added to.
    pub scatter: ScatterKind,
    /// Standard deviation of the scatter: in rad on the amplitude, dimensionless on ln A.
    pub scatter_size: f64,
}

/// Law of decay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// Viscous damping alone.
    Exponential,
    /// Dry friction and viscous damping.
    CoulombViscous,
    /// Viscous and quadratic damping.
    ViscousQuadratic,
}

/// Quantity that scatter is added to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ScatterKind {
    /// The amplitude, as with a sensor's noise.
    Amplitude,
    /// The log amplitude ln A.
    Logarithm,
}

/// Kinds of problems.
pub(crate) const KINDS: &[&str] = &["exponential", "coulomb-viscous", "viscous-quadratic", "record"];

/// All sections except those of the problems.
pub(crate) const PREDICT_SECTIONS: &[Section<'static>] = &[
    Section { name: "", fields: TOP },
    Section { name: "predict", fields: PREDICT },
    Section { name: "checkpoint", fields: CHECKPOINT },
    Section { name: "envelope.paper", fields: PAPER },
    Section { name: "envelope.recommended", fields: RECOMMENDED },
    Section { name: "envelope.samples", fields: SAMPLES },
];

const PREDICT: &[Field] = &[
    Field::new("methods", Kind::Texts { at_least: 1, at_most: 1000 }, Default::Absent)
        .meaning("Which methods, classical and learned, by name; left open, all there are."),
    Field::new("problems", Kind::Texts { at_least: 1, at_most: 1000 }, Default::Absent)
        .meaning("Which problems, by name; left open, every section problem.NAME."),
    Field::new("draws", Kind::Integer { min: 1, max: 100_000 }, Default::Integer(200))
        .meaning("Draws of the scatter on a simulated problem, each with a fit of its own.")
        .source("a share of 0.95 is then known to 0.03 (Clopper, Pearson 1934)"),
    Field::new("draws_seeded", Kind::Integer { min: 1, max: 100_000 }, Default::Integer(20))
        .meaning(
            "Draws for methods with random numbers of their own, which are slow: the first of all \
                draws.",
        )
        .source("what a minute on two cores allows"),
    Field::new("block_peaks", Kind::Integer { min: 1, max: 10_000 }, Default::Integer(3))
        .unit("peaks")
        .meaning("Interpolation: successive peaks held out together.")
        .source("more than one, so that a neighbor's scatter is no help"),
    Field::new("every", Kind::Integer { min: 2, max: 1000 }, Default::Integer(4))
        .unit("blocks")
        .meaning(
            "Interpolation: one of every so many blocks is held out, but never the first or the \
                last.",
        )
        .source("fits keep three quarters of the peaks"),
    Field::new("last_share", Kind::Float { min: 0.05, max: 0.8 }, Default::Float(1.0 / 3.0))
        .meaning("Extrapolation: share of the peaks at the end that is held out."),
    Field::new("significance", Kind::Float { min: 1e-9, max: 0.5 }, Default::Float(0.05))
        .meaning("Largest adjusted p-value that counts as more than chance.")
        .source("convention"),
    Field::new("max_steps", Kind::Integer { min: 0, max: i64::MAX }, Default::Absent)
        .meaning("Cap on the training steps, in addition to a method's own; 0 leaves it untrained."),
];

const KIND: Field = Field::new("kind", Kind::Choice(KINDS), Default::Required)
    .meaning("Where the envelope comes from: a law of decay, or a record file.");

const TITLE: Field = Field::new("title", Kind::Text, Default::Absent)
    .meaning("Title in tables and reports; left open, the section's name.");

const PIPELINE: Field =
    Field::new("pipeline", Kind::Choice(&["paper", "recommended", "samples"]), Default::Text("recommended"))
        .meaning(
            "Pipeline from the record to its envelope: the paper's, the recommended one, or a fit \
                of the samples.",
        );

/// Keys of every simulated problem.
const SIMULATED: &[Field] = &[
    Field::new("amplitude", Kind::Float { min: 1e-9, max: 1e9 }, Default::Float(0.5))
        .unit("rad")
        .meaning("Amplitude of the first peak."),
    Field::new("period_s", Kind::Float { min: 1e-9, max: 1e9 }, Default::Float(0.288))
        .unit("s")
        .meaning("Period; peaks of both sides lie half of it apart.")
        .source("the paper's pendulum"),
    Field::new("peaks", Kind::Integer { min: 12, max: 10_000 }, Default::Integer(72))
        .meaning("Peaks of the envelope.")
        .source("the paper's record has 69"),
    Field::new("decay_rate", Kind::Float { min: 0.0, max: 1e9 }, Default::Required)
        .unit("1/s")
        .meaning("Decay rate of the viscous part."),
    Field::new("scatter", Kind::Choice(&["amplitude", "logarithm"]), Default::Text("amplitude"))
        .meaning("What Gaussian scatter is added to: the amplitude, as a sensor's noise, or ln A."),
    Field::new("scatter_size", Kind::Float { min: 0.0, max: 1e9 }, Default::Required)
        .unit("rad on the amplitude, a number on ln A")
        .meaning("Standard deviation of the scatter."),
];

const DEAD_ZONE: Field = Field::new("dead_zone", Kind::Float { min: 0.0, max: 1e9 }, Default::Required)
    .unit("rad")
    .meaning("Half-width of the dead zone: dry friction over stiffness.");

const QUADRATIC_RATE: Field =
    Field::new("quadratic_rate", Kind::Float { min: 0.0, max: 1e9 }, Default::Required)
        .unit("1/(s rad)")
        .meaning("Rate q of quadratic damping: the rate at amplitude A is decay_rate + q A.");

/// Returns `true` if the document asks for this task.
#[must_use]
pub fn is_prediction(document: &Document) -> bool {
    document.get("task").is_some_and(|leaf| leaf.value.as_str() == Some(TASK))
}

/// Checks a document with `task = "predict"`, with overrides applied, against the schema, the registry of
/// estimators and the names of the classical methods. [`crate::resolve`] does the same for the tasks
/// `estimate` and `compare`.
///
/// # Errors
/// [`SettingsError`], with file, line and column or the override that caused it.
pub fn resolve_prediction(
    document: &Document,
    registry: &[Entry],
    classical: &[&str],
) -> Result<PredictionStudy, SettingsError> {
    let ids = document.tables_below("problem");
    if ids.is_empty() {
        return Err(SettingsError::Missing {
            file: document.file().to_owned(),
            key: "problem.NAME".to_owned(),
            meaning: "A study needs problems.".to_owned(),
            expected: "a section [problem.NAME] with a kind for each, as in configs/beyond.toml".to_owned(),
        });
    }
    let names: Vec<String> = ids.iter().map(|id| format!("problem.{id}")).collect();
    let fields: Vec<Vec<Field>> = names.iter().map(|name| fields(document, name)).collect();
    let own = names.iter().zip(&fields).map(|(name, fields)| Section { name, fields });
    let sections: Vec<Section<'_>> = PREDICT_SECTIONS.iter().copied().chain(own).collect();
    let resolved = Resolved::new(document, &sections)?;

    let top: Top = resolved.section("")?;
    let settings: PredictionSettings = resolved.section("predict")?;
    let learned = registry.iter().map(|entry| entry.id);
    let methods: Vec<String> = classical.iter().copied().chain(learned).map(str::to_owned).collect();
    all_known(document, "predict.methods", "method", settings.methods.as_deref(), &methods)?;
    all_known(document, "predict.problems", "problem", settings.problems.as_deref(), &ids)?;
    let wanted =
        |id: &str| settings.problems.as_ref().is_none_or(|names| names.iter().any(|name| name == id));
    let problems = ids
        .iter()
        .zip(&names)
        .filter(|(id, _)| wanted(id))
        .map(|(id, section)| problem(&resolved, id, section))
        .collect::<Result<_, _>>()?;
    Ok(PredictionStudy {
        name: top.name.unwrap_or(top.task),
        seed: top.seed,
        envelope: pipelines::each(&resolved, Pipeline::Recommended)?,
        settings,
        checkpoint: resolved.section("checkpoint")?,
        problems,
        resolved,
    })
}

fn fields(document: &Document, section: &str) -> Vec<Field> {
    fields_of(document.get(&format!("{section}.kind")).and_then(|leaf| leaf.value.as_str()))
}

/// Returns the keys that a problem may have, depending on its kind.
pub(crate) fn fields_of(kind: Option<&str>) -> Vec<Field> {
    let common = [KIND, TITLE];
    let own: Vec<Field> = match kind {
        Some("record") => {
            DATA.iter()
                // The shipped record is no default here: each problem names its own record.
                .map(|field| if field.key == "path" { field.default(Default::Required) } else { *field })
                .chain([PIPELINE])
                .collect()
        }
        Some("exponential") => SIMULATED.to_vec(),
        Some("coulomb-viscous") => SIMULATED.iter().copied().chain([DEAD_ZONE]).collect(),
        Some("viscous-quadratic") => SIMULATED.iter().copied().chain([QUADRATIC_RATE]).collect(),
        // If the kind is missing or wrong, the message should be about the kind and not about the keys that
        // go with it.
        _ => SIMULATED.iter().chain(DATA).copied().chain([PIPELINE, DEAD_ZONE, QUADRATIC_RATE]).collect(),
    };
    common.into_iter().chain(own).collect()
}

#[derive(Deserialize)]
struct Head {
    kind: String,
    title: Option<String>,
}

#[derive(Deserialize)]
struct RecordProblem {
    pipeline: Pipeline,
    #[serde(flatten)]
    data: DataSettings,
}

fn problem(resolved: &Resolved, id: &str, section: &str) -> Result<Problem, SettingsError> {
    let head: Head = resolved.section(section)?;
    let source = if head.kind == "record" {
        let RecordProblem { pipeline, data } = resolved.section(section)?;
        ProblemSource::Record { data: Box::new(data), pipeline }
    } else {
        ProblemSource::Simulated(resolved.section(section)?)
    };
    Ok(Problem { id: id.to_owned(), title: head.title.unwrap_or_else(|| id.to_owned()), source })
}

/// Refuses unknown names.
pub(crate) fn all_known(
    document: &Document,
    key: &str,
    what: &str,
    names: Option<&[String]>,
    known: &[String],
) -> Result<(), SettingsError> {
    let origin = || document.get(key).map_or(Origin::Default, |leaf| leaf.origin.clone());
    match names.into_iter().flatten().find(|name| !known.contains(name)) {
        Some(name) => Err(SettingsError::unknown_name(origin(), what, name, known.to_vec())),
        None => Ok(()),
    }
}
