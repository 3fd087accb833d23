//! Motion of a record, smoothed without a law: position, velocity and acceleration from the readings alone.
//!
//! The readings are those of the given oscillator under an unknown torque that wanders at random. A Kalman filter
//! and a Rauch–Tung–Striebel smoother estimate its state; the size of the wandering torque is the one, among
//! those of a grid, that makes the readings most likely. The torque takes the place of every law that the
//! oscillator lacks, so that the motion has the form that the readings show: flat where a body hangs in its
//! play, steep where it meets a stop.
//!
//! # Reference
//! Rauch, Tung and Striebel, AIAA Journal 3 (1965) 1445.

use crate::data::segments::{Data, Segment};
use crate::model::predictor::Motion;
use dynamics::{Input, Nominal};
use nalgebra::{Matrix3, RowVector3, Vector3};
use record::Quantity;

/// Sizes of the wandering torque: its change over a radian of the swing, relative to the spring's torque.
const WANDERS: [f64; 11] = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0];

/// Smallest noise relative to the amplitude: the rounding of a file's digits.
const LEAST_NOISE: f64 = 1e-6;

/// Number of terms of the exponential's series, and the longest step that it is summed for, in radians and decay
/// times; a longer one is made of two.
const TERMS: i32 = 14;
const LONGEST: f64 = 1.0;

/// Step from one sample to the next; time is in radians of the swing.
#[derive(Debug, Clone, Copy)]
struct Step {
    transition: Matrix3<f64>,
    /// Response to a constant acceleration of 1 by the input.
    push: Vector3<f64>,
    /// Covariance by a torque that wanders by 1.
    spread: Matrix3<f64>,
}

impl Step {
    /// Computes the step over a time. The rate matrix is that of the oscillator with the torque as third state.
    fn of(h: f64, rate: &Matrix3<f64>) -> Self {
        let size = h * (rate.m21.abs().sqrt() + rate.m22.abs());
        if size > LONGEST && size.is_finite() {
            return Self::of(0.5 * h, rate).twice();
        }
        let (mut transition, mut integral) = (Matrix3::zeros(), Matrix3::zeros());
        let mut power = Matrix3::identity();
        for k in 0..TERMS {
            let n = f64::from(k);
            transition += power;
            integral += power * (h / (n + 1.0));
            power = power * rate * (h / (n + 1.0));
        }
        let [h2, h3, h4, h5] = [2, 3, 4, 5].map(|n| h.powi(n));
        let spread = Matrix3::new(
            h5 / 20.0,
            h4 / 8.0,
            h3 / 6.0, //
            h4 / 8.0,
            h3 / 3.0,
            h2 / 2.0, //
            h3 / 6.0,
            h2 / 2.0,
            h,
        );
        Self { transition, push: integral * Vector3::new(0.0, 1.0, 0.0), spread }
    }

    /// Returns the step that is as long as two of these.
    fn twice(self) -> Self {
        let Self { transition, push, spread } = self;
        Self {
            transition: transition * transition,
            push: transition * push + push,
            spread: transition * spread * transition.transpose() + spread,
        }
    }
}

/// State before a sample, and after it.
#[derive(Debug, Clone, Copy)]
struct Estimate {
    before: Vector3<f64>,
    before_spread: Matrix3<f64>,
    after: Vector3<f64>,
    after_spread: Matrix3<f64>,
}

/// Readings of one run, in units of the amplitude and of radians of the swing.
struct Readings {
    values: Vec<f64>,
    /// Acceleration by the input at each sample.
    input: Vec<f64>,
    steps: Vec<Step>,
    observe: RowVector3<f64>,
    /// Part of the input in a reading.
    direct: f64,
    noise: f64,
    first: Vector3<f64>,
}

