//! True closure: share of the gap to the noise-free motion that an answer's simulator removes.

#![allow(clippy::indexing_slicing, reason = "position and velocity come first in every state")]

use super::judgment::Judgment;
use super::statistics::proportion;
use crate::hidden::{Bank, Hidden};
use dynamics::chain::Observed;
use dynamics::sensitivity::{Free, FullState, Model, Response, Settings};
use dynamics::{Active, DynamicsError, Effect, Hold, Input, Nominal, SYSTEM_HIDDEN, System};
use least_squares::{Descent, Method};
use nalgebra::{DMatrix, DVector};
use results::{CalibratedRow, ClosureStudy, DiagnosisResult};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use truth::Truth;

/// Length in periods of a segment with its own initial state.
const PERIODS: f64 = 6.0;
/// Number of compared samples per period: a swing contains only a few harmonics.
const PER_PERIOD: f64 = 25.0;
/// Lower limit of a stated closure, which a diagnosis also applies: worse by the gap itself.
const LOWEST: f64 = -1.0;
/// Method of fitting an initial state.
const METHOD: Method = Method {
    first: 1e-4,
    least: 1e-12,
    least_raised: 1e-6,
    max_steps: 40,
    tolerance: 1e-9,
    max_damping: 1e7,
    ..Method::TENFOLD
};

const MEANS: &str = "1 − m²/m₀², m and m₀ the root mean square distances of the repaired and of the nominal simulator from the \
    motion without noise, start states fitted in segments of six periods; at least −1";

/// Returns the closure of an answer's repaired simulator on the noise-free motion: 1 − m²/m₀², where m and m₀
/// are the root mean square distances of the repaired and of the nominal simulator from the motion that
/// generated the records. Initial states (including hidden states) are fitted in segments of six periods.
///
/// `nominal` is the simulator that the diagnosis was given. The repaired simulator has the answer's
/// coefficients and the effects that the answer's gap was computed with.
///
/// # Errors
/// A text with the reason why there is no such number: measured residuals, hidden or named effects in the
/// measurement chain, no spring, no gap to close, a law outside the vocabulary, or a coefficient outside its
/// range.
pub fn true_closure(hidden: &Hidden, nominal: &Nominal, answer: &DiagnosisResult) -> Result<f64, String> {
    // The residual of a measured record also contains motion, which belongs to the gap that the diagnosis
    // sees.
    if hidden.bank == Bank::Measured {
        return Err("measured residuals hold motion that nobody knows".to_owned());
    }
    if hidden.records.is_empty() {
        return Err("the system cannot be said in the vocabulary".to_owned());
    }
    let in_chain = |id: &str| matches!(Effect::find(id), Ok(Effect::MeasuringChain(_)));
    if hidden.effects.iter().any(|effect| in_chain(&effect.id)) {
        return Err("a hidden effect lies in the measurement chain".to_owned());
    }
    let repaired = repaired(nominal, answer)?;
    let given = System::new(*nominal, Vec::new()).map_err(|error| error.to_string())?;
    let (mut before, mut after) = (0.0, 0.0);
    for truth in &hidden.records {
        let clean = Clean::of(truth).map_err(|_| "the clean motion cannot be simulated".to_owned())?;
        before += clean.misfit(&given)?;
        after += clean.misfit(&repaired)?;
    }
    // Both simulators fit to the accuracy of the integrator: there is nothing to close.
    if before <= 1e-12 * (1.0 + after) {
        return Err("there is no gap to close".to_owned());
    }
    Ok(1.0 - after / before)
}

