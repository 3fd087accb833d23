//! Signatures of the measurement chain in stamps and values, which need no physics.

use crate::answer::Finding;
use crate::data::observations::Observations;
use crate::data::period::swing;
use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::measurement::neighbors::white_noise;
pub(crate) use crate::measurement::outliers::kept;
use crate::measurement::stale::stale;
use crate::noise::statistics::{mean, mean_and_error, median, normal_above};
use dynamics::Nominal;
use record::{ClockKind, StampStatistics, counted, two_digits};

/// Number of equal samples in a row at an end of the range that make a flat top, and the number of flat tops
/// that no swing without a stop shows.
const FLAT: usize = 3;
const LEAST_RUNS: usize = 3;

/// Returns findings about the stamps and values of a record.
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
    let is_blind = observations.input.is_some() && observations.input_rows.is_empty();
    findings.extend(dropouts(stamps, is_blind));
    findings.extend(errors_of_stamps(observations, kept));
    let stale = stale(observations);
    findings.extend(repeats(&stale));
    let outliers = kept.iter().zip(&stale).filter(|(kept, stale)| !**kept && !**stale).count();
    if outliers > 0 {
        findings.push(Finding {
            effect: Some("outliers"),
            text: format!(
                "{} farther from the neighbors than noise explains {} left out",
                counted(outliers, "isolated sample"),
                if outliers == 1 { "was" } else { "were" },
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
                text: format!(
                    "the values lie on steps of {found:.2e}, the nominal sensor resolves {stated:.2e}"
                ),
            });
        }
    }
    findings
}

/// Share of the samples outside all segments above which a finding is reported.
const UNSEEN: f64 = 0.01;

/// Returns a finding about samples that no segment contains: a swing that has died out is not analyzed.
pub(crate) fn without_motion(kept: &[Vec<bool>], in_segments: usize) -> Option<Finding> {
    let all = kept.iter().flatten().filter(|kept| **kept).count();
    let unseen = all.saturating_sub(in_segments);
    (unseen as f64 > UNSEEN * all as f64).then(|| Finding {
        effect: None,
        text: format!(
            "{unseen} of {all} samples are left out: the motion there is smaller than the sensor's steps or \
             the noise"
        ),
    })
}

/// Share of stale readings from which on the sensor is slower than the log, and nothing drops out.
const SLOWER: f64 = 0.5;

/// Returns a finding if readings are stale.
fn repeats(stale: &[bool]) -> Option<Finding> {
    let (all, found) = (stale.len(), stale.iter().filter(|stale| **stale).count());
    if found == 0 {
        return None;
    }
    let text = format!(
        "{found} of {all} readings repeat the one before while the body moves: they are stale, and left out"
    );
    if found as f64 > SLOWER * all as f64 {
        let rows = all as f64 / (all - found) as f64;
        let text = format!("{text}; the sensor has a new reading every {rows:.1} rows");
        return Some(Finding { effect: None, text });
    }
    Some(Finding { effect: Some("dropouts"), text })
}

const UNDRIVEN: &str = "; the input is missing there too, so its effect in the meantime stays unexplained";

/// Returns a finding if the stamps show that samples are missing. `driven` adds that the input is missing
/// there too.
fn dropouts(stamps: &StampStatistics, driven: bool) -> Option<Finding> {
    let (gaps, lost) = (counted(stamps.gaps, "gap"), counted(stamps.lost, "sample"));
    let text = match (stamps.gaps, stamps.lost) {
        (0, 0) => return None,
        (0, _) => format!("the time between bursts is longer than their samples account for: {lost} missing"),
        (_, 0) => format!("{gaps} of more than 1.5 sampling intervals in the stamps"),
        (_, _) => format!("{lost} missing in {gaps} of the stamps, by whole sampling intervals"),
    };
    let text = if driven { text + UNDRIVEN } else { text };
    Some(Finding { effect: Some("dropouts"), text })
}

/// Number of standard errors from which stamps are said to bend. Student's t with nine degrees of freedom
/// (twelve stretches less the parabola's three) exceeds it in one of 10,000 cases, in either direction.
const DRIFTS: f64 = 6.594;

/// Largest deviation from its mean, in sampling intervals, of the wait of a burst's last sample: one half,
/// plus half of that for other scatter.
const WAITS: f64 = 0.75;

/// Probability with which values without information about the clock are said to prefer one.
const PREFERS_BY_CHANCE: f64 = 0.01;

/// Share of the noise variance above which a contribution to it is reported.
const LARGE: f64 = 0.05;

/// Size over the whole record, in units of the noise, above which a contribution is reported too. At ten
/// times the noise every effect of the body is expected to be found.
const VISIBLE: f64 = 10.0;

/// Returns `true` if a contribution with this share of the noise variance is reported.
fn matters(share: f64, samples: usize) -> bool {
    share > LARGE || share * samples as f64 > VISIBLE * VISIBLE
}

