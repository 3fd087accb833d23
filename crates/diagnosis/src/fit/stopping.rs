//! When a fit ends.

use crate::model::predictor::Prediction;
use crate::noise::statistics::autocorrelation_time;

/// How long to go on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stopping {
    /// Steps tried at most.
    pub(crate) steps: usize,
    /// Relative decrease of the squares that a step has to bring, however few samples there are.
    pub(crate) small: f64,
    /// Log evidence that a step has to bring, where it is more than [`Self::small`]: half the relative decrease of the
    /// squares, times the samples, over the residual's autocorrelation time.
    pub(crate) worth: f64,
    /// Squares that a step has to bring, where they are more than [`Self::small`] of them.
    pub(crate) squares: f64,
    /// How many times the smallest gain is little.
    pub(crate) little: f64,
    /// Relative decrease of the squares that a step may promise and fail to bring, and be the last all the same: the ground
    /// is uneven there, and shorter steps win little of what a straight one would.
    pub(crate) rough: f64,
    /// Steps at the beginning that leave widths, frequencies and phases of the effects where they are: a size that
    /// has still to grow says nothing about them.
    pub(crate) sizes_first: usize,
    /// Whether segments that fit much worse than others are heeded less until the others are fitted: friction that
    /// is not yet right stops the motion half a swing too early or too late somewhere, and that one segment would
    /// hold all coefficients.
    pub(crate) wary: bool,
    /// Whether segments that are behind may begin again where the squares are uneven in their start states.
    pub(crate) begins_again: bool,
    /// Squares that a fit has to come below to be of use; one that will not do so within its steps is given up.
    pub(crate) below: f64,
}

impl Stopping {
    /// To rank proposals.
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
    /// For an experiment that is only planned: a distance within parts of a thousand is enough. What it is measured from is known,
    /// so that no segment has to begin again.
    pub(crate) const PLANNED: Self = Self { steps: 12, small: 1e-3, begins_again: false, ..Self::FINAL };
    /// For parts held out: begun at the fit to all, there is not far to go.
    pub(crate) const HELD_OUT: Self = Self { steps: 12, ..Self::FINAL };
    /// For what is reported: half of 1e-6·N is less than a probability would feel, and the step that gained
    /// so little is the last of a quadratic convergence.
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

    /// For what a set takes away of a gap of so many squares: a thousandth of it is enough.
    pub(crate) fn share(gap: f64) -> Self {
        Self { squares: 1e-3 * gap, ..Self::SEARCH }
    }

    /// The same where segments are heeded less: that only leads to where the fit begins in earnest.
    pub(crate) fn roughly(self) -> Self {
        Self { small: self.small.max(self.rough), ..self }
    }

    /// The same for a fit that is of use only where its squares come below a bound.
    pub(crate) fn below(self, squares: f64) -> Self {
        Self { below: squares, ..self }
    }
}

/// Damping beyond which a step is so much shorter than an undamped one that a small gain says nothing.
pub(crate) const SHORT: f64 = 1e-2;

/// So many steps in a row that gained little, however short they were, end a fit: in an uneven valley it would go on
/// like that until its steps are spent.
const CREPT: usize = 5;

/// Relative decrease from which on a step is worth going on in any case.
const PLENTY: f64 = 0.02;

/// Damping at which steps are so short that nothing comes of them.
const MOST_DAMPING: f64 = 1e6;

/// Steps before which a fit is not given up, and how many of the last gains it is judged by.
const FEWEST: usize = 6;
const LOOKED_AT: usize = 3;

/// What the last steps brought.
#[derive(Debug, Clone)]
pub(crate) struct Ending {
    effort: Stopping,
    /// Relative decrease of the squares that a step has to bring.
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

    /// The fit begins again, in other terms.
    pub(crate) fn begin_again(&mut self) {
        *self = Self { least: self.least, ..Self::new(self.effort) };
    }

