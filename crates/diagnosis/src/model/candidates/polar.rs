//! Laws with a size and an angle, fitted as a Cartesian pair.

#![allow(clippy::indexing_slicing, reason = "indices are those of the law's own parameters")]

/// Indices of a size and an angle among a law's parameters.
///
/// A fit moves the pair (size·cos, size·sin) instead: the law is linear in it, and no angle winds up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Polar {
    pub(crate) size: usize,
    pub(crate) angle: usize,
}

impl Polar {
    /// Converts the fitted pair to size and angle; the other values are unchanged.
    pub(crate) fn values(self, fitted: &[f64]) -> Vec<f64> {
        self.replaced(fitted, |p, q| (libm::hypot(p, q), libm::atan2(q, p)))
    }

    /// Converts size and angle to the fitted pair: the inverse of [`Self::values`].
    pub(crate) fn fitted(self, values: &[f64]) -> Vec<f64> {
        self.replaced(values, |length, turned| {
            let (sine, cosine) = libm::sincos(turned);
            (length * cosine, length * sine)
        })
    }

    /// Returns the derivatives of [`Self::values`]: row, column and value of each entry that differs from the
    /// unit matrix.
    pub(crate) fn slopes(self, fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        let Self { size, angle } = self;
        let (p, q) = (fitted[size], fitted[angle]);
        let length = libm::hypot(p, q);
        if length == 0.0 {
            return vec![(angle, angle, 0.0)];
        }
        let (cosine, sine) = (p / length, q / length);
        vec![
            (size, size, cosine),
            (size, angle, sine),
            (angle, size, -sine / length),
            (angle, angle, cosine / length),
        ]
    }

    /// Applies a map to the pair and leaves the other values as they are.
    fn replaced(self, values: &[f64], map: impl Fn(f64, f64) -> (f64, f64)) -> Vec<f64> {
        let mut all = values.to_vec();
        (all[self.size], all[self.angle]) = map(values[self.size], values[self.angle]);
        all
    }
}
