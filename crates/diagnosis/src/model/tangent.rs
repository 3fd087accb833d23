//! The response of an observed motion to small further torques.
//!
//! Along a fitted motion the system is linear in what is added to it: I·δ̈ + γ(t)·δ̇ + κ(t)·δ = f(t), with κ and γ the
//! derivatives of all torques at the motion. Between two samples κ and γ are taken constant (mean of both
//! ends) and f linear, which the matrix exponential solves exactly. At a reversal with dry friction δ̇ jumps by
//! the ratio of the accelerations after and before. One set of steps serves any number of torques; that is what
//! makes it possible to ask for a hundred candidates at once. Full fits use exact sensitivities instead.

use crate::data::scales::Scales;
use crate::data::segments::Data;
use crate::fit::levenberg_marquardt::Fit;
use crate::model::contact::bent;
use crate::model::predictor::{Derivatives, Motion, Simulator};
use dynamics::scalar::Dual;
use dynamics::{
    Coefficients, DynamicsError, Effect, MOST_HIDDEN, MOST_PARAMETERS, Moment, System, SystemEffect,
};
use nalgebra::{DMatrix, Matrix2, Vector2};
use record::Quantity;

/// The step from one sample to the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    transition: Matrix2<f64>,
    /// Response to the torque at the step's begin and at its end.
    from: Vector2<f64>,
    to: Vector2<f64>,
}

/// Terms of the exponential's series.
const TERMS: usize = 26;

impl Step {
    /// The step over a time h in seconds of I·δ̈ + γ·δ̇ + κ·δ = f, with f linear.
    pub(crate) fn of(h: f64, stiffness: f64, damping: f64, inertia: f64) -> Self {
        let rate = Matrix2::new(0.0, 1.0, -stiffness / inertia, -damping / inertia) * h;
        let (mut transition, mut one, mut two) = (Matrix2::zeros(), Matrix2::zeros(), Matrix2::zeros());
        let mut power = Matrix2::identity();
        for k in 0..TERMS {
            // power is (A·h)ᵏ/k!
            let n = k as f64;
            transition += power;
            one += power / (n + 1.0);
            two += power / ((n + 1.0) * (n + 2.0));
            power = power * rate / (n + 1.0);
        }
        let push = Vector2::new(0.0, h / inertia);
        Self { transition, from: (one - two) * push, to: two * push }
    }

    /// Deviation and its rate after the step.
    pub(crate) fn after(&self, state: Vector2<f64>, from: f64, to: f64) -> Vector2<f64> {
        self.transition * state + self.from * from + self.to * to
    }
}

/// A motion on one segment, with what a small torque does to it.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub(crate) times: Vec<f64>,
    pub(crate) motion: Motion,
    /// Torque of the input at the samples.
    pub(crate) input: Vec<f64>,
    /// ∂observed/∂(quantity observed).
    pub(crate) gain: Vec<f64>,
    /// What carries a small deviation from each sample to the next. A bending contact's hidden state is not followed.
    steps: Vec<Step>,
    /// Slopes of the torque at the samples, by position and by velocity.
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    inertia: f64,
    /// The segment's record, and whether it is the first of it.
    pub(crate) record: usize,
    pub(crate) first: bool,
}

impl Path {
    /// The paths of all segments of a fit.
    pub(crate) fn of(data: &Data, fit: &Fit) -> Result<Vec<Self>, DynamicsError> {
        let mut simulator = Simulator::new(data, &fit.hypothesis, &fit.point.globals, Derivatives::None)?;
        let system = fit.hypothesis.system(&data.facts, &fit.point.globals)?;
        let measurement = fit.hypothesis.measurement(&data.facts, &fit.point.globals);
        let mut paths = Vec::with_capacity(data.segments.len());
        for (segment, start) in data.segments.iter().zip(&fit.point.starts) {
            let motion = simulator.motion(segment, start)?;
            let input = data.inputs.get(segment.record).and_then(Option::as_ref);
            let gain = system.nominal().input_gain();
            let torque = segment
                .times
                .iter()
                .map(|time| input.map_or(0.0, |input| gain * held(input, *time)))
                .collect();
            let (x, rate, curvature) = observed(data.quantity, &motion);
            let at = |list: &[f64], index: usize| list.get(index).copied().unwrap_or(0.0);
            let slopes = x
                .iter()
                .zip(&segment.times)
                .enumerate()
                .map(|(index, (x, time))| {
                    let (rate, curvature) = (at(rate, index), at(curvature, index));
                    let [slope, ..] = measurement.observe(*x, rate, curvature, *time, 0.0).by_motion;
                    slope
                })
                .collect();
            let mut path = Self {
                times: segment.times.clone(),
                motion,
                input: torque,
                gain: slopes,
                steps: Vec::new(),
                stiffness: Vec::new(),
                damping: Vec::new(),
                inertia: system.nominal().inertia(),
                record: segment.record,
                first: segment.first,
            };
            path.linearize(&system, &data.facts);
            paths.push(path);
        }
        Ok(paths)
    }

