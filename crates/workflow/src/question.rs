//! Diagnosis question (records of one system and its nominal simulator) and its answer.

use crate::commanded::{check_columns, is_still, left_out_still};
use crate::error::WorkflowError;
use crate::logs::Log;
use crate::nominal;
use crate::read::{Given, Loaded, Reading};
use crate::repair::repaired;
use crate::result::{Beside, result, series_rows};
use diagnosis::{Diagnosis, DiagnosisError, Observations, Settings, Stage};
use experiment::StatedNominal;
use export::Repaired;
use results::DiagnosisResult;
use runs::{RunError, to_csv, to_json};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Records of one system and its nominal simulator.
pub struct Question {
    /// Nominal simulator.
    pub stated: StatedNominal,
    /// Records, in the order given.
    pub given: Vec<Given>,
    /// Name of the nominal simulator's file in results.
    pub nominal: String,
}

/// Diagnosis with everything needed to show it.
pub struct Answer {
    /// Diagnosis.
    pub found: Diagnosis,
    /// Repaired simulator: the recalibrated simulator with the fitted effects.
    pub repaired: Repaired,
    /// Content of `diagnosis.json`.
    pub result: DiagnosisResult,
}

impl Answer {
    /// Returns the files of the answer with their names: `diagnosis.json`, `series.csv`, and the repaired simulator in every
    /// form.
    ///
    /// # Errors
    /// [`RunError::Encoding`], never in practice: the answer has no value that JSON or CSV cannot hold.
    pub fn files(&self) -> Result<Vec<(&'static str, String)>, RunError> {
        let series = to_csv("series.csv", &series_rows(&self.found.series))?;
        let mut files = vec![
            ("diagnosis.json", to_json("diagnosis.json", &self.result)?),
            ("series.csv", String::from_utf8_lossy(&series).into_owned()),
        ];
        files.extend(export::files(&self.repaired));
        Ok(files)
    }
}

/// Cycles of the nominal simulator from which another free swing of a file is a record of its own.
const CYCLES: f64 = 6.0;

/// Returns the stamps, in seconds, of the other long free swings of a file.
fn other_swings(loaded: &Loaded, stated: &StatedNominal) -> Vec<[f64; 2]> {
    let reading = &loaded.source.reading;
    let (Some(whole), Some(read)) = (&reading.whole, reading.part_s) else { return Vec::new() };
    let least = CYCLES * TAU / stated.simulator.angular_frequency();
    let is_other = |[from, to]: &&[f64; 2]| [*from, *to] != read && to - from > least;
    whole.free_s.iter().filter(is_other).copied().collect()
}

/// Number of standard errors of a gain from which an input drives the system, though the nominal simulator states none.
const DRIVES: f64 = 10.0;

/// Returns the gain of an input that a simulator does not state and a record follows, with a sentence; `None` if the
/// reading names an input or none, or if the record follows none.
fn gain_of(log: &Log, stated: &StatedNominal, reading: &Reading) -> Option<(f64, String)> {
    if reading.options.columns.input.is_some() && stated.actuator.is_none() {
        return None;
    }
    let mut reading = reading.clone().for_nominal(stated);
    reading.options.driven = true;
    let loaded = Loaded::parse(&log.name, &log.bytes, &reading).ok()?;
    loaded.record.input()?;
    let oscillator = identify::identify(&loaded.record, &loaded.believed().ok()?).ok()?;
    let gain = oscillator.input_gain.filter(|gain| gain.value.abs() > DRIVES * gain.std_error)?;
    let gain = gain.value * stated.nominal.inertia();
    let column = loaded.source.reading.input.map(|input| input.column)?;
    let told = format!("{gain:.4e}").parse::<f64>().unwrap_or(gain);
    if stated.actuator.is_some() {
        let text = format!(
            "the gain of the loop is unknown: beside the stated inertia, `{column}` and the motion tell about {told}, \
             where its calibration begins"
        );
        return (gain > 0.0).then_some((gain, text));
    }
    Some((
        gain,
        format!(
            "the nominal simulator states no input_gain, but `{column}` drives the record: it was taken as the input, \
             with a gain of {told} from the record, which is fitted too; state input_gain, or leave the input out with \
             --input none"
        ),
    ))
}

