//! What stamps and values show of the measuring chain before any physics.

use crate::answer::Finding;
use crate::fit::Fit;
use crate::observations::Observations;
use crate::period::swing;
use crate::segments::Data;
use crate::statistics::{mean_and_error, median, normal_above};
use dynamics::Nominal;
use record::ClockKind;

pub(crate) use crate::outliers::kept;

/// Largest share of samples at one end of the range that a swing without a stop shows.
const FLAT: usize = 3;

/// What stamps and values of a record show.
pub(crate) fn findings(observations: &Observations, kept: &[bool], nominal: &Nominal) -> Vec<Finding> {
    let mut findings = Vec::new();
    let stamps = &observations.stamps;
    if stamps.repeated > 0 {
        findings.push(Finding {
            effect: Some("timestamp_batching"),
            text: format!(
                "{} of {} stamps repeat the one before: samples arrive in {} bursts about {:.1} ms apart",
                stamps.repeated,
                observations.len(),
                stamps.groups,
                1e3 * stamps.group_interval_s
            ),
        });
    }
    let interval = 1.0 / observations.sample_rate_hz;
    let rounding = stamps.rounding_s.unwrap_or(0.0);
    // Stamps that scatter about an even clock may leave long intervals without a sample being lost.
    if stamps.gaps > 0 && observations.clock != ClockKind::UniformIndex {
        findings.push(Finding {
            effect: Some("dropouts"),
            text: format!("{} gaps in the stamps are longer than 1.5 sampling intervals", stamps.gaps),
        });
    } else if stamps.repeated == 0 && observations.clock == ClockKind::UniformIndex {
        // Rounding alone scatters stamps by its step over √12.
        let scatter = (stamps.deviation_s.powi(2) - rounding * rounding / 12.0).max(0.0).sqrt();
        if scatter > 0.02 * interval && scatter > rounding {
            findings.push(Finding {
                effect: Some("timestamp_jitter"),
                text: format!(
                    "stamps scatter by {:.3} ms about an even clock, {:.0} % of the sampling interval",
                    1e3 * scatter,
                    100.0 * scatter / interval
                ),
            });
        }
    }
    let outliers = kept.iter().filter(|kept| !**kept).count();
    if outliers > 0 {
        findings.push(Finding {
            effect: Some("outliers"),
            text: format!(
                "{outliers} isolated samples lie farther off their neighbors than noise brings them, and were left out"
            ),
        });
    }
    if let Some(flat) = flat_top(&observations.values) {
        findings.push(Finding { effect: None, text: flat });
    }
    if let (Some(found), Some(stated)) = (observations.resolution, nominal.sensor_resolution()) {
        let ratio = found / stated;
        if !(0.5..2.0).contains(&ratio) {
            findings.push(Finding {
                effect: None,
                text: format!("the values lie on steps of {found:e}, the nominal sensor resolves {stated:e}"),
            });
        }
    }
    findings
}

/// Part by which frequencies of records differ that are said to differ.
const APART: f64 = 0.1;

/// Whether the records swing at frequencies of their own. Amplitude can do that, and so can records of several systems.
pub(crate) fn frequencies(records: &[Observations]) -> Option<Finding> {
    let free = records.iter().filter(|record| record.input.is_none());
    let found: Vec<f64> = free
        .filter_map(|record| swing(&record.times_s, &record.values))
        .map(|swing| std::f64::consts::TAU / swing.period_s)
        .collect();
    let highest = found.iter().copied().fold(0.0, f64::max);
    let lowest = found.iter().copied().fold(f64::INFINITY, f64::min);
    (highest > (1.0 + APART) * lowest).then(|| Finding {
        effect: None,
        text: format!(
            "the records swing at {lowest:.1} to {highest:.1} rad/s; unless their amplitudes differ much they are not of \
             one system: diagnose them one by one"
        ),
    })
}

/// Runs of equal values at an end of the range.
fn flat_top(values: &[f64]) -> Option<String> {
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let runs = |end: f64| {
        let mut runs = 0;
        let mut length = 0;
        for value in values {
            length = if *value == end { length + 1 } else { 0 };
            runs += usize::from(length == FLAT);
        }
        runs
    };
    [highest, lowest].into_iter().find(|end| runs(*end) >= 3).map(|end| {
        format!("the values stay at {end} several times: flat tops, as of a sensor at the end of its range")
    })
}

/// Part of the noise variance from which on the rounding of the values is named.
const QUANTIZED: f64 = 0.05;

/// Whether the rounding to the sensor's steps is a part of the noise, and the nominal simulator does not know of it.
pub(crate) fn quantization(data: &Data, noise: f64, nominal: &Nominal) -> Option<Finding> {
    let step = data.resolution?;
    let share = step * step / 12.0 / (noise * noise);
    let stated = nominal.sensor_resolution().is_some_and(|stated| (0.5..2.0).contains(&(step / stated)));
    (share > QUANTIZED && !stated).then(|| Finding {
        effect: Some("sensor_quantization"),
        text: format!(
            "the values lie on steps of {step:e}, whose rounding makes up {:.0} % of the noise variance",
            100.0 * share.min(1.0)
        ),
    })
}

/// Whether the noise grows with speed, as errors of the stamps make it: standard errors by which the white part's
/// square is larger where the speed is above its median than below, at least three quarters more.
pub(crate) fn noise_with_speed(data: &Data, fit: &Fit) -> Option<Finding> {
    let (mut slow, mut fast) = (Vec::new(), Vec::new());
    let mut speeds = Vec::new();
    for segment in &data.segments {
        speeds.extend(segment.values.windows(3).map(|w| match w {
            &[a, _, c] => (c - a).abs(),
            _ => 0.0,
        }));
    }
    let middle = median(&speeds);
    let mut at = speeds.iter();
    for residual in &fit.residuals {
        for w in residual.as_slice().windows(3) {
            if let (&[a, b, c], Some(speed)) = (w, at.next()) {
                let square = (a - 2.0 * b + c).powi(2) / 6.0;
                if *speed > middle { fast.push(square) } else { slow.push(square) }
            }
        }
    }
    let (quick, quick_error) = mean_and_error(&fast);
    let (calm, calm_error) = mean_and_error(&slow);
    let z = (quick - calm) / quick_error.hypot(calm_error);
    let quantum = data.resolution.map_or(0.0, |step| step * step / 12.0);
    // Second differences of white noise are correlated; a factor of 1.5 in the error covers it.
    (z > 1.5 * normal_above(1e-4) && quick > 1.75 * calm && quick > 2.0 * quantum).then(|| Finding {
        effect: Some("timestamp_jitter"),
        text: format!(
            "the white part of the residual is {:.1} times larger at high speed than at low speed ({z:.0} standard \
             errors): the stamps scatter",
            (quick / calm).sqrt()
        ),
    })
}
