//! Response of an observed motion to small additional torques.
//!
//! Along a fitted motion the system is linear in small additions: I·δ̈ + γ(t)·δ̇ + κ(t)·δ = f(t), with κ and
//! γ the derivatives of all torques at the motion. Between two samples, κ and γ are taken as constant (the
//! mean of both ends) and f as linear; the matrix exponential solves this exactly. At a reversal with dry
//! friction δ̇ jumps by the ratio of the accelerations after and before. One set of steps serves any number
//! of torques, which makes it possible to evaluate a hundred candidates at once. Full fits use exact
//! sensitivities instead.

#![allow(clippy::indexing_slicing, reason = "columns have a row for every sample of all paths")]

use crate::data::scales::Scales;
use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::model::candidate::Candidate;
use crate::model::candidates::{Along, driven, padded};
use crate::model::predictor::{Derivatives, Motion, Simulator};
use dynamics::{Active, Coefficients, DynamicsError, Effect, Input, System, Values};
use nalgebra::{DMatrix, Matrix2, Vector2};
use record::Quantity;

/// Step from one sample to the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    transition: Matrix2<f64>,
    /// Response to the torque at the start of the step and at its end.
    from: Vector2<f64>,
    to: Vector2<f64>,
}

/// Longest step that the series is summed for, in radians and decay times; a longer one is made of two.
const LONGEST: f64 = 4.0;

/// Number of terms of the exponential's series.
const TERMS: usize = 26;

impl Step {
    /// Computes the step over a time h in seconds of I·δ̈ + γ·δ̇ + κ·δ = f, with f linear in time.
    pub(crate) fn of(h: f64, stiffness: f64, damping: f64, inertia: f64) -> Self {
        let size = h * ((stiffness / inertia).abs().sqrt() + (damping / inertia).abs());
        if size > LONGEST && size.is_finite() {
            return Self::of(0.5 * h, stiffness, damping, inertia).twice();
        }
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

    /// Returns the step that is as long as two of these.
    fn twice(self) -> Self {
        let Self { transition, from, to } = self;
        Self {
            transition: transition * transition,
            from: transition * (from + 0.5 * to) + 0.5 * from,
            to: 0.5 * (transition * to + from) + to,
        }
    }

    /// Returns the deviation and its rate after the step.
    pub(crate) fn after(&self, state: Vector2<f64>, from: f64, to: f64) -> Vector2<f64> {
        self.transition * state + self.from * from + self.to * to
    }
}

/// Motion on one segment, with its response to small torques.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub(crate) times: Vec<f64>,
    pub(crate) motion: Motion,
    /// Torque of the input at the samples, and its rate.
    pub(crate) input: Vec<f64>,
    pub(crate) input_rate: Vec<f64>,
    /// ∂reading/∂(observed quantity).
    pub(crate) gain: Vec<f64>,
    /// Steps that propagate a small deviation from each sample to the next. A bending contact's hidden state
    /// is not included.
    steps: Vec<Step>,
    /// Stiffness −∂τ/∂θ and damping −∂τ/∂θ̇ at the samples.
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    inertia: f64,
    /// Index of the segment's record, and `true` if the segment is the record's first.
    pub(crate) record: usize,
    pub(crate) first: bool,
}

impl Path {
    /// Computes the paths of all segments of a fit.
    pub(crate) fn of(data: &Data, fit: &Fit) -> Result<Vec<Self>, DynamicsError> {
        let mut simulator = Simulator::new(data, &fit.hypothesis, &fit.point.globals, Derivatives::None)?;
        let system = fit.hypothesis.system(&data.facts, &fit.point.globals)?;
        let measurement = fit.hypothesis.measurement(&data.facts, &fit.point.globals);
        let mut paths = Vec::with_capacity(data.segments.len());
        for (segment, start) in data.segments.iter().zip(&fit.point.starts) {
            let motion = simulator.motion(segment, start)?;
            let input = data.inputs.get(segment.record).and_then(Option::as_ref);
            let gain = system.nominal().input_gain();
            let [torque, torque_rate] = driven(input, gain, &segment.times);
            let (x, rate, _) = observed(data.quantity, &motion);
            // The rate of an acceleration is not integrated and counts as zero.
            let rates = rate.iter().copied().chain(std::iter::repeat(0.0));
            let samples = x.iter().zip(rates).zip(&segment.times);
            let slopes = samples
                .map(|((x, rate), time)| measurement.observe([*x, 0.0], rate, *time, 0.0).slope)
                .collect();
            let mut path = Self {
                times: segment.times.clone(),
                motion,
                input: torque,
                input_rate: torque_rate,
                gain: slopes,
                steps: Vec::new(),
                stiffness: Vec::new(),
                damping: Vec::new(),
                inertia: system.nominal().inertia(),
                record: segment.record,
                first: segment.first,
            };
            path.linearize(&system, data.quantity, &data.facts);
            paths.push(path);
        }
        Ok(paths)
    }

