//! Arguments of `trainer diagnose`.

use crate::options::Output;
use crate::share::ShareOptions;
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use diagnosis::Settings;
use record::{CsvColumns, Format, Missing, Quantity, ReadOptions, TimeUnit, Unit};
use seed::Seed;
use serde::de::IntoDeserializer;
use serde::de::value::Error;
use serde::{Deserialize, Serialize};
use settings::nearest;
use std::path::PathBuf;

/// Diagnoses the gap between a nominal simulator and records: its location, its causes, and its closure by a
/// repair.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trainer diagnose record.csv --nominal nominal.toml
  trainer diagnose near.csv far.csv --nominal nominal.toml --out DIR
                                   several records of one system, diagnosed together
  trainer diagnose LOGS --nominal nominal.toml           every log in a folder, as records of one system
  trainer diagnose log.txt --nominal nominal.toml        a host log (wall clock, elapsed s, angle deg)
  trainer diagnose log.csv --time t --value theta --unit deg --nominal nominal.toml
  trainer diagnose drive.csv --value qm_m --input vir_V --unit m --nominal drive.toml
  trainer diagnose box.csv --value output_v --input input_v --unit V --sample-rate 610.35 \\
      --remove-mean --nominal box.toml                   no time column: laid out at that rate
  trainer diagnose gyro.csv --value rate --unit deg/s --quantity velocity --nominal nominal.toml
  trainer diagnose --batch CASES --out ANSWERS --threads 8
                                   every CASES/<id>/ with record-*.csv and nominal.toml; a case.toml beside them
                                   (joint = \"elbow\", robot, date) labels the case in `trainer report ANSWERS`
  trainer diagnose --batch CASES --out ANSWERS --shard 2/8
                                   the second of eight shares; all may run at once on one folder
  trainer diagnose --batch CASES --out ANSWERS --launcher slurm --shards 50
                                   a job array with one task for each share
  trainer diagnose --rigs A/ B/ C/ --out DIR
                                   several rigs of one build: what they share, and where they differ
  trainer diagnose log.csv --nominal arm.urdf            a robot: one diagnosis for each joint, and a run of the whole
  trainer diagnose a.csv b.csv --nominal arm.urdf --joint elbow --columns elbow=q2,tau2 --check c.csv

Separator, decimal sign, columns and units are found from the file and printed: names such as time,
timestamp_ms, angle [deg], theta, displacement_m, position, velocity_rad_s, gyro (deg/s), torque_nm;
times in s, ms, us, ns, since 1970 or as dates. What is ambiguous is refused with the option to set.

nominal.toml holds inertia, damping, stiffness and rest_angle in SI units, or all divided by the
inertia with inertia = 1.0; and, where they apply, coordinate = \"displacement\", input_gain (torque
or force per unit of the input) and sensor_resolution.

Exit codes: 0 diagnosed, whatever the verdict; 1 some case of a batch, or some rig, gave no answer; 2 wrong input
or usage; 130 interrupted. With --as-task 0 instead of 1.")]
pub(crate) struct DiagnoseArguments {
    /// Records of one system: files, or a folder of them
    #[arg(value_name = "RECORD", required_unless_present_any = ["batch", "rigs"], conflicts_with_all = ["batch", "rigs"])]
    pub(crate) records: Vec<PathBuf>,
    /// The simulator as it is: a nominal.toml [default: the one in a folder of records]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["batch", "rigs"])]
    pub(crate) nominal: Option<PathBuf>,
    /// Diagnoses every folder CASES/<id>/ holding record-*.csv and nominal.toml
    #[arg(long, value_name = "CASES", requires = "out")]
    pub(crate) batch: Option<PathBuf>,
    /// Diagnoses several rigs of one build, each a folder holding record-*.csv and nominal.toml: which classes of effects
    /// they share, and where their coefficients agree
    #[arg(long, value_name = "RIG", num_args = 1.., conflicts_with = "batch")]
    pub(crate) rigs: Vec<PathBuf>,
    /// Folder for the answer: new or empty [default: a new one below reports/runs]. With --batch, for
    /// ANSWERS/<id>/diagnosis.json; answers that are there already are left alone
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Resumes an interrupted diagnosis in the folder of --out, or prints its answer again if it is finished. A
    /// batch always resumes
    #[arg(long, requires = "out")]
    pub(crate) resume: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) robot: Robot,
    /// Largest number of effects in one fitted set, 1 to 5 [default: 5]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=5))]
    pub(crate) most_effects: Option<u8>,
    /// Effects that are not considered, by id, with commas between (`trainer list effects`)
    #[arg(long, value_name = "EFFECT", value_delimiter = ',', value_parser = effect)]
    pub(crate) without: Vec<String>,
    /// False-alarm probability of the search, 0.001 to 0.2: of the best candidate, by chance
    #[arg(long, value_name = "P", default_value_t = 0.01, value_parser = false_alarm)]
    pub(crate) false_alarm: f64,
    /// Root of the random draws (bootstraps)
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Threads; results do not depend on it [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    #[command(flatten)]
    pub(crate) share: ShareOptions,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Options for a robot of several joints.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "A robot of several joints (--nominal ARM.urdf)")]
