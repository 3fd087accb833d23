//! Comparison of columns by their data: which one swings, and how far.

use crate::statistics::upper_median;

/// Smallest number of half swings for a column to swing.
const FEWEST_HALF_SWINGS: usize = 4;
/// Height, over the root mean square, that a column has to pass on both sides for a half swing to count.
const PASSED: f64 = 0.5;
/// Largest deviation of a half swing's duration from the median one, as a part of it, for the two to be alike.
const ALIKE: f64 = 0.25;

/// The motion in a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Swing {
    /// Root mean square about the straight line through the column, without the noise, in the column's unit.
    pub(crate) size: f64,
    /// `true` if most half swings are equally long.
    pub(crate) is_regular: bool,
}

impl Swing {
    /// Measures the motion in a column. The noise is that of the second differences, which a swing of many
    /// samples leaves out: of white noise of variance s², they have the variance 6 s².
    pub(crate) fn of(values: &[f64]) -> Self {
        let about = without_line(values);
        let square = mean(about.iter().map(|value| value * value));
        let second = values.windows(3).filter_map(|three| match three {
            [one, two, three] => Some((one - 2.0 * two + three).powi(2) / 6.0),
            _ => None,
        });
        let noise = mean(second);
        // The first half of a decay has its largest swings; noise is all that the rest of a long one holds.
        let half = about.get(..about.len() / 2).unwrap_or(&about);
        let is_regular = regular(&about) || regular(half);
        Self { size: (square - noise).max(0.0).sqrt(), is_regular: is_regular && square > 2.0 * noise }
    }
}

/// Returns the mean of some numbers.
fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = numbers.fold((0.0, 0_usize), |(sum, count), number| (sum + number, count + 1));
    sum / count.max(1) as f64
}

/// Returns the values less the straight line through them, by their index.
fn without_line(values: &[f64]) -> Vec<f64> {
    let middle = 0.5 * (values.len() as f64 - 1.0);
    let level = mean(values.iter().copied());
    let place = |(at, value): (usize, &f64)| (at as f64 - middle, *value);
    let spread: f64 = values.iter().enumerate().map(place).map(|(x, _)| x * x).sum();
    let slope = values.iter().enumerate().map(place).map(|(x, y)| x * y).sum::<f64>() / spread.max(1.0);
    values.iter().enumerate().map(place).map(|(x, y)| y - level - slope * x).collect()
}

/// Returns `true` if a series passes from one side to the other again and again after equal times.
fn regular(about: &[f64]) -> bool {
    let height = PASSED * mean(about.iter().map(|value| value * value)).sqrt();
    let (mut side, mut crossings) = (0.0, Vec::new());
    for (at, value) in about.iter().enumerate() {
        if value.abs() > height && value.signum() != side {
            crossings.push(at as f64);
            side = value.signum();
        }
    }
    let spans: Vec<f64> =
        crossings.iter().zip(crossings.iter().skip(1)).map(|(one, next)| next - one).collect();
    if spans.len() < FEWEST_HALF_SWINGS {
        return false;
    }
    let Some(median) = upper_median(spans.clone()) else { return false };
    let alike = spans.iter().filter(|span| (*span - median).abs() <= (ALIKE * median).max(1.0)).count();
    median > 2.0 && 4 * alike >= 3 * spans.len()
}

#[cfg(test)]
mod tests {
    use super::Swing;

    fn noise(at: usize) -> f64 {
        let x = (at as f64 * 12.9898).sin() * 43758.5453;
        x - x.floor() - 0.5
    }

    #[test]
    fn a_decay_swings_and_noise_or_a_drift_does_not() {
        let of = |value: &dyn Fn(usize) -> f64| Swing::of(&(0..2000).map(value).collect::<Vec<f64>>());
        let decay = |at: usize| (-0.002 * at as f64).exp() * (0.13 * at as f64).cos();
        let swing = of(&|at| decay(at) + 0.02 * noise(at));
        assert!(swing.is_regular && (swing.size - 0.25).abs() < 0.01, "{swing:?}");
        assert!(of(&|at| 5.0 + 0.001 * at as f64 + decay(at)).is_regular, "beside a drift");
        assert!(!of(&noise).is_regular && of(&noise).size < 0.1);
        assert!(!of(&|at| 20.0 + 1e-6 * (at * at) as f64 + 0.01 * noise(at)).is_regular, "a drift");
        assert!(!of(&|_| 3.0).is_regular && of(&|_| 3.0).size == 0.0);
        assert!(!Swing::of(&[]).is_regular);
    }
}
