//! Learning of dynamics from records, scored on records that were not used for training.

use crate::error::Error;
use crate::nominal::Nominal;
use crate::record::Record;
use estimator::Cancel;
use experiment::{LearnStudy, LearningProblem, resolve_learning};
use learn::data::{Making, Trajectory};
use learn::learners::LEARNERS;
use learn::{Learner, Step};
use rayon::prelude::*;
use record::Origin;
use results::{LearnKind, LearnResult, RESULT_SCHEMA};
use seed::Seed;
use settings::Document;
use std::path::Path;
use std::time::Instant;
use workflow::learning::{
    Method, Ready, ablation_rows, check_record, described, method_of, methods, row, sort, trajectory, tried,
};

/// Options of a learning run, with the defaults of the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnOptions {
    /// Names of the learners; `None` for all.
    pub learners: Option<Vec<String>>,
    /// Names of the baselines; `None` for all.
    pub baselines: Option<Vec<String>>,
    /// Name of the data set; the seeds of the learners depend on it.
    pub name: String,
    /// Root seed of all random draws.
    pub seed: u64,
    /// Limit on the steps of every fit; `None` for the learners' own limits.
    pub max_steps: Option<u64>,
    /// `true` to score each learner's model twice more: with everything it learned at zero, and with noise as
    /// its input.
    pub ablations: bool,
    /// Keys of the data set as lines of TOML, such as `split = "time"`.
    pub data: String,
    /// Sections of the learners as TOML, such as `[neural-ode]` with its keys.
    pub settings: String,
}

impl Default for LearnOptions {
    fn default() -> Self {
        Self {
            learners: None,
            baselines: None,
            name: "records".to_owned(),
            seed: 0,
            max_steps: None,
            ablations: true,
            data: String::new(),
            settings: String::new(),
        }
    }
}

/// A custom learner with its name.
pub struct OwnLearner<'a> {
    /// Identifier in results.
    pub id: &'a str,
    /// The learner itself.
    pub learner: &'a dyn Learner,
}

/// Learns the dynamics from records with the requested learners and with the custom ones in `own`. Scores
/// each of them and the baselines on held-out records, the best first.
///
/// `observe` is called after each step with the name of the method. A request to stop ends the fits in
/// progress.
///
/// # Errors
/// [`Error::Config`] for unknown learners or settings, [`Error::Learn`] for records that nothing can be
/// learned from.
///
/// ```
/// use ringdown_lab::{LearnOptions, Nominal, Simulation, learn};
/// use ringdown_lab::contract::Cancel;
///
/// let pendulum = Nominal::swinging(1.0, 0.01)?;
/// let run = |position: f64| Simulation::of(&pendulum).released_at(position).noise(1e-3).sampled(50.0, 20.0).run();
/// let records = [run(0.3)?, run(0.5)?, run(0.4)?];
/// let options = LearnOptions {
///     learners: Some(vec!["sindy".to_owned()]),
///     baselines: Some(vec!["persistence".to_owned()]),
///     ..LearnOptions::default()
/// };
/// let told = learn(&records, None, &options, &[], &Cancel::new(), &|_, _| ())?;
/// assert_eq!(told.results[0].id, "sindy");
/// # Ok::<(), ringdown_lab::Error>(())
/// ```
pub fn learn(
    records: &[Record],
    nominal: Option<&Nominal>,
    options: &LearnOptions,
    own: &[OwnLearner<'_>],
    cancel: &Cancel,
    observe: &(dyn Fn(&str, &Step) + Sync),
) -> Result<LearnResult, Error> {
    let start = Instant::now();
    let study = study(options)?;
    let problem = study.problems.first().ok_or_else(|| Error::Config("there is no data set".to_owned()))?;
    let ready = data_set(records, nominal, problem)?;
    let mut asked = methods(&study.settings, &study.resolved)?;
    asked.retain(|method| method.kind != LearnKind::Reference);
    asked.extend(own.iter().map(|own| method_of(own.id, own.id, own.learner)));
    let root = Seed::new(study.seed).child("learn").child(&problem.id);
    let each = |method: &Method<'_>| {
        let seed = root.child(method.id);
        let steps = |step: &Step| observe(method.id, step);
        let found = tried(&ready, method, seed.clone(), study.settings.max_steps, cancel, &steps);
        let ablated = match study.settings.ablations {
            true => ablation_rows(&problem.id, &ready, method, &found, &seed),
            false => Vec::new(),
        };
        [vec![row(&problem.id, &ready, method, &found, None, None)], ablated].concat()
    };
    let mut rows: Vec<_> = asked.par_iter().flat_map_iter(each).collect();
    sort(&mut rows);
    let told = described(&problem.id, &problem.title, origin(records), Ok(&ready));
    Ok(LearnResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "learn".to_owned(),
        seed: study.seed,
        data: told.data,
        problems: vec![told],
        results: rows,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Returns the configuration that the command line would run.
fn study(options: &LearnOptions) -> Result<LearnStudy, Error> {
    let text = |value: &str| toml::Value::String(value.to_owned()).to_string();
    let names = |key: &str, names: &Option<Vec<String>>| {
        names.as_ref().map_or_else(String::new, |names| {
            let names: Vec<String> = names.iter().map(|name| text(name)).collect();
            format!("{key} = [{}]\n", names.join(", "))
        })
    };
    let cap = options.max_steps.map_or_else(String::new, |cap| format!("max_steps = {cap}\n"));
    let configuration = format!(
        "task = \"learn\"\nseed = {}\n[learn]\nablations = {}\n{}{}{cap}[problem.{}]\nfolder = \".\"\nrecords = [\"*\"]\n{}\n{}\n",
        options.seed,
        options.ablations,
        names("learners", &options.learners),
        names("baselines", &options.baselines),
        text(&options.name),
        options.data,
        options.settings,
    );
    Ok(resolve_learning(&Document::parse("options", &configuration)?, LEARNERS)?)
}

fn data_set(
    records: &[Record],
    nominal: Option<&Nominal>,
    problem: &LearningProblem,
) -> Result<Ready, Error> {
    let mut first = None;
    let (mut trajectories, mut missing): (Vec<Trajectory>, Vec<String>) = (Vec::new(), Vec::new());
    for record in records {
        let name = Path::new(record.name()).file_stem().unwrap_or_default().to_string_lossy();
        check_record(&name, &record.loaded.record, &mut first)?;
        let told = record.loaded.source.reading.missing_in_words();
        missing.extend(told.map(|words| format!("{name}: {words}")));
        let clock = record.clock()?;
        trajectories.push(trajectory(problem, &name, &record.loaded.record, &clock.times_s)?);
    }
    // Without a record there is no data set, which is refused below.
    let rate_hz = trajectories.first().map_or(0.0, Trajectory::rate_hz);
    let making = Making {
        unit: first.map_or("rad", |(_, unit)| unit).to_owned(),
        nominal: nominal.map(|nominal| nominal.stated.simulator.clone()),
        ..problem.making(rate_hz)
    };
    Ok(Ready {
        data: learn::data_set(&trajectories, making)?,
        records: trajectories.len(),
        missing,
        truth: None,
        parts: Vec::new(),
    })
}

/// Returns the origin that all records share, or unstated where they differ.
fn origin(records: &[Record]) -> Origin {
    let stated = |record: &Record| record.loaded.origin.or(record.loaded.source.statements.origin);
    // A record that states nothing has the origin "unstated".
    Origin::shared(records.iter().map(|record| stated(record).unwrap_or_default()))
}
