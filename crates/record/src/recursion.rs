//! Test for one motion: of a linear system on which nothing acts, however many modes it has.

use crate::statistics::{extremes, upper_median};
use nalgebra::{DMatrix, DVector};

/// Number of earlier values in the recursion, of a short series and of a longer one: three and five modes. A long recursion
/// also follows a hand in a short series.
const ORDERS: [usize; 2] = [6, 10];
/// Length from which a series is long.
const LONG: usize = 200;
/// Values of the recursion in a half swing.
const PER_HALF_SWING: f64 = 5.0;
/// Fewest values from which the recursion is estimated.
const FEWEST: usize = 40;
/// Ratio of the largest to the median root mean square residual of parts as long as the order, up to which nothing acts:
/// 1.2 to 2.0 for simulated decays of one to three modes, dry friction and noise of up to 3 % of the amplitude; 2.8 and
/// more where a hand lifts, holds, strikes or stops.
const EVEN: f64 = 2.2;
/// The same ratio, and the part of the range that a residual has to be as well, from which something moved the system; and the
/// ratio from which it did so if the motion grows much.
const STRUCK: f64 = 8.0;
const SEEN: f64 = 0.02;
const FAINT: f64 = 4.0;
/// Growth of the motion at a strike, of a faint one, the part of it that a stop leaves, and the parts before and after in which
/// that is seen.
const GROWS: f64 = 1.3;
const GROWS_MUCH: f64 = 2.5;
const STOPS: f64 = 0.1;
const AROUND: usize = 4;
/// Samples from one value of the recursion to the next, from which three neighbors are nearly equal.
const DENSE: usize = 3;
/// Singular values, as a part of the largest one, that are zero.
const ZERO: f64 = 1e-9;

/// Returns `true` if one linear recursion describes a series of even samples everywhere equally well. Free motion of a
/// linear system follows such a recursion; a hand that lifts, holds, strikes or stops it is a part with large residuals.
/// `half_swing` is the number of samples in a half swing. `false` for a short series.
pub(crate) fn is_one_motion(values: &[f64], half_swing: f64) -> bool {
    let series: Vec<f64> = values.iter().copied().step_by(step(half_swing)).collect();
    residuals(&series).is_some_and(|found| {
        let usual = upper_median(found.parts.clone());
        usual.is_some_and(|usual| found.parts.iter().all(|part| *part <= EVEN * usual))
    })
}

/// Returns the pieces of a series between strikes, whatever the modes of the system, by the indices of their first and last
/// sample: between parts with large residuals after which it swings farther than before, or hardly any more. A stop that
/// is hit takes energy, but not all of it. None if there is no such part, and for a series with so few samples in a half swing that a wrong value could not be
/// told from the motion.
pub(crate) fn between_strikes(values: &[f64], half_swing: f64) -> Vec<[usize; 2]> {
    let step = step(half_swing);
    // Of three neighbors the middle value, where they are nearly equal: a single wrong one moves nothing.
    let beside = usize::from(step >= DENSE);
    let near = |at: usize| values.get(at.saturating_sub(beside)..values.len().min(at + beside + 1));
    let series = (0..values.len()).step_by(step);
    let series: Vec<f64> = series.filter_map(|at| upper_median(near(at)?.to_vec())).collect();
    let Some(found) = residuals(&series) else { return Vec::new() };
    let Some(usual) = upper_median(found.parts.clone()) else { return Vec::new() };
    let [lowest, highest] = extremes(&series);
    let least = |ratio: f64| (ratio * usual).max(SEEN * (highest - lowest));
    let order = found.order;
    // What a hand moves slowly hardly counts among velocities.
    let velocities: Vec<f64> =
        series.iter().zip(series.iter().skip(1)).map(|(one, next)| next - one).collect();
    let energy = |from: usize, to: usize| {
        let part = velocities.get(from..to.min(velocities.len())).unwrap_or_default();
        deviation(part)
    };
    // A sample is predicted by those of the part before, so that a strike also shows in the part after it.
    let is_large = |part: &f64| *part > least(FAINT);
    let runs = found.parts.chunk_by(|one, next| is_large(one) == is_large(next)).scan(0, |part, run| {
        let from = *part;
        *part += run.len();
        Some((extremes(run)[1], (from + 1) * order, (*part + 1) * order))
    });
    let strikes: Vec<[usize; 2]> = runs
        .filter(|&(largest, from, to)| {
            let before = energy(from.saturating_sub(AROUND * order), from);
            let after = energy(to, to + AROUND * order);
            let is_clear = largest > least(STRUCK) && (after > GROWS * before || after < STOPS * before);
            is_clear || largest > least(FAINT) && after > GROWS_MUCH * before
        })
        .map(|(_, from, to)| [from * step, to * step])
        .collect();
    let starts = std::iter::once(0).chain(strikes.iter().map(|strike| strike[1]));
    let ends = strikes.iter().map(|strike| strike[0]).chain([values.len()]);
    let pieces = starts.zip(ends).filter(|(start, end)| start < end);
    if strikes.is_empty() { Vec::new() } else { pieces.map(|(start, end)| [start, end - 1]).collect() }
}