/// Builds the simulator that an answer's gap was computed with.
fn repaired(nominal: &Nominal, answer: &DiagnosisResult) -> Result<System, String> {
    let value = |row: &CalibratedRow, own: f64| row.repaired.map_or(own, |found| found.value);
    let own = nominal.coefficients();
    let of = &answer.calibration;
    let coefficients = dynamics::Coefficients {
        inertia: value(&of.inertia, own.inertia),
        damping: value(&of.damping, own.damping),
        stiffness: value(&of.stiffness, own.stiffness),
        rest_angle: value(&of.rest_angle, own.rest_angle),
        input_gain: own.input_gain,
    };
    let outside = |_: DynamicsError| "a coefficient of the answer is outside its range".to_owned();
    let nominal = nominal.with_coefficients(coefficients).map_err(outside)?;
    let mut effects = Vec::new();
    // An effect with a share of the gap is part of the simulator that the gap was computed with.
    for row in answer.effects.iter().filter(|row| row.gap_share.is_some()) {
        if matches!(Effect::find(&row.id), Ok(Effect::MeasuringChain(_))) {
            return Err("a named effect lies in the measurement chain".to_owned());
        }
        let parameters: Vec<(&str, f64)> =
            row.parameters.iter().map(|(name, parameter)| (name.as_str(), parameter.value)).collect();
        effects.push(Active::named(&row.id, &parameters).map_err(outside)?);
    }
    System::new(nominal, effects).map_err(outside)
}

/// Noise-free motion in segments.
struct Clean {
    segments: Vec<Segment>,
    input: Option<Input>,
    observed: Observed,
}

struct Segment {
    times: Vec<f64>,
    values: Vec<f64>,
    start: FullState,
}

fn settings(observed: Observed) -> Settings {
    Settings {
        velocity: true,
        acceleration: observed == Observed::Acceleration,
        most_steps: 100_000,
        ..Settings::default()
    }
}

/// Returns the observed values and their derivatives with respect to the free quantities, row by row.
fn seen(response: &Response, observed: Observed) -> (&[f64], &[f64]) {
    match observed {
        Observed::Position => (&response.position, &response.position_sensitivity),
        Observed::Velocity => (&response.velocity, &response.velocity_sensitivity),
        Observed::Acceleration => (&response.acceleration, &response.acceleration_sensitivity),
    }
}

impl Clean {
    fn of(truth: &Truth) -> Result<Self, DynamicsError> {
        let sampling = &truth.sampling;
        let omega = truth.system.nominal().angular_frequency();
        if omega <= 0.0 || sampling.samples < 2 {
            return Err(DynamicsError::BadTimes { index: 0, value: omega });
        }
        let period = TAU / omega;
        let all: Vec<f64> = (0..sampling.samples).map(|index| index as f64 / sampling.rate_hz).collect();
        let duration = (sampling.samples - 1) as f64 / sampling.rate_hz;
        let input = match truth.excitation {
            Some(excitation) => {
                let values = all.iter().map(|&time| excitation.at(time, duration)).collect();
                Some(Input::new(all.clone(), values, Hold::Zero)?)
            }
            None => None,
        };
        let stride = ((sampling.rate_hz * period / PER_PERIOD) as usize).max(1);
        let times: Vec<f64> = all.into_iter().step_by(stride).collect();
        let observed = truth.chain.observed();
        let mut model = Model::new(&truth.system, &[], settings(observed))?;
        let motion = model.run(FullState::from(truth.start), input.as_ref(), &times)?;
        let (values, _) = seen(&motion, observed);
        let count = ((duration / (PERIODS * period)).round() as usize).max(2);
        let per_segment = times.len().div_ceil(count).max(4);
        let segments = (0..times.len())
            .step_by(per_segment)
            .filter_map(|from| {
                let to = (from + per_segment).min(times.len());
                let start = FullState {
                    position: *motion.position.get(from)?,
                    velocity: *motion.velocity.get(from)?,
                    hidden: None,
                };
                let times = times.get(from..to).filter(|times| times.len() >= 4)?.to_vec();
                Some(Segment { times, values: values.get(from..to)?.to_vec(), start })
            })
            .collect();
        Ok(Self { segments, input, observed })
    }

    /// Returns the sum of squares that a system leaves of the motion, with fitted initial states.
    fn misfit(&self, system: &System) -> Result<f64, String> {
        let hidden = system.hidden_states();
        let free: Vec<Free> = [Free::StartPosition, Free::StartVelocity]
            .into_iter()
            .chain((0..hidden).map(Free::StartHidden))
            .collect();
        let words = |error: DynamicsError| error.to_string();
        let mut model = Model::new(system, &free, settings(self.observed)).map_err(words)?;
        let mut sum = 0.0;
        for segment in &self.segments {
            sum += self.fitted(&mut model, segment, hidden).map_err(|_| {
                "the repaired simulator cannot be run from the clean motion's states".to_owned()
            })?;
        }
        Ok(sum)
    }

