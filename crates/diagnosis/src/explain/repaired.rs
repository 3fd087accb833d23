//! Repaired simulator: the coefficients and effects of a fit, as numbers for another simulator.

#![allow(clippy::indexing_slicing, reason = "matrices have a row and a column for every global parameter")]

use crate::answer::{RepairedSimulator, StartState, Undetermined};
use crate::data::segments::Data;
use crate::error::DiagnosisError;
use crate::evidence::determined::{reach, says_something};
use crate::explain::coefficients::{around, interval};
use crate::fit::fitted::{Fit, Point, first_starts};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::significance::{OFF_BY_CHANCE, significant};
use crate::fit::stopping::Stopping;
use crate::matrices::product;
use crate::model::candidate::Candidate;
use crate::model::hypothesis::{Calibrated, Hypothesis};
use crate::sets::shooting_interval::ShootingInterval;
use dynamics::{Active, DynamicsError, Effect, Hold, Nominal, NominalSimulator};
use nalgebra::DMatrix;
use results::WithInterval;

/// Number of digits kept behind the first digit of a standard error.
const GUARD: i32 = 2;

/// Builds the repaired simulator from a fit on a shooting interval. If the values are found to be rounded to
/// the sensor's steps, quantization is part of it.
///
/// The numbers are those of the longest shooting interval that the fit follows: what accumulates over a
/// record shows there, and it matters to anyone who runs the repaired simulator over a record.
///
/// # Errors
/// Returns an error if the motion cannot be computed or a number is not admitted.
pub(crate) fn repaired(
    horizon: ShootingInterval,
    segments: &Data,
    simulator: &NominalSimulator,
    is_rounded: bool,
    input_hold: Option<Hold>,
) -> Result<RepairedSimulator, DiagnosisError> {
    let ShootingInterval { data, calibrated: complete, .. } = farthest(horizon, segments);
    let data = &data;
    let (fit, undetermined) = without_undetermined(data, &complete);
    let errors = given_all_others(data, &fit);
    let nominal = rounded_nominal(&fit, &errors)?;
    let mut left_out = Vec::new();
    let mut effects = Vec::new();
    let known = &fit.hypothesis.known;
    for stated in simulator.effects() {
        let own = Candidate::of(&stated.active).map(|(candidate, _)| candidate);
        // An effect that no fit includes stays as stated.
        let place = known.iter().position(|known| Some(known.candidate) == own);
        let moved = place.map(|place| active(data, &fit, &errors, place, Some(&stated.active)));
        effects.push(moved.transpose()?.unwrap_or(stated.active));
    }
    for (index, candidate) in fit.hypothesis.candidates.iter().enumerate() {
        match active(data, &fit, &errors, known.len() + index, None) {
            Ok(found) => effects.push(found),
            Err(error) => left_out.push((candidate.id(), error.to_string())),
        }
    }
    let quantization = Effect::find("sensor_quantization")?;
    // An effect that was stated or fitted is in the list already.
    if is_rounded && !effects.iter().any(|active| active.effect() == quantization) {
        effects.extend(Active::of(quantization, &[step(data)]));
    }
    let start = start(data, &fit);
    Ok(RepairedSimulator { nominal, effects, start, undetermined, input_hold, left_out })
}

/// Returns the fitted state at the first sample of the first record.
fn start(data: &Data, fit: &Fit) -> Option<StartState> {
    data.segments.first().filter(|segment| segment.first && segment.record == 0)?;
    let [position, velocity, own @ ..] = fit.point.starts.first()?.as_slice() else { return None };
    let mut own = own.iter().copied();
    let effects = fit.hypothesis.effects().filter(|effect| !effect.free_hidden().is_empty());
    let hidden = effects
        .map(|effect| (effect.id(), own.by_ref().take(effect.free_hidden().len()).collect()))
        .collect();
    Some(StartState { position: *position, velocity: *velocity, hidden })
}

/// Returns the fit on the longest shooting interval that it follows. If the squares are uneven in the start
/// states, the fit is also begun anew, as a diagnosis with the repaired simulator would begin it, and the
/// better of the two is kept.
fn farthest(horizon: ShootingInterval, segments: &Data) -> ShootingInterval {
    let anew = restarted(&horizon, segments)
        .map(|fit| ShootingInterval::shortest(segments, &fit).farthest(segments));
    let own = horizon.farthest(segments);
    match anew {
        Some(anew) if anew.by > own.by => anew,
        Some(anew) if anew.by == own.by && anew.calibrated.squares < own.calibrated.squares => anew,
        _ => own,
    }
}

/// Returns the best fit to the segments as cut that begins at guessed start states; `None` if the hypothesis
/// is smooth.
fn restarted(horizon: &ShootingInterval, segments: &Data) -> Option<Fit> {
    let from = &horizon.calibrated;
    let hypothesis = &from.hypothesis;
    if hypothesis.smooth() {
        return None;
    }
    let guess = Point { globals: from.point.globals.clone(), starts: first_starts(segments, hypothesis) };
    let settled = fit(segments, hypothesis, guess.clone(), Moving::Starts, Stopping::FINAL).ok();
    let begun = settled.map(|settled| settled.point).into_iter().chain([guess]);
    let fits = begun.filter_map(|point| fit(segments, hypothesis, point, Moving::All, Stopping::FINAL).ok());
    fits.min_by(|a, b| a.squares.total_cmp(&b.squares))
}