impl Readings {
    /// Runs the filter. Calls `take` with every estimate and returns the log likelihood of the readings, with
    /// the scale of all variances free.
    fn filtered(&self, wanders: f64, mut take: impl FnMut(Estimate)) -> f64 {
        let (mut state, mut spread) = (self.first, Matrix3::identity());
        let (mut logarithms, mut squares) = (0.0, 0.0);
        let mut steps = self.steps.iter();
        let mut inputs = self.input.iter().zip(self.input.iter().skip(1).chain(self.input.last()));
        for value in &self.values {
            let (own, next) = inputs.next().unwrap_or((&0.0, &0.0));
            let (before, before_spread) = (state, spread);
            let off = value - (self.observe * state).x - self.direct * own;
            let variance = (self.observe * spread * self.observe.transpose()).x + self.noise * self.noise;
            let gain = spread * self.observe.transpose() / variance;
            state += gain * off;
            spread -= gain * self.observe * spread;
            logarithms += libm::log(variance);
            squares += off * off / variance;
            take(Estimate { before, before_spread, after: state, after_spread: spread });
            if let Some(step) = steps.next() {
                state = step.transition * state + step.push * (0.5 * (own + next));
                spread = step.transition * spread * step.transition.transpose()
                    + step.spread * (wanders * wanders);
                spread = 0.5 * (spread + spread.transpose());
            }
        }
        let count = self.values.len() as f64;
        -0.5 * (logarithms + count * libm::log((squares / count.max(1.0)).max(f64::MIN_POSITIVE)))
    }

    /// Returns the smoothed states.
    fn smoothed(&self) -> Vec<Vector3<f64>> {
        let likelihood = |wanders: &f64| self.filtered(*wanders, |_| {});
        let likely = WANDERS.iter().map(|wanders| (likelihood(wanders), *wanders));
        let (_, wanders) =
            likely.fold((f64::NEG_INFINITY, 1.0), |best, own| if own.0 > best.0 { own } else { best });
        let mut estimates = Vec::with_capacity(self.values.len());
        self.filtered(wanders, |own| estimates.push(own));
        let mut states: Vec<Vector3<f64>> = Vec::with_capacity(estimates.len());
        let mut later: Option<(Estimate, Vector3<f64>)> = None;
        for (own, step) in
            estimates.iter().rev().zip(std::iter::once(None).chain(self.steps.iter().rev().map(Some)))
        {
            let state = match (later, step) {
                (Some((next, smooth)), Some(step)) => {
                    let spread = next.before_spread.try_inverse();
                    let back = spread.map(|spread| own.after_spread * step.transition.transpose() * spread);
                    back.map_or(own.after, |back| own.after + back * (smooth - next.before))
                }
                _ => own.after,
            };
            later = Some((*own, state));
            states.push(state);
        }
        states.reverse();
        states
    }
}