/// Returns findings about errors of the stamps that matter: those that move the values, at their RMS speed,
/// by more than a part of the noise variance, or by ten times the noise in all. Scatter is reported if the
/// values contradict it, drift if the stamps bend away from an even clock by more than their scatter
/// explains.
fn errors_of_stamps(observations: &Observations, kept: &[bool]) -> Vec<Finding> {
    let stamps = &observations.stamps;
    let noise = white_noise(observations, kept);
    let per_time = mean_square_speed(observations, kept, noise) / (noise * noise).max(f64::MIN_POSITIVE);
    let mut findings = Vec::new();
    let rounding = stamps.rounding_s.unwrap_or(0.0);
    // Rounding moves a stamp by up to half its step, so that second differences over √6 stay below 0.82
    // steps.
    let scatter = (stamps.scatter_s.powi(2) - rounding * rounding / 12.0).max(0.0);
    let share = scatter * per_time;
    // Second differences of N stamps count as N/1.94 independent ones; their squares scatter by √(2·1.94/N).
    let error = (2.0 * 1.94 / observations.len() as f64).sqrt();
    if stamps.scatter_s > rounding
        && matters(share * (1.0 - normal_above(PREFERS_BY_CHANCE) * error), observations.len())
        && stamps.preference_for_even > normal_above(PREFERS_BY_CHANCE)
    {
        findings.push(Finding {
            effect: Some("timestamp_jitter"),
            text: format!(
                "stamps scatter by {:.4} ms about an even clock, on which the values run more smoothly \
                 ({:.1} standard errors): if used, the stamps would add {:.1} % of the noise variance",
                1e3 * scatter.sqrt(),
                stamps.preference_for_even,
                100.0 * share
            ),
        });
    }
    let share = stamps.bend_s * stamps.bend_s * per_time;
    // Miscounted samples in bursts, or a late host, would bend the stamps too. So in bursts the bend may
    // leave no more than the wait of the last sample, which is up to one interval.
    let waits = stamps.left_by_bend_s * observations.sample_rate_hz <= WAITS;
    if (stamps.repeated == 0 || stamps.lost == 0 && waits)
        && stamps.bend_standard_errors > DRIFTS
        && stamps.bend_s > rounding
        && matters(share, observations.len())
        && observations.clock != ClockKind::Host
    {
        findings.push(Finding {
            effect: Some("clock_drift"),
            text: format!(
                "the stamps bend away from an even clock by {} ms ({:.0} standard errors): the logger's clock and the \
                 sensor's drift apart",
                two_digits(1e3 * stamps.bend_s),
                stamps.bend_standard_errors
            ),
        });
    }
    findings
}

/// Returns the mean square speed, from differences over two sampling intervals, less the noise's
/// contribution.
fn mean_square_speed(observations: &Observations, kept: &[bool], noise: f64) -> f64 {
    let samples = observations.times_s.iter().zip(&observations.values).zip(kept);
    let kept: Vec<(f64, f64)> =
        samples.filter(|(_, kept)| **kept).map(|((time, value), _)| (*time, *value)).collect();
    let squares: Vec<f64> = kept
        .windows(3)
        .filter_map(|w| match w {
            &[first, _, last] if last.0 > first.0 => {
                Some(((last.1 - first.1).powi(2) - 2.0 * noise * noise) / (last.0 - first.0).powi(2))
            }
            _ => None,
        })
        .collect();
    mean(&squares).max(0.0)
}

/// Relative difference above which frequencies of records are said to differ.
const APART: f64 = 0.1;

/// Returns a finding if the records swing at different frequencies. A difference in amplitude can cause that,
/// and so can records of several systems.
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

/// Returns the text about runs of equal values at an end of the range; `None` if there are too few.
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
    [highest, lowest].into_iter().find(|end| runs(*end) >= LEAST_RUNS).map(|end| {
        format!("the values stay at {end} several times: flat tops, as of a sensor at the end of its range")
    })
}

/// Returns a finding if rounding to the sensor's steps is a part of the noise that the nominal simulator does
/// not state.
pub(crate) fn quantization(data: &Data, noise: f64, nominal: &Nominal) -> Option<Finding> {
    let step = data.resolution?;
    let share = step * step / 12.0 / (noise * noise);
    let stated = nominal.sensor_resolution().is_some_and(|stated| (0.5..2.0).contains(&(step / stated)));
    (matters(share, data.samples()) && !stated).then(|| Finding {
        effect: Some("sensor_quantization"),
        text: format!(
            "the values lie on steps of {step:.2e}, whose rounding makes up {:.1} % of the noise variance",
            100.0 * share.min(1.0)
        ),
    })
}

