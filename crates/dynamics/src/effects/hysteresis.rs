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
    equation: "-τ_h z with z′ = (θ′ - |θ′| z)/δ",
    latex: r"-\tau_h z,\quad \dot z=(\dot\theta-\lvert\dot\theta\rvert z)/\delta",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_h",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "friction torque once sliding",
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
    ],
    tell_tale: "A loss as from dry friction, but stiffer at very small amplitude: the contact bends before it slides.",
    confused_with: &["coulomb_friction"],
    reference: "Dahl, Aerospace Corporation TOR-0158(3107-18)-1 (1968), exponent 1; the same as Bouc-Wen (Wen, Journal of the Engineering Mechanics Division 102 (1976) 249) with n = 1, γ = 0",
    driven_only: false,
    hidden_states: 1,
    smooth: false,
    example: &[1.0, 0.01],
};

/// Dry friction with a pre-sliding spring (Dahl; Bouc–Wen with n = 1, γ = 0): −τ_h·z with the hidden state ż
/// = (θ̇ − |θ̇|·z)/δ. A stretch of motion in one direction brings z to that direction within a few δ; the
/// stiffness is τ_h/δ at small displacement.
///
/// Regions: 0 while z builds up, 1 once it lies within 1e-13 of the direction of motion. It is then set to
/// that direction: the equation has become stiff and is replaced by its limit.
#[derive(Debug, Clone, Copy)]
pub struct Hysteresis;

/// Distance of z from ±1 at which it counts as built up. The error of the torque is at most this part of τ_h.
const SATURATED: f64 = 1e-13;

impl Law for Hysteresis {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export {
        states: &[StateExport {
            name: "z",
            rate: "(velocity - abs(velocity) * {z}) / {displacement}",
            start: "0",
        }],
        ..Export::torque("-{torque} * {z}")
    };
    const DIRECTED: bool = true;

    fn torque<S: Scalar>(&[torque, ..]: &Values<S>, moment: &Moment<S>) -> S {
        let [z, _] = moment.hidden;
        -torque * z
    }

    fn hidden_rate<S: Scalar>(&[_, displacement, ..]: &Values<S>, moment: &Moment<S>) -> Hidden<S> {
        let [z, _] = moment.hidden;
        let zero = S::from(0.0);
        match moment.region {
            0 => [(moment.velocity - moment.velocity * z * moment.direction) / displacement, zero],
            _ => [zero, zero],
        }
    }

    fn region(_: &Values<f64>, moment: &Moment<f64>) -> i8 {
        let [z, _] = moment.hidden;
        i8::from(moment.direction != 0.0 && 1.0 - z * moment.direction <= SATURATED)
    }

    fn margins<S: Scalar>(_: &Values<S>, moment: &Moment<S>) -> Margins<S> {
        let [z, _] = moment.hidden;
        match moment.region {
            0 if moment.direction != 0.0 => [Some(-z * moment.direction + (1.0 - SATURATED)), None],
            _ => [None, None],
        }
    }

    fn beyond(_: i8, _: usize) -> i8 {
        1
    }

    fn settle(region: i8, direction: f64, hidden: Hidden<f64>) -> Hidden<f64> {
        if region == 1 && direction != 0.0 { [direction, 0.0] } else { hidden }
    }
}
