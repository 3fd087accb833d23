//! `trainer init`: a first look at a log, and files to start from.

mod damping;
mod looked;
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
use dynamics::Coordinate;
use identify::{Estimated, regular_part};
use looked::{CRITICAL, Looked, looked};
use modes::uncertain;
use record::Fault;
use report::format::significant;
use runs::{RunError, RunFolder};
use serde_json::{Value, json};
use shell::{given, path_from, path_word};
use std::path::{Path, PathBuf};
use workflow::guess as files;
use workflow::read::{bias, coordinate_of};
use workflow::{WorkflowError, in_options, left_out, logs};

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
    /// Frequency and damping of each log; empty for a single log.
    each: Vec<EachLog>,
    coordinate: Coordinate,
    folder: PathBuf,
    /// Remarks from trying the commands: a damping ratio that changes along the decay, and refusals.
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
    let paths = logs(log)?;
    let folder = out.clone().unwrap_or_else(|| folder_of(log));
    RunFolder::check_free(&folder).map_err(|error| match error {
        RunError::Occupied { path } => TrainerError::InitOccupied { folder: path.display().to_string() },
        other => other.into(),
    })?;
    let mut looked =
        paths.into_iter().map(|path| looked(&path, &arguments.reading)).collect::<Result<Vec<_>, _>>()?;
    let each = if looked.len() > 1 { looked.iter().map(Looked::each).collect() } else { Vec::new() };
    let bias = looked.iter().any(|looked| bias(&looked.look.record).is_some());
    let by_error = |one: &Looked, other: &Looked| {
        one.oscillator.damping.std_error.total_cmp(&other.oscillator.damping.std_error)
    };
    looked.sort_by(by_error);
    // A folder without logs was refused above.
    let none = || WorkflowError::Record(Fault::Folder.in_file(&log.display().to_string()));
    let mut surest = looked.into_iter().next().ok_or_else(none)?;
    surest.look.source.findings.extend(left_out(log));
    let coordinate = coordinate_of(surest.look.source.reading.coordinate);
    let (files, next, tried) = (Vec::new(), Vec::new(), Vec::new());
    Ok(Found { surest, each, coordinate, folder, tried, files, next }
        .with_diagnosis(log, bias)
        .with_estimate())
}

/// Returns the keys of a configuration that reads a log in the same way.
fn options(looked: &Looked) -> Vec<(&'static str, String)> {
    let mut options = looked.look.source.reading.options();
    let Reading { clock, input, .. } = &looked.reading;
    options.extend((*clock != Reading::default().clock).then(|| ("clock", clock.clone())));
    // A column that is left out on purpose would be found again.
    options
        .extend(input.clone().filter(|_| looked.look.record.input().is_none()).map(|none| ("input", none)));
    options
}

