//! Diagnoses of the gap between a simulator and records.

use crate::error::Error;
use crate::nominal::{Nominal, config};
use crate::record::Record;
use export::Repaired;
use report::RunTexts;
use results::{ClassRow, DiagnosisResult, DiagnosisVerdict, EffectRow, GapSummary, SeriesRow};
use seed::Seed;
use std::path::Path;
use workflow::{Answer, Question, series_rows};

/// Options of a diagnosis, with the defaults of the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosisOptions {
    /// False-alarm probability of the search, 0.001 to 0.2: the chance that noise alone lets a candidate into
    /// the sets that are fitted and weighed.
    pub false_alarm: f64,
    /// Largest number of effects in one fitted set: 1 to 5.
    pub most_effects: usize,
    /// Ids of effects to exclude.
    pub without: Vec<String>,
    /// Root seed of the random draws (bootstraps).
    pub seed: u64,
}

impl Default for DiagnosisOptions {
    fn default() -> Self {
        let usual = diagnosis::Settings::default();
        Self {
            false_alarm: usual.false_alarm,
            most_effects: usual.most_effects,
            without: usual.without,
            seed: 0,
        }
    }
}

impl DiagnosisOptions {
    pub(crate) fn settings(&self) -> Result<diagnosis::Settings, Error> {
        if !(0.001..=0.2).contains(&self.false_alarm) {
            let found = self.false_alarm;
            return Err(config(format!("false_alarm is {found}; expected 0.001 to 0.2")));
        }
        if !(1..=5).contains(&self.most_effects) {
            return Err(config(format!("most_effects is {}; expected 1 to 5", self.most_effects)));
        }
        for id in &self.without {
            dynamics::Effect::find(id).map_err(config)?;
        }
        Ok(diagnosis::Settings {
            false_alarm: self.false_alarm,
            most_effects: self.most_effects,
            without: self.without.clone(),
            hold: None,
            seed: Seed::new(self.seed),
        })
    }
}

/// Diagnoses the gap between a nominal simulator and records of one system: its location, the effects that
/// cause it, and the share of it that they close.
///
/// Apart from times, the answer depends only on the arguments, to the bit and for any number of threads.
///
/// # Errors
/// [`Error::Record`] for records that cannot be of this system, [`Error::Diagnosis`] for records that carry
/// no information about it, [`Error::Config`] for options out of range.
///
/// ```
/// use ringdown_lab::{DiagnosisOptions, Nominal, Simulation, diagnose, result::VerdictStatus};
///
/// // A record of an arm with dry friction that its simulator lacks; a real one comes from `Record::read`.
/// let nominal = Nominal::swinging(3.5, 0.005)?;
/// let record = Simulation::of(&nominal)
///     .with_effect("coulomb_friction", &[("torque", 1.0)])?
///     .released_at(0.5)
///     .sampled(150.0, 12.0)
///     .noise(2e-4)
///     .run()?;
///
/// let diagnosis = diagnose(&[record], &nominal, &DiagnosisOptions::default())?;
/// assert_eq!(diagnosis.verdict().status, VerdictStatus::Effect);
/// assert_eq!(diagnosis.classes()[0].id, "friction");
/// assert!(diagnosis.gap().repaired < 0.2 * diagnosis.gap().recalibrated);
/// println!("{}", diagnosis.verdict().summary);
/// # Ok::<(), ringdown_lab::Error>(())
/// ```
pub fn diagnose(
    records: &[Record],
    nominal: &Nominal,
    options: &DiagnosisOptions,
) -> Result<Diagnosis, Error> {
    diagnose_watched(records, nominal, options, &|_| true)
}

