//! Fits of the nominal simulator to the data: with its coefficients as they are, and recalibrated.

use crate::data::segments::Data;
use crate::error::DiagnosisError;
use crate::fit::fitted::{Fit, Point, first_starts};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::significance::{OFF_BY_CHANCE, significant};
use crate::fit::stopping::Stopping;
use crate::model::hypothesis::{Calibrated, Hypothesis, Known};
use dynamics::{Effect, Hold, Nominal, NominalSimulator, SystemEffect};
use rayon::prelude::*;

/// Fits of the given simulator and of the recalibrated one.
#[derive(Debug, Clone)]
pub(crate) struct Baseline {
    /// Fit of the start states only.
    pub(crate) nominal: Fit,
    /// Fit of the start states and the calibrated coefficients.
    pub(crate) calibrated: Fit,
}

impl Baseline {
    /// Returns `true` if the coefficients differ from their nominal values by more than chance.
    pub(crate) fn is_off(&self) -> bool {
        let time = self.calibrated.autocorrelation_time();
        significant(&self.calibrated, &self.nominal, time, self.calibrated.globals(), OFF_BY_CHANCE)
    }
}

/// Returns what calibration may move: the damping always, stiffness and rest angle if there is a spring, the
/// inertia if a measured input tells it apart from the stiffness, and the parameters of known effects that
/// are to be recalibrated. On a spring a known constant torque does what the rest angle does, and moves in its place.
pub(crate) fn movable(nominal: &Nominal, known: &[Known], driven: bool) -> Vec<Calibrated> {
    let mut movable = Vec::new();
    if driven {
        movable.push(Calibrated::Inertia);
    }
    movable.push(Calibrated::Damping);
    if nominal.stiffness() > 0.0 {
        movable.push(Calibrated::Stiffness);
        let torque = Effect::System(SystemEffect::ConstantTorque);
        if !known.iter().any(|own| own.recalibrate && own.candidate.effect() == torque) {
            movable.push(Calibrated::RestAngle);
        }
    }
    for (number, own) in known.iter().enumerate().filter(|(_, own)| own.recalibrate) {
        let parameters = 0..own.stated.len();
        movable.extend(parameters.map(|parameter| Calibrated::Effect { known: number, parameter }));
    }
    movable
}

/// Fits the start states alone, then the coefficients too.
pub(crate) fn baseline(data: &Data, simulator: &NominalSimulator) -> Result<Baseline, DiagnosisError> {
    let nominal = simulator.nominal();
    let known = Known::of(simulator, data.quantity);
    let calibrated = movable(nominal, &known, data.driven());
    let hypothesis = Hypothesis { nominal: *nominal, known, calibrated, candidates: Vec::new() };
    let point = Point { globals: hypothesis.nominal_point(), starts: first_starts(data, &hypothesis) };
    let nominal = fit(data, &hypothesis, point, Moving::Starts, Stopping::FINAL)?;
    // With a stiffness far off, the start states of the nominal fit wander: begin from both, keep the better.
    let from_guess =
        Point { globals: nominal.point.globals.clone(), starts: first_starts(data, &hypothesis) };
    let mut guessed = from_guess.clone();
    if let Some(period) = data.period_s {
        let omega = std::f64::consts::TAU / period;
        swinging_at(omega, simulator, &hypothesis, &mut guessed.globals);
    }
    let mut best: Option<Fit> = None;
    for point in [nominal.point.clone(), guessed] {
        let found = fit(data, &hypothesis, point, Moving::All, Stopping::FINAL)?;
        if best.as_ref().is_none_or(|best| found.squares < best.squares) {
            best = Some(found);
        }
    }
    let calibrated = best
        .filter(|fit| fit.squares.is_finite())
        .ok_or_else(|| DiagnosisError::NotFitted { reason: "its squares are not finite".to_owned() })?;
    Ok(Baseline { nominal, calibrated })
}

/// Sets the spring's stiffness so that, together with a weight, the system swings at an angular frequency.
/// Without a spring to calibrate, scales the torque of the weight instead.
fn swinging_at(omega: f64, simulator: &NominalSimulator, hypothesis: &Hypothesis, globals: &mut [f64]) {
    let place = |wanted: Calibrated| hypothesis.calibrated.iter().position(|own| *own == wanted);
    let wanted = hypothesis.nominal.inertia() * omega * omega;
    let (_, stated) = simulator.equilibrium();
    if let Some(stiffness) = place(Calibrated::Stiffness).and_then(|at| globals.get_mut(at)) {
        *stiffness = (wanted - (stated - hypothesis.nominal.stiffness())).max(0.0);
        return;
    }
    let known = hypothesis.known.iter().position(|known| known.candidate.is_weight());
    let first = known.and_then(|known| place(Calibrated::Effect { known, parameter: 0 }));
    // Both parameters of a weight are components of its torque.
    for torque in first.and_then(|at| globals.get_mut(at..at + 2)).into_iter().flatten() {
        *torque *= wanted / stated;
    }
}

/// Returns the data and fits for the behavior of the input between its samples that fits best.
pub(crate) fn best_hold(
    data: &Data,
    simulator: &NominalSimulator,
) -> Result<(Data, Baseline), DiagnosisError> {
    if !data.driven() {
        return Ok((data.clone(), baseline(data, simulator)?));
    }
    let under = |hold: Hold| -> Result<(Data, Baseline), DiagnosisError> {
        let data = data.holding(hold)?;
        let own = baseline(&data, simulator)?;
        Ok((data, own))
    };
    let mut all: Vec<(Data, Baseline)> = Hold::ALL.into_par_iter().map(under).collect::<Result<_, _>>()?;
    // A known delay was found with one of the holds, which differ by half an interval. So a hold with which the
    // simulator needs no calibration is kept.
    let is_right = |own: &Baseline| !simulator.effects().is_empty() && !own.is_off();
    if all.iter().any(|(_, own)| is_right(own)) {
        all.retain(|(_, own)| is_right(own));
    }
    let squares = |own: &(Data, Baseline)| own.1.calibrated.squares;
    all.into_iter()
        .min_by(|a, b| squares(a).total_cmp(&squares(b)))
        .ok_or_else(|| DiagnosisError::NotFitted { reason: "no input was tried".to_owned() })
}