/// Returns the standard deviation; 0 of nothing.
fn deviation(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// Returns the number of samples from one value of the recursion to the next.
fn step(half_swing: f64) -> usize {
    ((half_swing / PER_HALF_SWING) as usize).max(1)
}

/// Residuals of a recursion.
#[derive(Debug)]
struct Residuals {
    /// Number of values that predict the next.
    order: usize,
    /// Root mean squares of parts with as many values, from the first one that is predicted.
    parts: Vec<f64>,
}

/// Fits a recursion; `None` for a short series.
///
/// The covariance method of linear prediction with a constant (Makhoul, Linear prediction: a tutorial review, Proc. IEEE 63,
/// 1975, section II).
fn residuals(series: &[f64]) -> Option<Residuals> {
    if series.len() < FEWEST {
        return None;
    }
    let [short, long] = ORDERS;
    let order = if series.len() < LONG { short } else { long };
    let size = series.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let rows = series.len() - order;
    let earlier = series.windows(order).take(rows).flat_map(|values| values.iter().copied().chain([size]));
    let earlier = DMatrix::from_row_iterator(rows, order + 1, earlier);
    let next = DVector::from_iterator(rows, series.iter().skip(order).copied());
    let decomposition = earlier.clone().svd(true, true);
    let zero = ZERO * decomposition.singular_values.max();
    let residuals = decomposition.solve(&next, zero).ok().map(|recursion| next - earlier * recursion)?;
    let size =
        |part: &[f64]| (part.iter().map(|residual| residual * residual).sum::<f64>() / order as f64).sqrt();
    Some(Residuals { order, parts: residuals.as_slice().chunks_exact(order).map(size).collect() })
}

#[cfg(test)]
mod tests {
    use super::{between_strikes, is_one_motion};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn is_one(noise: f64, motion: impl Fn(f64) -> f64) -> bool {
        let mut draws = rand_chacha::ChaCha8Rng::seed_from_u64(9);
        let mut value = |at: i32| {
            let draw: f64 = StandardNormal.sample(&mut draws);
            motion(0.01 * f64::from(at)) + noise * draw
        };
        let values: Vec<f64> = (0..2400).map(&mut value).collect();
        is_one_motion(&values, 100.0 * std::f64::consts::PI / 6.0)
    }

    fn decay(time: f64, omega: f64) -> f64 {
        (-0.01 * omega * time).exp() * (omega * time).cos()
    }

    #[test]
    fn modes_and_friction_are_one_motion() {
        for noise in [1e-4, 1e-3, 0.02] {
            assert!(is_one(noise, |time| 0.3 + decay(time, 6.0)));
            assert!(is_one(noise, |time| decay(time, 6.0) + 0.5 * decay(time, 18.5)));
            assert!(is_one(noise, |time| decay(time, 6.0)
                + 0.5 * decay(time, 15.9)
                + 0.4 * decay(time, 27.3)));
            assert!(is_one(noise, |time| (1.0 - 0.04 * time).max(0.0) * (6.0 * time).cos()));
        }
    }

    #[test]
    fn hands_are_seen() {
        for noise in [1e-4, 1e-3, 0.02] {
            assert!(!is_one(noise, |time| if time < 12.0 { decay(time, 6.0) } else { 0.0 }));
            assert!(!is_one(noise, |time| decay(time % 12.0, 6.0)));
            assert!(!is_one(noise, |time| if time < 5.0 { 1.0 } else { decay(time - 5.0, 6.0) }));
        }
    }

    /// Two modes, struck twice after a rest; a stop that is hit takes energy and is no strike.
    #[test]
    fn strikes_are_found_whatever_the_modes() {
        let ring = |time: f64| {
            let mode = |omega: f64, zeta: f64| (-zeta * omega * time).exp() * (omega * time).sin();
            if time < 0.0 { 0.0 } else { mode(56.5, 0.008) + 0.6 * mode(89.2, 0.006) }
        };
        // Also with a few samples a half swing, and in noise of a fortieth of the motion.
        for (interval, noise) in [(0.002, 1e-3), (0.009, 1e-3), (0.002, 0.04)] {
            let mut draws = rand_chacha::ChaCha8Rng::seed_from_u64(9);
            let mut value = |at: usize| {
                let (time, draw): (f64, f64) = (interval * at as f64, StandardNormal.sample(&mut draws));
                ring(time - 0.5) + ring(time - 7.0) + noise * draw
            };
            let mut values: Vec<f64> = (0..(14.0 / interval) as usize).map(&mut value).collect();
            // One wrong value is no strike.
            values[(4.0 / interval) as usize] = 2.0;
            let pieces = between_strikes(&values, 0.05 / interval);
            assert_eq!(pieces.len(), 3, "{interval} {noise} {pieces:?}");
            for ([from, _], strike) in pieces[1..].iter().zip([0.5, 7.0]) {
                let late = *from as f64 * interval - strike;
                assert!((0.0..0.25).contains(&late), "{interval} {noise} {late}");
            }
        }
        let stopped = |time: f64| decay(time, 6.0).clamp(-0.8, 2.0);
        let values: Vec<f64> = (0..3000).map(|at| stopped(0.01 * f64::from(at))).collect();
        assert!(between_strikes(&values, 52.0).is_empty());
    }
}
