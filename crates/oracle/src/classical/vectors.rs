//! Sums over plain vectors.

/// Terms that are summed one after the other; more are summed by halves.
const RUN: usize = 64;

/// Σ aᵢ·bᵢ, by halves: rounding errors grow with the logarithm of the number of terms.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    match (a.split_at_checked(count / 2), b.split_at_checked(count / 2)) {
        (Some((head_a, tail_a)), Some((head_b, tail_b))) if count > RUN => {
            dot(head_a, head_b) + dot(tail_a, tail_b)
        }
        _ => a.iter().zip(b).map(|(a, b)| a * b).sum(),
    }
}

/// Σ aᵢ, by halves.
pub(super) fn sum(a: &[f64]) -> f64 {
    match a.split_at_checked(a.len() / 2) {
        Some((head, tail)) if a.len() > RUN => sum(head) + sum(tail),
        _ => a.iter().sum(),
    }
}

/// Euclidean length, without overflow or underflow on the way.
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

/// y ← y + factor·x.
pub(super) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// Entrywise product.
pub(super) fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// Entrywise quotient.
pub(super) fn over(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a / b).collect()
}

/// Entrywise difference.
pub(super) fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Whether every entry is finite.
pub(super) fn finite(a: &[f64]) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// Product of a matrix by columns with a vector.
pub(super) fn combine(columns: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let rows = columns.first().map_or(0, Vec::len);
    let mut sum = vec![0.0; rows];
    for (column, weight) in columns.iter().zip(weights) {
        add_scaled(&mut sum, *weight, column);
    }
    sum
}

/// Square diagonal matrix by columns.
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
