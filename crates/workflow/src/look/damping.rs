//! Changes of the damping and of the frequency along a decay.

use envelope::Envelope;
use report::format::with_uncertainty;

/// Fewest peaks of a part of a decay, the number that a part of a short decay has, and the fewest that tell a frequency.
const FEWEST: usize = 3;
const SHORT: usize = 4;
const FEWEST_OF_A_FREQUENCY: usize = 5;
/// Difference of two parts, in standard errors, from which one number does not describe both.
const APART: f64 = 6.0;
/// Difference of their damping ratios that it needs as well, as a part of the smaller one.
const ANOTHER_DAMPING: f64 = 0.2;
/// Fall between them beyond that of their decays that it needs as well, as a part of the whole fall.
const ANOTHER_LEVEL: f64 = 0.08;
/// Difference of their frequencies that it needs as well, as a part of the first.
const ANOTHER_FREQUENCY: f64 = 0.005;

/// Distance of the time between two turning points from a whole number of half periods, in these.
const TURN: f64 = 0.25;

/// Returns remarks if the damping ratio or the frequency in the last third of a decay differs from that in the first; of
/// a decay of few swings, in the last half from that in the first.
#[must_use]
pub(super) fn changing(envelope: &Envelope) -> Vec<String> {
    let count = envelope.len();
    let size = (count / 3).max(SHORT.min(count / 2));
    // The scatter of so few peaks alone tells no error.
    if size < FEWEST || (size <= SHORT && envelope.log_std_errors().is_none()) {
        return Vec::new();
    }
    let parts = [0, count - size].map(|from| part(envelope, from, from + size));
    let [Some(first), Some(last)] = parts else { return Vec::new() };
    let of = if 3 * size > count { "half" } else { "third" };
    let damping = apart(ratio(&first), ratio(&last), ANOTHER_DAMPING).map(|[first, last]| {
        format!(
            "the damping ratio changes along the decay, from {first} in its first {of} to {last} in its last: no single number \
             describes it. Dry friction makes it rise and drag makes it fall; a diagnosis tells them apart"
        )
    });
    let frequency = apart(frequency_hz(&first), frequency_hz(&last), ANOTHER_FREQUENCY).map(|[first, last]| {
        format!(
            "the frequency changes along the decay, from {first} Hz in its first {of} to {last} Hz in its last, as that of a \
             wide swing does; a small swing has the last one or what lies beyond it. A diagnosis finds the restoring force"
        )
    });
    let is_long = damping.is_none() && size >= FEWEST_OF_A_FREQUENCY;
    let begins_s = envelope.times_s().get(count - size).filter(|_| is_long);
    let step = begins_s.and_then(|begins_s| step(&first, &last, *begins_s));
    damping.into_iter().chain(step).chain(frequency).collect()
}

/// Returns a remark if the decays of the first and of the last part of a decay, each carried on to the middle between them,
/// do not meet there: between them something moved or stopped it. `begins_s` is the time of the last part's first peak after
/// that of the first part.
fn step(first: &Envelope, last: &Envelope, begins_s: f64) -> Option<String> {
    let middle = 0.5 * (first.times_s().last()? + begins_s);
    let ([one, one_error], [other, other_error]) = (level(first, middle)?, level(last, middle - begins_s)?);
    let fall = first.log_amplitudes().first()? - last.log_amplitudes().last()?;
    let is_far = (one - other).abs() > APART * libm::hypot(one_error, other_error)
        && (one - other).abs() > ANOTHER_LEVEL * fall.abs();
    let by = 100.0 * libm::expm1(other - one);
    is_far.then(|| {
        format!(
            "between the first third of the decay and the last one the amplitude changes by {by:+.0} % beyond what the decay in \
             either tells, as if something touched or pushed it: the damping ratio holds that change; set `data.from_s` or \
             `data.to_s` to read one side of it alone"
        )
    })
}

