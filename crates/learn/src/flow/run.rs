//! Integration of a field from sample to sample, with sensitivities.
//!
//! Runge–Kutta of order four, with steps that end on samples. For a directed field, a reversal of the
//! velocity is an event: the step is solved again to end at the reversal. The motion then continues in the
//! other direction, or rests until the torque exceeds the dry friction. Sensitivities are those of the
//! discrete steps. At a reversal, the velocity's sensitivity jumps by the factor f⁺/f⁻, the saltation (Leine,
//! Nijmeijer 2004, section 7.3); at rest it vanishes.

#![allow(clippy::indexing_slicing, reason = "two times have a first one")]

use super::field::{Field, Slope};
use super::start::State;
use crate::{LearnError, Place};
use dynamics::{Hold, Input};

/// Number of events within a sampling interval beyond which the motion counts as at rest.
const MOST_EVENTS: usize = 6;

/// Field with weights and integration settings.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// Law of motion.
    pub field: &'a dyn Field,
    /// Weights of the law.
    pub weights: &'a [f64],
    /// Longest step in seconds.
    pub longest_step_s: f64,
    /// Interpolation of the input between samples.
    pub hold: Hold,
    /// Absolute position beyond which the motion counts as diverged.
    pub bound: f64,
}

/// Positions at the requested times, with optional sensitivities.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    /// Positions.
    pub positions: Vec<f64>,
    /// Row-major ∂position/∂(weights, initial position, initial velocity); empty unless requested.
    pub sensitivity: Vec<f64>,
    /// State at the last time.
    pub end: State,
}

/// Derivatives of the state with respect to one quantity.
#[derive(Debug, Clone, Copy, Default)]
struct Column {
    position: f64,
    velocity: f64,
}

/// Input over a sampling interval: coefficients of 1, x, x² and x³, where x is the time in seconds.
#[derive(Clone, Copy)]
struct Course([f64; 4]);

impl Course {
    fn at(self, x: f64) -> f64 {
        let Self([a, b, c, d]) = self;
        a + x * (b + x * (c + x * d))
    }

    /// Returns the same input with times counted from `x`.
    fn from(self, x: f64) -> Self {
        let Self([_, b, c, d]) = self;
        Self([self.at(x), b + x * (2.0 * c + x * 3.0 * d), c + x * 3.0 * d, d])
    }
}

/// State of an integration in progress.
struct Going<'a> {
    run: Run<'a>,
    state: State,
    direction: f64,
    resting: bool,
    columns: Vec<Column>,
    slopes: [Slope; 4],
}

impl Run<'_> {
    /// Integrates from a state at the first of `times_s` and returns the positions at all of them. `input`
    /// has one value per time.
    ///
    /// # Errors
    /// [`LearnError::Diverged`] if the position exceeds the bound or the velocity is not finite,
    /// [`LearnError::Dynamics`] for an input of another length.
    pub fn motion(
        &self,
        start: State,
        times_s: &[f64],
        input: Option<&[f64]>,
        sensitivities: bool,
    ) -> Result<Motion, LearnError> {
        let count = self.field.weights();
        let mut columns = Vec::new();
        if sensitivities {
            columns = vec![Column::default(); count];
            columns.push(Column { position: 1.0, velocity: 0.0 });
            columns.push(Column { position: 0.0, velocity: 1.0 });
        }
        let slope = || Slope { weights: vec![0.0; count], ..Slope::default() };
        let mut going = Going {
            run: *self,
            state: start,
            direction: if start.velocity < 0.0 { -1.0 } else { 1.0 },
            resting: start.velocity == 0.0,
            columns,
            slopes: std::array::from_fn(|_| slope()),
        };
        let mut motion = Motion { positions: vec![start.position], ..Motion::default() };
        going.note(&mut motion);
        let given = |input: &[f64]| Input::new(times_s.to_vec(), input.to_vec(), self.hold);
        let input = input.filter(|input| !input.is_empty()).map(given).transpose()?;
        // Without an input nothing drives the system.
        let course = |number: usize| Course(input.as_ref().map_or([0.0; 4], |input| input.cubic(number)));
        for (number, &[from, to]) in times_s.array_windows().enumerate() {
            going.interval(to - from, course(number));
            if !(going.state.position.abs() <= self.bound && going.state.velocity.is_finite()) {
                return Err(LearnError::Diverged { time_s: to - times_s[0], bound: self.bound });
            }
            motion.positions.push(going.state.position);
            going.note(&mut motion);
        }
        motion.end = going.state;
        Ok(motion)
    }
}