/// Returns the motion of a run of samples. `oscillator` is the closest linear one, `noise` the size of the noise
/// in the readings' unit.
pub(crate) fn smoothed(data: &Data, run: &Segment, oscillator: &Nominal, noise: f64) -> Motion {
    let own = oscillator.coefficients();
    let (unit, time) = (data.facts.amplitude, data.facts.frequency);
    let rest = own.rest_angle + data.facts.rest_moved;
    let stiffness = own.stiffness / own.inertia / (time * time);
    let damping = own.damping / own.inertia / time;
    let input = data.inputs.get(run.record).and_then(Option::as_ref);
    let acceleration =
        |input: &Input, at: f64| own.input_gain * input.at(at) / (own.inertia * unit * time * time);
    let input: Vec<f64> = match input {
        Some(input) => run.times.iter().map(|at| acceleration(input, *at)).collect(),
        None => vec![0.0; run.times.len()],
    };
    let (observe, direct, rate, offset) = match data.quantity {
        Quantity::Position => (RowVector3::new(1.0, 0.0, 0.0), 0.0, 1.0, rest),
        Quantity::Velocity => (RowVector3::new(0.0, 1.0, 0.0), 0.0, time, 0.0),
        Quantity::Acceleration => (RowVector3::new(-stiffness, -damping, 1.0), 1.0, time * time, 0.0),
    };
    let matrix = Matrix3::new(0.0, 1.0, 0.0, -stiffness, -damping, 1.0, 0.0, 0.0, 0.0);
    let mut steps: Vec<Step> = Vec::with_capacity(run.times.len());
    let mut size = 0.0;
    for (before, after) in run.times.iter().zip(run.times.iter().skip(1)) {
        let h = time * (after - before);
        // On an even clock all steps are the same.
        let known = steps.last().filter(|_| (h - size).abs() <= 1e-9 * size).copied();
        size = h;
        steps.push(known.unwrap_or_else(|| Step::of(h, &matrix)));
    }
    let [position, velocity] = run.guess;
    let readings = Readings {
        values: run.values.iter().map(|value| (value - offset) / (unit * rate)).collect(),
        first: Vector3::new((position - rest) / unit, velocity / (unit * time), 0.0),
        noise: (noise / (unit * rate)).max(LEAST_NOISE),
        input,
        steps,
        observe,
        direct,
    };
    let states = readings.smoothed();
    let pulled = |(state, input): (&Vector3<f64>, &f64)| {
        (input + state.z - stiffness * state.x - damping * state.y) * unit * time * time
    };
    Motion {
        acceleration: states.iter().zip(&readings.input).map(pulled).collect(),
        position: states.iter().map(|state| rest + unit * state.x).collect(),
        velocity: states.iter().map(|state| unit * time * state.y).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::smoothed;
    use crate::data::observations::Observations;
    use crate::data::segments::{Data, Segment, cut};
    use crate::fixtures::record;
    use dynamics::chain::{Chain, Observed};
    use dynamics::reference::{Tolerance, simulate};
    use dynamics::{Active, Nominal, Start, System};
    use record::{Clock, ClockChoice};

    /// Returns the data of a system released at 0.6 rad and read with a noise of 1 mrad, and their run of all samples.
    fn released(system: &System, samples: u32) -> (Data, Segment) {
        let chain = Chain::new(Observed::Position, 1e-3, Vec::new()).unwrap();
        let record = record(system, 0.6, samples, &chain, 1);
        let clock = Clock::new(&record, ClockChoice::Host).unwrap();
        let observed = Observations::new(&record, &clock);
        let kept = vec![true; observed.len()];
        let data = cut(std::slice::from_ref(&observed), &[kept], &system.nominal().into()).unwrap();
        let run = data.joined(usize::MAX).segments.remove(0);
        (data, run)
    }

    /// A damped joint whose speed settles within an eightieth of a sample's interval. The smoothed motion keeps to
    /// the readings.
    #[test]
    fn follows_a_joint_that_settles_between_samples() {
        let nominal = Nominal::new(1e-4, 2.0, 20.0, 0.0).unwrap();
        let system = System::new(nominal, Vec::new()).unwrap();
        let (data, run) = released(&system, 300);
        let motion = smoothed(&data, &run, &nominal, 1e-3);
        let most = |of: &[f64]| of.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        let (furthest, fastest) = (most(&motion.position), most(&motion.velocity));
        assert!(furthest < 0.7 && fastest < 10.0, "{furthest} rad, {fastest} rad/s");
    }

    /// A swing in a play of two fifths of its release. The oscillator that smooths it has no play.
    #[test]
    fn follows_a_play_that_the_oscillator_lacks() {
        let nominal = Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap();
        let play = Active::new("backlash", &[0.24]).unwrap();
        let system = System::new(nominal, vec![play]).unwrap();
        let (data, run) = released(&system, 1000);
        let softer = Nominal::new(1.0, 0.2, 250.0, 0.0).unwrap();
        let motion = smoothed(&data, &run, &softer, 1e-3);
        let truth = simulate(&system, Start::release(0.6), None, &run.times, &Tolerance::default()).unwrap();
        let off = |found: &[f64], truth: &[f64]| {
            let squares = found.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            (squares / found.len() as f64).sqrt()
        };
        assert!(off(&motion.position, &truth.position) < 1e-3);
        let largest = truth.velocity.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        let error = off(&motion.velocity, &truth.velocity) / largest;
        assert!(error < 0.02, "{error}");
    }
}
