//! Stopping rules of a fit.

use crate::model::predictor::Prediction;
use crate::noise::statistics::autocorrelation_time;

/// Limits at which a fit stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stopping {
    /// Maximum number of steps tried.
    pub(crate) steps: usize,
    /// Minimum relative decrease of the squares per step, whatever the number of samples.
    pub(crate) small: f64,
    /// Minimum log evidence per step in nats, if it requires more than [`Self::small`]: half the relative
    /// decrease of the squares, times the number of samples, over the autocorrelation time of the residual.
    pub(crate) worth: f64,
    /// Minimum absolute decrease of the squares per step, if it requires more than [`Self::small`].
    pub(crate) squares: f64,
    /// Multiple of the minimum gain up to which a gain counts as little; several in a row end the fit.
    pub(crate) little: f64,
    /// Relative decrease of the squares that a failed step may have promised and still end the fit: the
    /// squares are uneven there, and shorter steps gain little of what a straight one would.
    pub(crate) rough: f64,
    /// Number of first steps that hold widths, frequencies and phases of the effects: an effect whose size
    /// has yet to grow gives no information about them.
    pub(crate) sizes_first: usize,
    /// `true` if segments that fit much worse than others get less weight until the others are fitted.
    /// Friction that is not yet right stops the motion half a swing too early or too late somewhere, and that
    /// one segment would hold back all coefficients.
    pub(crate) wary: bool,
    /// `true` if segments that fit badly may begin again if the squares are uneven in their start states.
    pub(crate) begins_again: bool,
    /// Sum of squares below which a fit is of use; a fit that will not reach it within its steps is given up.
    pub(crate) below: f64,
}

impl Stopping {
    /// Limits for ranking proposals.
    pub(crate) const SEARCH: Self = Self {
        steps: 40,
        small: 1e-4,
        worth: 0.1,
        squares: 0.0,
        little: 2.0,
        rough: 0.02,
        sizes_first: 2,
        wary: true,
        begins_again: true,
        below: f64::INFINITY,
    };
    /// Limits for an experiment that is only planned: a distance within parts of a thousand is enough. The
    /// motion that it is measured from is known, so that no segment has to begin again.
    pub(crate) const PLANNED: Self = Self { steps: 12, small: 1e-3, begins_again: false, ..Self::FINAL };
    /// Limits for held-out parts: they begin at the fit to all, which is close.
    pub(crate) const HELD_OUT: Self = Self { steps: 12, ..Self::FINAL };
    /// Limits for reported fits: half of 1e-6·N is too little to affect a probability, and a step that gained
    /// so little is the last one of a quadratic convergence.
    pub(crate) const FINAL: Self = Self {
        steps: 60,
        small: 1e-6,
        worth: 3e-3,
        squares: 0.0,
        little: 20.0,
        rough: 0.0,
        sizes_first: 0,
        wary: false,
        begins_again: true,
        below: f64::INFINITY,
    };

    /// Limits for the share of a gap that a set explains: a thousandth of the gap's squares is accurate
    /// enough.
    pub(crate) fn share(gap: f64) -> Self {
        Self { squares: 1e-3 * gap, ..Self::SEARCH }
    }

    /// Returns coarser limits for the phase in which segments have less weight: it only leads to the start of
    /// the main fit.
    pub(crate) fn roughly(self) -> Self {
        Self { small: self.small.max(self.rough), ..self }
    }

    /// Returns the same limits for a fit that is of use only if its squares fall below a bound.
    pub(crate) fn below(self, squares: f64) -> Self {
        Self { below: squares, ..self }
    }
}

/// Damping beyond which a step is so much shorter than an undamped one that a small gain tells nothing.
pub(crate) const SHORT: f64 = 1e-2;

/// Number of steps in a row with little gain, however short they were, that end a fit: in an uneven valley it
/// would continue like that until its steps are spent.
const CREPT: usize = 5;

/// Relative decrease of the squares from which on the fit continues in any case.
const PLENTY: f64 = 0.02;

/// Damping at which steps are too short to have an effect.
const MOST_DAMPING: f64 = 1e6;

/// Number of steps before which a fit is not given up, and number of last gains that decide.
const FEWEST: usize = 6;
const LOOKED_AT: usize = 3;

/// Number of steps within which a fit has to become of use, at the pace of the best of its last steps.
const SOON: usize = 10;

/// Record of the last steps' gains, from which the end of a fit is decided.
#[derive(Debug, Clone)]
pub(crate) struct Ending {
    effort: Stopping,
    /// Minimum relative decrease of the squares per step.
    least: f64,
    /// Relative decreases since the fit began, or began again.
    gains: Vec<f64>,
    small: bool,
    crept: usize,
    spent: bool,
}

impl Ending {
    pub(crate) fn new(effort: Stopping) -> Self {
        Self { effort, least: effort.small, gains: Vec::new(), small: false, crept: 0, spent: false }
    }

    /// Clears the gains because the fit begins again from other start states or weights.
    pub(crate) fn begin_again(&mut self) {
        *self = Self { least: self.least, ..Self::new(self.effort) };
    }

