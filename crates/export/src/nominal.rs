//! Export of a nominal simulator as the text of a configuration.

use dynamics::{KnownEffect, NominalSimulator};

/// Writes a nominal simulator with its effects as the text of a `nominal.toml`: inertia, damping, stiffness
/// and rest position, each with its unit in a comment. Reading the text gives the same simulator to the bit.
#[must_use]
pub fn nominal_text(simulator: impl Into<NominalSimulator>) -> String {
    use dynamics::Quantity;
    let simulator = simulator.into();
    let nominal = simulator.nominal();
    let units = nominal.units();
    let mut text = String::from(match simulator.effects() {
        [] => "# What is believed of the system: the simulator without any effect.\n",
        _ => "# What is believed of the system: the simulator with the effects that it has.\n",
    });
    if nominal.coordinate() == dynamics::Coordinate::Displacement {
        text.push_str("coordinate = \"displacement\"\n");
    }
    for (key, value, quantity) in [
        ("inertia", nominal.inertia(), Quantity::Inertia),
        ("damping", nominal.damping(), Quantity::Damping),
        ("stiffness", nominal.stiffness(), Quantity::Stiffness),
        ("rest_angle", nominal.rest_angle(), Quantity::Position),
    ] {
        text.push_str(&format!("{:<40}# {}\n", format!("{key} = {value:?}"), quantity.unit(units)));
    }
    if nominal.input_gain() != 1.0 {
        text.push_str(&format!("input_gain = {:?}\n", nominal.input_gain()));
    }
    if let Some(resolution) = nominal.sensor_resolution() {
        let unit = Quantity::Position.unit(units);
        text.push_str(&format!("{:<40}# {unit}\n", format!("sensor_resolution = {resolution:?}")));
    }
    for KnownEffect { active, recalibrate } in simulator.effects() {
        text.push_str(&format!("\n[[effects]]\nid = \"{}\"\nrecalibrate = {recalibrate}\n", active.id()));
        for (parameter, value) in active.effect().description().parameters.iter().zip(active.values()) {
            let line = format!("parameters.{} = {value:?}", parameter.name);
            text.push_str(&format!("{line:<40}# {}\n", parameter.quantity.unit(units)));
        }
    }
    text
}
