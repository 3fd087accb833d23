//! A joint for MuJoCo and for URDF.

use crate::Repaired;
use crate::configuration::one_line;
use crate::terms::JointTerms;
use dynamics::{Coordinate, Units};
use std::fmt::Write;

/// Gravity of the model in m/s².
const GRAVITY: f64 = 9.81;

/// Writes a MuJoCo model of one body on one joint: damping, stiffness, springref, frictionloss, and inertia as armature beside
/// what a mass that hangs on the joint has. Effects that are no attribute of a joint stand in a comment.
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
    // A point mass at a distance that carries half of the inertia has the weight asked for; body and armature share
    // the rest. MuJoCo takes no body whose mass or inertia is below 1e-15, so that none is a small part of the whole.
    let inertia = nominal.inertia();
    let (mass, place, own) = match terms.weight {
        Some((torque, angle)) => {
            let mass = 2.0 * torque * torque / (inertia * GRAVITY * GRAVITY);
            let arm = torque / (mass * GRAVITY);
            (mass, [-arm * angle.sin(), 0.0, -arm * angle.cos()], inertia / 4.0)
        }
        // On the axis of a hinge a mass moves nothing; of a slide it is the inertia.
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
        // MuJoCo's friction yields a little; by default so much that it is a part of the answer.
        let _ = write!(
            text,
            " frictionloss=\"{friction:?}\" solreffriction=\"{:?} 1\" solimpfriction=\"0.9999 0.9999 0.001\"",
            2.0 * timestep(repaired)
        );
    }
    let _ = write!(
        text,
        " armature=\"{armature:?}\"/>\n    </body>\n  </worldbody>\n  <keyframe>\n    \
         <key name=\"start\" qpos=\"{:?}\" qvel=\"{:?}\"/>\n  </keyframe>\n</mujoco>\n",
        repaired.start.position, repaired.start.velocity
    );
    text
}

/// A thousandth of a period, and no more than a millisecond.
fn timestep(repaired: &Repaired) -> f64 {
    let frequency = repaired.system.nominal().angular_frequency();
    if frequency > 0.0 { (std::f64::consts::TAU / frequency / 1000.0).min(1e-3) } else { 1e-3 }
}

/// A limit beyond any motion, in whatever unit, that single precision still holds.
const UNBOUNDED: &str = "1e9";

/// Writes the `<dynamics>` of a URDF joint, which holds damping and friction only; a joint that slides has a `<limit>`, too, which
/// bounds nothing. Everything else stands in a comment.
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
    let (kind, limit) = match nominal.coordinate() {
        Coordinate::Angle => ("continuous", String::new()),
        // Without limits a prismatic joint is refused, and bounds that are not stated are 0.
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
        // A joint without dry friction has the format's own default.
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
