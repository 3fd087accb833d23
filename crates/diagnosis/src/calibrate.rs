//! The nominal simulator against the data: as it is, and recalibrated.

use crate::error::DiagnosisError;
use crate::fit::{Effort, Fit, Moving, Point, first_starts, fit};
use crate::hypothesis::{Calibrated, Hypothesis};
use crate::segments::Data;
use dynamics::{Hold, Nominal};

/// The given simulator and the recalibrated one.
#[derive(Debug, Clone)]
pub(crate) struct Baseline {
    /// Start states fitted only.
    pub(crate) nominal: Fit,
    /// Coefficients fitted too.
    pub(crate) calibrated: Fit,
}

/// What calibration may move: damping always, stiffness and rest angle where there is a spring, the inertia where
/// a measured input tells it apart from the stiffness.
pub(crate) fn movable(nominal: &Nominal, driven: bool) -> Vec<Calibrated> {
    let mut movable = Vec::new();
    if driven {
        movable.push(Calibrated::Inertia);
    }
    movable.push(Calibrated::Damping);
    if nominal.stiffness() > 0.0 {
        movable.extend([Calibrated::Stiffness, Calibrated::RestAngle]);
    }
    movable
}

/// Fits the start states alone, then the coefficients.
pub(crate) fn baseline(data: &Data, nominal: &Nominal) -> Result<Baseline, DiagnosisError> {
    let hypothesis =
        Hypothesis { nominal: *nominal, calibrated: movable(nominal, data.driven()), candidates: Vec::new() };
    let point = Point { globals: hypothesis.nominal_point(), starts: first_starts(data, &hypothesis) };
    let nominal = fit(data, &hypothesis, point, Moving::Starts, Effort::FINAL)?;
    // A stiffness far off lets the starts of the nominal fit wander: begin from both, keep the better.
    let from_guess =
        Point { globals: nominal.point.globals.clone(), starts: first_starts(data, &hypothesis) };
    let mut guessed = from_guess.clone();
    if let (Some(period), Some(at)) =
        (data.period_s, hypothesis.calibrated.iter().position(|own| *own == Calibrated::Stiffness))
    {
        let omega = std::f64::consts::TAU / period;
        if let Some(stiffness) = guessed.globals.get_mut(at) {
            *stiffness = hypothesis.nominal.inertia() * omega * omega;
        }
    }
    let mut best: Option<Fit> = None;
    for point in [nominal.point.clone(), guessed] {
        let found = fit(data, &hypothesis, point, Moving::All, Effort::FINAL)?;
        if best.as_ref().is_none_or(|best| found.squares < best.squares) {
            best = Some(found);
        }
    }
    let calibrated = best
        .filter(|fit| fit.squares.is_finite())
        .ok_or_else(|| DiagnosisError::NotFitted { reason: "its squares are not finite".to_owned() })?;
    Ok(Baseline { nominal, calibrated })
}

/// The belief about the input between its samples that fits better: kept, or changing linearly.
pub(crate) fn better_hold(data: &Data, nominal: &Nominal) -> Result<(Data, Baseline), DiagnosisError> {
    let linear = baseline(data, nominal)?;
    if !data.driven() {
        return Ok((data.clone(), linear));
    }
    let zero_data = data.holding(Hold::Zero)?;
    let zero = baseline(&zero_data, nominal)?;
    if zero.calibrated.squares < linear.calibrated.squares {
        Ok((zero_data, zero))
    } else {
        Ok((data.clone(), linear))
    }
}