/// Returns a simulator with the gain of an input that drives the first log, with a sentence, if it states none.
fn with_gain(
    first: Option<&Log>,
    stated: StatedNominal,
    nominal: &str,
    reading: &Reading,
) -> Result<(StatedNominal, Option<String>), WorkflowError> {
    let Some(first) = first.filter(|_| !stated.driven) else { return Ok((stated, None)) };
    match gain_of(first, &stated, reading) {
        Some((gain, finding)) => {
            let refused = |error: dynamics::DynamicsError| WorkflowError::Nominal {
                file: nominal.to_owned(),
                problem: error.to_string(),
            };
            Ok((stated.driven_by(gain).map_err(refused)?, Some(finding)))
        }
        None if stated.actuator.is_some() => Err(WorkflowError::UnknownGain { file: first.name.clone() }),
        None => Ok((stated, None)),
    }
}

/// Returns a reading that takes the columns of a record that was read, for the other records of the system.
fn alike_to(loaded: &Loaded, reading: &Reading) -> Reading {
    let (mut alike, own) = (reading.clone(), &loaded.source.reading);
    let columns = &mut alike.options.columns;
    columns.value.get_or_insert_with(|| own.value.column.clone());
    if let Some(input) = &own.input {
        columns.input.get_or_insert_with(|| input.column.clone());
    }
    alike
}

impl Question {
    /// Combines records and a nominal simulator.
    ///
    /// # Errors
    /// [`WorkflowError::SameRecord`] if a record is given twice, since it would count as two records that
    /// agree.
    pub fn new(given: Vec<Given>, stated: StatedNominal, nominal: String) -> Result<Self, WorkflowError> {
        for (at, one) in given.iter().enumerate() {
            let part = |given: &Given| (given.row.digest.clone(), given.row.reading.part_s);
            if let Some(again) = given.iter().skip(at + 1).find(|other| part(other) == part(one)) {
                let [first, second] = [one, again].map(|given| given.row.path.clone());
                return Err(WorkflowError::SameRecord { first, second, digest: one.row.digest.clone() });
            }
        }
        Ok(Self { stated, given, nominal })
    }

    /// Reads records and their nominal simulator from files; a folder stands for the logs in it ([`Log::read`]).
    ///
    /// # Errors
    /// [`WorkflowError`] with the file, the place in it and the option to set.
    pub fn read(records: &[PathBuf], nominal: &Path, reading: &Reading) -> Result<Self, WorkflowError> {
        let stated = nominal::read(nominal)?;
        Self::read_with(records, stated, nominal, reading)
    }

    /// Reads records as [`Question::read`] does, for a nominal simulator whose file is called `nominal`.
    ///
    /// # Errors
    /// Same as [`Question::read`].
    pub fn read_with(
        records: &[PathBuf],
        stated: StatedNominal,
        nominal: &Path,
        reading: &Reading,
    ) -> Result<Self, WorkflowError> {
        let logs: Vec<Vec<Log>> = records.iter().map(|path| Log::read(path)).collect::<Result<_, _>>()?;
        Self::of_logs(&logs.concat(), stated, nominal.display().to_string(), reading)
    }

    /// Reads records from logs in memory, for a nominal simulator whose file is called `nominal`.
    ///
    /// # Errors
    /// [`WorkflowError`] with the file, the place in it and the option to set.
    pub fn of_logs(
        logs: &[Log],
        stated: StatedNominal,
        nominal: String,
        reading: &Reading,
    ) -> Result<Self, WorkflowError> {
        let (stated, gain) = with_gain(logs.first(), stated, &nominal, reading)?;
        let reading = reading.clone().for_nominal(&stated);
        let mut given: Vec<Given> = Vec::new();
        let (mut columns, mut still): (Option<Reading>, Vec<String>) = (None, Vec::new());
        let mut note = None;
        for log in logs {
            note = log.note.clone().or(note);
            let read = |reading: &Reading| Loaded::parse(&log.name, &log.bytes, reading);
            let alike = columns.as_ref().and_then(|alike| read(alike).ok());
            let loaded = alike.map_or_else(|| read(&reading), Ok)?;
            columns.get_or_insert_with(|| alike_to(&loaded, &reading));
            if is_still(&loaded) {
                still.push(log.name.clone());
                continue;
            }
            check_columns(&loaded, &stated, &log.name)?;
            let mut first = loaded.given(&stated)?;
            first.row.findings.extend(note.take());
            given.push(first);
            for [from_s, to_s] in other_swings(&loaded, &stated) {
                let mut reading = reading.clone();
                (reading.options.from_s, reading.options.to_s) = (Some(from_s), Some(to_s));
                given.push(read(&reading)?.given(&stated)?);
            }
        }
        if let (true, Some(file)) = (given.is_empty(), still.first()) {
            return Err(WorkflowError::StandsStill { file: file.clone() });
        }
        if let Some(first) = given.first_mut() {
            first.row.findings.extend(gain.into_iter().chain(still.iter().map(|file| left_out_still(file))));
        }
        Self::new(given, stated, nominal)
    }

