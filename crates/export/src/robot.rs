//! Export as a joint for MuJoCo and for URDF.

use crate::Repaired;
use crate::configuration::one_line;
use crate::terms::{JointTerms, SecondBody};
use dynamics::{Coordinate, Units};
use std::fmt::Write;

/// Gravitational acceleration of the model, in m/s².
const GRAVITY: f64 = 9.81;

/// Writes a MuJoCo model of one body on one joint with damping, stiffness, springref and frictionloss, and of a
/// second body on a joint of its own if there is one. The armature holds the inertia that the mass hanging on
/// the joint does not have. Effects that no attribute of a joint can express are stated in a comment.
#[must_use]
pub fn mjcf(repaired: &Repaired) -> String {
    let nominal = repaired.system.nominal();
    let terms = JointTerms::of(repaired);
    let mut text = String::from("<mujoco model=\"repaired\">\n");
    comments(&mut text, repaired, &terms, "  ");
    let (kind, axis) = match nominal.coordinate() {
        Coordinate::Angle => ("hinge", "0 1 0"),
        Coordinate::Displacement => ("slide", "1 0 0"),
    };
    // A point mass at a distance, carrying half of the inertia, has the required weight; body and armature
    // share the rest. MuJoCo refuses bodies whose mass or inertia is below 1e-15, so no part is a small share
    // of the whole.
    let inertia = nominal.inertia();
    let (mass, place, own) = match terms.weight {
        Some((torque, angle)) => {
            let mass = 2.0 * torque * torque / (inertia * GRAVITY * GRAVITY);
            let arm = torque / (mass * GRAVITY);
            (mass, [-arm * angle.sin(), 0.0, -arm * angle.cos()], inertia / 4.0)
        }
        // A mass on the axis of a hinge moves nothing; on a slide it is the inertia.
        None => (inertia / 2.0, [0.0; 3], inertia / 2.0),
    };
    let armature = own;
    let [x, y, z] = place;
    let _ = write!(
        text,
        "  <compiler angle=\"radian\"/>\n  <option timestep=\"{:?}\" integrator=\"implicitfast\" gravity=\"0 0 -{GRAVITY}\"/>\n  <worldbody>\n    \
         <body name=\"body\">\n      <inertial pos=\"{x:?} {y:?} {z:?}\" mass=\"{mass:?}\" \
         diaginertia=\"{own:?} {own:?} {own:?}\"/>\n      \
         <joint name=\"joint\" type=\"{kind}\" axis=\"{axis}\" damping=\"{:?}\" stiffness=\"{:?}\" \
         springref=\"{:?}\"",
        timestep(repaired),
        nominal.damping(),
        nominal.stiffness(),
        terms.rest,
    );
    if let Some(friction) = terms.friction {
        // MuJoCo's friction yields a little, and with its defaults so much that the motion changes.
        let _ = write!(
            text,
            " frictionloss=\"{friction:?}\" solreffriction=\"{:?} 1\" solimpfriction=\"0.9999 0.9999 0.001\"",
            2.0 * timestep(repaired)
        );
    }
    let _ = writeln!(text, " armature=\"{armature:?}\"/>");
    let start = terms.second_body.as_ref().map_or((0.0, 0.0), |second| second.start);
    let state = |own: f64, second: f64| match terms.second_body {
        Some(_) => format!("{own:?} {second:?}"),
        None => format!("{own:?}"),
    };
    let positions = state(repaired.start.position, start.0);
    let velocities = state(repaired.start.velocity, start.1);
    text.extend(terms.second_body.iter().map(|second| second_body(second, kind, axis)));
    let _ = write!(
        text,
        "    </body>\n  </worldbody>\n  <keyframe>\n    \
         <key name=\"start\" qpos=\"{positions}\" qvel=\"{velocities}\"/>\n  </keyframe>\n</mujoco>\n"
    );
    text
}

