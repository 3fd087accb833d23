//! What an effect in the system is to the integrators.

use crate::description::Description;
use crate::error::DynamicsError;
use crate::export::Export;
use crate::nominal::{Coefficients, Nominal};
use crate::scalar::Scalar;

/// Most parameters that one effect has.
pub const MOST_PARAMETERS: usize = 4;

/// Most hidden state variables that one effect has.
pub const MOST_HIDDEN: usize = 2;

/// Values of an effect's parameters in the order of its description; the rest is unused.
pub type Values<S> = [S; MOST_PARAMETERS];

/// Hidden state variables of one effect; the rest is unused.
pub type Hidden<S> = [S; MOST_HIDDEN];

/// State of a system at one moment, as an effect gets it.
#[derive(Debug, Clone, Copy)]
pub struct Moment<S> {
    /// Time in seconds.
    pub time: S,
    /// Position in rad or m.
    pub position: S,
    /// Velocity in rad/s or m/s.
    pub velocity: S,
    /// The input's torque, after gain and delay.
    pub input: S,
    /// The effect's own hidden state.
    pub hidden: Hidden<S>,
    /// The nominal coefficients.
    pub nominal: Coefficients<S>,
    /// Direction of motion: 1 or −1, or 0 while it sticks. Where the velocity is exactly zero it says
    /// where the motion is about to go.
    pub direction: f64,
    /// Which of its smooth pieces the effect is on; 0 where it has only one.
    pub region: i8,
}

/// Distance to the ends of a region: positive inside, zero at its edge. `None` where there is no edge.
pub type Margins<S> = [Option<S>; 2];

/// An effect that acts in the system: a generalized force, possibly with hidden state and pieces.
///
/// The law holds on one smooth piece at a time: [`Moment::direction`] and [`Moment::region`] are constant
/// while an integrator makes a step, and change only at an event that it locates.
pub trait Law {
    /// Returns the description: id, equation, parameters, signature and reference.
    const DESCRIPTION: &'static Description;

    /// What it looks like in other simulators.
    const EXPORT: Export;

    /// True if the law depends on the direction of motion: a reversal then ends its smooth piece.
    const DIRECTED: bool = false;

    /// The generalized force that it adds to the right-hand side, in the system's unit of torque.
    fn torque<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> S;

    /// Time derivative of the hidden state.
    fn hidden_rate<S: Scalar>(_values: &Values<S>, _moment: &Moment<S>) -> Hidden<S> {
        [S::from(0.0); MOST_HIDDEN]
    }

    /// The hidden state at a start where none is given: the effect is relaxed and moves along.
    fn relaxed<S: Scalar>(_position: S, _velocity: S) -> Hidden<S> {
        [S::from(0.0); MOST_HIDDEN]
    }

    /// The torque up to which dry friction holds the system at rest; none where it is not dry friction.
    fn holding_torque<S: Scalar>(_values: &Values<S>) -> Option<S> {
        None
    }

    /// The delay of the input in seconds; none where the effect does not delay.
    fn input_delay<S: Scalar>(_values: &Values<S>) -> Option<S> {
        None
    }

    /// The region at a moment, from the state alone.
    fn region(_values: &Values<f64>, _moment: &Moment<f64>) -> i8 {
        0
    }

    /// Distances to the edges of the present region.
    fn margins<S: Scalar>(_values: &Values<S>, _moment: &Moment<S>) -> Margins<S> {
        [None, None]
    }

    /// The region behind an edge (0 or 1) of a region.
    fn beyond(region: i8, _edge: usize) -> i8 {
        region
    }

    /// The hidden state put exactly where the region demands it; unchanged in most.
    fn settle(_region: i8, _direction: f64, hidden: Hidden<f64>) -> Hidden<f64> {
        hidden
    }

    /// Conditions among several parameters.
    ///
    /// # Errors
    /// [`DynamicsError::Contradiction`] where they contradict each other.
    fn check(_values: &Values<f64>, _nominal: &Nominal) -> Result<(), DynamicsError> {
        Ok(())
    }
}
