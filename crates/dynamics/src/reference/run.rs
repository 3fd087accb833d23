//! Integration from piece to piece.

#![allow(clippy::indexing_slicing, reason = "an edge names an effect of its own field")]

use super::gauss::Gauss;
use super::motion::{Event, Happening, Motion};
use super::recorder::Recorder;
use super::step::{LENGTH, Solved, Step, Vector, state};
use super::tolerance::Tolerance;
use crate::edges::Edge;
use crate::error::DynamicsError;
use crate::field::{Field, Mode};
use crate::input::Input;
use crate::system::{Drive, Start, System};

/// Choice of the steps.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stepping {
    /// Sized by the error of each step.
    Adaptive(Tolerance),
    /// All of one size in seconds, but cut at events: for tests of the order.
    #[cfg_attr(not(test), allow(dead_code, reason = "tests of the order of convergence use it"))]
    Fixed(f64),
}

/// Maximum number of events in a row without a change of time; beyond it the run is stuck.
const MOST_EVENTS_AT_ONCE: usize = 64;

/// Maximum number of iterations of the stage equations; beyond it a step counts as too large.
pub(super) const MOST_ITERATIONS: usize = 30;

/// Outcome of a step toward an edge.
pub(super) enum Landing {
    /// The step ends on the edge.
    OnTheEdge,
    /// The edge is at the start of the step.
    AtOnce,
    /// The stage equations were not solved.
    Failed,
}

/// Running simulation.
pub(crate) struct Run<'a> {
    pub(super) field: Field<f64>,
    pub(super) directed: bool,
    pub(super) gauss: Gauss,
    stepping: Stepping,
    pub(super) drive: Drive<'a>,
    time: f64,
    vector: Vector,
    pub(super) mode: Mode,
    /// Largest size so far of each state variable.
    scale: Vector,
    /// Size of the next step, in seconds.
    size: f64,
    /// Position beyond which the motion counts as diverging.
    bound: f64,
    recorder: Recorder,
}

impl<'a> Run<'a> {
    pub(crate) fn new(
        system: &System,
        start: Start,
        input: Option<&'a Input>,
        times: &[f64],
        stepping: Stepping,
        stages: usize,
    ) -> Result<Self, DynamicsError> {
        start.check()?;
        crate::times::check(times)?;
        let field = system.field();
        let (time, end) = crate::times::ends(times);
        let duration = end - time;
        let drive = Drive::new(input, field.nominal.input_gain, system.input_delay(), time);
        let mut vector = [0.0; LENGTH];
        let hidden = system.hidden_at(start);
        for (slot, value) in vector.iter_mut().zip([start.position, start.velocity].into_iter().chain(hidden))
        {
            *slot = value;
        }
        let mode = field.mode(&state(time, &vector, drive.torque(time)));
        let frequency = system.nominal().angular_frequency();
        let size = match stepping {
            Stepping::Fixed(size) => size,
            Stepping::Adaptive(_) if frequency > 0.0 => 0.1 / frequency,
            Stepping::Adaptive(_) => 1e-3 * duration,
        };
        let recorder = Recorder::new(&field, times.len());
        Ok(Self {
            directed: field.directed(),
            field,
            gauss: Gauss::new(stages),
            stepping,
            drive,
            time,
            vector,
            mode,
            scale: vector.map(f64::abs),
            size,
            bound: start.bound(),
            recorder,
        })
    }

    /// Integrates until every time is recorded.
    pub(crate) fn motion(mut self, times: &[f64]) -> Result<Motion, DynamicsError> {
        let Some(&end) = times.last() else { return Ok(self.recorder.motion) };
        let mut step = Step::new(self.gauss.stages(), self.variables());
        let mut at_once = 0;
        while !self.recorder.complete(times) {
            self.cross_knots();
            let before = self.time;
            self.advance(&mut step, end, times)?;
            at_once = if self.time > before { 0 } else { at_once + 1 };
            if at_once > MOST_EVENTS_AT_ONCE {
                return Err(DynamicsError::StepTooSmall { time_s: self.time, step_s: 0.0 });
            }
            self.recorder.motion.steps += 1;
            if let Stepping::Adaptive(tolerance) = self.stepping
                && self.recorder.motion.steps > tolerance.most_steps
            {
                let steps = self.recorder.motion.steps;
                return Err(DynamicsError::TooManySteps { steps, time_s: self.time });
            }
        }
        Ok(self.recorder.motion)
    }

