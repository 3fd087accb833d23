//! The nominal simulator against the data: as it is, and recalibrated.

use crate::data::segments::Data;
use crate::error::DiagnosisError;
use crate::evidence::weights::{OFF_BY_CHANCE, significant};
use crate::fit::fitted::{Fit, Point, first_starts};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::hypothesis::{Calibrated, Hypothesis, Known};
use dynamics::{Hold, Nominal, NominalSimulator};

/// The given simulator and the recalibrated one.
#[derive(Debug, Clone)]
pub(crate) struct Baseline {
    /// Start states fitted only.
    pub(crate) nominal: Fit,
    /// Coefficients fitted too.
    pub(crate) calibrated: Fit,
}

impl Baseline {
    /// Whether coefficients are off by more than chance.
    pub(crate) fn is_off(&self) -> bool {
        let time = self.calibrated.autocorrelation_time();
        significant(&self.calibrated, &self.nominal, time, self.calibrated.globals(), OFF_BY_CHANCE)
    }
}

/// What calibration may move: damping always, stiffness and rest angle where there is a spring, the inertia where
/// a measured input tells it apart from the stiffness; and known effects as stated.
pub(crate) fn movable(nominal: &Nominal, known: &[Known], driven: bool) -> Vec<Calibrated> {
    let mut movable = Vec::new();
    if driven {
        movable.push(Calibrated::Inertia);
    }
    movable.push(Calibrated::Damping);
    if nominal.stiffness() > 0.0 {
        movable.extend([Calibrated::Stiffness, Calibrated::RestAngle]);
    }
    for (number, own) in known.iter().enumerate().filter(|(_, own)| own.recalibrate) {
        let parameters = 0..own.stated.len();
        movable.extend(parameters.map(|parameter| Calibrated::Effect { known: number, parameter }));
    }
    movable
}

/// Fits the start states alone, then the coefficients.
pub(crate) fn baseline(data: &Data, simulator: &NominalSimulator) -> Result<Baseline, DiagnosisError> {
    let nominal = simulator.nominal();
    let known = Known::of(simulator, data.quantity);
    let calibrated = movable(nominal, &known, data.driven());
    let hypothesis = Hypothesis { nominal: *nominal, known, calibrated, candidates: Vec::new() };
    let point = Point { globals: hypothesis.nominal_point(), starts: first_starts(data, &hypothesis) };
    let nominal = fit(data, &hypothesis, point, Moving::Starts, Stopping::FINAL)?;
    // A stiffness far off lets the starts of the nominal fit wander: begin from both, keep the better.
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

/// Gives the spring the stiffness that lets it swing at an angular frequency beside a weight; where there is none, the
/// weight its torque.
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
    // Both of its parameters are parts of the torque.
    for torque in first.and_then(|at| globals.get_mut(at..at + 2)).into_iter().flatten() {
        *torque *= wanted / stated;
    }
}

/// The belief about the input between its samples that fits better: kept, or changing linearly.
pub(crate) fn better_hold(
    data: &Data,
    simulator: &NominalSimulator,
) -> Result<(Data, Baseline), DiagnosisError> {
    let linear = baseline(data, simulator)?;
    if !data.driven() {
        return Ok((data.clone(), linear));
    }
    let zero_data = data.holding(Hold::Zero)?;
    let zero = baseline(&zero_data, simulator)?;
    // A delay that is known was found with one of the two beliefs, and half an interval lies between them: the belief with
    // which the simulator needs no calibration stays.
    let is_right = |own: &Baseline| !simulator.effects().is_empty() && !own.is_off();
    let is_better = match (is_right(&zero), is_right(&linear)) {
        (true, false) => true,
        (false, true) => false,
        _ => zero.calibrated.squares < linear.calibrated.squares,
    };
    if is_better { Ok((zero_data, zero)) } else { Ok((data.clone(), linear)) }
}