    /// Creates a path from a motion alone, for tests.
    #[cfg(test)]
    pub(crate) fn of_motion(times: Vec<f64>, motion: Motion) -> Self {
        Self {
            times,
            motion,
            input: Vec::new(),
            input_rate: Vec::new(),
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

    fn linearize(&mut self, system: &System, quantity: Quantity, facts: &Scales) {
        let directed = system.effects().iter().any(|active| match active.effect() {
            Effect::System(effect) => effect.directed(),
            _ => false,
        });
        let fitted =
            |active: &Active| Some((Candidate::that_fits(active.effect())?, padded(active.values())));
        let effects: Vec<(Candidate, Values<f64>)> = system.effects().iter().filter_map(fitted).collect();
        let nominal = system.nominal().coefficients();
        let slopes: Vec<(f64, f64)> = {
            let along = self.along(quantity, facts, &nominal, None, &|torque: &[f64]| torque.to_vec());
            (0..self.len()).map(|index| slopes(&nominal, &effects, &along, index)).collect()
        };
        (self.stiffness, self.damping) = slopes.into_iter().unzip();
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

    /// Returns the motion in the form that a candidate reads.
    pub(crate) fn along<'a>(
        &'a self,
        quantity: Quantity,
        facts: &'a Scales,
        nominal: &'a Coefficients<f64>,
        command: Option<&'a Input>,
        respond: &'a dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Along<'a> {
        let (observed, rate, _) = self.observed(quantity);
        Along {
            times: &self.times,
            position: &self.motion.position,
            velocity: &self.motion.velocity,
            observed,
            rate,
            input: &self.input,
            input_rate: &self.input_rate,
            command,
            first: self.first,
            facts,
            nominal,
            respond,
        }
    }

    /// Returns the response of the observed quantity to a torque given at the samples, from rest.
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

    /// Returns the observed quantity with its first and second time derivative.
    pub(crate) fn observed(&self, quantity: Quantity) -> (&[f64], &[f64], &[f64]) {
        observed(quantity, &self.motion)
    }
}

/// Returns the observed quantity with its first and second time derivative; empty in place of the third and
/// fourth derivative of the position.
fn observed(quantity: Quantity, motion: &Motion) -> (&[f64], &[f64], &[f64]) {
    match quantity {
        Quantity::Position => (&motion.position, &motion.velocity, &motion.acceleration),
        Quantity::Velocity => (&motion.velocity, &motion.acceleration, &[]),
        Quantity::Acceleration => (&motion.acceleration, &[], &[]),
    }
}

/// Returns κ = −∂τ/∂θ and γ = −∂τ/∂θ̇ of the whole system at a sample.
fn slopes(
    nominal: &Coefficients<f64>,
    effects: &[(Candidate, Values<f64>)],
    along: &Along<'_>,
    index: usize,
) -> (f64, f64) {
    let (mut stiffness, mut damping) = (nominal.stiffness, nominal.damping);
    let moment = along.moment(index);
    for (candidate, values) in effects {
        let [by_position, by_velocity] = candidate.stiffness_and_damping(values, &moment, along.facts);
        stiffness += by_position;
        damping += by_velocity;
    }
    (stiffness, damping)
}

/// Stacks the columns of all segments, one below the other.
pub(crate) fn stack(paths: &[Path], column: impl Fn(&Path) -> Vec<f64>) -> Vec<f64> {
    paths.iter().flat_map(column).collect()
}

/// Builds a matrix from columns.
pub(crate) fn matrix(rows: usize, columns: &[Vec<f64>]) -> DMatrix<f64> {
    debug_assert!(columns.iter().all(|column| column.len() == rows));
    DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row])
}

#[cfg(test)]
mod tests {
    use super::Step;
    use nalgebra::Vector2;

    /// The inertia of a stiff joint shows for a thousandth of a step: the position then follows the torque as that of
    /// a damper and a spring, x' = (f − κ·x)/γ, which a ramp of torque moves in closed form.
    #[test]
    fn a_stiff_step_is_that_of_a_damper_and_a_spring() {
        let (h, stiffness, damping) = (0.02, 9.4, 4.4);
        let step = Step::of(h, stiffness, damping, 1e-6);
        let (from, to) = (0.3, 0.7);
        let after = step.after(Vector2::new(0.1, 0.0), from, to);
        let (time, slope) = (damping / stiffness, (to - from) / h / stiffness);
        let steady = |t: f64| from / stiffness + slope * (t - time);
        let expected = steady(h) + (0.1 - steady(0.0)) * (-h / time).exp();
        assert!((after.x / expected - 1.0).abs() < 1e-5, "{} {expected}", after.x);
        assert!((after.y - (to - stiffness * after.x) / damping).abs() < 1e-4 * after.y.abs());
    }
}