    /// Returns the sum of squares with the best initial state, by Levenberg–Marquardt from the initial state
    /// of the noise-free motion.
    fn fitted(&self, model: &mut Model, segment: &Segment, hidden: usize) -> Result<f64, DynamicsError> {
        let first = segment.times.get(..1).unwrap_or(&segment.times);
        let relaxed = model.run(segment.start, self.input.as_ref(), first)?.end.hidden;
        let mut at = vec![segment.start.position, segment.start.velocity];
        at.extend(relaxed.iter().flatten().take(hidden));
        let (residual, jacobian) = self.residual(model, segment, &at)?;
        let mut best = (at, residual, jacobian);
        let mut descent = Descent::new(METHOD);
        while let Ok(damping) = descent.next_damping() {
            let (at, residual, jacobian) = &best;
            let mut matrix = jacobian.tr_mul(jacobian);
            let slope = jacobian.tr_mul(residual);
            for index in 0..matrix.nrows() {
                if let Some(entry) = matrix.get_mut((index, index)) {
                    *entry += damping * *entry + f64::MIN_POSITIVE;
                }
            }
            let Some(factor) = matrix.cholesky() else { break };
            let step = factor.solve(&slope);
            let next: Vec<f64> = at.iter().zip(step.iter()).map(|(value, step)| value + step).collect();
            let trial = self.residual(model, segment, &next).ok();
            let trial = trial.map(|(residual, jacobian)| (next, residual, jacobian));
            descent.advance(&mut best, trial, |(_, residual, _)| residual.norm_squared());
        }
        Ok(best.1.norm_squared())
    }

    fn residual(
        &self,
        model: &mut Model,
        segment: &Segment,
        at: &[f64],
    ) -> Result<(DVector<f64>, DMatrix<f64>), DynamicsError> {
        debug_assert!(at.len() >= 2);
        let mut states = [0.0; SYSTEM_HIDDEN];
        for (slot, value) in states.iter_mut().zip(at.iter().skip(2)) {
            *slot = *value;
        }
        let hidden = (at.len() > 2).then_some(states);
        let start = FullState { position: at[0], velocity: at[1], hidden };
        let response = model.run(start, self.input.as_ref(), &segment.times)?;
        let (values, derivatives) = seen(&response, self.observed);
        let rows = segment.values.len();
        let residual = DVector::from_iterator(rows, segment.values.iter().zip(values).map(|(a, b)| a - b));
        Ok((residual, DMatrix::from_row_slice(rows, at.len(), derivatives)))
    }
}

