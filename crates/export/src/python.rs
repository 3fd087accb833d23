//! Export as a Python function for SciPy.

use crate::Repaired;
use crate::configuration::one_line;
use crate::terms::Terms;
use std::fmt::Write;

/// Writes a Python module with `rhs(time, state)` for `scipy.integrate.solve_ivp`, whose state is position,
/// velocity and the hidden states of the effects. The module also has the initial state of the first record,
/// and simulates that record when run.
#[must_use]
pub fn python(repaired: &Repaired) -> String {
    let terms = Terms::of(repaired);
    let mut text = declarations(repaired, &terms);
    derivative(&mut text, repaired, &terms);
    simulation(&mut text, repaired, &terms);
    text
}

/// Returns the module's docstring, its constants and a helper.
fn declarations(repaired: &Repaired, terms: &Terms) -> String {
    let mut text = String::from(
        "\"\"\"The repaired simulator, for scipy.integrate.solve_ivp.\n\n\
         Run as a program it prints the motion of the first record as CSV.\n",
    );
    text.push_str(
        "\nDry friction's sign is blurred over `small_speed`; at rest it creeps by less than that.\n",
    );
    if let Some(hold) = repaired.input {
        let between = hold.in_words();
        let _ = writeln!(
            text,
            "The system is driven: give `rhs` the input as a function of time, which {between}."
        );
    }
    for sentence in &terms.left_out {
        let _ = writeln!(text, "Not part of it: {}.", one_line(sentence).replace('"', "'"));
    }
    text.push_str("\"\"\"\n\nfrom math import exp, sin, tanh\n\n");
    for constant in &terms.constants {
        let _ = writeln!(text, "{} = {:?}  # {}", constant.name, constant.value, one_line(&constant.comment));
    }
    let _ = writeln!(text, "small_speed = {:?}", terms.small_speed);
    if let Some(delay) = terms.delay {
        let _ = writeln!(text, "input_delay = {delay:?}  # s");
    }
    if terms.use_the_drives_rate() {
        let _ = writeln!(
            text,
            "input_step = {:?}  # s, from one sample of the input to the next",
            1.0 / repaired.rate_hz
        );
    }
    text.push_str("\n\ndef sign(x):\n    return (x > 0) - (x < 0)\n\n\n");
    text
}

/// Appends the right-hand side.
fn derivative(text: &mut String, repaired: &Repaired, terms: &Terms) {
    let names: String = terms.states.iter().map(|state| format!(", {}", state.name)).collect();
    let _ = write!(
        text,
        "def rhs(time, state, u=lambda time: 0.0):\n    \
         \"\"\"Time derivative of [position, velocity{names}].\"\"\"\n    \
         position, velocity{names} = state\n    \
         direction = tanh(velocity / small_speed)\n"
    );
    let arrival = if terms.delay.is_some() { "max(time - input_delay, 0.0)" } else { "time" };
    let drive = if repaired.driven() { format!("input_gain * u({arrival})") } else { "0.0".to_owned() };
    let _ = writeln!(text, "    drive = {drive}\n    torque = drive");
    if terms.use_the_drives_rate() {
        let before = drive.replace("u(", "u(-input_step + ");
        let _ = writeln!(text, "    drive_rate = (drive - {before}) / input_step");
    }
    for term in &terms.torques {
        let _ = writeln!(text, "    torque += {}  # {}", term.expression, term.title);
    }
    text.push_str(
        "    acceleration = (torque - damping * velocity - stiffness * (position - rest_angle)) / inertia\n",
    );
    let rates: String = terms.states.iter().map(|state| format!(", {}", state.rate)).collect();
    let _ = write!(text, "    return [velocity, acceleration{rates}]\n\n\n");
}

/// Appends the initial state, and the simulation of the first record when the module is run.
fn simulation(text: &mut String, repaired: &Repaired, terms: &Terms) {
    let starts: String = terms.states.iter().map(|state| format!(", {}", state.start)).collect();
    let _ = write!(
        text,
        "position, velocity = {:?}, {:?}  # where the first record starts\nstart = [position, velocity{starts}]\n\n\n",
        repaired.start.position, repaired.start.velocity
    );
    let _ = write!(
        text,
        "def simulate(times, u=lambda time: 0.0):\n    \
         \"\"\"Positions and velocities at the given times.\"\"\"\n    \
         from scipy.integrate import solve_ivp\n\n    \
         span = (times[0], times[-1])\n    \
         found = solve_ivp(rhs, span, start, method=\"LSODA\", t_eval=times, args=(u,), rtol=1e-8, atol=1e-10, \
         max_step={:?})\n    \
         return found.y[0], found.y[1]\n\n\n\
         if __name__ == \"__main__\":\n    \
         rate, seconds = {:?}, {:?}\n    \
         times = [index / rate for index in range(int(rate * seconds) + 1)]\n    \
         positions, velocities = simulate(times)\n    \
         print(\"time_s,position,velocity\")\n    \
         for row in zip(times, positions, velocities):\n        \
         print(\"%.9g,%.9g,%.9g\" % row)\n",
        longest_step(repaired),
        repaired.rate_hz,
        repaired.seconds
    );
}

/// Returns the longest step: a thirtieth of a period, so that no step skips an event such as the contact with
/// a stop.
fn longest_step(repaired: &Repaired) -> f64 {
    let frequency = repaired.system.nominal().angular_frequency();
    if frequency > 0.0 { std::f64::consts::TAU / frequency / 30.0 } else { repaired.seconds / 1000.0 }
}
