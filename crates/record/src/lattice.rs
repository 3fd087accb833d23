//! Detection of the step of an encoder, or of a text file's last digit, from the values alone.

use crate::line::Line;

/// Lattice of values: whole multiples of a step plus a common offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Step of the lattice, in the unit of the values.
    pub step: f64,
    /// Root mean square distance of the distinct values from the lattice, in steps: 0.289 = 1/√12 for values
    /// without a lattice, and a few hundredths for lattice values that were rounded again in a text file.
    pub misfit_steps: f64,
}

/// Largest misfit that still counts as a lattice, in steps: half the misfit of values without one.
const LARGEST_MISFIT: f64 = 0.145;

/// The same for few values, which a line through them fits more easily.
const LARGEST_OF_FEW: f64 = 0.03;

/// Smallest number of distinct values from which a step can be found, and the smallest where each is read so
/// many times on average that only steps explain it.
const FEWEST_VALUES: usize = 8;
const FEWEST_REPEATED: usize = 4;
const REPEATED: usize = 10;

impl Lattice {
    /// Finds the lattice of some values; returns `None` if they lie on none. The cost is one sort.
    ///
    /// A first step comes from the small gaps between distinct values. Then the values are numbered gap by
    /// gap, and a regression of value on number gives the step to a small fraction of itself.
    #[must_use]
    pub fn find(values: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let span = sorted.last()? - sorted.first()?;
        // Converted units can make equal positions differ in their last bits.
        let same = span * 1e-12;
        sorted.dedup_by(|later, earlier| *later - *earlier <= same);
        let is_repeated = sorted.len() >= FEWEST_REPEATED && values.len() >= REPEATED * sorted.len();
        if sorted.len() < FEWEST_VALUES && !is_repeated {
            return None;
        }
        let gaps: Vec<f64> = sorted.windows(2).map(gap).collect();
        let mut ordered = gaps.clone();
        ordered.sort_by(f64::total_cmp);
        let smallest = *ordered.get(ordered.len() / 20)?;
        // Rounding in a text file spreads one step over neighboring decimals: average the cluster.
        let cluster: Vec<f64> =
            ordered.iter().copied().filter(|gap| (0.5..1.5).contains(&(gap / smallest))).collect();
        let first_step = cluster.iter().sum::<f64>() / cluster.len() as f64;

        let mut number = 0.0;
        let mut step = first_step;
        let origin = *sorted.first()?;
        let mut points = vec![(0.0, 0.0)];
        let (mut products, mut squares) = (0.0, 0.0);
        for (value, gap) in sorted.iter().skip(1).zip(&gaps) {
            number += (gap / step).round().max(1.0);
            points.push((number, value - origin));
            products += number * (value - origin);
            squares += number * number;
            // Long gaps are counted with the current estimate of the step, which sharpens as the span grows.
            step = products / squares;
        }
        let line = Line::through(&points);
        let misfit_steps = (line.squares() / points.len() as f64).sqrt() / line.slope;
        let most = if sorted.len() < FEWEST_VALUES { LARGEST_OF_FEW } else { LARGEST_MISFIT };
        (line.slope > 0.0 && misfit_steps <= most).then_some(Self { step: line.slope, misfit_steps })
    }
}

fn gap(pair: &[f64]) -> f64 {
    match pair {
        &[earlier, later] => later - earlier,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::Lattice;

    fn wave(count: usize) -> impl Iterator<Item = f64> {
        (0..count).map(|i| (-(i as f64) * 2e-4).exp() * (i as f64 * 0.137).sin())
    }

    #[test]
    fn finds_an_encoder_step_through_rounded_text() {
        let step = 360.0 / 4096.0;
        let values: Vec<f64> =
            wave(5000).map(|x| ((x * 40.0 / step).round() * step * 100.0).round() / 100.0).collect();
        let lattice = Lattice::find(&values).unwrap();
        assert!((lattice.step / step - 1.0).abs() < 1e-4, "{lattice:?}");
        assert!(lattice.misfit_steps < 0.05, "{lattice:?}");
    }

    #[test]
    fn finds_none_in_continuous_values() {
        let values: Vec<f64> = wave(5000).collect();
        assert_eq!(Lattice::find(&values), None);
    }

    #[test]
    fn finds_a_step_that_a_swing_passes_a_few_times() {
        let values: Vec<f64> = wave(500).map(|x| (3.0 * x).round() * 0.2).collect();
        assert!((Lattice::find(&values).unwrap().step / 0.2 - 1.0).abs() < 1e-9);
        let levels: Vec<f64> = (0..500).map(|at| [0.0, 1.0, 1.3, 2.9, 4.5][at % 5]).collect();
        assert_eq!(Lattice::find(&levels), None);
    }

    #[test]
    fn finds_none_in_too_few_values() {
        assert_eq!(Lattice::find(&[0.0, 1.0, 0.0, 1.0, 2.0, 3.0]), None);
        assert_eq!(Lattice::find(&[]), None);
        assert_eq!(Lattice::find(&[1.0; 50]), None);
    }
}
