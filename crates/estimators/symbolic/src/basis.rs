//! Tangent space of a fitted function: its directions of change with the constants.

/// Share of a column's length below which it counts as lying in the others' space.
const DEPENDENT: f64 = 1e-7;

/// Orthonormal basis of the space of the derivatives by the constants.
///
/// Columns may continue beyond the peaks, to times that were not measured. Those entries follow the linear
/// combinations of the basis, but do not determine them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TangentSpace {
    basis: Vec<Vec<f64>>,
    peaks: usize,
}

impl TangentSpace {
    /// Orthonormalizes by Gram–Schmidt over the first `peaks` entries, each column twice ("twice is enough":
    /// Giraud, Langou, Rozložník 2005).
    pub(crate) fn of<'a>(peaks: usize, columns: impl IntoIterator<Item = &'a [f64]>) -> Self {
        let mut space = Self { basis: Vec::new(), peaks };
        for column in columns {
            space.extend(column);
        }
        space
    }

    /// Returns the number of constants with a separate effect, to first order.
    pub(crate) fn rank(&self) -> usize {
        self.basis.len()
    }

    /// Adds a column; returns `true` if it lay outside of the space before.
    pub(crate) fn extend(&mut self, column: &[f64]) -> bool {
        let length = self.norm(column);
        if !length.is_normal() {
            return false;
        }
        let mut rest: Vec<f64> = column.iter().map(|entry| entry / length).collect();
        for _ in 0..2 {
            for direction in &self.basis {
                let pairs = self.measured(direction).iter().zip(self.measured(&rest));
                let along: f64 = pairs.map(|(a, b)| a * b).sum();
                rest.iter_mut().zip(direction).for_each(|(rest, entry)| *rest -= along * entry);
            }
        }
        let left = self.norm(&rest);
        if left <= DEPENDENT {
            return false;
        }
        rest.iter_mut().for_each(|entry| *entry /= left);
        self.basis.push(rest);
        true
    }

    /// Returns the leverage of each of `points` points. At a peak it is the derivative of the fitted value by
    /// the measured one. At a time that was not measured it is the variance of the value due to the scatter
    /// of the peaks, as a share of their variance.
    pub(crate) fn leverages(&self, points: usize) -> Vec<f64> {
        let mut leverages = vec![0.0; points];
        for direction in &self.basis {
            leverages.iter_mut().zip(direction).for_each(|(sum, entry)| *sum += entry * entry);
        }
        leverages
    }

    fn norm(&self, column: &[f64]) -> f64 {
        self.measured(column).iter().map(|entry| entry * entry).sum::<f64>().sqrt()
    }

    fn measured<'a>(&self, column: &'a [f64]) -> &'a [f64] {
        column.get(..self.peaks).unwrap_or(column)
    }
}

#[cfg(test)]
mod tests {
    use super::TangentSpace;

    #[test]
    fn a_line_has_the_leverages_of_the_textbook() {
        let times = [0.0, 0.1, 0.5, 0.6, 1.0];
        let mut space = TangentSpace::of(5, [&[3.0; 5][..], &times]);
        assert_eq!(space.rank(), 2);
        let mean = 0.44;
        let scatter: f64 = times.iter().map(|time: &f64| (time - mean).powi(2)).sum();
        for (time, leverage) in times.iter().zip(space.leverages(5)) {
            assert!((leverage - 0.2 - (time - mean).powi(2) / scatter).abs() < 1e-14);
        }
        let line: Vec<f64> = times.iter().map(|time| 2.0 - 7.0 * time).collect();
        assert!(!space.extend(&line));
        assert!(space.extend(&times.map(|time| time * time)));
    }

    #[test]
    fn a_time_that_was_not_measured_has_the_textbook_s_variance_and_no_say() {
        let times = [0.0, 0.1, 0.5, 0.6, 1.0, 3.0];
        let space = TangentSpace::of(5, [&[3.0; 6][..], &times]);
        let (mean, scatter) = (0.44, 0.652);
        let leverages = space.leverages(6);
        assert!((leverages[5] - 0.2 - (3.0_f64 - mean).powi(2) / scatter).abs() < 1e-13, "{leverages:?}");
        assert!((leverages[..5].iter().sum::<f64>() - 2.0).abs() < 1e-14);
    }
}