/// Returns the logarithm of the amplitude that a part's decay has at a time after its first peak, with its standard error.
fn level(decay: &Envelope, time: f64) -> Option<[f64; 2]> {
    let fit = oracle::decay_rate(decay).ok()?;
    let times = decay.times_s();
    let count = times.len() as f64;
    let mean = times.iter().sum::<f64>() / count;
    let spread: f64 = times.iter().map(|time| (time - mean).powi(2)).sum();
    let [_, ratio_error] = ratio(decay)?;
    let rate_error = ratio_error * decay.omega_rad_s();
    // The error of a line at its middle is that of its slope times the root mean square of the times.
    let error = rate_error * libm::hypot((spread / count).sqrt(), time - mean);
    Some([fit.log_amplitude_at(time), error])
}

/// Returns two numbers with their standard errors, as text, if they differ by more than [`APART`] of these and by more
/// than a part of the smaller one.
fn apart(first: Option<[f64; 2]>, last: Option<[f64; 2]>, part: f64) -> Option<[String; 2]> {
    let ([first, first_error], [last, last_error]) = first.zip(last)?;
    let difference = (last - first).abs();
    let is_far = difference > APART * libm::hypot(first_error, last_error)
        && difference > part * first.abs().min(last.abs());
    is_far.then(|| [with_uncertainty(first, first_error), with_uncertainty(last, last_error)])
}

/// Returns the peaks of a decay with numbers in a range, as a decay of its own.
fn part(envelope: &Envelope, from: usize, to: usize) -> Option<Envelope> {
    let times = envelope.times_s().get(from..to)?.to_vec();
    let logarithms = envelope.log_amplitudes().get(from..to)?.to_vec();
    let errors = envelope.log_std_errors().and_then(|errors| errors.get(from..to)).map(<[f64]>::to_vec);
    let part = Envelope::new(times, logarithms, envelope.omega_rad_s()).ok()?.with_ratio(envelope.ratio());
    Some(errors.into_iter().fold(part, Envelope::with_log_std_errors))
}

/// Returns the damping ratio of a decay with its standard error, which a decay that is not exponential does not enlarge:
/// that is what is looked for.
fn ratio(decay: &Envelope) -> Option<[f64; 2]> {
    let fit = oracle::decay_rate(decay).ok()?;
    let values = decay.times_s().iter().zip(decay.log_amplitudes());
    let residuals: Vec<f64> = values.map(|(time, value)| value - fit.log_amplitude_at(*time)).collect();
    let errors = decay.log_std_errors().map_or_else(|| vec![1.0; residuals.len()], <[f64]>::to_vec);
    Some([fit.zeta, fit.zeta_std_error * noise_share(&residuals, &errors)])
}

/// Returns the part of the scatter of residuals that is noise, at most 1: that of their second differences, to which
/// what changes slowly adds nothing.
fn noise_share(residuals: &[f64], errors: &[f64]) -> f64 {
    let squares: f64 = residuals.iter().zip(errors).map(|(residual, error)| (residual / error).powi(2)).sum();
    let differences = residuals.windows(3).zip(errors.windows(3)).filter_map(|(values, errors)| {
        let ([a, b, c], [ea, eb, ec]) = (values, errors) else { return None };
        Some((a - 2.0 * b + c).powi(2) / (ea * ea + 4.0 * eb * eb + ec * ec))
    });
    let (sum, count) = differences.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    let share = (sum / count) / (squares / (residuals.len() as f64 - 2.0));
    share.sqrt().min(1.0)
}

/// Returns the frequency of a decay's turning points in Hz, with its standard error, from the slope of their times
/// against their numbers.
fn frequency_hz(decay: &Envelope) -> Option<[f64; 2]> {
    let rough = std::f64::consts::PI / decay.omega_rad_s();
    // Amplitudes that were fitted to windows do not stand at turning points.
    let is_turn = |pair: &[f64]| {
        let count = pair.iter().rev().copied().reduce(|last, first| last - first).map(|step| step / rough);
        count.is_some_and(|count| count.round() > 0.0 && (count - count.round()).abs() < TURN)
    };
    if decay.len() < FEWEST_OF_A_FREQUENCY || !decay.times_s().windows(2).all(is_turn) {
        return None;
    }
    let half = identify::half_period(decay, rough)?;
    let frequency = 0.5 / half.value;
    Some([frequency, frequency * half.std_error / half.value])
}