    /// A motion by itself, for tests of what looks at it.
    #[cfg(test)]
    pub(crate) fn of_motion(times: Vec<f64>, motion: Motion) -> Self {
        Self {
            times,
            motion,
            input: Vec::new(),
            gain: Vec::new(),
            steps: Vec::new(),
            stiffness: Vec::new(),
            damping: Vec::new(),
            inertia: 1.0,
            record: 0,
            first: true,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.times.len()
    }

    fn linearize(&mut self, system: &System, facts: &Scales) {
        let directed = system.effects().iter().any(|active| match active.effect() {
            Effect::System(effect) => effect.directed(),
            _ => false,
        });
        for index in 0..self.len() {
            let (stiffness, damping) = slopes(system, self, index, facts);
            self.stiffness.push(stiffness);
            self.damping.push(damping);
        }
        let inertia = self.inertia;
        let pairs = |list: &[f64]| -> Vec<(f64, f64)> {
            list.iter().copied().zip(list.iter().copied().skip(1)).collect()
        };
        let times = pairs(&self.times);
        let rows = times
            .iter()
            .zip(pairs(&self.stiffness))
            .zip(pairs(&self.damping))
            .zip(pairs(&self.motion.velocity))
            .zip(pairs(&self.motion.acceleration));
        self.steps = rows
            .map(|((((time, stiffness), damping), velocity), acceleration)| {
                let h = time.1 - time.0;
                let mut step =
                    Step::of(h, 0.5 * (stiffness.0 + stiffness.1), 0.5 * (damping.0 + damping.1), inertia);
                if directed && velocity.0 * velocity.1 < 0.0 && acceleration.0 != 0.0 {
                    let ratio = (acceleration.1 / acceleration.0).clamp(0.0, 2.0);
                    step.transition = Matrix2::new(1.0, 0.0, 0.0, ratio) * step.transition;
                }
                step
            })
            .collect();
    }

    /// The response of the observed quantity to a torque given at the samples, from rest.
    pub(crate) fn response(&self, torque: &[f64], quantity: Quantity) -> Vec<f64> {
        self.propagate(Vector2::zeros(), torque, quantity)
    }

    fn propagate(&self, start: Vector2<f64>, torque: &[f64], quantity: Quantity) -> Vec<f64> {
        let mut state = start;
        let mut column = Vec::with_capacity(self.len());
        let mut steps = self.steps.iter();
        let mut next = torque.iter().skip(1);
        let rows = torque.iter().zip(&self.gain).zip(self.stiffness.iter().zip(&self.damping));
        for ((&torque, gain), (stiffness, damping)) in rows {
            let value = match quantity {
                Quantity::Position => state.x,
                Quantity::Velocity => state.y,
                Quantity::Acceleration => (torque - stiffness * state.x - damping * state.y) / self.inertia,
            };
            column.push(value * gain);
            if let (Some(step), Some(&after)) = (steps.next(), next.next()) {
                state = step.after(state, torque, after);
            }
        }
        column
    }

    /// What the sensor observes, with its first and second time derivative.
    pub(crate) fn observed(&self, quantity: Quantity) -> (&[f64], &[f64], &[f64]) {
        observed(quantity, &self.motion)
    }
}

/// What the sensor observes, with its first and second time derivative; nothing in place of the third and fourth
/// derivative of the position.
fn observed(quantity: Quantity, motion: &Motion) -> (&[f64], &[f64], &[f64]) {
    match quantity {
        Quantity::Position => (&motion.position, &motion.velocity, &motion.acceleration),
        Quantity::Velocity => (&motion.velocity, &motion.acceleration, &[]),
        Quantity::Acceleration => (&motion.acceleration, &[], &[]),
    }
}

/// The input at a time.
pub(crate) fn held(input: &dynamics::Input, time: f64) -> f64 {
    let at = input.times().partition_point(|knot| *knot <= time);
    let value = |index: usize| input.values().get(index).copied();
    let knot = |index: usize| input.times().get(index).copied();
    let Some(before) = at.checked_sub(1) else { return value(0).unwrap_or(0.0) };
    let low = value(before).unwrap_or(0.0);
    match (input.hold(), value(at), knot(before), knot(at)) {
        (dynamics::Hold::Linear, Some(high), Some(from), Some(to)) => {
            low + (high - low) * (time - from) / (to - from)
        }
        _ => low,
    }
}

/// A dual moment of the motion: derivatives with respect to position and velocity.
fn moment(path: &Path, index: usize, system: &System, region: i8) -> Moment<Dual<2>> {
    let at = |list: &[f64]| list.get(index).copied().unwrap_or(0.0);
    let (position, velocity) = (at(&path.motion.position), at(&path.motion.velocity));
    let c = system.nominal().coefficients();
    let constant = |value: f64| Dual::<2>::from(value);
    Moment {
        time: constant(at(&path.times)),
        position: Dual::variable(position, 0),
        velocity: Dual::variable(velocity, 1),
        input: constant(at(&path.input)),
        hidden: [constant(0.0); MOST_HIDDEN],
        nominal: Coefficients {
            inertia: constant(c.inertia),
            damping: constant(c.damping),
            stiffness: constant(c.stiffness),
            rest_angle: constant(c.rest_angle),
            input_gain: constant(c.input_gain),
        },
        direction: if velocity < 0.0 { -1.0 } else { 1.0 },
        region,
    }
}

/// The moment that a law sees at a sample, in its first region.
pub(crate) fn plain_moment(path: &Path, index: usize, coefficients: &Coefficients<f64>) -> Moment<f64> {
    let at = |list: &[f64]| list.get(index).copied().unwrap_or(0.0);
    let velocity = at(&path.motion.velocity);
    Moment {
        time: at(&path.times),
        position: at(&path.motion.position),
        velocity,
        input: at(&path.input),
        hidden: [0.0; MOST_HIDDEN],
        nominal: *coefficients,
        direction: if velocity < 0.0 { -1.0 } else { 1.0 },
        region: 0,
    }
}

/// κ = −∂τ/∂θ and γ = −∂τ/∂θ̇ of everything in the system at a sample.
fn slopes(system: &System, path: &Path, index: usize, facts: &Scales) -> (f64, f64) {
    let c = system.nominal().coefficients();
    let (mut stiffness, mut damping) = (c.stiffness, c.damping);
    let plain = plain_moment(path, index, &c);
    for active in system.effects() {
        let Effect::System(effect) = active.effect() else { continue };
        let mut values = [0.0; MOST_PARAMETERS];
        for (slot, value) in values.iter_mut().zip(active.values()) {
            *slot = *value;
        }
        // A second body moves along at low frequency; a bent contact is a spring while it bends.
        if effect == SystemEffect::FlexibleCoupling {
            continue;
        }
        if let (SystemEffect::Hysteresis, &[torque, displacement, ..]) = (effect, &values) {
            let deflection = plain.position - (c.rest_angle + facts.rest_moved);
            let z = bent(deflection, plain.velocity / facts.frequency, displacement).z;
            stiffness += torque * (1.0 - z * plain.direction).max(0.0) / displacement;
            continue;
        }
        let region = effect.region(&values, &plain);
        let torque = effect.torque(&values.map(Dual::<2>::from), &moment(path, index, system, region));
        let [by_position, by_velocity] = torque.partials;
        stiffness -= by_position;
        damping -= by_velocity;
    }
    (stiffness, damping)
}

/// Columns of all segments, one below the other.
pub(crate) fn stack(paths: &[Path], column: impl Fn(&Path) -> Vec<f64>) -> Vec<f64> {
    paths.iter().flat_map(column).collect()
}

/// A matrix from columns.
pub(crate) fn matrix(rows: usize, columns: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns.len(), |row, column| {
        columns.get(column).and_then(|column| column.get(row)).copied().unwrap_or(0.0)
    })
}
