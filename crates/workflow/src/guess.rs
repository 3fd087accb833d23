//! First guess of a nominal simulator, and the files that `trainer init` writes.

use crate::read::coordinate_of;
use dynamics::Coordinate;
use identify::{Basis, Estimated, LinearOscillator};
use record::{Unit, two_digits};
use std::fmt::Write;

/// Returns the inertia in kg m² or kg, with the sign of the input, if the log holds the torque or the force that drives
/// an angle or a displacement: the inertia is what that has to be divided by.
fn inertia(oscillator: &LinearOscillator, reading: &record::Reading) -> Option<(Estimated, f64)> {
    let gain = oscillator.input_gain.filter(|gain| gain.is_significant())?;
    let unit = |column: &record::ColumnReading| Unit::parse(column.unit.as_ref()?);
    let torque = match coordinate_of(reading.coordinate) {
        Coordinate::Angle => "N m",
        Coordinate::Displacement => "N",
    };
    let drives = unit(reading.input.as_ref()?)?.si() == torque;
    // The signal of a sensor stands for meters of its own.
    let observes = !unit(&reading.value)?.is_signal();
    let size = gain.value.abs();
    let found = Estimated { value: 1.0 / size, std_error: gain.std_error / (size * size) };
    (drives && observes).then_some((found, gain.value.signum()))
}

/// Writes a guess of a nominal simulator as a commented `nominal.toml`: in SI units if the log, which was read as stated,
/// holds the torque or the force that drives it, else per unit of inertia.
#[must_use]
pub fn nominal_toml(log: &str, oscillator: &LinearOscillator, reading: &record::Reading) -> String {
    let coordinate = coordinate_of(reading.coordinate);
    let known = inertia(oscillator, reading);
    let signal = reading.value.unit.as_deref().and_then(Unit::parse).filter(|unit| unit.is_signal());
    let (position, mass, torque, damping) = match coordinate {
        Coordinate::Angle => ("rad", "kg m^2", "torque", "N m s/rad"),
        Coordinate::Displacement => (signal.map_or("m", Unit::si), "kg", "force", "N s/m"),
    };
    let mut text = format!(
        "# The linear oscillator nearest to {log}. Where you have a simulator, put its numbers in place of these: a\n\
         # diagnosis says what the simulator in this file lacks.\n\n"
    );
    let mut line = |key: &str, value: String, comment: String| {
        let _ = writeln!(text, "{:<44}# {comment}", format!("{key} = {value}"));
    };
    line(
        "coordinate",
        format!("\"{}\"", name(coordinate)),
        "\"angle\" (rad) or \"displacement\" (m)".to_owned(),
    );
    match (oscillator.natural_frequency_hz(), oscillator.damping_ratio()) {
        (Some(frequency), Some(ratio)) => {
            line("natural_frequency", digits(frequency), format!("Hz, ± {}", error(frequency)));
            line("damping_ratio", digits(passive(ratio)), format!("± {}", error(ratio)));
        }
        _ => {
            let found = passive(oscillator.damping);
            let (unit, found) = match known {
                Some((inertia, _)) => (damping, found.times(inertia.value)),
                None => ("1/s, over the inertia", found),
            };
            line("damping", digits(found), format!("{unit}, ± {}", error(found)));
            line("stiffness", "0.0".to_owned(), format!("the record shows no restoring {torque}"));
        }
    }
    match oscillator.rest {
        Some(rest) => line("rest_angle", digits(rest), format!("{position}, ± {}", error(rest))),
        None => line("rest_angle", "0.0".to_owned(), position.to_owned()),
    }
    match (known, oscillator.input_gain) {
        (Some((inertia, sign)), _) => {
            line(
                "inertia",
                digits(inertia),
                format!("{mass}, by the recorded {torque}, ± {}", error(inertia)),
            );
            line("input_gain", format!("{sign:?}"), format!("the input is the {torque}"));
            return text;
        }
        (None, Some(gain)) => {
            let comment = format!("{torque} over the inertia, per unit of the input, ± {}", error(gain));
            line("input_gain", digits(gain), comment);
        }
        (None, None) => {}
    }
    let key = if oscillator.natural_frequency_hz().is_some() { "# inertia" } else { "inertia" };
    line(key, "1.0".to_owned(), format!("{mass}; left out, everything is per unit of inertia"));
    text
}

/// Returns a damping that a simulator can have: the negative damping of a growing swing becomes zero.
fn passive(damping: Estimated) -> Estimated {
    Estimated { value: damping.value.max(0.0), ..damping }
}

/// Writes a configuration that estimates the damping ratio of the record, including the keys that say how to
/// read it.
#[must_use]
pub fn configuration(path: &str, reading: &[(&str, String)]) -> String {
    let mut text = format!(
        "# Estimates the damping ratio of one record.\n\
         #\n\
         #   trainer CONFIG                        CONFIG is this file\n\
         #   trainer CONFIG estimator=pinn         another method: trainer list estimators\n\
         #\n\
         # Every key that is not written here has a default; trainer explain CONFIG lists them.\n\n\
         [data]\n\
         {:<44}# a relative path starts from this file\n",
        format!("path = {}", quoted(path))
    );
    for (key, value) in reading {
        let value = if value.parse::<f64>().is_ok() { value.clone() } else { quoted(value) };
        let _ = writeln!(text, "{key} = {value}");
    }
    text.push_str("\n[estimator]\n");
    let _ = writeln!(text, "{:<44}# ordinary least squares on the logarithms of the peaks", "name = \"ols\"");
    text
}

/// Quotes a text for TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Returns the coordinate's name in configurations.
#[must_use]
pub fn name(coordinate: Coordinate) -> &'static str {
    match coordinate {
        Coordinate::Angle => "angle",
        Coordinate::Displacement => "displacement",
    }
}