/// Calibrated number of a fit, or one of an effect: its name and the reach of its interval.
struct Number {
    name: String,
    /// Entries that leave the calibration if the number is held; empty for an effect that the nominal
    /// simulator lacks.
    held: Vec<Calibrated>,
    reach: f64,
    determined: bool,
}

fn numbers(data: &Data, fit: &Fit) -> Vec<Number> {
    let facts = &data.facts;
    let number = |name: String, held, quantity, estimate: &WithInterval| Number {
        name,
        held,
        reach: reach(facts, quantity, estimate),
        determined: says_something(facts, quantity, estimate),
    };
    let own = &fit.hypothesis.calibrated;
    let plain = own.iter().enumerate().filter(|(_, which)| !matches!(which, Calibrated::Effect { .. }));
    let mut all: Vec<Number> = plain
        .map(|(place, which)| {
            number(which.name().to_owned(), vec![*which], which.quantity(), &interval(fit, place))
        })
        .collect();
    let parts = fit.hypothesis.all_parts(facts, &fit.point.globals);
    for (index, (effect, place, fitted)) in parts.into_iter().enumerate() {
        let Some(place) = place else { continue };
        let is_own =
            |which: &&Calibrated| matches!(which, Calibrated::Effect { known, .. } if *known == index);
        let held: Vec<Calibrated> = own.iter().filter(is_own).copied().collect();
        let values = effect.values(fitted).into_iter().zip(fit.spread(effect, place, fitted));
        for (at, ((value, error), parameter)) in values.zip(effect.parameters(facts)).enumerate() {
            let name = format!("{}.{}", effect.id(), parameter.name);
            all.push(number(name, held.clone(), effect.quantity(at), &around(value, error)));
        }
    }
    all
}

/// Holds the numbers that the data do not determine at their nominal values, one after the other, the widest
/// first: once one is held, another may be determined. A number stays as fitted if the data contradict its
/// nominal value. Also returns all numbers that are not determined.
fn without_undetermined(data: &Data, complete: &Fit) -> (Fit, Vec<Undetermined>) {
    let time = complete.autocorrelation_time();
    let mut fit = complete.clone();
    let mut found: Vec<Undetermined> = Vec::new();
    loop {
        let mut open: Vec<Number> = numbers(data, &fit)
            .into_iter()
            .filter(|number| !number.determined && !found.iter().any(|known| known.name == number.name))
            .collect();
        open.sort_by(|a, b| b.reach.total_cmp(&a.reach));
        let Some(widest) = open.into_iter().next() else {
            // A number that stayed as fitted may be determined once others are held.
            let still = numbers(data, &fit);
            let is_open = |name: &str| still.iter().any(|number| number.name == name && !number.determined);
            found.retain(|own| own.is_nominal || is_open(&own.name));
            return (fit, found);
        };
        let held = |which: &Calibrated| widest.held.contains(which);
        let with = holding(data, &fit, &held);
        let is_free = |with: &Fit| {
            !significant(complete, with, time, complete.globals() - with.globals(), OFF_BY_CHANCE)
        };
        let with = with.filter(is_free);
        found.push(Undetermined { name: widest.name, is_nominal: with.is_some() });
        fit = with.unwrap_or(fit);
    }
}

/// Refits with some of the calibrated entries held at their nominal values; `None` if there are none to hold
/// or the fit fails.
fn holding(data: &Data, from: &Fit, held: &dyn Fn(&Calibrated) -> bool) -> Option<Fit> {
    let own = &from.hypothesis;
    let calibrated: Vec<Calibrated> = own.calibrated.iter().copied().filter(|which| !held(which)).collect();
    if calibrated.len() == own.calibrated.len() {
        return None;
    }
    let moved = from.point.globals.iter().enumerate();
    let globals =
        moved.filter(|(place, _)| !own.calibrated.get(*place).is_some_and(held)).map(|(_, value)| *value);
    let point = Point { globals: globals.collect(), starts: from.point.starts.clone() };
    let hypothesis = Hypothesis { calibrated, ..own.clone() };
    fit(data, &hypothesis, point, Moving::All, Stopping::FINAL).ok()
}