pub(crate) struct Robot {
    /// A joint to diagnose; may be given several times [default: every joint]
    #[arg(long = "joint", value_name = "NAME")]
    pub(crate) joints: Vec<String>,
    /// Columns of a joint; may be given several times [default: by names such as elbow_position, q_elbow,
    /// /joint_states/elbow/position, or q1, tau1 in the order of the joints]
    #[arg(long, value_name = "JOINT=POSITION,TORQUE")]
    pub(crate) columns: Vec<String>,
    /// Inertia of a rotor at its joint, that of the rotor times the square of the gear ratio, in kg m^2; may be given
    /// several times [default: found from the recordings]
    #[arg(long = "armature", value_name = "JOINT=INERTIA")]
    pub(crate) armatures: Vec<String>,
    /// Recordings that are not fitted: the repaired model is run over them
    #[arg(long, value_name = "LOG", num_args = 1..)]
    pub(crate) check: Vec<PathBuf>,
}

/// Options for reading record files.
#[derive(Debug, Clone, Args, Serialize)]
#[command(next_help_heading = "How to read the records")]
pub(crate) struct Reading {
    /// Format of the files
    #[arg(long, value_enum, default_value_t = FormatChoice::Auto)]
    pub(crate) format: FormatChoice,
    /// Clock to use: the stamps as written (host), evenly spaced samples (uniform-index), or what stamps and values support
    #[arg(long, value_name = "CLOCK", default_value = "auto",
          value_parser = PossibleValuesParser::new(record::ClockChoice::NAMES))]
    pub(crate) clock: String,
    /// The time column
    #[arg(long, value_name = "COLUMN")]
    pub(crate) time: Option<String>,
    /// The observed column
    #[arg(long, value_name = "COLUMN", alias = "angle")]
    pub(crate) value: Option<String>,
    /// The column of the measured input; none if nothing drives the system
    #[arg(long, value_name = "COLUMN")]
    pub(crate) input: Option<String>,
    /// Unit of the observed column [default: from its name, else that of the simulator's coordinate]
    #[arg(long, value_name = "UNIT", value_parser = PossibleValuesParser::new(Unit::NAMES))]
    pub(crate) unit: Option<String>,
    /// Unit of the input [default: by its header]
    #[arg(long, value_name = "UNIT", value_parser = PossibleValuesParser::new(Unit::INPUT_NAMES))]
    pub(crate) input_unit: Option<String>,
    /// Unit of the time column, iso for dates [default: by its header or its numbers, else s]
    #[arg(long, value_name = "UNIT", value_parser = PossibleValuesParser::new(TimeUnit::NAMES))]
    pub(crate) time_unit: Option<String>,
    /// Start of the part of the time to read, in seconds of the time column [default: the part in which it swings
    /// freely, which is said]
    #[arg(long = "from", value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) from_s: Option<f64>,
    /// End of that part
    #[arg(long = "to", value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) to_s: Option<f64>,
    /// The run to read, from 1, if a file holds several, each with its own time [default: the first]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) run: Option<u16>,
    /// Counts that make a turn, if the observed column holds counts of an encoder
    #[arg(long, value_name = "N", value_parser = rate)]
    pub(crate) counts_per_turn: Option<f64>,
    /// Lines to read, if a file holds several series: --where joint=elbow
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = filter)]
    pub(crate) filter: Option<String>,
    /// Treatment of cells without a number: a gap (segment), rows that the file never had (drop), or an error
    /// (refuse)
    #[arg(long, value_name = "CHOICE", default_value = "segment",
          value_parser = PossibleValuesParser::new(Missing::NAMES))]
    pub(crate) missing: String,
    /// Quantity that the sensor observes [default: by the column's name, else position]
    #[arg(long, value_enum)]
    pub(crate) quantity: Option<QuantityChoice>,
    /// Rate at which to lay out a file without a time column
    #[arg(long, value_name = "HZ", value_parser = rate)]
    pub(crate) sample_rate: Option<f64>,
    /// Origin of the numbers, if the files do not state it: for the report's headline, not for the diagnosis
    #[arg(long, value_name = "ORIGIN", value_parser = PossibleValuesParser::new(record::Origin::NAMES))]
    pub(crate) origin: Option<String>,
    /// Subtracts the mean of the observed column and of the input, weighted toward the middle of the record: for channels
    /// with an arbitrary zero
    #[arg(long)]
    pub(crate) remove_mean: bool,
}

