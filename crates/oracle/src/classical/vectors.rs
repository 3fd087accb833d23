//! Basic operations on plain vectors.

/// Half the distance from 1 to the next double.
pub(super) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Number of terms that are summed in sequence; longer sums are split into halves.
const RUN: usize = 64;

/// Returns Σ aᵢ·bᵢ, summed by halves: rounding errors grow with the logarithm of the number of terms.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    match (a.split_at_checked(count / 2), b.split_at_checked(count / 2)) {
        (Some((head_a, tail_a)), Some((head_b, tail_b))) if count > RUN => {
            dot(head_a, head_b) + dot(tail_a, tail_b)
        }
        _ => a.iter().zip(b).map(|(a, b)| a * b).sum(),
    }
}

/// Returns Σ aᵢ, summed by halves.
pub(super) fn sum(a: &[f64]) -> f64 {
    match a.split_at_checked(a.len() / 2) {
        Some((head, tail)) if a.len() > RUN => sum(head) + sum(tail),
        _ => a.iter().sum(),
    }
}

/// Returns the Euclidean length, without intermediate overflow or underflow.
pub(super) fn length(a: &[f64]) -> f64 {
    let largest = a.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    if largest > 1e-140 && largest < 1e140 {
        return dot(a, a).sqrt();
    }
    largest * a.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt()
}

/// Adds factor·x to y.
pub(super) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// Returns the entrywise product.
pub(super) fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// Returns the entrywise quotient.
pub(super) fn over(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a / b).collect()
}

/// Returns the entrywise difference.
pub(super) fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Returns `true` if every entry is finite.
pub(super) fn finite(a: &[f64]) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// Returns the number of rows of a matrix given by columns; 0 without columns.
pub(super) fn rows(columns: &[Vec<f64>]) -> usize {
    columns.first().map_or(0, Vec::len)
}

/// Returns the product of a matrix given by columns with a vector.
pub(super) fn combine(columns: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    debug_assert_eq!(columns.len(), weights.len(), "a weight for each column");
    let mut sum = vec![0.0; rows(columns)];
    for (column, weight) in columns.iter().zip(weights) {
        add_scaled(&mut sum, *weight, column);
    }
    sum
}

/// Returns a square diagonal matrix by columns.
pub(super) fn diagonal(entries: &[f64]) -> impl Iterator<Item = Vec<f64>> {
    let size = entries.len();
    entries.iter().enumerate().map(move |(at, entry)| {
        let mut column = vec![0.0; size];
        if let Some(place) = column.get_mut(at) {
            *place = *entry;
        }
        column
    })
}

#[cfg(test)]
mod tests {
    use super::{add_scaled, combine, diagonal, dot, finite, length, minus, over, sum, times};

    /// Whole numbers are added without rounding, in any number and order.
    #[test]
    fn sums_hold_every_term_once() {
        for count in [0, 1, 2, 63, 64, 65, 66, 127, 128, 129, 1000, 12_345_u32] {
            let terms: Vec<f64> = (1..=count).map(f64::from).collect();
            let n = f64::from(count);
            assert_eq!(sum(&terms), n * (n + 1.0) / 2.0);
            assert_eq!(dot(&terms, &terms), n * (n + 1.0) * (2.0 * n + 1.0) / 6.0);
            assert_eq!(dot(&terms, &[]), 0.0);
        }
        // The shorter vector ends the product.
        assert_eq!(dot(&[1.0, 2.0, 3.0], &[4.0, 5.0]), 14.0);
    }

    /// A tenth is not a double: a million of them summed in sequence are off by 1e-11, by halves by 1e-15.
    #[test]
    fn sums_by_halves_keep_their_digits() {
        let tenths = vec![0.1; 1_000_000];
        assert!((sum(&tenths) / 1e5 - 1.0).abs() < 2e-15);
        assert!((dot(&tenths, &vec![1.0; 1_000_000]) / 1e5 - 1.0).abs() < 2e-15);
    }

    #[test]
    fn lengths_beyond_the_squares_of_doubles_are_lengths() {
        for unit in [1.0, 1e-300, 1e-150, 1e-139, 1e139, 1e150, 1e300] {
            let found = length(&[3.0 * unit, 0.0, -4.0 * unit]);
            assert!((found / (5.0 * unit) - 1.0).abs() < 1e-15, "{unit:e}: {found:e}");
        }
        assert_eq!(length(&[]), 0.0);
        assert_eq!(length(&[0.0, -0.0]), 0.0);
        assert_eq!(length(&[1.0, f64::NEG_INFINITY]), f64::INFINITY);
    }

    #[test]
    fn entries_are_taken_one_by_one() {
        let (a, b) = ([6.0, -8.0], [2.0, 4.0]);
        assert_eq!(times(&a, &b), [12.0, -32.0]);
        assert_eq!(over(&a, &b), [3.0, -2.0]);
        assert_eq!(minus(&a, &b), [4.0, -12.0]);
        let mut moved = a;
        add_scaled(&mut moved, -0.5, &b);
        assert_eq!(moved, [5.0, -10.0]);
        assert!(finite(&a) && !finite(&[1.0, f64::NAN]) && !finite(&[f64::INFINITY, 1.0]));
    }

    #[test]
    fn a_matrix_by_columns_times_a_vector() {
        let columns = [vec![1.0, 2.0, 3.0], vec![0.0, -1.0, 1.0]];
        assert_eq!(combine(&columns, &[2.0, 10.0]), [2.0, -6.0, 16.0]);
        assert_eq!(combine(&[], &[]), [] as [f64; 0]);
        let square: Vec<Vec<f64>> = diagonal(&[7.0, 8.0]).collect();
        assert_eq!(square, [vec![7.0, 0.0], vec![0.0, 8.0]]);
    }
}