/// Diagnoses like [`diagnose`], with a callback. `goes_on` is called after each stage but the last with the
/// stage's name, such as `search`; if it returns `false`, the diagnosis ends.
///
/// # Errors
/// As [`diagnose`], and [`Error::Diagnosis`] if `goes_on` ended it.
pub fn diagnose_watched(
    records: &[Record],
    nominal: &Nominal,
    options: &DiagnosisOptions,
    goes_on: &dyn Fn(&'static str) -> bool,
) -> Result<Diagnosis, Error> {
    let settings = options.settings()?;
    let given = records.iter().map(|record| record.loaded.given(&nominal.stated));
    let given = given.collect::<Result<Vec<_>, _>>()?;
    let question = Question::new(given, nominal.stated.clone(), nominal.name.clone())?;
    let Answer { found, repaired, result } =
        question.answer_watched(&settings, options.seed, &|stage| goes_on(stage.name()))?;
    Ok(Diagnosis { result, repaired, series: series_rows(&found.series) })
}

/// A diagnosis: the content of `diagnosis.json`, the repaired simulator, and the series behind the report's
/// plots.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    result: DiagnosisResult,
    repaired: Repaired,
    series: Vec<SeriesRow>,
}

impl Diagnosis {
    /// Returns the verdict: status, named effects, confidence, and one plain sentence.
    #[must_use]
    pub fn verdict(&self) -> &DiagnosisVerdict {
        &self.result.verdict
    }

    /// Returns the classes of effects that act alike, the most probable first.
    #[must_use]
    pub fn classes(&self) -> &[ClassRow] {
        &self.result.classes
    }

    /// Returns the effects with their probabilities, coefficients and shares of the gap, best first.
    #[must_use]
    pub fn effects(&self) -> &[EffectRow] {
        &self.result.effects
    }

    /// Returns the held-out errors of the nominal, recalibrated and repaired simulators, and the noise floor.
    #[must_use]
    pub fn gap(&self) -> &GapSummary {
        &self.result.gap
    }

    /// Returns the content of `diagnosis.json` as types.
    #[must_use]
    pub fn result(&self) -> &DiagnosisResult {
        &self.result
    }

    /// Returns the observed values and the predictions of the nominal, recalibrated and repaired simulators,
    /// sample by sample.
    #[must_use]
    pub fn series(&self) -> &[SeriesRow] {
        &self.series
    }

    /// Returns the content of `diagnosis.json` as text.
    ///
    /// # Errors
    /// [`Error::File`], never in practice: the result has no value that JSON cannot hold.
    pub fn to_json(&self) -> Result<String, Error> {
        Ok(runs::to_json("diagnosis.json", &self.result)?)
    }

    /// Returns the repaired simulator: the system with the effects that it lacked, its measurement chain and
    /// its initial state.
    #[must_use]
    pub fn repaired(&self) -> &Repaired {
        &self.repaired
    }

    /// Returns the repaired simulator as a nominal one, for diagnosing further records.
    ///
    /// # Errors
    /// As [`Nominal::parse`].
    pub fn repaired_nominal(&self) -> Result<Nominal, Error> {
        Nominal::parse("repaired.toml", &export::configuration(&self.repaired))
    }

    /// Returns the repaired simulator as files, with their names: a configuration, equations, and exports for
    /// SciPy, Modelica, MuJoCo and URDF.
    #[must_use]
    pub fn files(&self) -> Vec<(&'static str, String)> {
        export::files(&self.repaired)
    }

    /// Returns the report as a self-contained HTML page.
    ///
    /// # Errors
    /// [`Error::Report`] if no page can be made from the result.
    pub fn report_html(&self) -> Result<String, Error> {
        let result = self.to_json()?;
        let series = runs::to_csv("series.csv", &self.series)?;
        let series = String::from_utf8_lossy(&series);
        let config = export::configuration(&self.repaired);
        let texts = RunTexts {
            name: "diagnosis",
            config: &config,
            result: &result,
            series: &series,
            ..RunTexts::default()
        };
        Ok(report::render_diagnosis(&texts)?)
    }

    /// Writes the report to a file, replacing an existing one.
    ///
    /// # Errors
    /// [`Error::File`] if the file cannot be written, and as [`Diagnosis::report_html`].
    pub fn report(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        Ok(runs::write_file(path.as_ref(), self.report_html()?.as_bytes())?)
    }
}
