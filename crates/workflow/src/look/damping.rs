//! Change of the damping along a decay.

use envelope::Envelope;
use report::format::with_uncertainty;

/// Fewest peaks of a part of a decay.
const FEWEST: usize = 5;
/// Difference of the damping ratios of two parts, in standard errors and as a part of the smaller one, from which one
/// number does not describe both.
const APART: (f64, f64) = (6.0, 0.4);

/// Returns a remark if the damping ratio of the last third of a decay differs from that of the first.
#[must_use]
pub fn changing(envelope: &Envelope) -> Option<String> {
    let third = envelope.len() / 3;
    if third < FEWEST {
        return None;
    }
    let (errors, part) = APART;
    let [first, last] = [0, envelope.len() - third].map(|from| ratio(envelope, from, from + third));
    let ((first, first_error), (last, last_error)) = (first?, last?);
    let difference = (last - first).abs();
    let is_far = difference > errors * first_error.hypot(last_error)
        && difference > part * first.abs().min(last.abs());
    is_far.then(|| {
        format!(
            "the damping ratio changes along the decay, from {} in its first third to {} in its last: no single number \
             describes it. Dry friction makes it rise and drag makes it fall; a diagnosis tells them apart",
            with_uncertainty(first, first_error),
            with_uncertainty(last, last_error)
        )
    })
}

/// Returns the damping ratio of a part of a decay, with its standard error.
fn ratio(envelope: &Envelope, from: usize, to: usize) -> Option<(f64, f64)> {
    let times = envelope.times_s().get(from..to)?.to_vec();
    let logarithms = envelope.log_amplitudes().get(from..to)?.to_vec();
    let errors = envelope.log_std_errors().and_then(|errors| errors.get(from..to)).map(<[f64]>::to_vec);
    let part = Envelope::new(times, logarithms, envelope.omega_rad_s()).ok()?.with_ratio(envelope.ratio());
    let part = errors.into_iter().fold(part, Envelope::with_log_std_errors);
    let fit = oracle::decay_rate(&part).ok()?;
    Some((fit.zeta, fit.zeta_std_error))
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
        assert_eq!(changing(&decay(|time| (-0.05 * time).exp())), None);
        assert!(changing(&decay(|time| 1.0 - 0.02 * time)).is_some());
        assert!(changing(&decay(|time| 1.0 / (1.0 + 0.1 * time))).is_some());
    }
}
