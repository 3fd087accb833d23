//! Motion of a tree under torques, with effects in its joints.
//!
//! Steps alternate between half a displacement, a change of the speeds and half a displacement (Störmer and
//! Verlet). Dry friction acts within the change of the speeds: its impulses are the largest dissipation that their
//! bounds allow, which also holds a joint at rest (Moreau's time stepping, by projected Gauss–Seidel).
//!
//! # Reference
//! Moreau, in *Nonsmooth Mechanics and Applications* (1988) 1. Hairer, Lubich, Wanner, Acta Numerica 12 (2003)
//! 399.

use super::algorithms::solved;
use super::error::TreeError;
use super::structure::Tree;
use crate::active::Active;
use crate::field::{Field, SYSTEM_HIDDEN, State as JointState, Term};
use crate::nominal::Coefficients;
use crate::registry::Effect;

/// Longest step, in seconds.
const LONGEST_STEP: f64 = 5e-4;

/// Number of sweeps over the joints that friction's impulses take, and the change at which they end, relative to
/// the bound of an impulse.
const SWEEPS: usize = 60;
const SETTLED: f64 = 1e-10;

/// Speed in rad/s or m/s beyond which a motion counts as diverging.
const FASTEST: f64 = 1e5;

/// Torques that act in one joint beside the torque of its drive.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Acting {
    /// Inertia beyond that of the tree, in kg m² or kg; it may be below 0.
    pub inertia: f64,
    /// Torque of viscous damping per speed, in N m s/rad or N s/m.
    pub damping: f64,
    /// Stiffness of a spring beside the joint, in N m/rad or N/m, which is relaxed at 0.
    pub stiffness: f64,
    /// Constant torque, in N m or N.
    pub torque: f64,
    /// Effects in the system; those of the measurement chain do not act.
    pub effects: Vec<Active>,
}

/// Positions and velocities of all joints.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Positions in rad or m.
    pub position: Vec<f64>,
    /// Velocities in rad/s or m/s.
    pub velocity: Vec<f64>,
}

/// Mechanism that a motion is computed of: whatever gives a mass matrix and bias forces.
pub trait Mechanism {
    /// Reason why they cannot be computed.
    type Error: From<TreeError>;

    /// Returns the names of the joints, in the order of all vectors.
    fn names(&self) -> Vec<String>;

    /// Computes the rows of the mass matrix, armatures included.
    ///
    /// # Errors
    /// [`Self::Error`].
    fn mass_matrix(&self, position: &[f64]) -> Result<Vec<Vec<f64>>, Self::Error>;

    /// Computes the torques of gravity, Coriolis and centrifugal forces.
    ///
    /// # Errors
    /// [`Self::Error`].
    fn bias(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, Self::Error>;
}

impl Mechanism for Tree {
    type Error = TreeError;

    fn names(&self) -> Vec<String> {
        Tree::names(self).map(str::to_owned).collect()
    }

    fn mass_matrix(&self, position: &[f64]) -> Result<Vec<Vec<f64>>, TreeError> {
        Tree::mass_matrix(self, position)
    }

    fn bias(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, TreeError> {
        Tree::bias(self, position, velocity)
    }
}

/// One joint's field of forces and hidden states.
struct Joint {
    field: Field<f64>,
    inertia: f64,
    offset: f64,
    hidden: [f64; SYSTEM_HIDDEN],
}

impl Joint {
    fn new(acting: &Acting, inertia: f64, (position, velocity): (f64, f64)) -> Self {
        let mut hidden = 0;
        let mut terms = Vec::new();
        for active in &acting.effects {
            if let Effect::System(effect) = active.effect() {
                terms.push(Term { effect, values: active.all_values(), hidden });
                hidden += effect.description().hidden_states;
            }
        }
        let nominal = Coefficients {
            inertia,
            damping: acting.damping,
            stiffness: acting.stiffness,
            rest_angle: 0.0,
            input_gain: 1.0,
        };
        let field = Field { nominal, terms };
        let hidden = field.relaxed(position, velocity);
        Self { field, inertia: acting.inertia, offset: acting.torque, hidden }
    }