impl Going<'_> {
    fn note(&self, motion: &mut Motion) {
        motion.sensitivity.extend(self.columns.iter().map(|column| column.position));
    }

    /// Advances over a sampling interval.
    fn interval(&mut self, length: f64, input: Course) {
        let steps = (length / self.run.longest_step_s - 1e-9).ceil().max(1.0);
        let step = length / steps;
        let mut events = 0;
        for number in 0..steps as usize {
            let (mut done, begin) = (0.0, number as f64 * step);
            while step - done > 1e-12 * step {
                let now = input.from(begin + done);
                if self.resting && !self.sets_off(now.at(0.0)) {
                    break;
                }
                let rest = step - done;
                let taken = if self.run.field.is_directed() { self.until_reversal(rest, now) } else { None };
                self.step(taken.unwrap_or(rest), now);
                done += taken.unwrap_or(rest);
                if taken.is_some() {
                    events += 1;
                    self.reverse(input.at(begin + done));
                    if events > MOST_EVENTS {
                        self.rest();
                    }
                }
            }
        }
    }

    fn acceleration(&self, position: f64, velocity: f64, direction: f64, input: f64) -> f64 {
        let place = Place { position, velocity, direction, input };
        self.run.field.acceleration(self.run.weights, &place)
    }

    /// Starts a resting motion if the torque allows it. Returns `true` if it moves.
    fn sets_off(&mut self, input: f64) -> bool {
        if self.run.field.is_directed() {
            let ahead = self.acceleration(self.state.position, 0.0, 1.0, input);
            let back = self.acceleration(self.state.position, 0.0, -1.0, input);
            if ahead <= 0.0 && back >= 0.0 {
                return false;
            }
            self.direction = if ahead > 0.0 { 1.0 } else { -1.0 };
        }
        self.resting = false;
        true
    }

    /// Continues the motion after a reversal, or brings it to rest.
    fn reverse(&mut self, input: f64) {
        let before = self.acceleration(self.state.position, 0.0, self.direction, input);
        let after = self.acceleration(self.state.position, 0.0, -self.direction, input);
        self.state.velocity = 0.0;
        if after * self.direction < 0.0 {
            self.direction = -self.direction;
            let jump = if before == 0.0 { 1.0 } else { after / before };
            self.columns.iter_mut().for_each(|column| column.velocity *= jump);
        } else {
            self.rest();
        }
    }

    fn rest(&mut self) {
        self.resting = true;
        self.state.velocity = 0.0;
        self.columns.iter_mut().for_each(|column| column.velocity = 0.0);
    }

    /// Returns the length of the step that ends at a reversal, found by the Illinois method on the velocity;
    /// `None` if there is none within `step`.
    fn until_reversal(&self, step: f64, input: Course) -> Option<f64> {
        let velocity = |length: f64| self.plain(length, input).velocity * self.direction;
        let (mut low, mut high) = (0.0, step);
        let (mut at_low, mut at_high) = (self.state.velocity * self.direction, velocity(step));
        if at_high >= 0.0 {
            return None;
        }
        if at_low <= 0.0 {
            // The motion has just started; it reverses only if it moved.
            at_low = velocity(1e-3 * step);
            low = 1e-3 * step;
            if at_low <= 0.0 {
                return Some(low);
            }
        }
        for _ in 0..40 {
            let middle = low + (high - low) * at_low / (at_low - at_high);
            let value = velocity(middle);
            if value.abs() < 1e-13 * (at_low - at_high).abs().max(f64::MIN_POSITIVE)
                || high - low < 1e-12 * step
            {
                return Some(middle);
            }
            if value > 0.0 {
                (low, at_low, at_high) = (middle, value, 0.5 * at_high);
            } else {
                (high, at_high, at_low) = (middle, value, 0.5 * at_low);
            }
        }
        Some(0.5 * (low + high))
    }

    /// Takes one Runge–Kutta step of the state alone.
    fn plain(&self, h: f64, input: Course) -> State {
        let State { position: x, velocity: v } = self.state;
        let force = |x: f64, v: f64, at: f64| self.acceleration(x, v, self.direction, input.at(at));
        let half = 0.5 * h;
        let a1 = force(x, v, 0.0);
        let (x2, v2) = (x + half * v, v + half * a1);
        let a2 = force(x2, v2, half);
        let (x3, v3) = (x + half * v2, v + half * a2);
        let a3 = force(x3, v3, half);
        let (x4, v4) = (x + h * v3, v + h * a3);
        let a4 = force(x4, v4, h);
        State {
            position: x + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4),
            velocity: v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4),
        }
    }

    /// Takes one Runge–Kutta step of the state and its sensitivities.
    fn step(&mut self, h: f64, input: Course) {
        if self.columns.is_empty() {
            self.state = self.plain(h, input);
            return;
        }
        let State { position: x, velocity: v } = self.state;
        let (field, weights, direction) = (self.run.field, self.run.weights, self.direction);
        let half = 0.5 * h;
        let [s1, s2, s3, s4] = &mut self.slopes;
        let force = |x: f64, v: f64, at: f64, slope_of: &mut Slope| {
            let place = Place { position: x, velocity: v, direction, input: input.at(at) };
            field.sloped(weights, &place, slope_of)
        };
        let a1 = force(x, v, 0.0, s1);
        let (x2, v2) = (x + half * v, v + half * a1);
        let a2 = force(x2, v2, half, s2);
        let (x3, v3) = (x + half * v2, v + half * a2);
        let a3 = force(x3, v3, half, s3);
        let (x4, v4) = (x + h * v3, v + h * a3);
        let a4 = force(x4, v4, h, s4);
        let own = |slope: &Slope| [slope.position, slope.velocity];
        let [[p1, q1], [p2, q2], [p3, q3], [p4, q4]] = [own(s1), own(s2), own(s3), own(s4)];
        let weight = |slope: &Slope| slope.weights.iter().copied().chain([0.0, 0.0]).collect::<Vec<f64>>();
        let (w1, w2, w3, w4) = (weight(s1), weight(s2), weight(s3), weight(s4));
        let by_weight = w1.iter().zip(&w2).zip(&w3).zip(&w4);
        for (column, (((g1, g2), g3), g4)) in self.columns.iter_mut().zip(by_weight) {
            let (dx, dv) = (column.position, column.velocity);
            let b1 = p1 * dx + q1 * dv + g1;
            let (dx2, dv2) = (dx + half * dv, dv + half * b1);
            let b2 = p2 * dx2 + q2 * dv2 + g2;
            let (dx3, dv3) = (dx + half * dv2, dv + half * b2);
            let b3 = p3 * dx3 + q3 * dv3 + g3;
            let (dx4, dv4) = (dx + h * dv3, dv + h * b3);
            let b4 = p4 * dx4 + q4 * dv4 + g4;
            column.position = dx + h / 6.0 * (dv + 2.0 * dv2 + 2.0 * dv3 + dv4);
            column.velocity = dv + h / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4);
        }
        self.state = State {
            position: x + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4),
            velocity: v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::library::{Library, Term};

    fn times(count: usize, step: f64) -> Vec<f64> {
        (0..count).map(|at| at as f64 * step).collect()
    }

    fn run<'a>(library: &'a Library, weights: &'a [f64]) -> Run<'a> {
        Run { field: library, weights, longest_step_s: 0.01, hold: Hold::Zero, bound: 1e3 }
    }

    #[test]
    fn an_oscillator_follows_its_closed_form() {
        let library = Library::new(vec![Term::Position]);
        let times = times(200, 0.05);
        let start = State { position: 1.0, velocity: 0.0 };
        let motion = run(&library, &[-4.0]).motion(start, &times, None, true).unwrap();
        for ((time, position), row) in times.iter().zip(&motion.positions).zip(motion.sensitivity.chunks(3)) {
            assert!((position - (2.0 * time).cos()).abs() < 1e-7, "{time}: {position}");
            // ∂cos(√k·t)/∂(−k) = t·sin(2t)/4.
            assert!((row[0] - time * (2.0 * time).sin() / 4.0).abs() < 1e-6);
            assert!((row[2] - (2.0 * time).sin() / 2.0).abs() < 1e-7);
        }
    }

    /// Each half swing loses 2F/k; the body stops where the spring's force is below F.
    #[test]
    fn dry_friction_takes_equal_steps_and_then_holds() {
        let library = Library::new(vec![Term::Position, Term::Direction]);
        let half = std::f64::consts::FRAC_PI_2;
        let start = State { position: 1.0, velocity: 0.0 };
        let weights = [-4.0, -0.5];
        let motion = run(&library, &weights).motion(start, &times(8, half), None, true).unwrap();
        for (number, position) in motion.positions.iter().enumerate() {
            let swings = number.min(4) as f64;
            let expected = (1.0 - 0.25 * swings) * if number.min(4) % 2 == 0 { 1.0 } else { -1.0 };
            assert!((position - expected).abs() < 2e-7, "{number}: {position} for {expected}");
        }
        // ∂(turning point n)/∂F/(−k): its magnitude falls by 2/k with each half swing.
        let row: Vec<f64> = motion.sensitivity.chunks(4).nth(2).unwrap().to_vec();
        assert!((row[1] - 1.0).abs() < 1e-5, "{row:?}");
    }

    #[test]
    fn sensitivities_are_those_of_the_motion_over_reversals() {
        let terms =
            vec![Term::Position, Term::Velocity, Term::Direction, Term::Drag, Term::Sine, Term::Input];
        let library = Library::new(terms);
        let weights = [-3.0, -0.1, -0.2, -0.05, -1.0, 0.5];
        let input: Vec<f64> = (0..120).map(|at| (at as f64 * 0.11).sin()).collect();
        let times = times(120, 0.04);
        let start = State { position: 0.9, velocity: 0.2 };
        let motion = run(&library, &weights).motion(start, &times, Some(&input), true).unwrap();
        for column in 0..weights.len() {
            let moved = |by: f64| {
                let mut other = weights;
                other[column] += by;
                run(&library, &other).motion(start, &times, Some(&input), false).unwrap().positions
            };
            let (up, down) = (moved(1e-5), moved(-1e-5));
            for (row, (up, down)) in motion.sensitivity.chunks(8).zip(up.iter().zip(&down)) {
                let slope = (up - down) / 2e-5;
                assert!(
                    (row[column] - slope).abs() < 2e-4 * (1.0 + slope.abs()),
                    "{column}: {} {slope}",
                    row[column]
                );
            }
        }
    }
}
