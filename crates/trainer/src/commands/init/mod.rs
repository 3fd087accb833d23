//! `trainer init`: a first look at a log, and the files to start from.

use crate::commands::diagnose::arguments::Reading;
use crate::error::TrainerError;
use crate::options::Output;
use crate::outcome::Outcome;
use crate::own_program::own_program;
use crate::terminal::table::table;
use clap::Args;
use dynamics::Coordinate;
use identify::{Estimated, LinearOscillator, identify};
use record::{Look, ReadOptions, look};
use runs::{RunError, RunFolder};
use serde_json::{Value, json};
use std::path::{Component, Path, PathBuf};
use workflow::guess as files;
use workflow::read::{bias, centered, coordinate_of};
use workflow::{WorkflowError, in_options};

/// A look at a log: columns, units, rate, clock, swing; writes nominal.toml and a configuration to start from.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer init log.csv                         writes log/nominal.toml and log/estimate.toml
  trainer init log.csv --out RIG               the same into RIG
  trainer init arm.csv --where joint=elbow     one of several series in a file
  trainer init log.csv --value phi --unit deg  where the file does not say it

It prints the `trainer diagnose` command to continue with. Nothing that exists is overwritten.")]
pub(crate) struct InitArguments {
    /// The log: any text file with columns
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// Folder for nominal.toml and estimate.toml: new or empty [default: the log's name without its ending]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
}

/// What was found, and what comes of it.
struct Found {
    look: Look,
    oscillator: LinearOscillator,
    coordinate: Coordinate,
    folder: PathBuf,
    /// Names of the files with their texts.
    files: Vec<(&'static str, String)>,
    /// What each command does, and the command.
    next: Vec<(&'static str, String)>,
}

/// Looks at a log, writes the files and says what it found.
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
    let InitArguments { log, out, reading, .. } = arguments;
    let folder = out.clone().unwrap_or_else(|| PathBuf::from(log.file_stem().unwrap_or_default()));
    if out.is_none() && folder == *log {
        let log = log.display().to_string();
        return Err(TrainerError::NoFolder { log });
    }
    RunFolder::check_free(&folder).map_err(|error| match error {
        RunError::Occupied { path } => TrainerError::InitOccupied { folder: path.display().to_string() },
        other => other.into(),
    })?;
    // An input that stands in the file drives the system, whatever its name.
    let options = ReadOptions { driven: true, ..reading.plain().options };
    let mut look = look(log, &options).map_err(WorkflowError::Record)?;
    let name = log.display().to_string();
    if reading.remove_mean {
        look.record = centered(&look.record).map_err(|fault| WorkflowError::Record(fault.in_file(&name)))?;
    }
    let oscillator = identify(&look.record, &look.clock)
        .map_err(|source| WorkflowError::Identify { file: name.clone(), source })?;
    let coordinate = coordinate_of(look.source.reading.coordinate);
    let mut files = vec![("nominal.toml", files::nominal_toml(&name, &oscillator, coordinate))];
    let nominal = folder.join("nominal.toml");
    let mut next = vec![(
        "what a linear oscillator with these numbers lacks",
        format!(
            "trainer diagnose {} --nominal {}{}{}",
            word(&name),
            path_word(&nominal),
            given(reading),
            bias(&look.record).map_or("", |_| " --remove-mean")
        ),
    )];
    // Only a free decay has an envelope to estimate a damping ratio from.
    if oscillator.input_gain.is_none() {
        let path = path_from(&folder, log).display().to_string();
        files.push(("estimate.toml", files::configuration(&path, &look.source.reading.options())));
        next.push((
            "the damping ratio from the decay of the peaks",
            format!("trainer {}", path_word(&folder.join("estimate.toml"))),
        ));
    }
    Ok(Found { look, oscillator, coordinate, folder, files, next })
}

impl Found {
    fn json(&self) -> Value {
        let number = |estimated: Option<Estimated>| {
            estimated.map(|found| json!({ "value": found.value, "std_error": found.std_error }))
        };
        let columns = self.look.columns.iter().map(|column| {
            json!({
                "title": column.title, "unit": column.unit, "role": column.role, "holds": column.holds,
                "because": column.because,
            })
        });
        json!({
            "record": {
                "path": self.look.source.path,
                "digest": self.look.source.digest,
                "samples": self.look.record.len(),
                "duration_s": self.duration_s(),
                "sample_rate_hz": self.look.clock.sample_rate_hz,
                "clock": self.look.clock.kind.name(),
                "clock_reason": self.look.clock.reason,
                "columns": columns.collect::<Vec<_>>(),
                "reading": self.look.source.reading,
                "findings": self.findings(),
            },
            "oscillator": {
                "coordinate": files::name(self.coordinate),
                "natural_frequency_hz": number(self.oscillator.natural_frequency_hz()),
                "damping_ratio": number(self.oscillator.damping_ratio()),
                "damping_per_inertia": number(Some(self.oscillator.damping)),
                "rest": number(self.oscillator.rest),
                "input_gain_per_inertia": number(self.oscillator.input_gain),
                "basis": files::basis(&self.oscillator),
            },
            "files": self.files.iter().map(|(name, _)| self.folder.join(name)).collect::<Vec<_>>(),
            "next": self.next.iter().map(|(_, command)| command).collect::<Vec<_>>(),
        })
    }

