//! Linear oscillator from the turning points of a free decay.

use crate::observed::order;
use crate::{Basis, Estimated, LinearOscillator};
use envelope::{Envelope, RecommendedPipeline};
use record::{Clock, Record};
use std::f64::consts::PI;

/// Estimates the frequency from the times of turning points and the damping from their heights. `None` if a
/// record has too few turning points.
///
/// Turning points follow each other after half a period π/ω_d. So ω_d is π divided by the slope of their
/// times against their number, and −λ is the slope of the logarithms of their heights. Then ω₀² = ω_d² + λ²
/// and 2ζω₀ = 2λ.
pub(crate) fn oscillator(record: &Record, clock: &Clock) -> Option<LinearOscillator> {
    let extraction = RecommendedPipeline::DEFAULT.extract(record, clock).ok()?;
    let envelope = &extraction.envelope;
    let line = oracle::decay_rate(envelope).ok()?;
    let half_period = half_period(envelope, 0.5 * extraction.period_s)?;
    let damped = PI / half_period.value;
    let decay = line.decay_rate;
    let stiffness = Estimated {
        value: damped * damped + decay * decay,
        std_error: libm::hypot(
            2.0 * damped * damped * half_period.std_error / half_period.value,
            2.0 * decay * line.std_error,
        ),
    };
    let rest = (order(record.quantity()) == 0).then(|| Estimated {
        value: extraction.offset,
        // The offset is a median of means of three heights, each with the scatter of the heights about the
        // line.
        std_error: scatter(envelope, &line) / (envelope.len() as f64).sqrt(),
    });
    Some(LinearOscillator {
        stiffness,
        damping: Estimated { value: 2.0 * decay, std_error: 2.0 * line.std_error },
        rest,
        input_gain: None,
        basis: Basis::TurningPoints(envelope.len()),
    })
}

/// Returns the slope of the turning points' times against their number, in seconds, by least squares. A rough
/// half period numbers them, so that a missed turning point does not shift the numbers of the others. Each has the
/// square of its height as its weight: noise moves a low turning point farther than a high one.
///
/// `None` if there is only one.
#[must_use]
pub fn half_period(envelope: &Envelope, rough: f64) -> Option<Estimated> {
    let times = envelope.times_s();
    let count = times.len() as f64;
    let numbers: Vec<f64> = times
        .windows(2)
        .scan(0.0, |number, pair| {
            let [one, next] = pair else { return None };
            *number += ((next - one) / rough).round();
            Some(*number)
        })
        .collect();
    let heights = envelope.log_amplitudes();
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights = || heights.iter().map(|height| libm::exp(2.0 * (height - highest)));
    let numbers = || std::iter::once(0.0).chain(numbers.iter().copied());
    let total: f64 = weights().sum();
    let middle = weights().zip(numbers()).map(|(weight, number)| weight * number).sum::<f64>() / total;
    let mean = weights().zip(times).map(|(weight, time)| weight * time).sum::<f64>() / total;
    let centered = || {
        weights()
            .zip(numbers().zip(times))
            .map(|(weight, (number, time))| (weight, number - middle, time - mean))
    };
    let squares: f64 = centered().map(|(weight, number, _)| weight * number * number).sum();
    let slope = centered().map(|(weight, number, time)| weight * number * time).sum::<f64>() / squares;
    let rest: f64 = centered().map(|(weight, number, time)| weight * (time - slope * number).powi(2)).sum();
    let std_error = (rest / (count - 2.0).max(1.0) / squares).sqrt();
    (slope > 0.0).then_some(Estimated { value: slope, std_error })
}

/// Returns the root mean square distance of the heights from the fitted decay, in the record's unit.
fn scatter(envelope: &Envelope, line: &oracle::DecayFit) -> f64 {
    let squares: f64 = envelope
        .times_s()
        .iter()
        .zip(envelope.log_amplitudes())
        .map(|(&time, logarithm)| (libm::exp(*logarithm) - libm::exp(line.log_amplitude_at(time))).powi(2))
        .sum();
    (squares / envelope.len() as f64).sqrt()
}
