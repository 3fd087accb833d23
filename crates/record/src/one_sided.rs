//! Records whose swings stand still on one side.

use crate::free::{Turn, turning_points};
use crate::record::Record;
use crate::statistics::upper_median;

/// Fewest turning points on a side.
const FEWEST: usize = 9;
/// Change of one side along the record, as a part of that of the other, up to which it stands still.
const STANDS: f64 = 0.08;
/// Change of the other side, as a part of the first height, from which the swings fall.
const FALLS: f64 = 0.3;

/// Largest distance of the mean between turning points from their middle, as a part of their height, in a swing about its
/// rest position: of a magnitude it is 0.14, of a signal without its lower half 0.18.
const EVEN: f64 = 0.06;

impl Record {
    /// Returns `true` if the turning points of one side stand at one level while those of the other fall toward it, as
    /// those of a magnitude, of a rectified and of a clipped signal do. The turning points of a swing about its rest
    /// position come together from both sides.
    #[must_use]
    pub fn stands_on_one_side(&self) -> bool {
        let values = self.values();
        let (turns, _) = turning_points(values);
        let side = |first: usize| -> Vec<f64> {
            turns.iter().skip(first).step_by(2).filter_map(|turn| values.get(turn.at).copied()).collect()
        };
        // The first turning point may be the record's first sample.
        let sides = [1, 2].map(|first| thirds(&side(first)));
        let [Some([one_first, one_last]), Some([other_first, other_last])] = sides else { return false };
        if self.is_even(&turns) {
            return false;
        }
        let height = (one_first - other_first).abs();
        let changes = [(one_last - one_first).abs(), (other_last - other_first).abs()];
        let [least, most] = [changes[0].min(changes[1]), changes[0].max(changes[1])];
        most > FALLS * height && least < STANDS * most
    }

    /// Returns `true` if the values between turning points lie as those of a swing about its rest position do, also of one
    /// that drifts: on average in the middle between them.
    fn is_even(&self, turns: &[Turn]) -> bool {
        let values = self.values();
        let height = |turn: &Turn| values.get(turn.at).copied().unwrap_or(f64::NAN);
        let shares = turns.iter().zip(turns.iter().skip(1)).filter_map(|(one, next)| {
            let between = values.get(one.at..next.at)?;
            let mean = between.iter().sum::<f64>() / between.len() as f64;
            let [low, high] = [height(one).min(height(next)), height(one).max(height(next))];
            Some((mean - low) / (high - low))
        });
        upper_median(shares.collect()).is_some_and(|share| (share - 0.5).abs() < EVEN)
    }
}

/// Returns the means of the first and of the last third of a series; `None` of a short one.
fn thirds(series: &[f64]) -> Option<[f64; 2]> {
    let third = series.len() / 3;
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    (series.len() >= FEWEST).then(|| {
        [
            mean(series.get(..third).unwrap_or(series)),
            mean(series.get(series.len() - third..).unwrap_or(series)),
        ]
    })
}

#[cfg(test)]
mod tests {
    use crate::{Quantity, Record};

    fn stands(motion: impl Fn(f64) -> f64) -> bool {
        let times: Vec<f64> = (0..2000).map(|at| 0.01 * f64::from(at)).collect();
        let values = times.iter().map(|time| motion(*time)).collect();
        Record::new(times, values, None, Quantity::Position, "rad").unwrap().stands_on_one_side()
    }

    #[test]
    fn a_magnitude_stands_on_one_side_and_a_swing_does_not() {
        let decay = |time: f64| (-0.1 * time).exp() * (8.0 * time).cos();
        assert!(stands(|time| decay(time).abs()));
        assert!(stands(|time| 0.3 - decay(time).abs()));
        assert!(stands(|time| decay(time).max(-0.1)));
        for drift in [0.0, 0.01] {
            assert!(!stands(|time| decay(time) + drift * time), "{drift}");
        }
        // Regression: a sensor that warms up while the swing decays.
        assert!(!stands(|time| decay(time) - (-0.1 * time).exp()));
        assert!(!stands(|time| 0.4 * decay(time) * decay(time) + decay(time)));
    }
}
