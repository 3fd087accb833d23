//! Second body on a spring.

use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::export::{Export, Joint, StateExport};
use crate::law::{Hidden, Law, Moment, Values};
use crate::scalar::Scalar;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "flexible_coupling",
    title: "Flexible coupling",
    kind: Kind::System,
    class: Class::Conservative,
    equation: "+k_2 (ψ - θ) + c_2 (ψ′ - θ′) with I_2 ψ″ = -k_2 (ψ - θ) - c_2 (ψ′ - θ′)",
    latex: r"+k_2(\psi-\theta)+c_2(\dot\psi-\dot\theta),\quad I_2\ddot\psi=-k_2(\psi-\theta)-c_2(\dot\psi-\dot\theta)",
    parameters: &[
        Parameter {
            name: "inertia",
            symbol: "I_2",
            quantity: Quantity::Inertia,
            range: Range::POSITIVE,
            meaning: "inertia of the hidden body",
            default: None,
        },
        Parameter {
            name: "stiffness",
            symbol: "k_2",
            quantity: Quantity::Stiffness,
            range: Range::POSITIVE,
            meaning: "stiffness of the coupling",
            default: None,
        },
        Parameter {
            name: "damping",
            symbol: "c_2",
            quantity: Quantity::Damping,
            range: Range::NON_NEGATIVE,
            meaning: "viscous damping of the coupling",
            default: None,
        },
    ],
    tell_tale: "A second line that decays, and beating.",
    confused_with: &["periodic_forcing"],
    reference: "Den Hartog, Mechanical Vibrations, 4th ed., McGraw-Hill 1956, sections 3.1 to 3.3",
    driven_only: false,
    hidden_states: 2,
    smooth: true,
    example: &[0.05, 180.0, 0.2],
};

/// Second body on a spring and damper: +k₂·(ψ − θ) + c₂·(ψ̇ − θ̇) with the hidden motion I₂·ψ̈ = −k₂·(ψ − θ)
/// − c₂·(ψ̇ − θ̇). At a start it moves along with the coupling relaxed, unless its state is given.
#[derive(Debug, Clone, Copy)]
pub struct FlexibleCoupling;

fn coupling<S: Scalar>(stiffness: S, damping: S, moment: &Moment<S>) -> S {
    let [position, velocity] = moment.hidden;
    stiffness * (position - moment.position) + damping * (velocity - moment.velocity)
}

impl Law for FlexibleCoupling {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const EXPORT: Export = Export {
        states: &[
            StateExport { name: "position", rate: "{velocity}", start: "position" },
            StateExport {
                name: "velocity",
                rate: "-({stiffness} * ({position} - position) + {damping} * ({velocity} - velocity)) / {inertia}",
                start: "velocity",
            },
        ],
        joint: Joint::SecondBody { inertia: "inertia", stiffness: "stiffness", damping: "damping" },
        ..Export::torque("{stiffness} * ({position} - position) + {damping} * ({velocity} - velocity)")
    };

    fn torque<S: Scalar>(&[_, stiffness, damping, _]: &Values<S>, moment: &Moment<S>) -> S {
        coupling(stiffness, damping, moment)
    }

    fn hidden_rate<S: Scalar>(
        &[inertia, stiffness, damping, _]: &Values<S>,
        moment: &Moment<S>,
    ) -> Hidden<S> {
        let [_, velocity] = moment.hidden;
        [velocity, -coupling(stiffness, damping, moment) / inertia]
    }

    fn relaxed<S: Scalar>(position: S, velocity: S) -> Hidden<S> {
        [position, velocity]
    }
}
