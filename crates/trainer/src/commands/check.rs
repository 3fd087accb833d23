//! `trainer check`: validation of a configuration and its data, without running or writing anything.

use crate::commands::learn::problem;
use crate::configured::{ConfigArguments, Configured, read_document};
use crate::error::TrainerError;
use crate::fits::input;
use crate::fits::method::Method;
use crate::outcome::Outcome;
use crate::terminal::table::table;
use experiment::{Experiment, LearnStudy, PredictionStudy, Single, Task};
use serde::Serialize;
use settings::{Origin, Resolved};
use simulator::Plan;
use trials::TrialPlan;
use workflow::learning::methods;

/// Summary of the run that a configuration asks for.
#[derive(Debug, Serialize)]
struct Checked {
    config: String,
    task: &'static str,
    name: String,
    seed: u64,
    /// Planned work, as labels and texts.
    plan: Vec<Line>,
    values: Values,
}

#[derive(Debug, Serialize)]
struct Line {
    what: String,
    text: String,
}

/// Number of values in force, by their source.
#[derive(Debug, Default, Serialize)]
struct Values {
    file: usize,
    command_line: usize,
    default: usize,
}

fn line(what: impl Into<String>, text: impl Into<String>) -> Line {
    Line { what: what.into(), text: text.into() }
}

/// Checks a configuration and reports the run that it asks for.
pub(crate) fn command(arguments: &ConfigArguments) -> Result<Outcome, TrainerError> {
    let document = read_document(&arguments.config, &arguments.overrides, arguments.seed)?;
    let configured = Configured::resolve(&document)?;
    let (task, name, seed, plan) = match &configured {
        Configured::Experiment(experiment) => {
            let task = match experiment.task {
                Task::Estimate(_) => "estimate",
                Task::Compare(_) => "compare",
            };
            (task, &experiment.name, experiment.seed, fits(experiment)?)
        }
        Configured::Learning(study) => ("learn", &study.name, study.seed, learning(study)?),
        Configured::Prediction(study) => ("predict", &study.name, study.seed, study_of(study)?),
        Configured::Simulation(plan) => {
            ("simulate", &plan.name, plan.seed, simulation(plan, document.file())?)
        }
        Configured::Trials(plan) => ("trials", &plan.name, plan.seed, trials_of(plan)),
    };
    let checked = Checked {
        config: document.file().to_owned(),
        task,
        name: name.clone(),
        seed,
        plan,
        values: values(configured.resolved()),
    };
    arguments.output.print(&checked, || summary(&checked))?;
    Ok(Outcome::Done)
}

fn fits(experiment: &Experiment) -> Result<Vec<Line>, TrainerError> {
    let input = input::read(experiment)?;
    let method = match &experiment.task {
        Task::Estimate(Single::Learned { entry, .. }) => format!("{} ({})", entry.title, entry.id),
        Task::Estimate(Single::Classical(id)) => id.clone(),
        Task::Compare(comparison) => match &comparison.methods {
            Some(methods) => methods.join(", "),
            None => "all of the paper's".to_owned(),
        },
    };
    let data = input.data_summary(experiment.data.statements());
    let envelope = input.envelope_summary();
    let mut lines = vec![
        line("fits", method),
        line("seeds", format!("{}, from {} on", experiment.fit.seeds, experiment.seed)),
        line("record", record(&data.path, data.samples, data.origin, &data.clock)),
        line(
            "envelope",
            format!(
                "{} {} by the {} pipeline, ω = {:.6} rad/s",
                envelope.peaks,
                envelope.counted(),
                envelope.pipeline,
                envelope.omega_rad_s
            ),
        ),
    ];
    lines.extend(data.findings.into_iter().map(|finding| line("remark", finding)));
    Ok(lines)
}