/// Writes a second body on a joint within the first. Its center is on the axis of a hinge, where its weight turns
/// nothing, and its joint deflects by ψ − θ.
fn second_body(second: &SecondBody, kind: &str, axis: &str) -> String {
    let SecondBody { inertia, stiffness, damping, .. } = second;
    format!(
        "      <body name=\"second_body\">\n        <inertial pos=\"0 0 0\" mass=\"{inertia:?}\" \
         diaginertia=\"{inertia:?} {inertia:?} {inertia:?}\"/>\n        \
         <joint name=\"coupling\" type=\"{kind}\" axis=\"{axis}\" damping=\"{damping:?}\" stiffness=\"{stiffness:?}\"/>\n      \
         </body>\n"
    )
}

/// Returns a thousandth of a period, but at most a millisecond.
fn timestep(repaired: &Repaired) -> f64 {
    let frequency = repaired.system.nominal().angular_frequency();
    if frequency > 0.0 { (std::f64::consts::TAU / frequency / 1000.0).min(1e-3) } else { 1e-3 }
}

/// A limit beyond any motion, in any unit, that single precision can hold.
const UNBOUNDED: &str = "1e9";

/// Writes the `<dynamics>` of a URDF joint, which holds only damping and friction. A sliding joint also has a
/// `<limit>` that bounds nothing. Everything else is stated in a comment.
#[must_use]
pub fn urdf(repaired: &Repaired) -> String {
    let nominal = repaired.system.nominal();
    let mut terms = JointTerms::of(repaired);
    terms.left_out.push(format!(
        "the spring: URDF has none; k = {:?} {}, relaxed at {:?} {}",
        nominal.stiffness(),
        repaired.unit(dynamics::Quantity::Stiffness),
        terms.rest,
        repaired.unit(dynamics::Quantity::Position)
    ));
    terms.left_out.push(format!(
        "the inertia, which belongs to the link: {:?} {}",
        nominal.inertia(),
        repaired.unit(dynamics::Quantity::Inertia)
    ));
    if let Some((torque, angle)) = terms.weight {
        terms.left_out.push(format!(
            "the weight, which follows from the link's mass and center: {torque:?} held level, hanging straight down \
             {angle:?} rad before position 0"
        ));
    }
    if let Some(second) = &terms.second_body {
        let (deflection, rate) = second.start;
        terms.left_out.push(format!(
            "the second body, which needs a link and a joint with a spring: inertia {:?}, stiffness {:?}, damping {:?}; \
             at the start its joint is deflected by {deflection:?} and moves at {rate:?}",
            second.inertia, second.stiffness, second.damping
        ));
    }
    let (kind, limit) = match nominal.coordinate() {
        Coordinate::Angle => ("continuous", String::new()),
        // A prismatic joint without limits is refused, and bounds that are not stated are 0.
        Coordinate::Displacement => (
            "prismatic",
            format!(
                "  <!-- The limits bound nothing: URDF asks for some where a joint slides. -->\n  \
                 <limit lower=\"-{UNBOUNDED}\" upper=\"{UNBOUNDED}\" effort=\"{UNBOUNDED}\" \
                 velocity=\"{UNBOUNDED}\"/>\n"
            ),
        ),
    };
    let mut text = format!("<joint name=\"joint\" type=\"{kind}\">\n");
    comments(&mut text, repaired, &terms, "  ");
    let _ = write!(
        text,
        "  <parent link=\"base\"/>\n  <child link=\"body\"/>\n{limit}  <dynamics damping=\"{:?}\" friction=\"{:?}\"/>\n</joint>\n",
        nominal.damping(),
        terms.friction.unwrap_or(0.0)
    );
    text
}

fn comments(text: &mut String, repaired: &Repaired, terms: &JointTerms, indent: &str) {
    if matches!(repaired.units, Units::PerInertia(_)) {
        let _ =
            writeln!(text, "{indent}<!-- Only the motion is known: every torque is per unit of inertia. -->");
    }
    if repaired.driven() {
        let _ = writeln!(
            text,
            "{indent}<!-- An input drives the system: torque {:?} per unit of it, by an actuator of yours. -->",
            repaired.system.nominal().input_gain()
        );
    }
    for sentence in &terms.left_out {
        // Two hyphens would end a comment.
        let sentence = one_line(sentence).replace("--", "- -");
        let _ = writeln!(text, "{indent}<!-- Not part of it: {sentence}. -->");
    }
}
