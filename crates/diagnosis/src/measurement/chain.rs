//! Summary of the measurement chain.

#![allow(clippy::indexing_slicing, reason = "data are cut from at least one record")]

use crate::answer::{Finding, MeasuringChain};
use crate::data::observations::Observations;
use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::measurement::signatures;
use crate::model::candidate::Candidate;
use dynamics::{DynamicsError, Hold, KnownEffect, Nominal, NominalSimulator};
use record::{ClockKind, Quantity};

/// Returns the nominal oscillator with the sensor's step, even if the simulator states the step as an effect.
fn seen(simulator: &NominalSimulator) -> Result<Nominal, DynamicsError> {
    let nominal = *simulator.nominal();
    let steps = simulator.effects().iter().filter(|known| known.active.id() == "sensor_quantization");
    match steps.filter_map(|known| known.active.value("step")).next() {
        Some(step) if nominal.sensor_resolution().is_none() => nominal.with_sensor_resolution(step),
        _ => Ok(nominal),
    }
}

/// Returns findings about effects of the nominal simulator that no fit includes.
pub(crate) fn not_followed(simulator: &NominalSimulator, quantity: Quantity) -> Vec<Finding> {
    let followed = |known: &&KnownEffect| {
        Candidate::of(&known.active).is_some_and(|(own, _)| own.is_observed_in(quantity))
    };
    let others = simulator.effects().iter().filter(|known| !followed(known));
    others
        .map(|known| Finding {
            effect: None,
            text: format!(
                "the nominal simulator has {}: no fit includes it; it is taken as known, and stamps and \
                 values are used as they are",
                known.active.id()
            ),
        })
        .collect()
}

/// Returns the finding that states the input's hold between samples, which the repaired simulator has to use
/// too.
pub(crate) fn between_samples(hold: Hold) -> Finding {
    let name = match hold {
        Hold::Zero => "zero-order hold",
        Hold::Linear => "linear interpolation",
        Hold::BandLimited => "band-limited interpolation",
    };
    Finding { effect: None, text: format!("for the model, the input {} ({name})", hold.in_words()) }
}

/// Summarizes the measurement chain: clock, rate, resolution, noise, and the signatures in stamps and values.
/// `kept` is `true` for each sample of each record that is not an outlier.
///
/// # Errors
/// Returns an error if the simulator states an invalid step of the sensor.
pub(crate) fn chain(
    records: &[Observations],
    kept: &[Vec<bool>],
    simulator: &NominalSimulator,
    data: &Data,
    repaired: &Fit,
    noise: f64,
) -> Result<MeasuringChain, DynamicsError> {
    let nominal = &seen(simulator)?;
    let mut findings: Vec<Finding> = records
        .iter()
        .zip(kept)
        .flat_map(|(record, kept)| signatures::findings(record, kept, nominal))
        .collect();
    findings.extend(signatures::quantization(data, noise, nominal));
    findings.extend(signatures::frequencies(records));
    let host = records.iter().any(|record| record.clock == ClockKind::Host);
    let known = findings.iter().any(|finding| finding.effect == Some("timestamp_jitter"));
    if host && !known {
        findings.extend(signatures::noise_with_speed(data, repaired));
    }
    let first = &records[0];
    Ok(MeasuringChain {
        clock: first.clock.name(),
        sample_rate_hz: first.sample_rate_hz,
        resolution: data.resolution,
        noise,
        findings,
    })
}
