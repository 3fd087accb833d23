//! `trainer init`: a first look at a log, and files to start from.

mod modes;
mod shell;
mod tried;

use crate::commands::diagnose::arguments::Reading;
use crate::error::TrainerError;
use crate::options::Output;
use crate::outcome::Outcome;
use crate::own_program::own_program;
use crate::terminal::table::table;
use clap::Args;
use envelope::Envelope;
use identify::Estimated;
use modes::uncertain;
use record::Fault;
use report::format::significant;
use runs::{RunError, RunFolder};
use serde_json::{Value, json};
use shell::{given, path_from, path_word};
use std::path::{Path, PathBuf};
use workflow::guess as files;
use workflow::look::Looked;
use workflow::read::bias;
use workflow::{Log, WorkflowError};

/// Inspects a log: columns, units, rate, clock, swing; writes nominal.toml and a configuration to start from.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer init log.csv                         writes log/nominal.toml and log/estimate.toml
  trainer init log.csv --out RIG               the same into RIG
  trainer init arm.csv --where joint=elbow     one of several series in a file
  trainer init log.csv --value phi --unit deg  where the file does not say it
  trainer init LOGS                            every log in a folder, as records of one system: the surest of
                                               them gives LOGS-nominal/nominal.toml

It prints the `trainer diagnose` command to continue with. Nothing that exists is overwritten.")]
pub(crate) struct InitArguments {
    /// The log: any text file with columns, or a folder of logs of one system
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// Folder for nominal.toml and estimate.toml: new or empty [default: the log's name without its ending;
    /// LOGS-nominal for a folder]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
}

