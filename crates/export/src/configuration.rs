//! Export as `repaired.toml`, a configuration of `trainer simulate`.

use crate::Repaired;
use dynamics::chain::Observed;
use dynamics::{Coordinate, Quantity};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Writes a configuration that `trainer simulate` can run: the oscillator's coefficients in SI units or per
/// inertia, the start, the sampling and length of the first record, and one table for each effect. A
/// configuration cannot hold a measured input: for a driven system the waveform is `none`, with a comment.
#[must_use]
pub fn configuration(repaired: &Repaired) -> String {
    let nominal = repaired.system.nominal();
    let mut text = String::from(
        "# The repaired simulator: the recalibrated nominal one with the effects that it lacked.\n\
         #\n\
         #   trainer simulate repaired.toml --out DIR\n",
    );
    for sentence in &repaired.left_out {
        let _ = writeln!(text, "#\n# Not part of it: {}", one_line(sentence));
    }
    text.push_str("\ntask = \"simulate\"\nname = \"repaired\"\nseed = 0\n\n[record]\n");
    number(&mut text, "rate_hz", repaired.rate_hz, "Hz");
    number(&mut text, "seconds", repaired.seconds, "s");
    text.push_str("\n[nominal]\n");
    if nominal.coordinate() == Coordinate::Displacement {
        text.push_str("coordinate = \"displacement\"\n");
    }
    number(&mut text, "inertia", nominal.inertia(), repaired.unit(Quantity::Inertia));
    number(&mut text, "damping", nominal.damping(), repaired.unit(Quantity::Damping));
    number(&mut text, "stiffness", nominal.stiffness(), repaired.unit(Quantity::Stiffness));
    number(&mut text, "rest_angle", nominal.rest_angle(), repaired.unit(Quantity::Position));
    number(&mut text, "input_gain", nominal.input_gain(), "torque or force per unit of the input");
    if let Some(resolution) = nominal.sensor_resolution() {
        number(&mut text, "sensor_resolution", resolution, repaired.unit(Quantity::Position));
    }
    text.push_str("\n[start]\n");
    number(&mut text, "position", repaired.start.position, repaired.unit(Quantity::Position));
    number(&mut text, "velocity", repaired.start.velocity, repaired.unit(Quantity::Velocity));
    if repaired.driven() {
        let frequency_hz = nominal.angular_frequency() / TAU;
        let _ = write!(
            text,
            "\n# The system was driven by a measured input, which this file cannot hold; repaired.py takes it. For another input:\n\
             #   trainer simulate repaired.toml input.waveform=sine input.amplitude=1 input.frequency_hz={:.3}\n\
             [input]\n{:<48}# or sine, chirp, square\n",
            if frequency_hz > 0.0 { frequency_hz } else { 1.0 },
            "waveform = \"none\"",
        );
    }
    let observed = match repaired.observed {
        Observed::Position => "position",
        Observed::Velocity => "velocity",
        Observed::Acceleration => "acceleration",
    };
    let _ = write!(text, "\n[sensor]\nobserves = \"{observed}\"\n");
    number(&mut text, "noise", repaired.noise.max(0.0), repaired.unit(Quantity::Observed));
    for active in repaired.system.effects().iter().chain(&repaired.chain) {
        let description = active.effect().description();
        let _ = write!(text, "\n[[effects]]\nid = \"{}\"\n", description.id);
        for (parameter, value) in description.parameters.iter().zip(active.values()) {
            let key = format!("parameters.{}", parameter.name);
            number(&mut text, &key, *value, repaired.unit(parameter.quantity));
        }
        if let Some(states) = repaired.hidden_start(description.id) {
            let _ = writeln!(text, "{:<48}# its hidden states at the start", format!("start = {states:?}"));
        }
    }
    text
}

fn number(text: &mut String, key: &str, value: f64, unit: &str) {
    // `{:?}` reads back as the same double, and always as a number with a point or an exponent.
    let _ = writeln!(text, "{:<48}# {unit}", format!("{key} = {value:?}"));
}

/// Joins a sentence to one line, so that it stays within its comment.
pub(crate) fn one_line(sentence: &str) -> String {
    sentence.split_whitespace().collect::<Vec<_>>().join(" ")
}
