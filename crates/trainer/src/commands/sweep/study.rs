//! Keys that a sweep varies and the configuration to which they apply, from a command line or a manifest.

use super::arguments::SweepArguments;
use super::measure::default_measure;
use crate::configured::{read_with_text, registries};
use crate::error::{SweepCommandError, TrainerError};
use experiment::sweep::{
    Axis, Dimension, PlannedRun, STARTING_POINTS, Sampler, SweepError, SweptTask, TriedPoint, combinations,
    plan, propose,
};
use results::{SweepAxis, SweepHalving, SweepManifest, SweepSampler, SweepSearch};
use seed::Seed;
use settings::Document;
use std::path::Path;

/// Configuration with the keys that are varied.
pub(super) struct Study {
    /// Text of the configuration file.
    pub(super) text: String,
    document: Document,
    varied: Varied,
}

enum Varied {
    /// All combinations of values.
    Axes(Vec<Axis>),
    /// Points of a space.
    Space { dimensions: Vec<Dimension>, sampler: Sampler, seed: Seed },
}

impl Study {
    /// Builds the study that a command line asks for.
    pub(super) fn of_arguments(arguments: &SweepArguments, config: &Path) -> Result<Self, TrainerError> {
        let (text, mut document) = read_with_text(config)?;
        if let Some(seed) = arguments.run.seed {
            document.apply_override(&format!("seed={seed}"))?;
        }
        let Some(sampler) = arguments.search.search else {
            let axes = arguments.axes.iter().map(|argument| Axis::parse(argument));
            let axes = axes.collect::<Result<_, _>>().map_err(SweepCommandError::Plan)?;
            return Ok(Self { text, document, varied: Varied::Axes(axes) });
        };
        let dimensions = space(&mut document, &arguments.axes).map_err(SweepCommandError::Plan)?;
        if dimensions.is_empty() {
            return Err(SweepCommandError::NoSpace.into());
        }
        let seed = Seed::new(seed_of(&document));
        Ok(Self { text, document, varied: Varied::Space { dimensions, sampler: sampler.into(), seed } })
    }

    /// Rebuilds the study that a manifest describes; its configuration is read again.
    fn of_manifest(manifest: &SweepManifest, search: &SweepSearch) -> Result<Self, TrainerError> {
        let (text, mut document) = read_with_text(Path::new(&manifest.config))?;
        document.apply_override(&format!("seed={}", search.seed))?;
        Dimension::taken_from(&mut document).map_err(SweepCommandError::Plan)?;
        let dimension = |axis: &SweepAxis| {
            Dimension::from_described(&axis.key, &axis.values, axis.scale.as_deref())
                .ok_or_else(|| SweepError::NoAxis { argument: axis.key.clone() })
        };
        let dimensions = manifest.axes.iter().map(dimension);
        let dimensions = dimensions.collect::<Result<_, _>>().map_err(SweepCommandError::Plan)?;
        let varied = Varied::Space { dimensions, sampler: Sampler::Tpe, seed: Seed::new(search.seed) };
        Ok(Self { text, document, varied })
    }

    /// Returns the start of the sweep folder's name.
    pub(super) fn name(&self, config: &Path) -> String {
        let stem = config.file_stem().unwrap_or_default().to_string_lossy();
        let name = self.document.get("name").and_then(|leaf| leaf.value.as_str()).unwrap_or(&stem);
        let what = if matches!(self.varied, Varied::Space { .. }) { "search" } else { "sweep" };
        format!("{name}-{what}")
    }

    /// Returns the varied keys in the form of the manifest.
    pub(super) fn axes(&self) -> Vec<SweepAxis> {
        let described = |dimension: &Dimension| {
            let (values, scale) = dimension.described();
            SweepAxis { key: dimension.key.clone(), values, scale: scale.map(str::to_owned) }
        };
        match &self.varied {
            Varied::Axes(axes) => axes
                .iter()
                .map(|axis| SweepAxis { key: axis.key.clone(), values: axis.values.clone(), scale: None })
                .collect(),
            Varied::Space { dimensions, .. } => dimensions.iter().map(described).collect(),
        }
    }

    /// Plans the runs that are known before any is made.
    pub(super) fn first_runs(&self, trials: usize) -> Result<Vec<PlannedRun>, SweepCommandError> {
        match &self.varied {
            Varied::Axes(axes) => Ok(plan(&self.document, combinations(axes)?, 1, &registries())?),
            Varied::Space { sampler: Sampler::Random, .. } => self.next_runs(&[], trials),
            Varied::Space { sampler: Sampler::Tpe, .. } => self.next_runs(&[], trials.min(STARTING_POINTS)),
        }
    }

