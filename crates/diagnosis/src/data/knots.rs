//! Fewer knots of an input that is sampled faster than the motion feels.
//!
//! A run takes at least a step from knot to knot. A drive's command comes at a thousand a second and its motion answers
//! below ten: means over several samples, which keep the impulse, move it the same way. How many may be averaged is asked
//! of a fit: as many as change its prediction by no more than a small part of what it leaves.

use crate::data::segments::Data;
use crate::fit::levenberg_marquardt::{Fit, residuals};

/// Samples that are averaged at most.
const MOST: usize = 32;

/// Part of a fit's residual (RMS) by which its prediction may change.
const PART: f64 = 0.05;

impl Data {
    /// How many samples of the inputs may be averaged without a prediction noticing.
    pub(crate) fn spare_knots(&self, at: &Fit) -> usize {
        let Ok(exact) = residuals(self, at) else { return 1 };
        let most: f64 = PART * PART * exact.iter().map(nalgebra::DVector::norm_squared).sum::<f64>();
        let is_close = |count: usize| {
            residuals(&self.averaged(count), at).is_ok_and(|own| {
                own.iter().zip(&exact).map(|(own, exact)| (own - exact).norm_squared()).sum::<f64>() <= most
            })
        };
        let counts = std::iter::successors(Some(2), |count| Some(2 * count));
        let close = counts.take_while(|count| self.driven() && *count <= MOST && is_close(*count));
        close.last().unwrap_or(1)
    }

    /// The same with every so many samples of the inputs averaged to one.
    pub(crate) fn averaged(&self, count: usize) -> Self {
        let inputs = self.inputs.iter().map(|input| input.as_ref().map(|own| own.averaged(count)));
        Self { inputs: inputs.collect(), ..self.clone() }
    }
}