    /// Returns the torque of everything but dry friction, and the bound of the latter, and moves the hidden
    /// states on by a step.
    fn torque(&mut self, time: f64, [position, velocity, input]: [f64; 3], step: f64) -> (f64, f64) {
        // The torque that drives a joint of a robot has no rate that an effect of a joint reads.
        let state = JointState { time, position, velocity, hidden: self.hidden, input: [input, 0.0] };
        let direction = if velocity < 0.0 { -1.0 } else { 1.0 };
        let mode = self.field.moving(&state, direction);
        let (mut torque, mut bound) =
            (self.field.spring(&state) + self.field.damping(&state) + self.offset, 0.0);
        for (term, moment) in self.field.moments(&state, &mode) {
            let own = term.effect.torque(&term.values, &moment);
            match term.effect.holding_torque(&term.values, &moment) {
                // At rest the bound is that of a joint that holds, such as static friction.
                Some(holding) => bound += if velocity == 0.0 { holding } else { own.abs() },
                None => torque += own,
            }
        }
        let (_, rates) = self.field.rates(&state, &mode);
        for (hidden, rate) in self.hidden.iter_mut().zip(rates) {
            *hidden += step * rate;
        }
        self.field.settle(&mode, &mut self.hidden);
        (torque, bound)
    }
}

/// Finds the impulses of dry friction, each within ± its bound, that dissipate most. `response` holds the change of
/// the speeds by a unit impulse on each joint. Returns the speeds after it.
fn rubbed(mut speeds: Vec<f64>, response: &[Vec<f64>], bounds: &[f64]) -> Vec<f64> {
    let mut impulses = vec![0.0; speeds.len()];
    for _ in 0..SWEEPS {
        let mut moved = 0.0_f64;
        for (at, (column, &bound)) in response.iter().zip(bounds).enumerate() {
            let (Some(own), Some(speed), Some(impulse)) =
                (column.get(at), speeds.get(at).copied(), impulses.get_mut(at))
            else {
                continue;
            };
            if bound <= 0.0 || *own <= 0.0 {
                continue;
            }
            let wanted = (*impulse - speed / own).clamp(-bound, bound);
            let change = wanted - *impulse;
            *impulse = wanted;
            for (speed, by) in speeds.iter_mut().zip(column) {
                *speed += by * change;
            }
            moved = moved.max(change.abs() / bound);
        }
        if moved < SETTLED {
            break;
        }
    }
    speeds
}

/// Values at a time between two samples.
fn between(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect()
}

/// Computes the motion of a tree from a start under torques.
///
/// `times` are in seconds, ascending; `torques` holds the torques of all joints at each time, which are linear in
/// between; `acting` holds what else acts in each joint. Returns the positions at each time.
///
/// # Errors
/// [`TreeError::Length`] for vectors of another length than the number of joints; [`TreeError::Diverged`];
/// [`TreeError::NoInertia`] where the mass matrix is singular.
pub fn rollout<M: Mechanism>(
    mechanism: &M,
    acting: &[Acting],
    start: &State,
    times: &[f64],
    torques: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, M::Error> {
    let expected = mechanism.names().len();
    let lengths = [acting.len(), start.position.len(), start.velocity.len()];
    let found = lengths.into_iter().chain(torques.iter().map(Vec::len)).find(|found| *found != expected);
    if let Some(found) = found {
        return Err(TreeError::Length { expected, found }.into());
    }
    let inertias = mechanism.mass_matrix(&start.position)?;
    let mut joints: Vec<Joint> = Vec::with_capacity(acting.len());
    for (at, (acting, row)) in acting.iter().zip(&inertias).enumerate() {
        let state = start.position.get(at).copied().zip(start.velocity.get(at).copied());
        // The lengths were checked.
        joints.push(Joint::new(acting, row.get(at).copied().unwrap_or(1.0), state.unwrap_or((0.0, 0.0))));
    }
    let mut state = start.clone();
    let mut positions = vec![state.position.clone()];
    let samples = times.iter().zip(torques);
    for ((&from, first), (&to, last)) in samples.clone().zip(samples.skip(1)) {
        let count = ((to - from) / LONGEST_STEP).ceil().max(1.0) as usize;
        let step = (to - from) / count as f64;
        for at in 0..count {
            let share = (at as f64 + 0.5) / count as f64;
            let torque = between(first, last, share);
            advance(mechanism, &mut joints, &mut state, (from + share * (to - from), step), &torque)?;
        }
        if state.velocity.iter().any(|own| own.is_nan() || own.abs() > FASTEST) {
            return Err(TreeError::Diverged { time_s: to }.into());
        }
        positions.push(state.position.clone());
    }
    Ok(positions)
}

/// Moves a state on by one step about a time.
fn advance<M: Mechanism>(
    mechanism: &M,
    joints: &mut [Joint],
    state: &mut State,
    (time, step): (f64, f64),
    torque: &[f64],
) -> Result<(), M::Error> {
    let drift = |state: &mut State| {
        for (position, velocity) in state.position.iter_mut().zip(&state.velocity) {
            *position += 0.5 * step * velocity;
        }
    };
    drift(state);
    let mut matrix = mechanism.mass_matrix(&state.position)?;
    for (at, (row, joint)) in matrix.iter_mut().zip(joints.iter()).enumerate() {
        if let Some(own) = row.get_mut(at) {
            *own += joint.inertia;
        }
    }
    let singular = |at: usize| {
        let name = mechanism.names().into_iter().nth(at);
        M::Error::from(TreeError::NoInertia { joint: name.unwrap_or_else(|| format!("joint {}", at + 1)) })
    };
    let accelerate = |bias: Vec<f64>, given: &[f64]| {
        let sum: Vec<f64> = given.iter().zip(bias).map(|(given, bias)| given - bias).collect();
        solved(&matrix, sum).map_err(singular)
    };
    let (mut given, mut bounds) = (Vec::with_capacity(joints.len()), Vec::with_capacity(joints.len()));
    let moving = state.position.iter().zip(&state.velocity);
    for ((joint, torque), (position, velocity)) in joints.iter_mut().zip(torque).zip(moving) {
        let (own, bound) = joint.torque(time, [*position, *velocity, *torque], step);
        given.push(torque + own);
        bounds.push(step * bound);
    }
    // Coriolis torques at the speed of the middle of the step.
    let first = accelerate(mechanism.bias(&state.position, &state.velocity)?, &given)?;
    let middle: Vec<f64> =
        state.velocity.iter().zip(&first).map(|(own, rate)| own + 0.5 * step * rate).collect();
    let rates = accelerate(mechanism.bias(&state.position, &middle)?, &given)?;
    let free: Vec<f64> = state.velocity.iter().zip(&rates).map(|(own, rate)| own + step * rate).collect();
    state.velocity = if bounds.iter().any(|bound| *bound > 0.0) {
        let unit = |at: usize| (0..free.len()).map(|row| f64::from(u8::from(row == at))).collect();
        let response: Result<Vec<_>, _> = (0..free.len()).map(|at| solved(&matrix, unit(at))).collect();
        rubbed(free, &response.map_err(singular)?, &bounds)
    } else {
        free
    };
    drift(state);
    Ok(())
}