    /// Returns the digests of the records, separated by spaces.
    #[must_use]
    pub fn digests(&self) -> String {
        let digests: Vec<&str> = self.given.iter().map(|given| given.row.digest.as_str()).collect();
        digests.join(" ")
    }

    /// Checks the records as a diagnosis does before it fits anything.
    ///
    /// # Errors
    /// Those with which a diagnosis refuses its records.
    pub fn check(&self) -> Result<(), WorkflowError> {
        match self.answer_timed(&Settings::default(), 0, &|| 0.0, &|_| false) {
            Err(WorkflowError::Diagnosis { source: DiagnosisError::Interrupted { .. }, .. }) | Ok(_) => {
                Ok(())
            }
            Err(refusal) => Err(refusal),
        }
    }

    /// Computes the diagnosis. `seed` is the number that the answer states as the root of the random draws of
    /// `settings`.
    ///
    /// # Errors
    /// [`WorkflowError::Diagnosis`] with the record at fault.
    pub fn answer(&self, settings: &Settings, seed: u64) -> Result<Answer, WorkflowError> {
        self.answer_watched(settings, seed, &|_| true)
    }

    /// Computes the diagnosis as [`Question::answer`] does. `goes_on` is called after each stage but
    /// the last, and ends the diagnosis if it returns `false`.
    ///
    /// # Errors
    /// Same as [`Question::answer`], and if the diagnosis was ended.
    pub fn answer_watched(
        &self,
        settings: &Settings,
        seed: u64,
        goes_on: &dyn Fn(Stage) -> bool,
    ) -> Result<Answer, WorkflowError> {
        let start = Instant::now();
        self.answer_timed(settings, seed, &|| start.elapsed().as_secs_f64(), goes_on)
    }

    /// Computes the diagnosis as [`Question::answer_watched`] does, with the time from the caller: `stopwatch` returns the
    /// seconds since some moment before.
    ///
    /// # Errors
    /// Same as [`Question::answer_watched`].
    pub fn answer_timed(
        &self,
        settings: &Settings,
        seed: u64,
        stopwatch: &dyn Fn() -> f64,
        goes_on: &dyn Fn(Stage) -> bool,
    ) -> Result<Answer, WorkflowError> {
        let observations: Vec<Observations> =
            self.given.iter().map(|given| given.observations.clone()).collect();
        let start = stopwatch();
        let stopwatch = || stopwatch() - start;
        let hold = self.stated.actuator.as_ref().and_then(|servo| servo.actuator.hold);
        let settings = &Settings { hold: settings.hold.or(hold), ..settings.clone() };
        let found =
            diagnosis::diagnose_watched(&observations, &self.stated.simulator, settings, &stopwatch, goes_on)
                .map_err(|source| self.refused(source))?;
        let seconds = stopwatch();
        let repaired = repaired(&found, &self.given, self.stated.nominal.units())
            .map_err(|error| self.refused(DiagnosisError::Dynamics(error)))?;
        let nominal_digest = nominal::digest(&self.stated);
        let beside = Beside {
            given: &self.given,
            nominal: &self.nominal,
            nominal_digest: &nominal_digest,
            seed,
            seconds,
            repaired: &repaired,
            actuator: self.stated.actuator.as_ref(),
        };
        let result = result(&found, &beside);
        Ok(Answer { found, repaired, result })
    }

    /// Adds to an error the name of the record's file. The diagnosis counts records from 1.
    fn refused(&self, source: DiagnosisError) -> WorkflowError {
        use DiagnosisError as E;
        let record = match &source {
            E::TooFewSamples { record, .. }
            | E::TooFewCycles { record, .. }
            | E::NoMotion { record, .. }
            | E::MissingInput { record }
            | E::AnotherPeriod { record, .. }
            | E::MixedQuantities { record } => *record,
            _ => 1,
        };
        let file = record.checked_sub(1).and_then(|index| self.given.get(index));
        let file = file.map_or_else(String::new, |given| given.row.path.clone());
        WorkflowError::Diagnosis { file, source }
    }
}

/// Describes the work that follows a stage of a diagnosis; `None` stands for the beginning.
#[must_use]
pub fn after(stage: Option<Stage>) -> &'static str {
    match stage {
        None => "measuring the record",
        Some(Stage::MeasurementChain) => "recalibrating the simulator",
        Some(Stage::Calibration) => "searching for sets of effects",
        Some(Stage::Search) => "fitting the best sets on every sample",
        Some(Stage::Fits) => "predicting held-out parts",
        Some(Stage::HeldOutParts) => "testing the residual for further effects",
        Some(Stage::LeftOver | Stage::Explanation) => "describing the result",
    }
}
