//! Unmeasured shaker.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::Export;
use crate::law::{Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "periodic_forcing",
    title: "Periodic forcing",
    kind: Kind::System,
    class: Class::TimeDependent,
    equation: "+τ_f sin(Ω t + φ), unmeasured",
    latex: r"+\tau_f\,\sin(\Omega t+\varphi)",
    parameters: &[
        Parameter {
            name: "torque",
            symbol: "τ_f",
            quantity: Quantity::Torque,
            range: Range::NON_NEGATIVE,
            meaning: "amplitude of the forcing",
            default: None,
        },
        Parameter {
            name: "frequency",
            symbol: "Ω",
            quantity: Quantity::AngularFrequency,
            range: Range::POSITIVE,
            meaning: "angular frequency of the forcing",
            default: None,
        },
        Parameter {
            name: "phase",
            symbol: "φ",
            quantity: Quantity::Angle,
            range: Range::TURN,
            meaning: "phase of the forcing at time 0",
            default: None,
        },
    ],
    tell_tale: "A line in the spectrum of the residual that does not decay.",
    confused_with: &["flexible_coupling"],
    reference: "Den Hartog, Mechanical Vibrations, 4th ed., McGraw-Hill 1956, section 2.7",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[4.0, 31.0, 0.3],
};

/// Unmeasured shaker: +τ_f·sin(Ω·t + φ). Time counts from 0 of the record's own clock.
#[derive(Debug, Clone, Copy)]
pub struct PeriodicForcing;

impl Law for PeriodicForcing {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export::torque("{torque} * sin({frequency} * time + {phase})");

    fn torque<S: Scalar>(&[torque, frequency, phase, _]: &Values<S>, moment: &Moment<S>) -> S {
        torque * (frequency * moment.time + phase).sin()
    }
}
