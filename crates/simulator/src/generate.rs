//! Generation of a record from its truth.

use crate::generation_error::GenerationError;
use dynamics::chain::Observed;
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Coordinate, Hold, Input};
use record::{Quantity, Record};
use seed::Seed;
use truth::{Draws, Truth};

/// Maximum number of decimals of a stamp or value: more would be rounding noise of a double around 1000.
pub const MOST_DECIMALS: u8 = 12;

/// Maximum number of samples of a record. At 16 bytes a sample and column it fits into a gigabyte.
pub const MOST_SAMPLES: usize = 10_000_000;

/// Generates the record of a truth: the same bits at every call and on every machine.
///
/// The motion comes from the reference integrator, so that its error is far below any noise. Stamps and
/// values are rounded to their decimals: the record holds exactly the numbers of its file.
///
/// # Errors
/// Returns [`GenerationError`] for an impossible sampling, motion or measurement chain, or if so many samples
/// are lost that no record remains.
pub fn generate(truth: &Truth) -> Result<Record, GenerationError> {
    let sampling = &truth.sampling;
    let refused = |what, value, expected| Err(GenerationError::Sampling { what, value, expected });
    if !(sampling.rate_hz.is_finite() && sampling.rate_hz > 0.0) {
        return refused("rate_hz", sampling.rate_hz, "a finite number above 0");
    }
    if !(2..=MOST_SAMPLES).contains(&sampling.samples) {
        return refused("samples", sampling.samples as f64, "2 to 10000000: rate_hz times seconds");
    }
    if sampling.stamp_decimals.max(sampling.value_decimals) > MOST_DECIMALS {
        let most = sampling.stamp_decimals.max(sampling.value_decimals);
        return refused("number of decimals", f64::from(most), "0 to 12");
    }
    let times: Vec<f64> = (0..sampling.samples).map(|index| index as f64 / sampling.rate_hz).collect();
    let duration = (sampling.samples - 1) as f64 / sampling.rate_hz;
    let input = truth
        .excitation
        .map(|excitation| {
            let values =
                times.iter().map(|&time| round(excitation.at(time, duration), sampling.value_decimals));
            Input::new(times.clone(), values.collect(), Hold::Zero)
        })
        .transpose()?;
    let motion = simulate(&truth.system, truth.start, input.as_ref(), &times, &Tolerance::default())?;
    let coordinate = truth.system.nominal().coordinate();
    let seed = branch(&truth.draws).child("measuring chain");
    let samples =
        truth.chain.observe(&motion.sampled(&times), coordinate, |id| seed.child(id).generator())?;
    let stamps = samples
        .stamps_s
        .iter()
        .map(|stamp| round(sampling.first_stamp_s + stamp, sampling.stamp_decimals))
        .collect();
    let values = samples.values.iter().map(|value| round(*value, sampling.value_decimals)).collect();
    let input = input.map(|input| {
        samples.indices.iter().filter_map(|&index| input.values().get(index).copied()).collect()
    });
    let observed = truth.chain.observed();
    Ok(Record::new(stamps, values, input, quantity(observed), unit(observed, coordinate))?)
}

/// Returns the node of the seed tree that a record draws from.
fn branch(draws: &Draws) -> Seed {
    draws.branch.iter().fold(Seed::new(draws.seed), |node, name| node.child(name))
}

/// Returns the double nearest to a number's decimal notation.
fn round(value: f64, decimals: u8) -> f64 {
    let scale = 10_f64.powi(i32::from(decimals));
    let scaled = value * scale;
    // Beyond 2⁵² a double has no such decimals to round.
    if scaled.abs() < 4.5e15 { scaled.round() / scale } else { value }
}

fn quantity(observed: Observed) -> Quantity {
    match observed {
        Observed::Position => Quantity::Position,
        Observed::Velocity => Quantity::Velocity,
        Observed::Acceleration => Quantity::Acceleration,
    }
}

fn unit(observed: Observed, coordinate: Coordinate) -> &'static str {
    match (observed, coordinate) {
        (Observed::Position, Coordinate::Angle) => "rad",
        (Observed::Position, Coordinate::Displacement) => "m",
        (Observed::Velocity, Coordinate::Angle) => "rad/s",
        (Observed::Velocity, Coordinate::Displacement) => "m/s",
        (Observed::Acceleration, Coordinate::Angle) => "rad/s^2",
        (Observed::Acceleration, Coordinate::Displacement) => "m/s^2",
    }
}

/// Returns a simulated record as the text of a CSV file, labeled as simulated, with the given decimals.
///
/// Columns: `time_s`; `angle_rad` or, for other quantities, `position_m`, `velocity_rad_s` and so on;
/// `torque_nm` if there is an input. Reading the text again yields the same record to the bit.
#[must_use]
pub fn csv_text(record: &Record, stamp_decimals: u8, value_decimals: u8) -> String {
    use std::fmt::Write;
    let column = match record.unit() {
        "rad" => "angle_rad",
        "m" => "position_m",
        "rad/s" => "velocity_rad_s",
        "m/s" => "velocity_m_s",
        "rad/s^2" => "acceleration_rad_s2",
        _ => "acceleration_m_s2",
    };
    let (stamps, values) = (usize::from(stamp_decimals), usize::from(value_decimals));
    let mut text = String::with_capacity(record.len() * (stamps + values + 10) + 200);
    text.push_str("# origin: simulated\n# Made by a program: no sensor was involved.\n");
    text.push_str(&format!("time_s,{column}"));
    text.push_str(if record.input().is_some() { ",torque_nm\n" } else { "\n" });
    let mut inputs = record.input().into_iter().flatten();
    for (stamp, value) in record.stamps_s().iter().zip(record.values()) {
        // Writing to a string cannot fail.
        let _ = match inputs.next() {
            Some(input) => writeln!(text, "{stamp:.stamps$},{value:.values$},{input:.values$}"),
            None => writeln!(text, "{stamp:.stamps$},{value:.values$}"),
        };
    }
    text
}
