//! Interface of an effect in the system to the integrators.

use crate::description::Description;
use crate::error::DynamicsError;
use crate::export::Export;
use crate::nominal::{Coefficients, Nominal};
use crate::scalar::Scalar;

/// Maximum number of parameters of one effect.
pub const MOST_PARAMETERS: usize = 4;

/// Maximum number of hidden state variables of one effect.
pub const MOST_HIDDEN: usize = 2;

/// Values of an effect's parameters in the order of its description; the rest is unused.
pub type Values<S> = [S; MOST_PARAMETERS];

/// Hidden state variables of one effect; the rest is unused.
pub type Hidden<S> = [S; MOST_HIDDEN];

/// State of a system at one moment, as an effect reads it.
#[derive(Debug, Clone, Copy)]
pub struct Moment<S> {
    /// Time in seconds.
    pub time: S,
    /// Position in rad or m.
    pub position: S,
    /// Velocity in rad/s or m/s.
    pub velocity: S,
    /// Torque of the input, after gain and delay.
    pub input: S,
    /// Time derivative of that torque: of a held input, the step to its present sample over the time between the two.
    pub input_rate: S,
    /// Hidden state of the effect.
    pub hidden: Hidden<S>,
    /// Nominal coefficients.
    pub nominal: Coefficients<S>,
    /// Direction of motion: 1 or −1, or 0 while the system sticks. If the velocity is exactly zero, this is
    /// the direction in which the motion is about to go.
    pub direction: f64,
    /// Index of the smooth piece that the effect is on; 0 if it has only one.
    pub region: i8,
}

impl<S: Scalar> Moment<S> {
    /// Returns the torque of a servo's drive, whose spring and damper are software: the input's torque with
    /// the nominal spring and damping, τ − k·(θ − θ_rest) − c·θ̇.
    #[inline]
    pub fn drive_torque(&self) -> S {
        self.proportional_torque() - self.nominal.damping * self.velocity
    }

    /// Returns the part of the drive's torque in proportion to its error, τ − k·(θ − θ_rest).
    #[inline]
    pub fn proportional_torque(&self) -> S {
        self.input - self.nominal.stiffness * (self.position - self.nominal.rest_angle)
    }
}

/// Distances to the ends of a region: positive inside, zero at the edge. `None` if there is no edge.
pub type Margins<S> = [Option<S>; 2];

/// Effect that acts in the system: a generalized force, possibly with hidden state and smooth pieces.
///
/// The law holds on one smooth piece at a time: [`Moment::direction`] and [`Moment::region`] are constant
/// while an integrator makes a step, and change only at an event that it locates.
pub trait Law {
    /// Description: id, equation, parameters, signature and reference.
    const DESCRIPTION: &'static Description;

    /// Code of the effect for other simulators.
    const EXPORT: Export;

    /// `true` if the law depends on the direction of motion: a reversal then ends its smooth piece.
    const DIRECTED: bool = false;

    /// Returns the generalized force that the effect adds to the right-hand side, in the system's unit of
    /// torque.
    fn torque<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> S;

    /// Returns the time derivative of the hidden state.
    fn hidden_rate<S: Scalar>(_values: &Values<S>, _moment: &Moment<S>) -> Hidden<S> {
        [S::from(0.0); MOST_HIDDEN]
    }

    /// Returns the hidden state at a start that does not state one: the effect is relaxed and moves along.
    fn relaxed<S: Scalar>(_position: S, _velocity: S) -> Hidden<S> {
        [S::from(0.0); MOST_HIDDEN]
    }

    /// Returns the torque up to which dry friction holds the system at rest at a moment; `None` if the effect is
    /// not dry friction.
    fn holding_torque<S: Scalar>(_values: &Values<S>, _moment: &Moment<S>) -> Option<S> {
        None
    }

    /// Returns the delay of the input in seconds; `None` if the effect does not delay.
    fn input_delay<S: Scalar>(_values: &Values<S>) -> Option<S> {
        None
    }

    /// Returns the region at a moment, from the state alone.
    fn region(_values: &Values<f64>, _moment: &Moment<f64>) -> i8 {
        0
    }

    /// Returns the distances to the edges of the present region.
    fn margins<S: Scalar>(_values: &Values<S>, _moment: &Moment<S>) -> Margins<S> {
        [None, None]
    }

    /// Returns the region behind an edge (0 or 1) of a region.
    fn beyond(region: i8, _edge: usize) -> i8 {
        region
    }

    /// Returns the hidden state set exactly to the value that the region requires; most effects leave it
    /// unchanged.
    fn settle(_region: i8, _direction: f64, hidden: Hidden<f64>) -> Hidden<f64> {
        hidden
    }

    /// Checks conditions among several parameters.
    ///
    /// # Errors
    /// Returns [`DynamicsError::Contradiction`] if they contradict each other.
    fn check(_values: &Values<f64>, _nominal: &Nominal) -> Result<(), DynamicsError> {
        Ok(())
    }
}