#[cfg(test)]
mod tests {
    use super::changing;
    use envelope::{Envelope, RatioDefinition};

    fn decay(amplitude: impl Fn(f64) -> f64) -> Envelope {
        let times: Vec<f64> = (0..40).map(f64::from).collect();
        let logarithms =
            times.iter().enumerate().map(|(at, time)| amplitude(*time).ln() + 1e-3 * (at as f64 * 2.4).sin());
        let logarithms = logarithms.collect();
        Envelope::new(times, logarithms, 3.0).unwrap().with_ratio(RatioDefinition::LogarithmicDecrement)
    }

    #[test]
    fn friction_and_drag_change_it_and_viscous_damping_does_not() {
        assert!(changing(&decay(|time| (-0.05 * time).exp())).is_empty());
        // The last third of the second falls to a hundredth, steeper and steeper.
        for amplitude in
            [|time: f64| 1.0 - 0.02 * time, |time| 1.001 - time / 39.0, |time| 1.0 / (1.0 + 0.1 * time)]
        {
            let said = changing(&decay(amplitude));
            assert!(said.len() == 1 && said[0].contains("damping ratio"), "{said:?}");
        }
    }

    /// Something touches it once, or pushes it, where its decay before and after is the same.
    #[test]
    fn a_touch_is_said() {
        for factor in [0.75, 0.85, 1.12] {
            let said = changing(&decay(|time| (-0.03 * time).exp() * if time < 19.5 { 1.0 } else { factor }));
            assert!(said.len() == 1 && said[0].contains("touched"), "{said:?}");
            let by = format!("{:+.0} %", 100.0 * (factor - 1.0));
            assert!(said[0].contains(&by), "{said:?}");
        }
    }

    /// Regression: nothing was said of a swing that dry friction stops within five cycles.
    #[test]
    fn friction_that_stops_a_swing_soon_changes_it() {
        let decay = |amplitude: &dyn Fn(f64) -> f64| {
            let times: Vec<f64> = (0..9).map(|at| 0.5 * f64::from(at)).collect();
            let noise = |time: f64| 1e-3 * (7.7 * time).sin();
            let logarithms = times.iter().map(|time| (amplitude(*time) + noise(*time)).ln()).collect();
            let errors = times.iter().map(|time| 1e-3 / amplitude(*time)).collect();
            Envelope::new(times, logarithms, std::f64::consts::TAU).unwrap().with_log_std_errors(errors)
        };
        let said = changing(&decay(&|time| 0.52 - 0.12 * time));
        assert!(said.len() == 1 && said[0].contains("in its first half"), "{said:?}");
        assert!(changing(&decay(&|time| 0.5 * (-0.6 * time).exp())).is_empty());
    }

    /// A pendulum of 75 degrees swings slower by a tenth than one of 5.
    #[test]
    fn a_wide_swing_changes_its_frequency() {
        let mut time = 0.0_f64;
        let amplitudes = (0..60).map(|at| 1.3 * (-0.04 * f64::from(at)).exp());
        let (times, logarithms) = amplitudes
            .map(|amplitude: f64| {
                time += 0.5 * (1.0 + amplitude * amplitude / 16.0) * (1.0 + 1e-4 * (time * 7.0).sin());
                (time, -0.08 * time)
            })
            .unzip();
        let envelope = Envelope::new(times, logarithms, 2.0 * std::f64::consts::PI).unwrap();
        let said = changing(&envelope);
        assert!(said.iter().any(|said| said.contains("the frequency changes")), "{said:?}");
    }
}