    fn summary(&self) -> String {
        let (record, clock) = (&self.look.record, &self.look.clock);
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let mut rows = vec![
            row("reading", self.look.source.reading.sentence.clone()),
            row(
                "samples",
                format!("{} in {:.3} s, {:.2} Hz", record.len(), self.duration_s(), clock.sample_rate_hz),
            ),
            row("clock", format!("{}: {}", clock.kind.name(), clock.reason)),
        ];
        match (self.oscillator.natural_frequency_hz(), self.oscillator.damping_ratio()) {
            (Some(frequency), Some(ratio)) => {
                rows.push(row("natural frequency", format!("{} Hz, undamped", uncertain(frequency))));
                rows.push(row("damping ratio", uncertain(ratio)));
            }
            _ => rows
                .push(row("natural frequency", "none: nothing pulls it back to a rest position".to_owned())),
        }
        rows.push(row("", files::basis(&self.oscillator)));
        rows.extend(self.findings().into_iter().map(|finding| row("note", finding)));
        let written = self.files.iter().map(|(name, _)| path_word(&self.folder.join(name)));
        let next: Vec<String> =
            self.next.iter().map(|(what, command)| format!("  {command}\n      {what}")).collect();
        format!(
            "{}\n\n{}\n\nwrote {}\n\nnext{}:\n{}",
            self.look.source.path,
            table(&[], rows),
            written.collect::<Vec<_>>().join(" and "),
            if is_built_here() { " (for trainer, type cargo run -p trainer --)" } else { "" },
            next.join("\n")
        )
    }

    fn duration_s(&self) -> f64 {
        let times = &self.look.clock.times_s;
        times.first().zip(times.last()).map_or(0.0, |(first, last)| last - first)
    }

    fn findings(&self) -> Vec<String> {
        let read = self.look.source.findings.iter().map(|finding| in_options(finding));
        read.chain(bias(&self.look.record)).collect()
    }
}

/// Whether the program runs from the folder that cargo builds into, where no shell finds it by its name.
fn is_built_here() -> bool {
    let program = own_program().unwrap_or_default();
    program.ancestors().skip(1).take(2).any(|folder| folder.ends_with("target"))
}

fn uncertain(estimated: Estimated) -> String {
    format!("{} ± {} (standard error)", files::digits(estimated), files::error(estimated))
}

/// The reading options that were given, as the diagnosis takes them.
fn given(reading: &Reading) -> String {
    let stated = serde_json::to_value(reading).unwrap_or_default();
    let usual = serde_json::to_value(Reading::default()).unwrap_or_default();
    let Value::Object(stated) = stated else { return String::new() };
    let changed = stated.iter().filter(|(key, value)| usual.get(key.as_str()) != Some(value));
    let option = |(key, value): (&String, &Value)| {
        let name = if key == "filter" { "where".to_owned() } else { key.replace('_', "-") };
        match value {
            Value::Bool(_) => format!(" --{name}"),
            Value::String(text) => {
                format!(" --{name} {}", word(text))
            }
            other => format!(" --{name} {other}"),
        }
    };
    changed.map(option).collect()
}

/// A word as a shell reads it back.
fn word(text: &str) -> String {
    let plain = |sign: char| sign.is_alphanumeric() || "-_./=:,+%@".contains(sign);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

fn path_word(path: &Path) -> String {
    word(&path.display().to_string())
}

/// The way to a file from a folder; absolute where the folder is not plainly below the working directory.
fn path_from(folder: &Path, file: &Path) -> PathBuf {
    if file.is_absolute() {
        return file.to_owned();
    }
    let below = folder.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !below {
        return std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    }
    let depth = folder.components().filter(|part| matches!(part, Component::Normal(_))).count();
    std::iter::repeat_n("..", depth).collect::<PathBuf>().join(file)
}

#[cfg(test)]
mod tests {
    use super::{given, path_from, word};
    use crate::commands::diagnose::arguments::Reading;
    use std::path::{Path, PathBuf};

    #[test]
    fn options_that_were_given_are_given_again() {
        let reading = Reading {
            value: Some("phi 2".to_owned()),
            filter: Some("joint=elbow".to_owned()),
            remove_mean: true,
            sample_rate: Some(50.0),
            ..Reading::default()
        };
        assert_eq!(given(&Reading::default()), "");
        assert_eq!(given(&reading), " --value 'phi 2' --where joint=elbow --sample-rate 50.0 --remove-mean");
    }

    #[test]
    fn words_are_safe_in_a_shell() {
        assert_eq!(word("a/b.csv"), "a/b.csv");
        assert_eq!(word("it's $5"), r"'it'\''s $5'");
    }

    #[test]
    fn the_way_back_to_the_log_is_found() {
        assert_eq!(path_from(Path::new("rig/a"), Path::new("logs/x.csv")), PathBuf::from("../../logs/x.csv"));
        assert!(path_from(Path::new("../rig"), Path::new("x.csv")).is_absolute());
    }
}
