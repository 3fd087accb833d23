//! Rows that vanish outside a range, and the whitening of a covariance.

use nalgebra::{DMatrix, DVector};

/// Row of numbers that vanishes outside a range.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    first: usize,
    values: Vec<f64>,
}

impl Row {
    /// Creates zeros in the range that starts at `first`.
    pub(crate) fn zeros(first: usize, length: usize) -> Self {
        Self { first, values: vec![0.0; length] }
    }

    /// Adds to the entry at an index within the range; other indices are ignored.
    pub(crate) fn add(&mut self, at: usize, value: f64) {
        if let Some(entry) = at.checked_sub(self.first).and_then(|place| self.values.get_mut(place)) {
            *entry += value;
        }
    }

    /// Multiplies every entry by a factor.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.values.iter_mut().for_each(|value| *value *= factor);
    }

    /// Returns the inner product with a full row.
    pub(crate) fn of(&self, full: &[f64]) -> f64 {
        self.values.iter().zip(full.iter().skip(self.first)).map(|(one, other)| one * other).sum()
    }

    /// Adds a multiple of this row to a full one.
    pub(crate) fn add_to(&self, factor: f64, full: &mut [f64]) {
        let pairs = full.iter_mut().skip(self.first).zip(&self.values);
        pairs.for_each(|(entry, value)| *entry += factor * value);
    }

    /// Returns the inner product with another row.
    pub(crate) fn dot(&self, other: &Self) -> f64 {
        let from = self.first.max(other.first);
        let own = self.values.iter().skip(from - self.first);
        own.zip(other.values.iter().skip(from - other.first)).map(|(one, other)| one * other).sum()
    }

    /// Returns this row minus another of the same range, the latter multiplied entry by entry with a full
    /// row.
    pub(crate) fn minus_weighted(&self, other: &Self, full: &[f64]) -> Self {
        let weighted =
            other.values.iter().zip(full.iter().skip(self.first)).map(|(one, factor)| one * factor);
        let values = self.values.iter().zip(weighted).map(|(own, weighted)| own - weighted).collect();
        Self { first: self.first, values }
    }
}

/// Cholesky factor of a covariance, grown row by row: L with LLᵀ the covariance. L⁻¹r has independent entries
/// of equal variance if r has this covariance.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Whitening {
    rows: Vec<Vec<f64>>,
}

impl Whitening {
    /// Adds one more entry, by its covariances with the entries before it and its own variance. Returns
    /// `false` and adds nothing if the entries before it leave no more than a share `least` of its variance.
    pub(crate) fn extend(&mut self, covariances: &[f64], variance: f64, least: f64) -> bool {
        let mut row = self.forward(covariances.iter().copied());
        let left = variance - row.iter().map(|entry| entry * entry).sum::<f64>();
        let independent = left > least * variance;
        if independent {
            row.push(left.sqrt());
            self.rows.push(row);
        }
        independent
    }

    /// Returns L⁻¹ times a vector.
    fn forward(&self, vector: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut solution: Vec<f64> = Vec::with_capacity(self.rows.len());
        for (row, entry) in self.rows.iter().zip(vector) {
            let known: f64 = row.iter().zip(&solution).map(|(factor, value)| factor * value).sum();
            solution.push((entry - known) / row.last().copied().unwrap_or(f64::NAN));
        }
        solution
    }

    /// Returns L⁻ᵀ times a vector.
    fn backward(&self, mut rest: Vec<f64>) -> Vec<f64> {
        for (at, row) in self.rows.iter().enumerate().rev() {
            let Some((diagonal, before)) = row.split_last() else { continue };
            let Some((entry, above)) = rest.get_mut(..=at).and_then(<[f64]>::split_last_mut) else {
                continue;
            };
            *entry /= diagonal;
            above.iter_mut().zip(before).for_each(|(above, factor)| *above -= factor * *entry);
        }
        rest
    }

    /// Returns L⁻¹ times a vector.
    pub(crate) fn apply(&self, vector: &DVector<f64>) -> DVector<f64> {
        DVector::from_vec(self.forward(vector.iter().copied()))
    }

    /// Returns L⁻ᵀ times a matrix: after [`apply_all`](Self::apply_all) this is the covariance's inverse.
    pub(crate) fn unapply_all(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let entries = matrix.column_iter().flat_map(|column| self.backward(column.iter().copied().collect()));
        DMatrix::from_iterator(self.rows.len(), matrix.ncols(), entries)
    }

    /// Returns L⁻¹ times a matrix.
    pub(crate) fn apply_all(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let entries = matrix.column_iter().flat_map(|column| self.forward(column.iter().copied()));
        DMatrix::from_iterator(self.rows.len(), matrix.ncols(), entries)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(first: usize, values: &[f64]) -> Row {
        Row { first, values: values.to_vec() }
    }

    #[test]
    fn rows_meet_where_they_overlap() {
        let (one, other) = (row(1, &[1.0, 2.0, 3.0]), row(3, &[5.0, 7.0]));
        assert!((one.dot(&other) - 15.0).abs() < 1e-15 && (other.dot(&one) - 15.0).abs() < 1e-15);
        assert!(one.dot(&row(4, &[1.0])).abs() < 1e-15);
        assert!((one.of(&[9.0, 1.0, 1.0, 1.0, 9.0]) - 6.0).abs() < 1e-15);
        let difference = one.minus_weighted(&row(1, &[1.0, 1.0, 1.0]), &[0.0, 1.0, 2.0, 3.0]);
        assert_eq!(difference, row(1, &[0.0, 0.0, 0.0]));
        let mut full = [1.0; 5];
        one.add_to(2.0, &mut full);
        assert_eq!(full, [1.0, 3.0, 5.0, 7.0, 1.0]);
    }

    #[test]
    fn whitening_undoes_the_covariance() {
        let covariance = [[4.0, 2.0, 1.0], [2.0, 3.0, 0.5], [1.0, 0.5, 2.0]];
        let mut whitening = Whitening::default();
        for (at, line) in covariance.iter().enumerate() {
            assert!(whitening.extend(&line[..at], line[at], 1e-9));
        }
        let matrix = DMatrix::from_fn(3, 3, |i, j| covariance[i][j]);
        let half = whitening.apply_all(&matrix);
        let white = whitening.apply_all(&half.transpose());
        assert!((white - DMatrix::identity(3, 3)).norm() < 1e-14);
        let back = whitening.unapply_all(&half);
        assert!((back - DMatrix::identity(3, 3)).norm() < 1e-14);
    }

    #[test]
    fn what_is_determined_is_not_taken_in() {
        let mut whitening = Whitening::default();
        assert!(whitening.extend(&[], 1.0, 1e-9));
        assert!(!whitening.extend(&[2.0], 4.0, 1e-9));
        assert!(whitening.extend(&[2.0], 4.1, 1e-9));
    }
}