fn study_of(study: &PredictionStudy) -> Result<Vec<Line>, TrainerError> {
    let methods = Method::named(study.settings.methods.as_deref())?;
    if methods.is_empty() || study.problems.is_empty() {
        return Err(TrainerError::NothingToFit);
    }
    let names: Vec<&str> = methods.iter().map(|method| method.id()).collect();
    let mut lines = vec![line("methods", format!("{}: {}", names.len(), names.join(", ")))];
    for problem in &study.problems {
        let text = match studies::prepare(study, problem)? {
            Ok(ready) => match &ready.data {
                Some(data) => record(&data.path, data.samples, data.origin, &data.clock),
                None => format!("simulated, {} draws", ready.envelopes.len()),
            },
            Err(missing) => format!("ABSENT: {}", missing.reason),
        };
        lines.push(line(format!("problem {}", problem.id), text));
    }
    Ok(lines)
}

fn learning(study: &LearnStudy) -> Result<Vec<Line>, TrainerError> {
    let methods = methods(&study.settings, &study.resolved)?;
    let names: Vec<&str> = methods.iter().map(|method| method.id).collect();
    let mut lines = vec![line("methods", format!("{}: {}", names.len(), names.join(", ")))];
    for problem in &study.problems {
        let text = match problem::prepare(problem)?.ready {
            Ok(ready) => {
                let data = &ready.data;
                let parts = (data.train.len(), data.validation.len(), data.test.len());
                format!(
                    "{} records: {} to learn from, {} to choose, {} to test on",
                    ready.records, parts.0, parts.1, parts.2
                )
            }
            Err(reason) => format!("ABSENT: {reason}"),
        };
        lines.push(line(format!("problem {}", problem.id), text));
    }
    Ok(lines)
}

fn simulation(plan: &Plan, file: &str) -> Result<Vec<Line>, TrainerError> {
    plan.record(0, 0).map_err(|source| TrainerError::Generation {
        file: file.to_owned(),
        system: 0,
        record: 0,
        source,
    })?;
    let sampling = plan.sampling();
    let effects: Vec<&str> = plan.effects().map(|effect| effect.id()).collect();
    Ok(vec![
        line("systems", plan.systems.to_string()),
        line("records", format!("{} of each system", plan.records)),
        line("sampling", format!("{} samples at {} Hz", sampling.samples, sampling.rate_hz)),
        line("effects", if effects.is_empty() { "none".to_owned() } else { effects.join(", ") }),
    ])
}

fn trials_of(plan: &TrialPlan) -> Vec<Line> {
    let mut lines = vec![line("diagnoses", format!("{} cases, blind", plan.len()))];
    for left in plan.left_out_banks() {
        let text = format!("LEFT OUT, {} cases: {}", left.cases, left.reason);
        lines.push(line(format!("bank {}", left.bank.name()), text));
    }
    lines
}

fn record(path: &str, samples: usize, origin: record::Origin, clock: &str) -> String {
    format!("{path}: {samples} samples, {}, clock {clock}", origin.name())
}

/// Counts the values in force by their source; keys without a value are not counted.
fn values(resolved: &Resolved) -> Values {
    let mut values = Values::default();
    for setting in resolved.settings().iter().filter(|setting| setting.value.is_some()) {
        match setting.origin {
            Origin::File { .. } => values.file += 1,
            Origin::Override(_) => values.command_line += 1,
            Origin::Default => values.default += 1,
        }
    }
    values
}

fn summary(checked: &Checked) -> String {
    let mut rows: Vec<Vec<String>> =
        checked.plan.iter().map(|line| vec![line.what.clone(), line.text.clone()]).collect();
    let values = &checked.values;
    let counts = format!(
        "{} from files, {} from the command line, {} defaults; trainer explain {} lists them",
        values.file, values.command_line, values.default, checked.config
    );
    rows.push(vec!["values".to_owned(), counts]);
    format!(
        "{}: can run, task {}, name {}, seed {}\n\n{}",
        checked.config,
        checked.task,
        checked.name,
        checked.seed,
        table(&[], rows)
    )
}