    /// Plans the runs that follow those already tried.
    fn next_runs(&self, tried: &[TriedPoint], count: usize) -> Result<Vec<PlannedRun>, SweepCommandError> {
        let Varied::Space { dimensions, sampler, seed } = &self.varied else { return Ok(Vec::new()) };
        let points = propose(dimensions, *sampler, seed, tried, count)?;
        Ok(plan(&self.document, points, tried.len() + 1, &registries())?)
    }

    /// Returns the settings of the search; `None` if the study is no search.
    pub(super) fn search(
        &self,
        arguments: &SweepArguments,
        runs: &[PlannedRun],
    ) -> Result<Option<SweepSearch>, TrainerError> {
        let asked = &arguments.search;
        let Some(first) = runs.first().filter(|_| asked.is_one()) else { return Ok(None) };
        let named = asked.minimize.as_ref().or(asked.maximize.as_ref());
        let measure = named.cloned().unwrap_or_else(|| default_measure(first.task).to_owned());
        let (sampler, trials) = match &self.varied {
            Varied::Axes(_) => (SweepSampler::Grid, runs.len()),
            Varied::Space { sampler: Sampler::Random, .. } => (SweepSampler::Random, asked.trials()),
            Varied::Space { sampler: Sampler::Tpe, .. } => (SweepSampler::Tpe, asked.trials()),
        };
        let halving = asked.halving.map(|first_steps| SweepHalving {
            first_steps,
            keep_one_in: usize::from(asked.keep_one_in),
            rungs: Vec::new(),
        });
        if halving.is_some() {
            if sampler.looks_at_results() {
                return Err(SweepCommandError::HalvedTpe.into());
            }
            if first.task == SweptTask::Compare {
                return Err(SweepCommandError::HalvedCompare.into());
            }
            if first.task == SweptTask::Learn && measure.split('.').any(|part| part == "test") {
                return Err(SweepCommandError::HalvedTest { measure }.into());
            }
        }
        let seed = seed_of(&self.document);
        let (batch, maximize) = (usize::from(asked.batch), asked.maximize.is_some());
        Ok(Some(SweepSearch { sampler, trials, batch, seed, measure, maximize, halving }))
    }
}

/// Plans the runs that a search proposes next, from the costs of the earlier ones.
///
/// The configuration is read again from its file; its first runs must have the digests of the manifest.
pub(super) fn proposed(
    manifest: &SweepManifest,
    search: &SweepSearch,
    costs: &[Option<f64>],
) -> Result<Vec<PlannedRun>, TrainerError> {
    let study = Study::of_manifest(manifest, search)?;
    let first = study.first_runs(search.trials)?;
    if let Some((line, _)) =
        manifest.runs.iter().zip(&first).find(|(line, planned)| line.digest != planned.digest)
    {
        let (file, digest) = (manifest.config.clone(), line.digest.clone());
        return Err(SweepCommandError::Lost { file, digest }.into());
    }
    let tried = manifest.runs.iter().zip(costs);
    let tried: Vec<TriedPoint> =
        tried.map(|(line, cost)| TriedPoint { overrides: line.overrides.clone(), cost: *cost }).collect();
    let count = search.batch.min(search.trials.saturating_sub(tried.len()));
    Ok(study.next_runs(&tried, count)?)
}

/// Builds the search space from a study file and a command line, which overrides the file key by key.
fn space(document: &mut Document, arguments: &[String]) -> Result<Vec<Dimension>, SweepError> {
    let own: Vec<Dimension> =
        arguments.iter().map(|argument| Dimension::parse(argument)).collect::<Result<_, _>>()?;
    for (at, dimension) in own.iter().enumerate() {
        if own.iter().take(at).any(|other| other.key == dimension.key) {
            return Err(SweepError::RepeatedKey { key: dimension.key.clone() });
        }
    }
    let mut dimensions = Dimension::taken_from(document)?;
    dimensions.retain(|dimension| own.iter().all(|other| other.key != dimension.key));
    dimensions.extend(own);
    Ok(dimensions)
}

/// Returns the seed in force.
fn seed_of(document: &Document) -> u64 {
    let seed = document.get("seed").and_then(|leaf| leaf.value.as_integer());
    seed.and_then(|seed| u64::try_from(seed).ok()).unwrap_or_default()
}