/// Returns the coverage of the stated closure intervals.
pub(crate) fn study(judged: &[Judgment<'_>]) -> ClosureStudy {
    let mut left_out: BTreeMap<String, u64> = BTreeMap::new();
    let (mut held, mut below, mut above) = (Vec::new(), 0, 0);
    for judgment in judged {
        match (&judgment.case.true_closure, judgment.answer()) {
            (Ok(closure), Some(answer)) => {
                let [low, high] = answer.gap.closure.interval_95.map(|end| end.max(LOWEST));
                let closure = closure.max(LOWEST);
                held.push(low <= closure && closure <= high);
                below += u64::from(closure < low);
                above += u64::from(closure > high);
            }
            (Err(reason), Some(_)) => *left_out.entry(reason.clone()).or_default() += 1,
            (_, None) => *left_out.entry("no answer".to_owned()).or_default() += 1,
        }
    }
    ClosureStudy { means: MEANS.to_owned(), coverage: proportion(held), below, above, left_out }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::sample::{answered, case};
    use dynamics::Start;
    use dynamics::chain::Chain;
    use results::{EffectRow, ParameterRow, WithInterval};
    use truth::{Draws, Sampling, TRUTH_SCHEMA};

    fn exactly(value: f64) -> WithInterval {
        WithInterval { value, interval_95: [value, value] }
    }

    /// Builds a decay with effects that the nominal simulator lacks and a nominal damping that is 20 % too
    /// large.
    fn hidden(effects: &[(&str, &[f64])]) -> (Hidden, Nominal) {
        let nominal = Nominal::new(1.0, 0.3, 484.0, 0.0).unwrap();
        let active = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
        let truth = Truth {
            schema: TRUTH_SCHEMA.to_owned(),
            system: System::new(nominal, active).unwrap(),
            start: Start::release(0.7),
            excitation: None,
            chain: Chain::new(Observed::Position, 1e-3, Vec::new()).unwrap(),
            sampling: Sampling {
                rate_hz: 130.0,
                samples: 1300,
                first_stamp_s: 0.0,
                stamp_decimals: 6,
                value_decimals: 9,
            },
            draws: Draws { seed: 0, branch: Vec::new() },
        };
        let ids: Vec<&str> = effects.iter().map(|(id, _)| *id).collect();
        let mut hidden = case(Bank::Single, &ids, answered("none", &[], 0.5)).hidden;
        hidden.records = vec![truth];
        (hidden, Nominal::new(1.0, 0.36, 484.0, 0.0).unwrap())
    }

    fn answer(effects: &[(&str, &[(&str, f64)])], damping: Option<f64>) -> DiagnosisResult {
        let named: Vec<&str> = effects.iter().map(|(id, _)| *id).collect();
        let mut answer = answered("effect", &named, 0.9).unwrap();
        answer.calibration.damping.repaired = damping.map(exactly);
        let row = |(id, parameters): &(&str, &[(&str, f64)])| EffectRow {
            id: (*id).to_owned(),
            title: (*id).to_owned(),
            probability: 0.9,
            parameters: parameters
                .iter()
                .map(|(name, value)| {
                    let row = ParameterRow {
                        determined: true,
                        value: *value,
                        unit: String::new(),
                        interval_95: [0.0, 1.0],
                    };
                    ((*name).to_owned(), row)
                })
                .collect(),
            gap_share: Some(exactly(1.0)),
        };
        answer.effects = effects.iter().map(row).collect();
        answer
    }

    #[test]
    fn the_true_system_closes_all_and_the_nominal_one_nothing() {
        let (hidden, nominal) = hidden(&[("coulomb_friction", &[1.0])]);
        let of = |effects: &[(&str, &[(&str, f64)])], damping| {
            true_closure(&hidden, &nominal, &answer(effects, damping)).unwrap()
        };
        let all = of(&[("coulomb_friction", &[("torque", 1.0)])], Some(0.3));
        assert!((all - 1.0).abs() < 1e-9, "{all}");
        assert!(of(&[], None).abs() < 1e-12);
        let half = of(&[("coulomb_friction", &[("torque", 0.8)])], Some(0.32));
        assert!(0.0 < half && half < 1.0, "{half}");
        // Overshooting far is worse than changing nothing.
        assert!(of(&[("coulomb_friction", &[("torque", 4.0)])], Some(0.3)) < 0.0);
    }

    #[test]
    fn hidden_states_are_fitted_at_every_start() {
        let (hidden, nominal) = hidden(&[("hysteresis", &[1.0, 0.05])]);
        let effects: &[(&str, &[(&str, f64)])] =
            &[("hysteresis", &[("torque", 1.0), ("displacement", 0.05)])];
        let all = true_closure(&hidden, &nominal, &answer(effects, Some(0.3))).unwrap();
        assert!((all - 1.0).abs() < 1e-5, "{all}");
    }

    #[test]
    fn what_has_no_closure_says_why() {
        let (mut own, nominal) = hidden(&[]);
        let why = |hidden: &Hidden, nominal: &Nominal, answer: &DiagnosisResult| {
            true_closure(hidden, nominal, answer).unwrap_err()
        };
        let exact = Nominal::new(1.0, 0.3, 484.0, 0.0).unwrap();
        assert_eq!(why(&own, &exact, &answer(&[], None)), "there is no gap to close");
        let drift = answer(&[("sensor_drift", &[])], None);
        assert_eq!(why(&own, &nominal, &drift), "a named effect lies in the measurement chain");
        let impossible = answer(&[("coulomb_friction", &[("torque", -1.0)])], None);
        assert_eq!(why(&own, &nominal, &impossible), "a coefficient of the answer is outside its range");
        own.bank = Bank::Measured;
        assert_eq!(
            why(&own, &nominal, &answer(&[], None)),
            "measured residuals hold motion that nobody knows"
        );
        own.bank = Bank::Single;
        own.records.clear();
        assert_eq!(why(&own, &nominal, &drift), "the system cannot be said in the vocabulary");
    }
}
