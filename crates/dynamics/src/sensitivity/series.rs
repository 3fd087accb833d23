//! Truncated Taylor series.

/// Number of coefficients in a series; the highest degree is one less.
pub(crate) const LENGTH: usize = 20;

/// Taylor series in the time since the step began.
pub(crate) type Series = [f64; LENGTH];

/// Returns the first `length` entries of a list that has at least as many.
#[inline]
pub(crate) fn head<T>(list: &[T], length: usize) -> &[T] {
    debug_assert!(length <= list.len(), "{length} of {} entries", list.len());
    list.get(..length).unwrap_or(list)
}

/// Returns the coefficient of degree 0.
#[inline]
pub(crate) fn first(series: &Series) -> f64 {
    let [first, ..] = series;
    *first
}

/// Returns coefficient `degree` of a product.
#[inline]
pub(crate) fn convolve(a: &Series, b: &Series, degree: usize) -> f64 {
    dot_reversed(head(a, degree + 1), head(b, degree + 1))
}

/// Returns Σ aᵢ·b₋ᵢ of two lists of equal length, the second read backward. It keeps two sums, since each
/// addition to a single sum would wait for the one before.
#[inline]
pub(crate) fn dot_reversed(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len(), "lists of one length");
    let (mut even, mut odd) = (0.0, 0.0);
    for (a, b) in a.chunks_exact(2).zip(b.rchunks_exact(2)) {
        if let ([a, next], [before, b]) = (a, b) {
            even += a * b;
            odd += next * before;
        }
    }
    match (a.chunks_exact(2).remainder(), b) {
        ([last], [first, ..]) => even + odd + last * first,
        _ => even + odd,
    }
}

/// Evaluates a series at a time after the step began.
#[inline]
pub(crate) fn value(series: &[f64], time: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, coefficient| sum * time + coefficient)
}

/// Evaluates the time derivative of a series at a time after the step began.
#[inline]
pub(crate) fn slope(series: &[f64], time: f64) -> f64 {
    let terms = series.iter().enumerate().skip(1).rev();
    terms.fold(0.0, |sum, (power, coefficient)| sum * time + coefficient * power as f64)
}

/// Derivative series of a result with respect to a node. Coefficients from `length` on are zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Adjoint {
    pub(super) length: usize,
    pub(super) series: Series,
}

impl Adjoint {
    pub(crate) const NONE: Self = Self { length: 0, series: [0.0; LENGTH] };

    pub(super) fn clear(&mut self) {
        for value in self.series.iter_mut().take(self.length) {
            *value = 0.0;
        }
        self.length = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::{LENGTH, convolve, slope, value};

    #[test]
    fn products_values_and_slopes_are_the_polynomials() {
        let a: [f64; LENGTH] = std::array::from_fn(|i| 1.0 / (1.0 + i as f64));
        let b: [f64; LENGTH] = std::array::from_fn(|i| (i as f64 * 0.7).cos());
        for degree in 0..LENGTH {
            let expected: f64 = (0..=degree).map(|i| a[i] * b[degree - i]).sum();
            assert!((convolve(&a, &b, degree) - expected).abs() < 1e-14);
        }
        assert_eq!(value(&[3.0, -2.0, 0.5], 2.0), 1.0);
        assert_eq!(slope(&[3.0, -2.0, 0.5], 2.0), 0.0);
    }
}
