//! Test for one motion: of a linear system on which nothing acts, however many modes it has.

use crate::statistics::upper_median;
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
/// Singular values, as a part of the largest one, that are zero.
const ZERO: f64 = 1e-9;

/// Returns `true` if one linear recursion describes a series of even samples everywhere equally well. Free motion of a
/// linear system follows such a recursion; a hand that lifts, holds, strikes or stops it is a part with large residuals.
/// `half_swing` is the number of samples in a half swing. `false` for a short series.
///
/// The recursion is the covariance method of linear prediction with a constant (Makhoul, Linear prediction: a tutorial
/// review, Proc. IEEE 63, 1975, section II).
pub(crate) fn is_one_motion(values: &[f64], half_swing: f64) -> bool {
    let step = ((half_swing / PER_HALF_SWING) as usize).max(1);
    let series: Vec<f64> = values.iter().copied().step_by(step).collect();
    if series.len() < FEWEST {
        return false;
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
    let Ok(recursion) = decomposition.solve(&next, zero) else { return false };
    let residuals = next - earlier * recursion;
    let square = |part: &[f64]| part.iter().map(|residual| residual * residual).sum::<f64>();
    let squares: Vec<f64> = residuals.as_slice().chunks_exact(order).map(square).collect();
    let most = squares.iter().copied().fold(0.0, f64::max);
    upper_median(squares).is_some_and(|usual| most <= EVEN * EVEN * usual)
}

#[cfg(test)]
mod tests {
    use super::is_one_motion;
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
}
