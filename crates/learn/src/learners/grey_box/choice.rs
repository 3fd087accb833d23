//! Choice of a law by held-out error.

use crate::judge::root_mean;

/// Number of blocks of the held-out samples, over which the uncertainty of a mean error is told. A block is far longer
/// than the time over which errors are alike.
const BLOCKS: usize = 12;

/// Fitted law to choose among others.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    /// Number of its parameters.
    pub(super) parameters: usize,
    /// Squared errors on the held-out samples; empty if a run failed.
    pub(super) squares: Vec<f64>,
}

impl Candidate {
    /// Returns the root mean square error; infinite if a run failed.
    pub(super) fn error(&self) -> f64 {
        root_mean(&self.squares)
    }

    /// Returns the standard error of the mean square, over blocks.
    fn uncertainty(&self) -> f64 {
        let length = self.squares.len().div_ceil(BLOCKS).max(1);
        let blocks = self.squares.chunks(length);
        let means: Vec<f64> = blocks.map(|own| own.iter().sum::<f64>() / own.len() as f64).collect();
        let count = means.len() as f64;
        let mean = means.iter().sum::<f64>() / count;
        let spread: f64 = means.iter().map(|own| (own - mean).powi(2)).sum();
        // A single block tells no uncertainty.
        if count > 1.0 { (spread / (count - 1.0) / count).sqrt() } else { 0.0 }
    }
}

/// Returns the place of the law with the fewest parameters among those whose mean square error is within one standard
/// error of the smallest; of several, the one with the smallest error. `None` without candidates.
///
/// Breiman, Friedman, Olshen, Stone, Classification and Regression Trees, 1984, section 3.4.3 (the rule of one standard
/// error).
pub(super) fn simplest(candidates: &[Candidate]) -> Option<usize> {
    let errors: Vec<f64> = candidates.iter().map(Candidate::error).collect();
    let (best, least) = candidates.iter().zip(&errors).min_by(|a, b| a.1.total_cmp(b.1))?;
    let most = if least.is_finite() { least * least + best.uncertainty() } else { f64::INFINITY };
    let as_good =
        candidates.iter().zip(&errors).enumerate().filter(|(_, (_, error))| *error * *error <= most);
    let order =
        as_good.min_by(|(_, (a, x)), (_, (b, y))| a.parameters.cmp(&b.parameters).then(x.total_cmp(y)));
    order.map(|(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::{Candidate, simplest};

    fn candidate(parameters: usize, even: f64, odd: f64) -> Candidate {
        // Blocks of ten samples, with two errors by turns.
        let squares = (0..120).map(|at| if at / 10 % 2 == 0 { even } else { odd }).collect();
        Candidate { parameters, squares }
    }

    #[test]
    fn takes_the_simplest_law_within_one_standard_error() {
        // A mean square of 2, with a standard error of 0.30.
        let rich = candidate(27, 1.0, 3.0);
        assert_eq!(simplest(&[candidate(12, 2.25, 2.25), rich.clone()]), Some(0));
        assert_eq!(simplest(&[candidate(12, 2.35, 2.35), rich.clone()]), Some(1));
        assert_eq!(simplest(&[candidate(40, 1.9, 1.9), rich]), Some(0));
    }

    #[test]
    fn a_law_whose_run_failed_is_the_last_choice() {
        let failed = Candidate { parameters: 3, squares: Vec::new() };
        assert_eq!(simplest(&[failed.clone(), candidate(12, 1.0, 1.0)]), Some(1));
        assert_eq!(simplest(&[failed]), Some(0));
        assert_eq!(simplest(&[]), None);
    }
}