/// Findings in the logs, with the files and commands that follow from them.
struct Found {
    /// Log whose oscillator is written: the one with the smallest standard error of the damping.
    surest: Looked,
    /// Options that read it in the same way: those given, and `none` for an input that the motion does not follow.
    reading: Reading,
    /// Frequency and damping of each log; empty for a single log.
    each: Vec<EachLog>,
    folder: PathBuf,
    /// Envelope that the estimate would be fitted to, if there is one.
    envelope: Option<Envelope>,
    /// Refusals of the commands that were tried.
    tried: Vec<String>,
    /// Names of the files with their texts.
    files: Vec<(&'static str, String)>,
    /// Purpose of each suggested command, and the command.
    next: Vec<(&'static str, String)>,
}

/// Findings in one of several logs.
struct EachLog {
    path: String,
    samples: usize,
    natural_frequency_hz: Option<Estimated>,
    damping_ratio: Option<Estimated>,
}

/// Inspects a log, writes the files and reports the findings.
pub(crate) fn command(arguments: &InitArguments) -> Result<Outcome, TrainerError> {
    let found = find(arguments)?;
    let folder = RunFolder::create_at(&found.folder)?;
    for (name, text) in &found.files {
        folder.write(name, text.as_bytes())?;
    }
    arguments.output.print(&found.json(), || found.summary())?;
    Ok(Outcome::Done)
}

fn find(arguments: &InitArguments) -> Result<Found, TrainerError> {
    let InitArguments { log, out, .. } = arguments;
    let logs = Log::read(log)?;
    let folder = out.clone().unwrap_or_else(|| folder_of(log));
    RunFolder::check_free(&folder).map_err(|error| match error {
        RunError::Occupied { path } => TrainerError::InitOccupied { folder: path.display().to_string() },
        other => other.into(),
    })?;
    let plain = arguments.reading.plain();
    let mut looked = logs.iter().map(|log| Looked::of(log, &plain)).collect::<Result<Vec<_>, _>>()?;
    let each = if looked.len() > 1 { looked.iter().map(EachLog::of).collect() } else { Vec::new() };
    let bias = looked.iter().any(|looked| bias(&looked.look.record).is_some());
    let by_error = |one: &Looked, other: &Looked| {
        one.oscillator.damping.std_error.total_cmp(&other.oscillator.damping.std_error)
    };
    looked.sort_by(by_error);
    // A folder without logs was refused above.
    let none = || WorkflowError::Record(Fault::Folder.in_file(&log.display().to_string()));
    let mut surest = looked.into_iter().next().ok_or_else(none)?;
    surest.look.source.findings.extend(logs.first().and_then(|first| first.note.clone()));
    let (files, next, tried) = (Vec::new(), Vec::new(), Vec::new());
    let mut reading = arguments.reading.clone();
    if surest.without_input {
        reading.input = Some("none".to_owned());
    }
    let found = Found { surest, reading, each, folder, envelope: None, tried, files, next };
    Ok(found.with_diagnosis(log, bias).with_estimate())
}

/// Returns the keys of a configuration that reads a log in the same way.
fn options(looked: &Looked, reading: &Reading) -> Vec<(&'static str, String)> {
    let mut options = looked.look.source.reading.options();
    let Reading { clock, input, .. } = reading;
    options.extend((*clock != Reading::default().clock).then(|| ("clock", clock.clone())));
    // A column that is left out on purpose would be found again.
    options
        .extend(input.clone().filter(|_| looked.look.record.input().is_none()).map(|none| ("input", none)));
    options
}

/// Returns the folder for the files of a log: its name without its extension, or its name with `-nominal`
/// appended if the log is a folder or has no extension to remove.
fn folder_of(log: &Path) -> PathBuf {
    let stem = PathBuf::from(log.file_stem().unwrap_or_default());
    let absolute = std::path::absolute(log).unwrap_or_else(|_| log.to_owned());
    if log.is_file() && stem != *log {
        return stem;
    }
    let name = absolute.file_name().unwrap_or_default().to_string_lossy().into_owned();
    PathBuf::from(format!("{name}-nominal"))
}

impl EachLog {
    fn of(looked: &Looked) -> Self {
        Self {
            path: looked.look.source.path.clone(),
            samples: looked.look.record.len(),
            natural_frequency_hz: looked.oscillator.natural_frequency_hz(),
            damping_ratio: looked.oscillator.damping_ratio(),
        }
    }
}

/// Ratio of the frequencies of two logs above which they probably do not belong to one system.
const ANOTHER_SYSTEM: f64 = 1.5;

/// Returns a warning if the logs of a folder swing at frequencies that one system hardly has.
fn apart(each: &[EachLog]) -> Option<String> {
    let mut swinging: Vec<(f64, &str)> =
        each.iter().filter_map(|log| Some((log.natural_frequency_hz?.value, log.path.as_str()))).collect();
    swinging.sort_by(|one, other| one.0.total_cmp(&other.0));
    let ((slow, slowest), (fast, fastest)) = swinging.first().zip(swinging.last())?;
    (*fast > ANOTHER_SYSTEM * slow).then(|| {
        let [slow, fast] = [slow, fast].map(|frequency| significant(*frequency, 3));
        format!(
            "{slowest} swings at {slow} Hz and {fastest} at {fast} Hz, too far apart for records of one \
             system: diagnose each system separately"
        )
    })
}

impl Found {
    /// Adds `nominal.toml`, and the diagnosis with it or its refusal.
    fn with_diagnosis(mut self, log: &Path, bias: bool) -> Self {
        let (Looked { look, oscillator, .. }, reading) = (&self.surest, &self.reading);
        let file = self.folder.join("nominal.toml");
        let text = files::nominal_toml(&look.source.path, oscillator, &look.source.reading);
        if self.surest.is_diagnosable() {
            let reading = Reading { remove_mean: bias || reading.remove_mean, ..reading.clone() };
            match tried::diagnosis(log, (&file, &text), &reading.plain()) {
                Ok(()) => self.next.push((
                    "what a linear oscillator with these numbers lacks",
                    format!(
                        "trainer diagnose {} --nominal {}{}",
                        path_word(log),
                        path_word(&file),
                        given(&reading)
                    ),
                )),
                Err(refusal) => self.tried.push(format!("a diagnosis would refuse this record: {refusal}")),
            }
        }
        self.files.push(("nominal.toml", text));
        self
    }

    /// Adds `estimate.toml` and the estimate with it, or its refusal. Only a free decay has an envelope from which a
    /// damping ratio can be estimated.
    fn with_estimate(mut self) -> Self {
        let path = Path::new(&self.surest.look.source.path);
        if self.surest.oscillator.input_gain.is_some() {
            return self;
        }
        let file = self.folder.join("estimate.toml");
        let configuration = |path: &Path| {
            files::configuration(&path.display().to_string(), &options(&self.surest, &self.reading))
        };
        // The folder is not there yet, and a path out of it leads nowhere.
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        match tried::estimate(&file, &configuration(&absolute)) {
            Ok(found) => {
                let what = match found.because {
                    Some(_) => "the damping ratio from the samples",
                    None => "the damping ratio from the decay of the peaks",
                };
                let text = configuration(&path_from(&self.folder, path));
                self.files.push(("estimate.toml", text));
                self.next.push((what, format!("trainer {}", path_word(&file))));
                self.envelope = Some(found.envelope);
            }
            // A motion without a swing has its own remark.
            Err(refusal) if self.surest.swings() => {
                self.tried.push(format!("an estimate would refuse this record: {refusal}"));
            }
            Err(_) => {}
        }
        self
    }

    fn json(&self) -> Value {
        let number = |estimated: Option<Estimated>| {
            estimated.map(|found| json!({ "value": found.value, "std_error": found.std_error }))
        };
        let mut found = self.surest.json(&self.findings());
        let more = json!({
            "logs": self.each.iter().map(|log| json!({
                "path": log.path, "samples": log.samples,
                "natural_frequency_hz": number(log.natural_frequency_hz), "damping_ratio": number(log.damping_ratio),
            })).collect::<Vec<_>>(),
            "files": self.files.iter().map(|(name, _)| self.folder.join(name)).collect::<Vec<_>>(),
            "next": self.next.iter().map(|(_, command)| command).collect::<Vec<_>>(),
        });
        if let (Value::Object(found), Value::Object(more)) = (&mut found, more) {
            found.extend(more);
        }
        found
    }

    fn summary(&self) -> String {
        let (record, clock) = (&self.surest.look.record, &self.surest.look.clock);
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let mut rows = vec![
            row("reading", self.surest.look.source.reading.sentence.clone()),
            row(
                "samples",
                format!(
                    "{} in {:.3} s, {:.2} Hz",
                    record.len(),
                    self.surest.duration_s(),
                    clock.sample_rate_hz
                ),
            ),
            row("clock", format!("{}: {}", clock.kind.name(), clock.reason)),
        ];
        match (self.surest.oscillator.natural_frequency_hz(), self.surest.oscillator.damping_ratio()) {
            (Some(frequency), Some(ratio)) => {
                rows.push(row("natural frequency, Hz", format!("{}, undamped", uncertain(frequency))));
                rows.push(row("damping ratio", uncertain(ratio)));
                rows.extend(self.surest.resonance().iter().flat_map(modes::sharpness));
            }
            _ => rows
                .push(row("natural frequency", "none: nothing pulls it back to a rest position".to_owned())),
        }
        rows.push(row("", files::basis(&self.surest.oscillator)));
        rows.extend(modes::rows(&self.surest.modes));
        rows.extend(self.findings().into_iter().map(|finding| row("note", finding)));
        let written = self.files.iter().map(|(name, _)| path_word(&self.folder.join(name)));
        let next: Vec<String> =
            self.next.iter().map(|(what, command)| format!("  {command}\n      {what}")).collect();
        format!(
            "{}{}\n\n{}\n\nwrote {}\n\n{}",
            self.of_each(),
            self.surest.look.source.path,
            table(&[], rows),
            written.collect::<Vec<_>>().join(" and "),
            self.next_said(&next)
        )
    }

    fn next_said(&self, next: &[String]) -> String {
        if next.is_empty() {
            return "next: neither a diagnosis nor an estimate can take this record; give a longer one, or another part of it \
                    with --from and --to"
                .to_owned();
        }
        let built = if is_built_here() { " (for trainer, type cargo run -p trainer --)" } else { "" };
        format!("next{built}:\n{}", next.join("\n"))
    }

    /// Formats a table of the logs, if there are several, with a lead-in to the log that the rest is about.
    fn of_each(&self) -> String {
        if self.each.is_empty() {
            return String::new();
        }
        let told = |found: Option<Estimated>| found.map_or_else(String::new, uncertain);
        let rows = self.each.iter().map(|log| {
            vec![
                log.path.clone(),
                log.samples.to_string(),
                told(log.natural_frequency_hz),
                told(log.damping_ratio),
            ]
        });
        let heads = ["log", "samples", "natural frequency, Hz", "damping ratio"];
        format!("{}\n\nthe most certain of them: ", table(&heads, rows.collect()))
    }

    fn findings(&self) -> Vec<String> {
        let found = self.surest.findings().into_iter().chain(apart(&self.each));
        found.chain(self.surest.remarks(self.envelope.as_ref())).chain(self.tried.clone()).collect()
    }
}

/// Returns `true` if the program runs from cargo's build folder, where no shell finds it by its name.
fn is_built_here() -> bool {
    let program = own_program().unwrap_or_default();
    program.ancestors().skip(1).take(2).any(|folder| folder.ends_with("target"))
}