    /// A step under some damping has decreased the squares by a part of them.
    pub(crate) fn gained(&mut self, part: f64, damping: f64, predictions: &[Prediction]) {
        if self.effort.squares > 0.0 {
            let left: f64 = predictions.iter().map(|own| own.residual.norm_squared()).sum();
            self.least = (self.effort.squares / left.max(f64::MIN_POSITIVE)).max(self.effort.small);
        } else if part < PLENTY {
            // Samples of a residual with structure say less than so many independent ones: squares that fall by
            // little are no evidence then.
            let residuals: Vec<&[f64]> = predictions.iter().map(|p| p.residual.as_slice()).collect();
            let samples: usize = residuals.iter().map(|residual| residual.len()).sum();
            let evidence = 0.5 * samples as f64 / autocorrelation_time(&residuals);
            self.least = self.effort.small.max(self.effort.worth / evidence);
        }
        self.gains.push(part);
        self.small = damping <= SHORT && part <= self.least;
        self.crept = if part <= self.effort.little * self.least { self.crept + 1 } else { 0 };
    }

    /// A step under some damping has failed; it had promised a part of the squares.
    pub(crate) fn failed(&mut self, promised: f64, damping: f64) {
        // Shorter steps promise less still.
        self.spent = damping > SHORT && promised <= self.least.max(self.effort.rough);
    }

    /// Whether a step that promises this part of the squares is not worth a trial.
    pub(crate) fn promises_nothing(&self, promised: f64, damping: f64) -> bool {
        damping <= SHORT && promised <= self.least
    }

    /// Nothing more is to be had.
    pub(crate) fn nothing_left(&mut self) {
        self.small = true;
    }

    /// Whether the last step was no gain to speak of: what is known of the ground still holds.
    pub(crate) fn is_small(&self) -> bool {
        self.small
    }

    /// Whether no step of any length decreases the squares by anything to speak of: it is a minimum, if an uneven one.
    pub(crate) fn is_reached(&self, damping: f64) -> bool {
        self.small || self.crept >= CREPT || self.spent || damping > MOST_DAMPING
    }

    /// Whether steps like the best of the last ones do not bring the squares to where they would be of use, after so
    /// many have been made.
    pub(crate) fn is_in_vain(&self, squares: f64, steps: usize) -> bool {
        // Before the first step nothing was gained.
        let last = self.gains.get(self.gains.len().saturating_sub(LOOKED_AT)..).unwrap_or_default();
        let best = last.iter().copied().fold(0.0, f64::max);
        let left = self.effort.steps.saturating_sub(steps) as f64;
        steps >= FEWEST && last.len() == LOOKED_AT && squares * (1.0 - best).powf(left) > self.effort.below
    }
}

#[cfg(test)]
mod tests {
    use super::{Ending, Stopping};
    use crate::model::predictor::Prediction;
    use nalgebra::{DMatrix, DVector};

    /// Residuals of 2000 samples: alternating, which is as good as white; and slow, 50 samples a half wave.
    fn residual(half_wave: usize) -> [Prediction; 1] {
        let residual =
            DVector::from_fn(2000, |at, _| if (at / half_wave).is_multiple_of(2) { 1.0 } else { -1.0 });
        [Prediction { residual, jacobian: DMatrix::zeros(0, 0) }]
    }

    /// 3e-6 of the squares of 2000 samples is 0.003 of log evidence where they are independent.
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

    /// 0.9 to the power of the 34 steps that are left is 0.028.
    #[test]
    fn a_fit_is_given_up_where_its_pace_does_not_take_it_there() {
        let mut ending = Ending::new(Stopping::SEARCH.below(1.0));
        for part in [0.9, 0.1, 0.05, 0.01] {
            ending.gained(part, 0.0, &residual(1));
        }
        assert!(ending.is_in_vain(40.0, 6) && !ending.is_in_vain(30.0, 6));
        assert!(!ending.is_in_vain(40.0, 5), "too early to say");
        ending.begin_again();
        assert!(!ending.is_in_vain(40.0, 6), "nothing is known of the new beginning");
    }
}