/// Returns the standard error of each number with all others given, for a law's parameters in place of the
/// fitted ones. It is the scale for rounding a number, since the others do not move along.
fn given_all_others(data: &Data, fit: &Fit) -> Vec<f64> {
    let count = fit.globals();
    let mut change = DMatrix::identity(count, count);
    for (effect, place, fitted) in fit.hypothesis.all_parts(&data.facts, &fit.point.globals) {
        let Some(place) = place else { continue };
        for (row, column, slope) in effect.slopes(fitted) {
            change[(place + row, place + column)] = slope;
        }
    }
    let covariance = product(&change, &product(&fit.inverse, &change.transpose())) * fit.variance();
    // Scaled to a unit diagonal before the inversion, because units differ by many orders of magnitude.
    let scale = covariance.diagonal().map(|square| square.max(f64::MIN_POSITIVE).sqrt());
    let at = |index: usize| scale.get(index).copied().unwrap_or(1.0);
    let scaled =
        DMatrix::from_fn(count, count, |row, column| covariance[(row, column)] / (at(row) * at(column)));
    match scaled.try_inverse() {
        Some(precision) => {
            (0..count).map(|index| at(index) / precision[(index, index)].max(1.0).sqrt()).collect()
        }
        None => vec![0.0; count],
    }
}

/// Rounds a number to the digits that its standard error determines, and two more. Returns it unchanged if
/// the error is unknown (0, negative or not finite). A number smaller than its last digit keeps one digit.
#[must_use]
pub fn rounded(value: f64, error: f64) -> f64 {
    if !(error.is_finite() && error > 0.0) {
        return value;
    }
    let decimals = f64::from(GUARD) - libm::log10(error).floor();
    // The parse gives the double nearest to the shortest decimal. Beyond these limits the value is returned
    // as it is.
    if !(-300.0..=300.0).contains(&decimals) {
        return value;
    }
    let size = libm::log10(value.abs().max(f64::MIN_POSITIVE)).floor();
    let digits = (size + decimals).clamp(0.0, 17.0) as usize;
    format!("{value:.digits$e}").parse().unwrap_or(value)
}

fn rounded_nominal(fit: &Fit, errors: &[f64]) -> Result<Nominal, DynamicsError> {
    let calibrated = fit.hypothesis.calibrated.iter().zip(&fit.point.globals).zip(errors);
    let point: Vec<f64> = calibrated
        .map(|((which, value), error)| match which {
            // A rounded coefficient must not fall below 0.
            Calibrated::RestAngle => rounded(*value, *error),
            _ => rounded(*value, *error).max(0.0),
        })
        .collect();
    fit.hypothesis.calibrated_nominal(&point)
}

/// Returns an effect of a fit by its index among all, based on the nominal simulator's statement of it.
fn active(
    data: &Data,
    fit: &Fit,
    errors: &[f64],
    index: usize,
    stated: Option<&Active>,
) -> Result<Active, DynamicsError> {
    let facts = &data.facts;
    let parts = fit.hypothesis.all_parts(facts, &fit.point.globals);
    let Some(&(effect, place, fitted)) = parts.get(index) else {
        return Err(DynamicsError::UnknownEffect { id: index.to_string(), known: Vec::new() });
    };
    if let (Some(stated), None) = (stated, place) {
        return Ok(*stated);
    }
    // A candidate that was not fitted has no errors.
    let errors = place.into_iter().flat_map(|place| errors.iter().skip(place)).copied();
    let values = effect.values(fitted).into_iter().zip(errors.chain(std::iter::repeat(0.0)));
    let values: Vec<f64> = values.map(|(value, error)| rounded(value, error)).collect();
    if let Some(effect) = effect.system() {
        return crate::model::hypothesis::active(effect, &values);
    }
    let kind = Effect::find(effect.id())?;
    let names: Vec<&str> = effect.parameters(facts).iter().map(|parameter| parameter.name).collect();
    let own = |name: &str| names.iter().position(|own| *own == name).and_then(|at| values.get(at).copied());
    let parameters = kind.description().parameters.iter().map(|parameter| {
        let stated = || stated.and_then(|stated| stated.value(parameter.name));
        let is_step = effect.step_parameter() == Some(parameter.name);
        own(parameter.name).or_else(stated).unwrap_or(if is_step { step(data) } else { 0.0 })
    });
    Active::of(kind, &parameters.collect::<Vec<_>>())
}

/// Returns the sensor's step, rounded to the digits that counting steps over the whole motion determines.
fn step(data: &Data) -> f64 {
    let facts = &data.facts;
    let step = data.resolution.unwrap_or(facts.resolution);
    rounded(step, step * step / (facts.highest - facts.lowest))
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn digits_follow_the_error() {
        assert_eq!(rounded(1.533_986_912_949_457_1e-3, 1.7e-6), 0.001_533_99);
        assert_eq!(rounded(484.123_456, 0.3), 484.123);
        assert_eq!(rounded(-484.123_456, 30.0), -484.1);
        assert_eq!(rounded(0.000_4, 0.3), 0.000_4);
        assert_eq!(rounded(0.0, 0.3), 0.0);
        assert_eq!(rounded(123_456.7, 1e5), 123_000.0);
        assert_eq!(rounded(0.1 + 0.2, 0.0), 0.1 + 0.2);
        assert_eq!(rounded(0.1 + 0.2, f64::INFINITY), 0.1 + 0.2);
    }
}
