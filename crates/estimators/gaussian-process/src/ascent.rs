//! Maximization of the likelihood.
//!
//! The algorithm is Newton's method with the absolute values of the curvature's eigenvalues, so that it
//! leaves saddles and ridges uphill, and with a trust radius on the change of each scale. The radius grows
//! while the likelihood gains what its second derivatives predict, and shrinks otherwise. Near a maximum the
//! algorithm is Newton's method. (Scoring by average information has cheaper steps, but oscillates for
//! hundreds of steps along the ridge of signal and length scale. Damping instead of a radius makes very slow
//! progress where the signal vanishes.)
//!
//! References: Nocedal, Wright, Numerical Optimization, 2nd ed. (2006), sections 3.4 and 4.1; Dauphin,
//! Pascanu, Gulcehre, Cho, Ganguli, Bengio, Adv. Neural Inf. Process. Syst. 27 (2014) 2933.

use crate::likelihood::{Evaluation, Process, Slope};
use nalgebra::Vector5;
use std::ops::ControlFlow;

/// Bounds of the parameters; ln σ_f, ln ℓ and ln σ_n are bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) least: Vector5<f64>,
    pub(crate) most: Vector5<f64>,
}

/// Reason why an ascent ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ended {
    /// No step has a predicted gain above the tolerance.
    Converged,
    /// The gradient or the curvature is not finite.
    Lost,
    /// The steps are used up.
    StepsSpent,
    /// A stop was requested.
    Interrupted,
}

/// End point of an ascent.
pub(crate) struct Summit {
    pub(crate) at: Evaluation,
    pub(crate) ended: Ended,
}

/// Most rejected steps in a row, after which the likelihood counts as flat to rounding.
const MOST_REJECTIONS: u32 = 10;

/// Longest step in the logarithm of a scale: a factor of e² at most, and of e^0.7 in the first step.
const LARGEST_RADIUS: f64 = 2.0;
const FIRST_RADIUS: f64 = 0.7;

/// Climbs from a start within `budget` steps, including rejected ones. `watch` receives the start and the
/// state after every step, and may break.
pub(crate) fn climb(
    process: &Process,
    bounds: &Bounds,
    start: Evaluation,
    tolerance: f64,
    budget: u64,
    mut watch: impl FnMut(u64, &Evaluation) -> ControlFlow<()>,
) -> (Summit, u64) {
    let mut at = start;
    let mut slope = process.slope(&at);
    let (mut radius, mut rejections, mut steps) = (FIRST_RADIUS, 0, 0);
    let ended = loop {
        if watch(steps, &at).is_break() {
            break Ended::Interrupted;
        }
        if rejections >= MOST_REJECTIONS {
            break Ended::Converged;
        }
        if steps >= budget {
            break Ended::StepsSpent;
        }
        let held = bounds.held(&at.parameters, &slope.gradient);
        let uphill = Uphill::new(&slope, &held);
        match uphill.promise {
            None => break Ended::Lost,
            Some(gain) if gain <= tolerance => break Ended::Converged,
            Some(_) => {}
        }
        steps += 1;
        let longest = uphill.step.iter().skip(2).fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let share = if longest > radius { radius / longest } else { 1.0 };
        let trial = bounds.hold(at.parameters + uphill.step * share);
        let expected = slope.model(&(trial - at.parameters));
        let next = process.evaluate(trial).filter(|next| next.value > at.value);
        match next {
            Some(next) => {
                let kept = (next.value - at.value) / expected;
                // If the model predicts no gain although there is one, its prediction is useless: the radius
                // stays.
                if kept > 0.75 {
                    radius = (2.0 * radius).min(LARGEST_RADIUS);
                } else if (0.0..0.25).contains(&kept) {
                    radius *= 0.5;
                }
                at = next;
                slope = process.slope(&at);
                rejections = 0;
            }
            None => {
                radius = 0.25 * longest.min(radius);
                rejections += 1;
            }
        }
    };
    (Summit { at, ended }, steps)
}

/// Uphill step with its predicted gain.
struct Uphill {
    step: Vector5<f64>,
    /// Gain predicted by the quadratic model; `None` if gradient or curvature is not finite.
    promise: Option<f64>,
}

impl Uphill {
    /// Computes V·|Λ|⁻¹·Vᵀ·gradient with V·Λ·Vᵀ the curvature. Rows and columns of a and b are scaled to the
    /// size of the others. Held parameters do not move.
    fn new(slope: &Slope, held: &Vector5<bool>) -> Self {
        let free = held.map(|held| f64::from(u8::from(!held)));
        let mut scale = slope.curvature.diagonal().map(|entry| 1.0 / entry.abs().sqrt());
        scale.fixed_rows_mut::<3>(2).fill(1.0);
        let scale = scale.component_mul(&free);
        let curvature = slope.curvature.component_mul(&(scale * scale.transpose()));
        let gradient = slope.gradient.component_mul(&scale);
        if !(curvature.iter().chain(gradient.iter()).all(|entry| entry.is_finite())) {
            return Self { step: Vector5::zeros(), promise: None };
        }
        let eigen = curvature.symmetric_eigen();
        // A direction in which the likelihood has neither slope nor curvature gets no step.
        let inverse = eigen.eigenvalues.map(|value| 1.0 / value.abs().max(1e-9));
        let along = eigen.eigenvectors.tr_mul(&gradient);
        let step = eigen.eigenvectors * inverse.component_mul(&along);
        Self { promise: Some(0.5 * gradient.dot(&step)), step: step.component_mul(&scale) }
    }
}

impl Slope {
    /// Returns gradientᵀ·step − ½·stepᵀ·curvature·step.
    fn model(&self, step: &Vector5<f64>) -> f64 {
        self.gradient.dot(step) - 0.5 * step.dot(&(self.curvature * step))
    }
}

impl Bounds {
    fn hold(&self, parameters: Vector5<f64>) -> Vector5<f64> {
        parameters.sup(&self.least).inf(&self.most)
    }

    /// Returns the parameters that are at a bound and would cross it, and the length scale if the signal has
    /// vanished.
    pub(crate) fn held(&self, parameters: &Vector5<f64>, gradient: &Vector5<f64>) -> Vector5<bool> {
        let below =
            parameters.zip_zip_map(&self.least, gradient, |here, least, pull| here <= least && pull < 0.0);
        let above =
            parameters.zip_zip_map(&self.most, gradient, |here, most, pull| here >= most && pull > 0.0);
        let mut held = below.zip_map(&above, |below, above| below || above);
        held.w = held.w || below.z;
        held
    }
}
