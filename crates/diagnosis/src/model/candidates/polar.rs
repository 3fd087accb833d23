//! Laws with a size and an angle, fitted as a Cartesian pair.

/// Places of a size and an angle among a law's parameters.
///
/// Where a law has both, a fit moves (size·cos, size·sin): the law is linear in the pair, and no angle winds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Polar {
    pub(crate) size: usize,
    pub(crate) angle: usize,
}

impl Polar {
    /// Size and angle from the fitted pair; the other values are unchanged.
    pub(crate) fn values(self, fitted: &[f64]) -> Vec<f64> {
        self.replaced(fitted, |p, q| (p.hypot(q), q.atan2(p)))
    }

    /// The fitted pair from size and angle: the inverse of [`Self::values`].
    pub(crate) fn fitted(self, values: &[f64]) -> Vec<f64> {
        self.replaced(values, |length, turned| {
            let (sine, cosine) = turned.sin_cos();
            (length * cosine, length * sine)
        })
    }

    /// Derivatives of [`Self::values`]: row, column and value of what differs from the unit matrix.
    pub(crate) fn slopes(self, fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        let Self { size, angle } = self;
        // Both places are those of the law.
        let at = |place: usize| fitted.get(place).copied().unwrap_or(0.0);
        let (p, q) = (at(size), at(angle));
        let length = p.hypot(q);
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

    /// The pair put through a map, the other values left as they are.
    fn replaced(self, values: &[f64], map: impl Fn(f64, f64) -> (f64, f64)) -> Vec<f64> {
        let mut all = values.to_vec();
        let pair = (values.get(self.size), values.get(self.angle));
        if let (Some(&first), Some(&second)) = pair {
            let (first, second) = map(first, second);
            for (place, value) in [(self.size, first), (self.angle, second)] {
                if let Some(slot) = all.get_mut(place) {
                    *slot = value;
                }
            }
        }
        all
    }
}
