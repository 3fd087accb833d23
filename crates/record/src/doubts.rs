//! Doubts about units, as sentences: what a header, the options and the numbers say against each other.

use crate::heading::Heading;
use crate::statistics::{extremes, upper_median};
use crate::unit::Unit;

/// Returns a sentence if an option states a different unit than the header.
pub(crate) fn contradiction(
    heading: &Heading,
    [asked, written]: [Option<&str>; 2],
    key: &str,
) -> Option<String> {
    let (asked, written) = asked.zip(written).filter(|(asked, written)| asked != written)?;
    Some(format!(
        "the header `{}` states {written}, the options say {asked} and are followed; leave out `{key}` if the header is right",
        heading.title
    ))
}

/// Returns a sentence if the header states an unknown unit.
pub(crate) fn unknown_unit(heading: &Heading, assumed: bool, taken: &str, key: &str) -> Option<String> {
    let unit = heading.unknown.as_ref().filter(|_| assumed)?;
    Some(format!(
        "the header `{}` states `{unit}`, which is no known unit: the numbers were taken to be in {taken}; set `{key}`, or \
         convert them",
        heading.title
    ))
}

/// Returns a sentence if stamps assumed to be in seconds imply a sampling rate that hardly any logger has.
pub(crate) fn odd_rate(stamps: &[f64]) -> Option<String> {
    let steps = stamps.iter().zip(stamps.iter().skip(1)).map(|(one, next)| next - one);
    let step = upper_median(steps.filter(|step| *step > 0.0).collect())?;
    let unit = match step {
        step if (1.0..1000.0).contains(&step) => "ms",
        step if (1e3..1e6).contains(&step) => "us",
        step if step >= 1e6 => "ns",
        step if step < 1e-6 => "another unit",
        _ => return None,
    };
    Some(format!(
        "the time column states no unit and was taken to be in seconds, which makes {:.3e} samples a second; if it is in \
         {unit}, set `data.time_unit`",
        1.0 / step
    ))
}

/// Returns a sentence if the values suggest another unit. Without a stated unit these are angles beyond a
/// right angle, angular velocities beyond the range of gyroscopes, and accelerations centered on 1, the
/// gravity in g. With a unit from the header, only angles beyond a full turn are doubted.
pub(crate) fn doubtful_unit(values: &[f64], unit: Unit, assumed: bool) -> Option<String> {
    let [lowest, highest] = extremes(values);
    let (half, middle) = (0.5 * (highest - lowest), 0.5 * (highest + lowest));
    let taken = if assumed {
        format!("the values state no unit and were taken to be in {}", unit.symbol())
    } else {
        format!("the header says {}", unit.symbol())
    };
    let counts = values.iter().all(|value| value.fract() == 0.0);
    match unit {
        unit if unit.is_signal() => Some(format!(
            "{taken}, the signal of a sensor, of which 1 {} was taken as one meter: frequency and damping ratio are right, \
             sizes such as those of friction are not; convert the numbers, or set `data.unit`",
            unit.si()
        )),
        Unit::Radian if assumed && counts && half > std::f64::consts::TAU => Some(format!(
            "{taken}, though they are whole numbers; if they are counts of an encoder, set `data.counts_per_turn`, or \
             `data.unit` to their unit"
        )),
        Unit::Degree if assumed => Some(format!(
            "{taken}, since they go out to {half:.0}; if they are radians, set `data.unit` to rad"
        )),
        Unit::Radian if half > std::f64::consts::TAU => Some(format!(
            "{taken}, {:.1} turns to either side; if they are degrees (a factor of 57.3), set `data.unit` to deg",
            half / std::f64::consts::TAU
        )),
        _ if !assumed => None,
        Unit::Radian if half > std::f64::consts::FRAC_PI_2 => Some(format!(
            "{taken}, {:.0} degrees to either side; if they are degrees (a factor of 57.3), {half:.1} of them, set \
             `data.unit` to deg",
            half.to_degrees()
        )),
        Unit::RadianPerSecond if half > FASTEST => Some(format!(
            "{taken}, {:.0} degrees a second; if they are degrees a second (a factor of 57.3), set `data.unit` to deg/s",
            half.to_degrees()
        )),
        Unit::MeterPerSecondSquared if (middle.abs() - 1.0).abs() < 0.1 => Some(format!(
            "{taken}, and they center on {middle:.2}, as at rest in units of gravity; if they are in g (a factor of 9.81), set \
             `data.unit` to g"
        )),
        _ => None,
    }
}

/// Largest angular velocity that gyroscopes measure, in rad/s: 2000 degrees a second.
const FASTEST: f64 = 35.0;