/// Returns a finding if the noise grows with speed, as errors of the stamps cause it. The white part's square
/// has to be larger at speeds above the median than below, by at least three quarters and by enough standard
/// errors.
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
    let z = (quick - calm) / libm::hypot(quick_error, calm_error);
    let is_rounding = data.resolution.is_some_and(|step| quick <= 2.0 * (step * step / 12.0));
    // Second differences of white noise are correlated; a factor of 1.5 in the error accounts for it.
    (z > 1.5 * normal_above(1e-4) && quick > 1.75 * calm && !is_rounding).then(|| Finding {
        effect: Some("timestamp_jitter"),
        text: format!(
            "the white part of the residual is {:.1} times larger at high speed than at low speed ({z:.0} standard \
             errors): the stamps scatter",
            (quick / calm).sqrt()
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::findings;
    use crate::Observations;
    use dynamics::Nominal;
    use rand::RngExt;
    use rand_distr::StandardNormal;
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    const NOISE: f64 = 1e-3;

    /// Ids found in 25 s of a swing. `stamp` maps the true time and a standard normal number to a stamp;
    /// `None` loses the sample.
    fn named(seed: u64, stamp: impl Fn(f64, f64) -> Option<f64>) -> Vec<&'static str> {
        let mut generator = Seed::new(seed).child("chain").generator();
        let (mut stamps, mut values) = (Vec::new(), Vec::new());
        for index in 0..6500 {
            let time = f64::from(index) / 260.0;
            let [noise, error]: [f64; 2] =
                [generator.sample(StandardNormal), generator.sample(StandardNormal)];
            if let Some(stamp) = stamp(time, error) {
                stamps.push((stamp * 1e6).round() / 1e6);
                values.push(0.7 * (-0.1 * time).exp() * (20.0 * time).cos() + NOISE * noise);
            }
        }
        stamps.sort_by(f64::total_cmp);
        let record = Record::new(stamps, values, None, Quantity::Position, "rad").unwrap();
        let observations = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
        let nominal = Nominal::new(1.0, 0.2, 400.0, 0.0).unwrap();
        let kept = crate::measurement::outliers::kept(&observations);
        findings(&observations, &kept, &nominal).iter().filter_map(|finding| finding.effect).collect()
    }

    /// The RMS speed of that swing is about 4.4 rad/s: a scatter of 0.1 ms, 3 % of a sampling interval, makes
    /// 0.44 times the noise, 19 % of its variance; 0.02 ms make 1 %.
    #[test]
    fn scatter_of_stamps_is_named_where_it_moves_the_values() {
        for seed in 0..5 {
            assert_eq!(named(seed, |time, error| Some(time + 1.0 + 1e-4 * error)), ["timestamp_jitter"]);
            assert_eq!(named(seed, |time, error| Some(time + 1.0 + 2e-5 * error)), [""; 0]);
        }
    }

    #[test]
    fn lost_samples_are_named_beside_scatter() {
        let lost = |time: f64| (time * 260.0).round() % 83.0 > 79.5;
        let found = named(1, |time, error| (!lost(time)).then_some(time + 1.0 + 1e-4 * error));
        assert_eq!(found, ["dropouts", "timestamp_jitter"]);
        assert_eq!(named(1, |time, _| (!lost(time)).then_some(time)), ["dropouts"]);
    }

    #[test]
    fn where_samples_are_missing_the_input_is_too() {
        let times = (0..600).filter(|index| index % 50 > 4).map(|index| f64::from(index) / 100.0);
        let times: Vec<f64> = times.collect();
        let values: Vec<f64> = times.iter().map(|time| (5.0 * time).sin()).collect();
        let said = |input: Option<Vec<f64>>| {
            let record =
                Record::new(times.clone(), values.clone(), input, Quantity::Position, "rad").unwrap();
            let observations = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
            let nominal = Nominal::new(1.0, 0.2, 25.0, 0.0).unwrap();
            let kept = crate::measurement::outliers::kept(&observations);
            let all = findings(&observations, &kept, &nominal);
            let own = all.into_iter().find(|finding| finding.effect == Some("dropouts"));
            own.unwrap().text.ends_with(super::UNDRIVEN)
        };
        assert!(said(Some(values.clone())) && !said(None));
    }

    /// A rate that changes by 2·10⁻⁵ a second bends 25 s of stamps by 0.47 ms (RMS): twice the noise.
    #[test]
    fn a_drifting_clock_is_named_where_it_moves_the_values() {
        let drift = |change: f64| move |time: f64| time + 0.5 * change * time * time;
        assert_eq!(named(2, |time, _| Some(drift(2e-5)(time))), ["clock_drift"]);
        assert_eq!(named(2, |time, _| Some(drift(5e-7)(time))), [""; 0]);
        let bursts = |time: f64| (drift(6e-5)(time) / 0.0637).ceil() * 0.0637;
        assert_eq!(named(3, |time, _| Some(bursts(time))), ["timestamp_batching", "clock_drift"]);
        let still = |time: f64| (time / 0.0637).ceil() * 0.0637;
        assert_eq!(named(4, |time, _| Some(still(time))), ["timestamp_batching"]);
    }
}
