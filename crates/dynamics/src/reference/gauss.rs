//! Collocation at Gauss–Legendre nodes.

/// Maximum number of stages of a step.
pub(crate) const MOST_STAGES: usize = 16;

/// Tables of Gauss–Legendre collocation with a given number of stages, on the unit interval.
///
/// The right-hand side along a step is represented by its Legendre series, sampled at the zeros of the
/// Legendre polynomial P_s. The end of the step is of order 2s, its interior of order s + 1. The tables are
/// computed, not copied: zeros by Newton's method, everything else from the orthogonality of the P_k.
///
/// # Reference
/// Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed., Springer 2006, section II.1.3.
#[derive(Debug, Clone)]
pub(crate) struct Gauss {
    /// Nodes, ascending in (0, 1).
    pub(crate) nodes: Vec<f64>,
    /// Row i holds the integrals of the Lagrange polynomials from 0 to node i.
    pub(crate) matrix: Vec<Vec<f64>>,
    /// Row k converts values at the nodes to the coefficient of P_k.
    pub(crate) analysis: Vec<Vec<f64>>,
}

/// Computes P_0 … P_n at x by the three-term recurrence.
fn legendre(x: f64, values: &mut [f64]) {
    let (mut before, mut last) = (0.0, 1.0);
    for (k, value) in values.iter_mut().enumerate() {
        if k > 0 {
            let n = k as f64;
            let next = ((2.0 * n - 1.0) * x * last - (n - 1.0) * before) / n;
            before = last;
            last = next;
        }
        *value = last;
    }
}

/// Returns the integrals of the Legendre polynomials up to a part τ of the step, one for each stage; the rest
/// is 0.
pub(crate) fn basis(tau: f64, stages: usize) -> [f64; MOST_STAGES] {
    debug_assert!(stages <= MOST_STAGES, "{stages} of {MOST_STAGES} stages");
    let mut basis = [0.0; MOST_STAGES];
    if let Some(used) = basis.get_mut(..stages) {
        integrals(tau, used);
    }
    basis
}

/// Computes ∫₀^τ P_k(2t − 1) dt for k = 0 … integrals.len() − 1.
pub(crate) fn integrals(tau: f64, integrals: &mut [f64]) {
    let x = 2.0 * tau - 1.0;
    // P_{k−1}, P_k and P_{k+1} in turn.
    let (mut before, mut last) = (1.0, 1.0);
    for (k, integral) in integrals.iter_mut().enumerate() {
        let n = k as f64;
        if k == 0 {
            *integral = tau;
            last = 1.0;
            before = 0.0;
        }
        let next = ((2.0 * n + 1.0) * x * last - n * before) / (n + 1.0);
        if k > 0 {
            *integral = 0.5 * (next - before) / (2.0 * n + 1.0);
        }
        before = last;
        last = next;
    }
}

impl Gauss {
    /// Computes the tables for 1 to 16 stages; other numbers are clamped to that range.
    pub(crate) fn new(stages: usize) -> Self {
        let stages = stages.clamp(1, MOST_STAGES);
        let count = stages as f64;
        let mut values = vec![0.0; stages + 1];
        let mut nodes = Vec::with_capacity(stages);
        let mut weights = Vec::with_capacity(stages);
        for i in 0..stages {
            let mut x = -libm::cos(std::f64::consts::PI * (i as f64 + 0.75) / (count + 0.5));
            let mut slope = 1.0;
            for _ in 0..20 {
                legendre(x, &mut values);
                let (value, lower) = match values.as_slice() {
                    [.., lower, value] => (*value, *lower),
                    _ => (0.0, 1.0),
                };
                slope = count * (lower - x * value) / (1.0 - x * x);
                x -= value / slope;
            }
            nodes.push(0.5 * (1.0 + x));
            weights.push(1.0 / ((1.0 - x * x) * slope * slope));
        }
        let mut analysis = vec![vec![0.0; stages]; stages];
        for (j, (node, weight)) in nodes.iter().zip(&weights).enumerate() {
            legendre(2.0 * node - 1.0, &mut values);
            for (k, (row, value)) in analysis.iter_mut().zip(&values).enumerate() {
                if let Some(entry) = row.get_mut(j) {
                    *entry = (2.0 * k as f64 + 1.0) * weight * value;
                }
            }
        }
        let mut integrated = vec![0.0; stages];
        let matrix = nodes
            .iter()
            .map(|&node| {
                integrals(node, &mut integrated);
                (0..stages)
                    .map(|j| {
                        let column = analysis.iter().filter_map(|row| row.get(j));
                        column.zip(&integrated).map(|(entry, integral)| entry * integral).sum()
                    })
                    .collect()
            })
            .collect();
        Self { nodes, matrix, analysis }
    }

    pub(crate) fn stages(&self) -> usize {
        self.nodes.len()
    }
}

#[cfg(test)]
mod tests {
    use super::{Gauss, integrals};

    #[test]
    fn two_stages_are_the_textbooks() {
        let gauss = Gauss::new(2);
        let root = 3.0_f64.sqrt();
        assert!((gauss.nodes[0] - (0.5 - root / 6.0)).abs() < 1e-15);
        let expected = [[0.25, 0.25 - root / 6.0], [0.25 + root / 6.0, 0.25]];
        for (row, expected) in gauss.matrix.iter().zip(expected) {
            for (entry, expected) in row.iter().zip(expected) {
                assert!((entry - expected).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_polynomial_is_integrated_exactly_in_the_interior() {
        let gauss = Gauss::new(12);
        let samples: Vec<f64> = gauss.nodes.iter().map(|node| 12.0 * node.powi(11)).collect();
        let mut basis = [0.0; 12];
        for tau in [0.0, 0.1, 0.5, 0.93, 1.0] {
            integrals(tau, &mut basis);
            let integral: f64 = gauss
                .analysis
                .iter()
                .zip(basis)
                .map(|(row, basis)| basis * row.iter().zip(&samples).map(|(a, b)| a * b).sum::<f64>())
                .sum();
            assert!((integral - f64::powi(tau, 12)).abs() < 1e-14, "{tau}: {integral}");
        }
    }
}