    fn variables(&self) -> usize {
        let hidden = self.field.terms.iter().map(|term| term.effect.description().hidden_states);
        2 + hidden.sum::<usize>()
    }

    /// Passes the input's knots at the present time, and determines the state's piece afterward.
    fn cross_knots(&mut self) {
        let mut crossed = false;
        while self.drive.until() <= self.time {
            self.drive.advance();
            crossed = true;
        }
        if crossed {
            self.mode = self.field.mode(&state(self.time, &self.vector, self.drive.torque(self.time)));
        }
    }

    /// Makes one step, of full size or to the first edge.
    fn advance(&mut self, step: &mut Step, end: f64, times: &[f64]) -> Result<(), DynamicsError> {
        // The state may be on the wrong side for its mode, because of rounding at a balance of forces.
        if self.directed && self.vector_velocity() * self.mode.direction < 0.0 {
            self.mode = self.field.mode(&state(self.time, &self.vector, self.drive.torque(self.time)));
        }
        let room = (self.drive.until().min(end) - self.time).max(0.0);
        let mut size = self.size.min(room);
        loop {
            step.from = self.time;
            step.size = size;
            step.begin = self.vector;
            let scale = self.scale_with(size);
            let solved =
                step.solve(&self.gauss, &self.field, &self.mode, &self.drive, &scale, MOST_ITERATIONS);
            let factor = match (solved, self.stepping) {
                (Solved::TooLarge, _) => 0.25,
                (Solved::Converged, Stepping::Fixed(_)) => 1.0,
                (Solved::Converged, Stepping::Adaptive(tolerance)) => self.factor(step, tolerance.relative),
            };
            if factor >= 1.0 {
                // A step cut short by the end of a piece tells little about the next.
                if matches!(self.stepping, Stepping::Adaptive(_)) {
                    self.size = self.size.max(size * factor.min(if size < self.size { 1.0 } else { 4.0 }));
                }
                break;
            }
            size *= factor;
            self.size = size;
            if size <= f64::EPSILON * self.time.abs().max(end.abs()) {
                if !self.vector.iter().all(|value| value.is_finite() && value.abs() < f64::MAX) {
                    return Err(DynamicsError::Diverged { time_s: self.time, position: self.position() });
                }
                return Err(DynamicsError::StepTooSmall { time_s: self.time, step_s: size });
            }
        }
        let Some((edge, tau)) = self.first_edge(step) else { return self.accept(step, None, times) };
        match self.land(step, edge, tau) {
            Landing::OnTheEdge => self.accept(step, Some(edge), times),
            Landing::AtOnce => {
                self.cross(edge);
                Ok(())
            }
            Landing::Failed => {
                self.size = 0.5 * step.size;
                Ok(())
            }
        }
    }

    fn position(&self) -> f64 {
        let [position, ..] = self.vector;
        position
    }

    fn vector_velocity(&self) -> f64 {
        let [_, velocity, ..] = self.vector;
        velocity
    }

    /// Returns the sizes that errors are compared with. For a variable that has not moved yet, this is its
    /// motion in a step.
    pub(super) fn scale_with(&self, size: f64) -> Vector {
        let rates =
            |time, vector: &Vector| super::step::rates(&self.field, &self.mode, &self.drive, time, vector);
        let now = rates(self.time, &self.vector);
        let mut later = self.vector;
        for (value, rate) in later.iter_mut().zip(now) {
            *value += rate * size;
        }
        let later = rates(self.time + size, &later);
        let mut scale = self.scale;
        for (scale, (now, later)) in scale.iter_mut().zip(now.into_iter().zip(later)) {
            *scale = scale.max(now.abs() * size).max(later.abs() * size);
        }
        scale
    }

