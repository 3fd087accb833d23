//! Adam: steps along a running mean of the gradient, with each parameter scaled by the size of its own
//! gradient.
//!
//! Suited to losses that are drawn anew at every step. For a deterministic loss, [`Lbfgs`](crate::Lbfgs)
//! needs far fewer steps.
//!
//! Reference: Kingma, Ba, Adam: a method for stochastic optimization, ICLR 2015, algorithm 1.

use serde::{Deserialize, Serialize};

/// Decay rates of the mean gradient and of the mean squared gradient, as in the paper.
const KEPT: f64 = 0.9;
const KEPT_SQUARE: f64 = 0.999;
/// Term that prevents division by zero for a parameter without a gradient.
const FLOOR: f64 = 1e-8;

/// State of the method: mean gradient and mean squared gradient of every parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    means: Vec<f64>,
    squares: Vec<f64>,
    steps: i32,
}

impl Adam {
    /// Returns the state before the first step, for a number of parameters.
    #[must_use]
    pub fn new(parameters: usize) -> Self {
        Self { means: vec![0.0; parameters], squares: vec![0.0; parameters], steps: 0 }
    }

    /// Returns `true` if this is the state after `steps` steps on a number of parameters.
    #[must_use]
    pub fn has_taken(&self, steps: u64, parameters: usize) -> bool {
        u64::try_from(self.steps) == Ok(steps)
            && [&self.means, &self.squares].iter().all(|of| of.len() == parameters)
    }

    /// Moves the parameters by one step; `rate` is about the distance that each parameter moves. `parameters`
    /// and `gradient` are as long as the state; extra entries are left unchanged.
    pub fn step(&mut self, parameters: &mut [f64], gradient: &[f64], rate: f64) {
        self.steps = self.steps.saturating_add(1);
        // The means start at zero; this removes the resulting bias.
        let (seen, seen_square) = (1.0 - KEPT.powi(self.steps), 1.0 - KEPT_SQUARE.powi(self.steps));
        let state = self.means.iter_mut().zip(&mut self.squares);
        for ((parameter, slope), (mean, square)) in parameters.iter_mut().zip(gradient).zip(state) {
            *mean = KEPT * *mean + (1.0 - KEPT) * slope;
            *square = KEPT_SQUARE * *square + (1.0 - KEPT_SQUARE) * slope * slope;
            *parameter -= rate * (*mean / seen) / ((*square / seen_square).sqrt() + FLOOR);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Adam;

    /// Two steps computed by hand, for gradients 2 and −1.
    #[test]
    fn it_is_the_published_algorithm() {
        let (mut adam, mut x) = (Adam::new(1), [1.0]);
        adam.step(&mut x, &[2.0], 0.1);
        // m/(1 − β₁) = 2, v/(1 − β₂) = 4.
        assert!((x[0] - (1.0 - 0.1 * 2.0 / (2.0 + 1e-8))).abs() < 1e-15);
        let before = x[0];
        adam.step(&mut x, &[-1.0], 0.1);
        let mean = (0.9 * 0.2 - 0.1) / (1.0 - 0.81);
        let square: f64 = (0.999 * 0.004 + 0.001) / (1.0 - 0.998_001);
        assert!((x[0] - (before - 0.1 * mean / (square.sqrt() + 1e-8))).abs() < 1e-13);
    }

    #[test]
    fn it_knows_how_far_it_is() {
        let (mut adam, mut x) = (Adam::new(2), [1.0, 2.0]);
        for steps in 0..3 {
            assert!(adam.has_taken(steps, 2));
            assert!(!adam.has_taken(steps + 1, 2) && !adam.has_taken(steps, 1) && !adam.has_taken(steps, 3));
            adam.step(&mut x, &[1.0, 1.0], 0.1);
        }
        for torn in [
            Adam { means: vec![0.0], ..adam.clone() },
            Adam { squares: vec![0.0; 3], ..adam.clone() },
            Adam { steps: -1, ..adam },
        ] {
            assert!(!torn.has_taken(3, 2) && !torn.has_taken(u64::MAX, 2));
        }
    }

    #[test]
    fn it_finds_the_bottom_of_a_bowl() {
        let (mut adam, mut x) = (Adam::new(2), [3.0, -4.0]);
        for step in 0..2000 {
            let gradient = [2.0 * (x[0] - 1.0), 200.0 * (x[1] + 2.0)];
            adam.step(&mut x, &gradient, 0.05 * (1.0 - f64::from(step) / 2000.0));
        }
        assert!((x[0] - 1.0).abs() < 1e-3 && (x[1] + 2.0).abs() < 1e-3, "{x:?}");
    }
}
