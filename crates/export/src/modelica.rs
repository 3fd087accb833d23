//! Export as a Modelica model.

use crate::Repaired;
use crate::configuration::one_line;
use crate::terms::Terms;
use std::fmt::Write;

/// Writes a Modelica model, `Repaired`, that starts in the initial state of the first record. Parameters are
/// in SI units, or per inertia if the inertia is 1; `u` is the input of a driven system. What Modelica cannot
/// express is stated in a comment.
#[must_use]
pub fn modelica(repaired: &Repaired) -> String {
    let terms = Terms::of(repaired);
    let mut text = declarations(repaired, &terms);
    equations(&mut text, repaired, &terms);
    text
}

/// Returns the declarations of parameters, inputs and states.
fn declarations(repaired: &Repaired, terms: &Terms) -> String {
    let mut text = String::from("model Repaired \"The repaired simulator\"\n");
    text.push_str("  // Dry friction's sign is blurred over small_speed.\n");
    for sentence in &terms.left_out {
        let _ = writeln!(text, "  // Not part of it: {}", one_line(sentence));
    }
    for constant in &terms.constants {
        let _ = writeln!(
            text,
            "  parameter Real {} = {:?}; // {}",
            constant.name,
            constant.value,
            one_line(&constant.comment)
        );
    }
    let _ = writeln!(text, "  parameter Real small_speed = {:?};", terms.small_speed);
    if let Some(delay) = terms.delay {
        let _ = writeln!(text, "  parameter Real input_delay = {delay:?}; // s");
    }
    if terms.use_the_drives_rate() {
        let _ = writeln!(text, "  parameter Real input_step = {:?}; // s", 1.0 / repaired.rate_hz);
        text.push_str("  Real drive_rate;\n");
    }
    if repaired.driven() {
        text.push_str("  input Real u;\n");
    }
    let start = repaired.start;
    let _ = writeln!(text, "  parameter Real start_position = {:?};", start.position);
    let _ = writeln!(text, "  parameter Real start_velocity = {:?};", start.velocity);
    text.push_str("  Real position(start = start_position, fixed = true);\n");
    text.push_str("  Real velocity(start = start_velocity, fixed = true);\n");
    for state in &terms.states {
        let start = state.start.replace("position", "start_position").replace("velocity", "start_velocity");
        let _ = writeln!(text, "  Real {}(start = {start}, fixed = true);", state.name);
    }
    text.push_str("  Real direction;\n  Real drive;\n");
    text
}

/// Appends the equation of motion and the rates of hidden states.
fn equations(text: &mut String, repaired: &Repaired, terms: &Terms) {
    text.push_str("equation\n  der(position) = velocity;\n");
    text.push_str("  direction = tanh(velocity / small_speed);\n");
    let _ = writeln!(
        text,
        "  drive = {};",
        match (repaired.driven(), terms.delay) {
            (false, _) => "0",
            (true, None) => "input_gain * u",
            (true, Some(_)) => "input_gain * delay(u, input_delay)",
        }
    );
    if terms.use_the_drives_rate() {
        text.push_str("  drive_rate = (drive - delay(drive, input_step)) / input_step;\n");
    }
    text.push_str(
        "  inertia * der(velocity) = drive - damping * velocity - stiffness * (position - rest_angle)",
    );
    for term in &terms.torques {
        // Modelica allows no sign directly after a binary operator.
        let _ = write!(text, "\n    + ({}) /* {} */", term.expression, term.title);
    }
    text.push_str(";\n");
    for state in &terms.states {
        let _ = writeln!(text, "  der({}) = {};", state.name, state.rate);
    }
    let _ = writeln!(
        text,
        "  annotation(experiment(StopTime = {:?}, Tolerance = 1e-8));\nend Repaired;",
        repaired.seconds
    );
}