    /// Returns the factor by which the step may change for the next to meet the tolerance; below 1 it has to
    /// be repeated.
    fn factor(&self, step: &Step, relative: f64) -> f64 {
        let mut scale = self.scale;
        for stage in &step.stages {
            for (scale, value) in scale.iter_mut().zip(stage) {
                *scale = scale.max(value.abs());
            }
        }
        let mut error = step.error(&scale) / relative;
        if self.mode.sticks() {
            error = error.max(self.torque_tail(step) / relative);
        }
        let order = self.gauss.stages() as f64;
        let factor = 0.9 * libm::pow(error.max(1e-300), -1.0 / order);
        if error > 1.0 { factor.clamp(0.1, 0.9) } else { factor.clamp(1.0, 4.0) }
    }

    /// Returns the tail of the torque's series. While stuck nothing changes but the torque: the step has to
    /// resolve it, or a break-away is missed.
    fn torque_tail(&self, step: &Step) -> f64 {
        let here = state(self.time, &self.vector, self.drive.torque(self.time));
        let holding = self.field.holding_torque(&here, &self.mode);
        // Without dry friction nothing holds.
        let holding = holding.unwrap_or(f64::INFINITY).max(f64::MIN_POSITIVE);
        let (mut last, mut before) = (0.0, 0.0);
        let [.., lower, upper] = self.gauss.analysis.as_slice() else { return 0.0 };
        for (((node, stage), upper), lower) in self.gauss.nodes.iter().zip(&step.stages).zip(upper).zip(lower)
        {
            let time = step.from + node * step.size;
            let torque = self.field.torque(&state(time, stage, self.drive.torque(time)), &self.mode);
            last += upper * torque;
            before += lower * torque;
        }
        // If large torques cancel, the apparent tail is their rounding, and no step is too long.
        let rounding = self.field.balance(&here);
        (f64::max(last.abs(), 0.1 * before.abs()) - rounding).max(0.0) / holding
    }

    fn accept(&mut self, step: &Step, edge: Option<Edge>, times: &[f64]) -> Result<(), DynamicsError> {
        self.recorder.step(&self.gauss, &self.field, &self.mode, &self.drive, step, times);
        self.vector = step.at(1.0);
        self.time = if (step.from + step.size - self.drive.until()).abs() <= f64::EPSILON * step.from.abs() {
            self.drive.until()
        } else {
            step.from + step.size
        };
        for (scale, value) in self.scale.iter_mut().zip(self.vector) {
            *scale = scale.max(value.abs());
        }
        let position = self.position();
        if !position.is_finite() || position.abs() > self.bound {
            return Err(DynamicsError::Diverged { time_s: self.time, position });
        }
        if let Some(edge) = edge {
            self.cross(edge);
        }
        Ok(())
    }

    /// Passes to the piece behind an edge.
    fn cross(&mut self, edge: Edge) {
        if edge == Edge::Reversal {
            let [_, velocity, ..] = &mut self.vector;
            *velocity = 0.0;
        }
        let here = state(self.time, &self.vector, self.drive.torque(self.time));
        let next = self.field.behind(&here, &self.mode, edge);
        let happening = match edge {
            Edge::Reversal if next.sticks() => Happening::Stick,
            Edge::Reversal => Happening::Reversal,
            Edge::BreakAway { .. } => Happening::BreakAway,
            Edge::Region { term, .. } => {
                let effect = self.field.terms[term].effect.description().id;
                Happening::Region { effect, from: self.mode.regions[term], to: next.regions[term] }
            }
        };
        self.mode = next;
        let [_, _, hidden @ ..] = &mut self.vector;
        self.field.settle(&next, hidden);
        let event = Event { time: self.time, position: here.position, velocity: here.velocity, happening };
        self.recorder.motion.events.push(event);
    }
}