    /// Records a step that decreased the squares. `part` is the decrease relative to the squares.
    pub(crate) fn gained(&mut self, part: f64, damping: f64, predictions: &[Prediction]) {
        if self.effort.squares > 0.0 {
            let left: f64 = predictions.iter().map(|own| own.residual.norm_squared()).sum();
            self.least = (self.effort.squares / left.max(f64::MIN_POSITIVE)).max(self.effort.small);
        } else if part < PLENTY {
            // Correlated residuals hold less information than as many independent samples, so that a small
            // decrease of the squares is then no evidence.
            let residuals: Vec<&[f64]> = predictions.iter().map(|p| p.residual.as_slice()).collect();
            let samples: usize = residuals.iter().map(|residual| residual.len()).sum();
            let evidence = 0.5 * samples as f64 / autocorrelation_time(&residuals);
            self.least = self.effort.small.max(self.effort.worth / evidence);
        }
        self.gains.push(part);
        self.small = damping <= SHORT && part <= self.least;
        self.crept = if part <= self.effort.little * self.least { self.crept + 1 } else { 0 };
    }

    /// Records a failed step. `promised` is the decrease that it had promised, relative to the squares.
    pub(crate) fn failed(&mut self, promised: f64, damping: f64) {
        // Shorter steps promise even less.
        self.spent = damping > SHORT && promised <= self.least.max(self.effort.rough);
    }

    /// Returns `true` if a step that promises this part of the squares is not worth a trial.
    pub(crate) fn promises_nothing(&self, promised: f64, damping: f64) -> bool {
        damping <= SHORT && promised <= self.least
    }

    /// Records that no step promises a further gain.
    pub(crate) fn nothing_left(&mut self) {
        self.small = true;
    }

    /// Returns `true` if the last step gained too little: an earlier attempt to begin again is then still
    /// valid.
    pub(crate) fn is_small(&self) -> bool {
        self.small
    }

    /// Returns `true` if no step of any length decreases the squares noticeably: the point is a minimum, if
    /// an uneven one.
    pub(crate) fn is_reached(&self, damping: f64) -> bool {
        self.small || self.crept >= CREPT || self.spent || damping > MOST_DAMPING
    }

    /// Returns `true` if the next steps, each as good as the best of the last ones, would not reach the
    /// bound below which the fit is of use. `steps` is the number of steps made.
    pub(crate) fn is_in_vain(&self, squares: f64, steps: usize) -> bool {
        let (_, last) = self.gains.split_at(self.gains.len().saturating_sub(LOOKED_AT));
        let best = last.iter().copied().fold(0.0, f64::max);
        let left = self.effort.steps.saturating_sub(steps).min(SOON) as f64;
        steps >= FEWEST
            && last.len() == LOOKED_AT
            && squares * libm::pow(1.0 - best, left) > self.effort.below
    }
}

#[cfg(test)]
mod tests {
    use super::{Ending, Stopping};
    use crate::model::predictor::Prediction;
    use nalgebra::{DMatrix, DVector};

    /// Residuals of 2000 samples that alternate in sign: at every sample, which is as good as white, or every
    /// half wave.
    fn residual(half_wave: usize) -> [Prediction; 1] {
        let residual =
            DVector::from_fn(2000, |at, _| if (at / half_wave).is_multiple_of(2) { 1.0 } else { -1.0 });
        [Prediction { residual, jacobian: DMatrix::zeros(0, 0) }]
    }

    /// 3e-6 of the squares of 2000 samples is 0.003 of log evidence if they are independent.
    #[test]
    fn a_step_is_worth_what_its_evidence_is() {
        let part = 4e-6;
        let mut ending = Ending::new(Stopping::FINAL);
        ending.gained(part, 0.0, &residual(1));
        assert!(!ending.is_reached(0.0));
        ending.gained(part, 0.0, &residual(50));
        assert!(ending.is_reached(0.0));
    }

    #[test]
    fn short_steps_of_little_worth_end_a_fit_after_a_few() {
        let mut ending = Ending::new(Stopping::FINAL);
        for step in 0..5 {
            assert!(!ending.is_reached(1.0), "{step}");
            ending.gained(5e-6, 1.0, &residual(1));
        }
        assert!(ending.is_reached(1.0));
        ending.begin_again();
        assert!(!ending.is_reached(1.0));
    }

    #[test]
    fn a_failed_step_that_promised_nothing_is_the_last() {
        let mut ending = Ending::new(Stopping::FINAL);
        ending.failed(1e-3, 1.0);
        assert!(!ending.is_reached(1.0));
        ending.failed(1e-7, 1.0);
        assert!(ending.is_reached(1.0));
    }

    /// 0.9 to the power of the next ten steps is 0.35.
    #[test]
    fn a_fit_is_given_up_where_its_pace_does_not_take_it_there() {
        let mut ending = Ending::new(Stopping::SEARCH.below(1.0));
        for part in [0.9, 0.1, 0.05, 0.01] {
            ending.gained(part, 0.0, &residual(1));
        }
        assert!(ending.is_in_vain(3.0, 6) && !ending.is_in_vain(2.8, 6));
        assert!(!ending.is_in_vain(3.0, 5), "too early to say");
        ending.begin_again();
        assert!(!ending.is_in_vain(3.0, 6), "nothing is known of the new beginning");
    }
}
