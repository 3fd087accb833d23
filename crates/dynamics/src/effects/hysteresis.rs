//! Friction with a pre-sliding spring.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::{Export, StateExport};
use crate::law::{Hidden, Law, Margins, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "hysteresis",
    title: "Hysteresis",
    kind: Kind::System,
    class: Class::Dissipative,
    equation: "-τ_h z with z′ = (θ′ - (|θ′| z + γ θ′ |z|) |z|ⁿ⁻¹)/δ",
    latex: r"-\tau_h z,\quad \dot z=(\dot\theta-(\lvert\dot\theta\rvert z+\gamma\dot\theta\lvert z\rvert)\lvert z\rvert^{n-1})/\delta",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_h",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "friction torque once sliding, times (1 + γ)^(1/n)",
            default: None,
        },
        Parameter {
            name: "displacement",
            symbol: "δ",
            quantity: Quantity::Position,
            range: Range::POSITIVE,
            meaning: "displacement over which the friction builds up before sliding",
            default: None,
        },
        Parameter {
            name: "softening",
            symbol: "γ",
            quantity: Quantity::Ratio,
            range: Range::ANY,
            meaning: "softening of the contact as it bends; below 0 it stiffens, and from -1 down it never slides",
            default: Some(0.0),
        },
        Parameter {
            name: "exponent",
            symbol: "n",
            quantity: Quantity::Ratio,
            range: Range { minimum: 1.0, maximum: 3.0, closed: true },
            meaning: "sharpness of the bend between sticking and sliding",
            default: Some(1.0),
        },
    ],
    tell_tale: "A loss as from dry friction, but stiffer at very small amplitude: the contact bends before it slides.",
    confused_with: &["coulomb_friction"],
    reference: "Wen, Journal of the Engineering Mechanics Division 102 (1976) 249; with γ = 0 and n = 1 Dahl, Aerospace Corporation TOR-0158(3107-18)-1 (1968), exponent 1",
    driven_only: false,
    hidden_states: 1,
    smooth: false,
    example: &[1.0, 0.01, 0.3, 1.5],
};

/// Dry friction with a pre-sliding spring (Bouc–Wen): −τ_h·z with the hidden state ż = (θ̇ − (|θ̇|·z +
/// γ·θ̇·|z|)·|z|ⁿ⁻¹)/δ. A stretch of motion in one direction brings |z| to (1 + γ)^(−1/n) within a few δ if γ is
/// above −1; otherwise z never slides, and the contact stiffens in the direction of motion. The stiffness is τ_h/δ
/// at small displacement. With γ = 0 and n = 1, the defaults, the law is Dahl's.
///
/// |z|ⁿ⁻¹ is the parabola 1 + (n−1)·(|z|−1) + ½·(n−1)·(n−2)·(|z|−1)², which is exact for n = 1, 2 and 3. The power
/// itself has no Taylor series at z = 0 in between.
///
/// Regions of Dahl's law: 0 while z builds up, 1 once it lies within 1e-13 of the direction of motion. It is then set
/// to that direction: the equation has become stiff and is replaced by its limit. Derivatives by γ and n are not
/// defined there. Regions of the general law: 2 while |z| falls, 3 while it grows, 4 once its rate has fallen to
/// 1e-13 of the initial one and counts as zero.
#[derive(Debug, Clone, Copy)]
pub struct Hysteresis;

/// Rate of z, relative to that at z = 0, at which it counts as built up. In Dahl's law this is its distance from ±1,
/// and the error of the torque is at most this part of τ_h.
const SATURATED: f64 = 1e-13;

const BUILDING: i8 = 0;
const SLIDING: i8 = 1;
const FALLING: i8 = 2;
const GROWING: i8 = 3;
const HELD: i8 = 4;

/// Returns |z|ⁿ, as the parabola states it, from |z|.
fn power<S: Scalar>(size: S, exponent: S) -> S {
    let above = size - 1.0;
    let curved = (exponent - 2.0) * above * 0.5 + 1.0;
    size * ((exponent - 1.0) * above * curved + 1.0)
}

/// Returns the part of the initial rate that is left while z grows, from |z|.
fn left<S: Scalar>(&[_, _, softening, exponent]: &Values<S>, size: S) -> S {
    -power(size, exponent) * (softening + 1.0) + 1.0
}

impl Law for Hysteresis {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export {
        states: &[StateExport {
            name: "z",
            rate: "(velocity - (abs(velocity) * {z} + {softening} * velocity * abs({z})) * (1 + ({exponent} - 1) \
                   * (abs({z}) - 1) * (1 + 0.5 * ({exponent} - 2) * (abs({z}) - 1)))) / {displacement}",
            start: "0",
        }],
        ..Export::torque("-{torque} * {z}")
    };
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(&[torque, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let [z, _] = moment.hidden;
        -torque * z
    }

    fn hidden_rate<S: Scalar>(
        values @ &[_, displacement, softening, exponent]: &Values<S>,
        moment: &Moment<S>,
    ) -> Hidden<S> {
        let [z, _] = moment.hidden;
        let along = z * moment.direction;
        let part = match moment.region {
            BUILDING => {
                let rate = moment.velocity - moment.velocity * z * moment.direction;
                return [rate / displacement, S::from(0.0)];
            }
            FALLING => power(-along, exponent) * (-softening + 1.0) + 1.0,
            GROWING => left(values, along),
            _ => return [S::from(0.0); 2],
        };
        [moment.velocity * part / displacement, S::from(0.0)]
    }

    fn region(values @ &[_, _, softening, exponent]: &Values<f64>, moment: &Moment<f64>) -> i8 {
        let [z, _] = moment.hidden;
        let along = z * moment.direction;
        if softening == 0.0 && exponent == 1.0 {
            return if moment.direction != 0.0 && 1.0 - along <= SATURATED { SLIDING } else { BUILDING };
        }
        match along {
            along if along < 0.0 => FALLING,
            along if left(values, along) <= SATURATED => HELD,
            _ => GROWING,
        }
    }

    fn margins<S: Scalar>(values: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let [z, _] = moment.hidden;
        let along = z * moment.direction;
        match moment.region {
            _ if moment.direction == 0.0 => [None, None],
            BUILDING => [Some(-along + (1.0 - SATURATED)), None],
            FALLING => [Some(-along), None],
            GROWING => [Some(left(values, along) - SATURATED), None],
            _ => [None, None],
        }
    }

    fn beyond(region: i8, _: usize) -> i8 {
        region + 1
    }

    fn settle(region: i8, direction: f64, hidden: Hidden<f64>) -> Hidden<f64> {
        if region == SLIDING && direction != 0.0 { [direction, 0.0] } else { hidden }
    }
}