/// Describes the basis of the guess in words.
#[must_use]
pub fn basis(oscillator: &LinearOscillator) -> String {
    match oscillator.basis {
        Basis::TurningPoints(count) => format!("from {count} turning points of a free decay"),
        Basis::Samples(count) => format!("from damped sinusoids fitted to the samples of {count} windows"),
        Basis::Response(count) => format!("from the simulated response nearest to {count} samples"),
        Basis::Windows(count) => format!("by regression over {count} windows of the record"),
        Basis::Modes(1) => "from a damped sinusoid fitted beside steady lines".to_owned(),
        Basis::Modes(count) => format!("of the strongest of {count} modes"),
    }
}

/// Formats a number up to the second digit of its standard error, in a form that TOML can read.
fn digits(estimated: Estimated) -> String {
    let Estimated { value, std_error } = estimated;
    // At most eleven significant digits; ten if the standard error is zero or missing.
    let wanted = if std_error > 0.0 && value != 0.0 {
        (libm::log10(value.abs()).floor() - libm::log10(std_error).floor()).clamp(0.0, 9.0) as usize + 1
    } else {
        9
    };
    let text = format!("{value:.wanted$e}");
    match text.parse::<f64>() {
        Ok(number) if (1e-4..1e6).contains(&number.abs()) || number == 0.0 => format!("{number:?}"),
        _ => text,
    }
}

/// Formats a standard error with two digits.
fn error(estimated: Estimated) -> String {
    two_digits(estimated.std_error)
}

#[cfg(test)]
mod tests {
    use super::{configuration, digits, nominal_toml};
    use identify::{Basis, Estimated, LinearOscillator};

    fn of(value: f64, std_error: f64) -> Estimated {
        Estimated { value, std_error }
    }

    #[test]
    fn digits_follow_the_error() {
        assert_eq!(digits(of(3.462_345_6, 2.1e-4)), "3.46235");
        assert_eq!(digits(of(0.009_164_3, 1.2e-4)), "0.00916");
        assert_eq!(digits(of(12.3, 40.0)), "12.0");
        assert_eq!(digits(of(1.234_4e-7, 1e-9)), "1.234e-7");
        assert_eq!(digits(of(0.0, 0.0)), "0.0");
    }

    #[test]
    fn a_guess_is_a_nominal_simulator() {
        let swinging = LinearOscillator {
            stiffness: of(473.0, 0.1),
            damping: of(0.4, 0.01),
            rest: Some(of(0.03, 1e-3)),
            input_gain: None,
            basis: Basis::TurningPoints(70),
        };
        let drive = LinearOscillator {
            stiffness: of(0.0, 0.0),
            rest: None,
            input_gain: Some(of(0.31, 0.01)),
            basis: Basis::Windows(99),
            ..swinging
        };
        let stated = |oscillator: &LinearOscillator, reading: &record::Reading| {
            let text = nominal_toml("log.csv", oscillator, reading);
            let document = settings::Document::parse("nominal.toml", &text).unwrap();
            experiment::resolve_nominal(&document).unwrap()
        };
        let angle = record::Reading::default();
        let length =
            record::Reading { coordinate: record::Coordinate::Displacement, ..record::Reading::default() };
        for (oscillator, reading) in [(&swinging, &angle), (&drive, &length)] {
            let stated = stated(oscillator, reading);
            let coefficients = stated.nominal.coefficients();
            let found = oscillator.stiffness.value / coefficients.inertia;
            assert!((coefficients.stiffness - found).abs() <= 1e-3 * found);
            assert_eq!(stated.driven, oscillator.input_gain.is_some());
        }
        // A recorded force tells the mass: 1/0.31 kg. A voltage does not, nor does a force beside a sensor's signal.
        let column = |unit: &str| record::ColumnReading { unit: Some(unit.to_owned()), ..Default::default() };
        let both = LinearOscillator { input_gain: Some(of(-0.31, 0.01)), ..swinging };
        for (value, input, inertia, gain) in
            [("mm", "N", 1.0 / 0.31, -1.0), ("mm", "V", 1.0, -0.31), ("V", "N", 1.0, -0.31)]
        {
            let reading =
                record::Reading { value: column(value), input: Some(column(input)), ..length.clone() };
            for (oscillator, sign) in [(&both, 1.0), (&drive, -1.0)] {
                let found = stated(oscillator, &reading).nominal.coefficients();
                assert!((found.inertia / inertia - 1.0).abs() < 1e-2, "{value} {input}: {found:?}");
                assert!((found.input_gain * sign - gain).abs() < 1e-2, "{value} {input}: {found:?}");
                let per_inertia = [found.stiffness, found.damping].map(|own| own / found.inertia);
                let wanted = [oscillator.stiffness.value, oscillator.damping.value];
                assert!(
                    per_inertia
                        .iter()
                        .zip(wanted)
                        .all(|(own, wanted)| (own - wanted).abs() < 1e-2 * wanted.max(0.1))
                );
            }
        }
    }

    #[test]
    fn a_configuration_keeps_how_the_record_is_read() {
        let text = configuration(
            "a \"b\".csv",
            &[("value", "Winkel [deg]".to_owned()), ("sample_rate_hz", "100".to_owned())],
        );
        let table: toml::Table = text.parse().unwrap();
        assert_eq!(table["data"]["path"].as_str(), Some("a \"b\".csv"));
        assert_eq!(table["data"]["value"].as_str(), Some("Winkel [deg]"));
        assert_eq!(table["data"]["sample_rate_hz"].as_integer(), Some(100));
    }
}