/// Returns `true` if a diagnosis can take a record: it is driven, or has a spring and enough cycles.
fn is_diagnosable(looked: &Looked) -> bool {
    looked.oscillator.input_gain.is_some() || looked.cycles().is_some_and(|cycles| cycles >= FEW_CYCLES)
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

impl Looked {
    fn each(&self) -> EachLog {
        EachLog {
            path: self.path.display().to_string(),
            samples: self.look.record.len(),
            natural_frequency_hz: self.oscillator.natural_frequency_hz(),
            damping_ratio: self.oscillator.damping_ratio(),
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
        let Looked { path, reading, oscillator, .. } = &self.surest;
        let file = self.folder.join("nominal.toml");
        let text = files::nominal_toml(&path.display().to_string(), oscillator, self.coordinate);
        if is_diagnosable(&self.surest) {
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
        let Looked { path, oscillator, .. } = &self.surest;
        if oscillator.input_gain.is_some() {
            return self;
        }
        let file = self.folder.join("estimate.toml");
        let configuration =
            |path: &Path| files::configuration(&path.display().to_string(), &options(&self.surest));
        // The folder is not there yet, and a path out of it leads nowhere.
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.clone());
        match tried::estimate(&file, &configuration(&absolute)) {
            Ok(envelope) => {
                let what = match envelope.because {
                    Some(_) => "the damping ratio from the samples",
                    None => "the damping ratio from the decay of the peaks",
                };
                let text = configuration(&path_from(&self.folder, path));
                self.files.push(("estimate.toml", text));
                self.next.push((what, format!("trainer {}", path_word(&file))));
                self.tried.extend(damping::changing(&envelope.envelope));
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
        let columns = self.surest.look.columns.iter().map(|column| {
            json!({
                "title": column.title, "unit": column.unit, "role": column.role, "holds": column.holds,
                "because": column.because,
            })
        });
        let resonance = self.surest.resonance();
        json!({
            "record": {
                "path": self.surest.look.source.path,
                "digest": self.surest.look.source.digest,
                "samples": self.surest.look.record.len(),
                "duration_s": self.surest.duration_s(),
                "sample_rate_hz": self.surest.look.clock.sample_rate_hz,
                "clock": self.surest.look.clock.kind.name(),
                "clock_reason": self.surest.look.clock.reason,
                "columns": columns.collect::<Vec<_>>(),
                "reading": self.surest.look.source.reading,
                "findings": self.findings(),
            },
            "oscillator": {
                "coordinate": files::name(self.coordinate),
                "natural_frequency_hz": number(self.surest.oscillator.natural_frequency_hz()),
                "damping_ratio": number(self.surest.oscillator.damping_ratio()),
                "quality_factor": resonance.map(|found| found.quality_factor),
                "half_power_width_hz": resonance.map(|found| found.half_power_width_hz),
                "damping_per_inertia": number(Some(self.surest.oscillator.damping)),
                "rest": number(self.surest.oscillator.rest),
                "input_gain_per_inertia": number(self.surest.oscillator.input_gain),
                "basis": files::basis(&self.surest.oscillator),
            },
            "modes": workflow::mode_rows(&self.surest.modes),
            "logs": self.each.iter().map(|log| json!({
                "path": log.path, "samples": log.samples,
                "natural_frequency_hz": number(log.natural_frequency_hz), "damping_ratio": number(log.damping_ratio),
            })).collect::<Vec<_>>(),
            "files": self.files.iter().map(|(name, _)| self.folder.join(name)).collect::<Vec<_>>(),
            "next": self.next.iter().map(|(_, command)| command).collect::<Vec<_>>(),
        })
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
        let read = self.surest.look.source.findings.iter().map(|finding| in_options(finding));
        read.chain(bias(&self.surest.look.record))
            .chain(apart(&self.each))
            .chain(self.few_cycles())
            .chain(self.no_swing())
            .chain(modes::remark(&self.surest.modes))
            .chain(self.uneven())
            .chain(self.tried.clone())
            .chain(self.hardly_known())
            .chain(self.growth())
            .collect()
    }

    /// Returns a warning if the swing grows, which no passive system does.
    fn growth(&self) -> Option<String> {
        let damping = self.surest.oscillator.damping;
        (damping.value < 0.0 && damping.is_significant()).then(|| {
            "the swing grows: something adds energy to it, which no passive simulator can do; the written \
             damping is 0"
                .to_owned()
        })
    }

    /// Returns a warning if the frequency is so uncertain that the record may hold no swing.
    fn hardly_known(&self) -> Option<String> {
        let frequency = self.surest.oscillator.natural_frequency_hz()?;
        let part = frequency.std_error / frequency.value;
        (part > HARDLY_KNOWN).then(|| {
            format!(
                "the natural frequency is known to {:.0} % only: the record may hold noise and no swing, or a swing that \
                 hardly oscillates",
                100.0 * part
            )
        })
    }

    /// Returns a remark if only a part of the record swings evenly, and not because of another mode.
    fn uneven(&self) -> Option<String> {
        let Looked { look, modes, .. } = &self.surest;
        let [from, to] = regular_part(&look.record, &look.clock).filter(|_| modes.len() < 2)?;
        // Times of the clock begin where the stamps do.
        let shift = look.record.stamps_s().first()? - look.clock.start_s();
        Some(format!(
            "amplitude or phase change unevenly outside {from:.2} s to {to:.2} s, as if a hand moved it or friction stopped it \
             there: --from {from:.2} --to {to:.2} read that part alone",
            from = from + shift,
            to = to + shift
        ))
    }

    /// Returns a remark if the record comes to rest without a swing.
    fn no_swing(&self) -> Option<String> {
        let oscillator = &self.surest.oscillator;
        if oscillator.input_gain.is_some() {
            return None;
        }
        match oscillator.damping_ratio() {
            Some(ratio) if ratio.value < CRITICAL => None,
            Some(_) => Some(
                "no oscillation: the record comes to rest without a swing, as a critically damped or overdamped system does"
                    .to_owned(),
            ),
            None => Some(
                "no oscillation: the record comes to rest without a swing, as an overdamped or critically damped system \
                 does, or it drifts, or is sampled less than two and a half times in a cycle; neither a frequency nor a damping ratio \
                 can be read from it"
                    .to_owned(),
            ),
        }
    }

    /// Returns a warning if the record is too short for its decay to show.
    fn few_cycles(&self) -> Option<String> {
        let cycles = self.surest.cycles()?;
        (cycles < FEW_CYCLES).then(|| {
            format!(
                "the record shows {cycles:.1} cycles, too few to see what a simulator lacks; give a record of ten cycles or \
                 more"
            )
        })
    }
}

/// Relative error of a natural frequency above which it is doubtful whether anything swings: 24 simulated
/// records of noise, white or red, have 4 to 15 % or no frequency.
const HARDLY_KNOWN: f64 = 0.03;

/// Number of cycles below which a record says little about a decay: a diagnosis needs segments of them to
/// hold out.
const FEW_CYCLES: f64 = 3.0;

/// Returns `true` if the program runs from cargo's build folder, where no shell finds it by its name.
fn is_built_here() -> bool {
    let program = own_program().unwrap_or_default();
    program.ancestors().skip(1).take(2).any(|folder| folder.ends_with("target"))
}
