//! From observations to an answer, stage by stage.

use crate::answer::Diagnosis;
use crate::data::observations::Observations;
use crate::error::DiagnosisError;
use crate::measurement::clock_rates::ClockRates;
use crate::settings::Settings;
use crate::stages::{
    Judged, Known, Measured, Question, Refined, Remaining, Request, Searched, Stopwatch, answer,
};
use dynamics::NominalSimulator;
use std::cell::OnceCell;

/// How often clocks are corrected: what a corrected search finds may leave a little more of them.
const CORRECTIONS: usize = 2;

/// Diagnoses the gap between a nominal simulator and records of one system.
///
/// `seconds` is a stopwatch: it gives seconds since any moment. Costs are linear in the number of samples up to
/// 20,000; of more, every so many are taken or whole segments are left out, and the answer states the share used. The
/// same input gives the same bits with any number of threads (times apart).
///
/// `simulator` is the nominal oscillator, alone or with effects that it has already: these are part of every hypothesis
/// and no candidates.
///
/// # Errors
/// [`DiagnosisError`] for records that say nothing, or that are not of this system.
pub fn diagnose(
    records: &[Observations],
    simulator: impl Into<NominalSimulator>,
    settings: &Settings,
    seconds: &dyn Fn() -> f64,
) -> Result<Diagnosis, DiagnosisError> {
    diagnose_watched(records, simulator, settings, seconds, &|_| true)
}

/// Diagnoses as [`diagnose`] does. `goes_on` is called after each stage but the last with the stage's name, and ends the diagnosis
/// where it gives false.
///
/// # Errors
/// As [`diagnose`], and [`DiagnosisError::Interrupted`].
pub fn diagnose_watched(
    records: &[Observations],
    simulator: impl Into<NominalSimulator>,
    settings: &Settings,
    seconds: &dyn Fn() -> f64,
    goes_on: &dyn Fn(&'static str) -> bool,
) -> Result<Diagnosis, DiagnosisError> {
    let simulator = &simulator.into();
    let mut watch = Stopwatch::new(seconds, goes_on);
    let mut clocks = ClockRates::as_stamped(records);
    let mut search = |clocks: &ClockRates, known: Option<Known>| -> Result<_, DiagnosisError> {
        let request = Request { records: &clocks.records, simulator, settings };
        let measured = watch.after("measurement chain", Measured::of(&request)?)?;
        let question = watch.after("calibration", Question::of(&request, &measured)?)?;
        let searched = watch.after("search", Searched::of(&request, &question, measured.is_whole, known))?;
        Ok((measured, question, searched))
    };
    let (mut measured, mut question, mut searched) = search(&clocks, None)?;
    for _ in 0..CORRECTIONS {
        let vocabulary = question.candidates.len();
        let sets = (&searched.interval, &searched.found);
        let Some((corrected, set)) = clocks.corrected(&question.coarse, sets, vocabulary)? else { break };
        let other = search(&corrected, Some(Known { by: searched.interval.by, set }))?;
        if !other.2.is_closer(&searched, vocabulary, corrected.price) {
            break;
        }
        (measured, question, searched) = other;
        clocks = corrected;
    }
    measured.findings.extend(clocks.finding());
    let request = Request { records: &clocks.records, simulator, settings };
    let refined = watch.after("fits", Refined::of(question, searched)?)?;
    let work = refined.context(&request);
    let completed = OnceCell::new();
    let judged = Judged::of(&request, &measured, &refined, &work, &completed)?;
    let judged = watch.after("held-out parts", judged)?;
    let unit = records.first().map_or("", |record| record.unit);
    let remaining = watch.after("left-over", Remaining::of(&work, &refined, &judged, unit)?)?;
    let mut answer = answer(request, &measured, &refined, &work, &judged, &remaining)?;
    answer.stages = watch.last("explanation");
    Ok(answer)
}