impl DiagnoseArguments {
    /// Converts the options into the settings of a diagnosis.
    pub(super) fn settings(&self) -> Settings {
        Settings {
            false_alarm: self.false_alarm,
            most_effects: self.most_effects.map_or(Settings::default().most_effects, usize::from),
            without: self.without.clone(),
            hold: None,
            seed: Seed::new(self.seed),
        }
    }
}

impl Default for Reading {
    /// Returns the values in force without any option.
    fn default() -> Self {
        Self {
            format: FormatChoice::Auto,
            clock: "auto".to_owned(),
            time: None,
            value: None,
            input: None,
            unit: None,
            input_unit: None,
            time_unit: None,
            from_s: None,
            to_s: None,
            run: None,
            counts_per_turn: None,
            filter: None,
            missing: "segment".to_owned(),
            quantity: None,
            sample_rate: None,
            origin: None,
            remove_mean: false,
        }
    }
}

impl Reading {
    /// Converts the options into those of the record reader.
    pub(crate) fn plain(&self) -> workflow::Reading {
        workflow::Reading {
            options: ReadOptions {
                format: match self.format {
                    FormatChoice::Auto => Format::Auto,
                    FormatChoice::Csv => Format::Csv,
                    FormatChoice::HostLog => Format::HostLog,
                },
                columns: CsvColumns {
                    time: self.time.clone(),
                    value: self.value.clone(),
                    input: self.input.clone(),
                    unit: self.unit.as_deref().and_then(word),
                    input_unit: self.input_unit.as_deref().and_then(word),
                    time_unit: self.time_unit.as_deref().and_then(word),
                    sample_rate_hz: self.sample_rate,
                    run: self.run.map(usize::from),
                    counts_per_turn: self.counts_per_turn,
                    filter: self.filter.as_deref().and_then(word),
                    missing: word(&self.missing).unwrap_or_default(),
                },
                quantity: self.quantity.map(QuantityChoice::quantity),
                from_s: self.from_s,
                to_s: self.to_s,
                ..ReadOptions::default()
            },
            clock: word(&self.clock).unwrap_or_default(),
            origin: self.origin.as_deref().and_then(word),
            remove_mean: self.remove_mean,
        }
    }
}

/// Parses a word as configurations write it; the command line admits no other words.
fn word<'de, T: Deserialize<'de>>(text: &'de str) -> Option<T> {
    let deserializer = IntoDeserializer::<Error>::into_deserializer(text);
    T::deserialize(deserializer).ok()
}

/// Format of a record file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FormatChoice {
    /// By the first line
    Auto,
    /// A header with column names, then numbers, with commas, semicolons, tabs or blanks between them
    Csv,
    /// Two header lines, then wall clock, elapsed s, angle deg
    HostLog,
}

/// Quantity that the sensor observes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum QuantityChoice {
    /// Angle or displacement
    Position,
    /// Its first derivative: a gyroscope, a laser vibrometer
    Velocity,
    /// Its second derivative: an accelerometer
    Acceleration,
}

impl QuantityChoice {
    pub(crate) fn quantity(self) -> Quantity {
        match self {
            Self::Position => Quantity::Position,
            Self::Velocity => Quantity::Velocity,
            Self::Acceleration => Quantity::Acceleration,
        }
    }
}

fn filter(text: &str) -> Result<String, String> {
    record::Filter::try_from(text.to_owned()).map(String::from)
}

fn seconds(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    number.filter(|number| number.is_finite()).ok_or_else(|| "expected a number of seconds".to_owned())
}

fn rate(text: &str) -> Result<f64, String> {
    let rate: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    if rate.is_finite() && rate > 0.0 { Ok(rate) } else { Err("expected a number above 0".to_owned()) }
}

fn false_alarm(text: &str) -> Result<f64, String> {
    let level: f64 = text.parse().map_err(|_| "expected a probability".to_owned())?;
    if (0.001..=0.2).contains(&level) { Ok(level) } else { Err("expected 0.001 to 0.2".to_owned()) }
}

fn effect(text: &str) -> Result<String, String> {
    let known: Vec<String> = dynamics::REGISTRY.iter().map(|effect| effect.id().to_owned()).collect();
    if known.iter().any(|id| id == text) {
        return Ok(text.to_owned());
    }
    let meant = known.iter().find(|id| id.starts_with(text)).cloned().or_else(|| nearest(text, &known));
    let meant = meant.map_or_else(String::new, |id| format!("; did you mean {id}?"));
    Err(format!("no effect of the vocabulary: see `trainer list effects`{meant}"))
}
