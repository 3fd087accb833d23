//! Sets of effects weighed by the residuals of the samples that they were fitted to, on the same scale as in the
//! search ([`crate::sets::weights::Weighing`]).
//!
//! Held-out predictions give the error of a set, and no weight: the largest swing of a decay is always
//! extrapolated when it is held out, so that they would reject a right law for coefficients that the smaller
//! swings do not determine.
//!
//! Held-out predictions had weighed sets before: a set with a thirtieth of the error lost 379 nats.

use crate::data::segments::Data;
use crate::evidence::context::Predicted;
use crate::evidence::held_out::HeldOut;
use crate::fit::fitted::Fit;
use crate::residual::floor;
use crate::sets::likelihood::{BANDS, Likelihood};
use crate::sets::score::{further_starts, parameter_price};
use crate::sets::weights::{Weighed, price, share};
use nalgebra::DVector;

/// Records, and the simulator that sets are compared with.
#[derive(Clone, Copy)]
pub(crate) struct Records<'d> {
    /// Data that the sets were fitted to, and the same as unjoined segments.
    pub(crate) data: &'d Data,
    pub(crate) segments: &'d Data,
    /// Recalibrated simulator.
    pub(crate) bare: &'d Fit,
    /// Number of candidate effects.
    pub(crate) vocabulary: usize,
}

/// Residual power of a set, and the price of the set.
pub(crate) struct Left {
    /// Held-out error, in the unit of the records.
    pub(crate) error: f64,
    /// Power by segment and band.
    pub(crate) powers: Vec<[f64; BANDS]>,
    /// Price of the set's effects and parameters, in nats.
    pub(crate) price: f64,
}

/// Sets with their evidence, best first, and the residual of each.
pub(crate) struct WeighedSets<'a> {
    pub(crate) weighed: Vec<Weighed<'a>>,
    pub(crate) left: Vec<Left>,
    pub(crate) likelihood: Likelihood,
    /// Probability that something is left beside the best set.
    pub(crate) left_over: f64,
    /// Log evidence of the recalibrated simulator; the evidence of all sets is relative to it.
    bare: f64,
}

impl Records<'_> {
    /// Returns the residuals of a set by unjoined segment.
    fn residuals(&self, set: &Fit) -> Vec<DVector<f64>> {
        self.data.by_part(&set.residuals)
    }

    /// Returns the price of a set's effects and parameters in nats. `left_over` is the probability that something
    /// is left beside the best set.
    fn price(&self, set: &Fit, worth: f64, left_over: f64) -> f64 {
        let parameters = set.globals().saturating_sub(self.bare.globals()) + further_starts(set);
        price(self.segments, set, self.vocabulary, left_over) + parameter_price(parameters, worth)
    }
}

impl<'a> WeighedSets<'a> {
    /// Weighs sets as if nothing were left; the last of `sets` is the recalibrated simulator.
    pub(crate) fn of(records: &Records<'_>, sets: &[(&'a Fit, &HeldOut)]) -> Self {
        let residuals: Vec<Vec<DVector<f64>>> = sets.iter().map(|(fit, _)| records.residuals(fit)).collect();
        let square = |own: &&Vec<DVector<f64>>| own.iter().map(DVector::norm_squared).sum::<f64>();
        let closest = residuals.iter().min_by(|a, b| square(a).total_cmp(&square(b)));
        let closest = closest.map_or(&[][..], Vec::as_slice);
        let noise = floor::floor(records.segments, closest).value;
        let likelihood = Likelihood::of(records.segments, closest, noise);
        let of = |((fit, held), own): (&(&'a Fit, &HeldOut), &Vec<DVector<f64>>)| {
            let powers = likelihood.powers(own);
            let left = Left { error: held.mean_square().sqrt(), powers, price: 0.0 };
            (Weighed { fit, evidence: 0.0, probability: 0.0 }, left)
        };
        let (weighed, left) = sets.iter().zip(&residuals).map(of).unzip();
        Self { weighed, left, likelihood, left_over: 0.0, bare: 0.0 }.priced(records, 0.0)
    }

    /// Returns the same sets with their prices for a given probability of a left-over.
    pub(crate) fn priced(self, records: &Records<'_>, left_over: f64) -> Self {
        let Self { weighed, left, likelihood, .. } = self;
        let mut all: Vec<(Weighed<'a>, Left)> = weighed.into_iter().zip(left).collect();
        for (own, left) in &mut all {
            left.price = records.price(own.fit, likelihood.worth(), left_over);
            own.evidence = left.evidence(&likelihood);
        }
        let is_bare = |own: &&(Weighed<'_>, Left)| std::ptr::eq(own.0.fit, records.bare);
        // Evidence is relative to the bare set.
        let bare = all.iter().find(is_bare).map_or(0.0, |bare| bare.0.evidence);
        all.sort_by(|a, b| b.0.evidence.total_cmp(&a.0.evidence));
        let (mut weighed, left): (Vec<Weighed<'a>>, Vec<Left>) = all.into_iter().unzip();
        share(&mut weighed);
        for own in &mut weighed {
            own.evidence -= bare;
        }
        Self { weighed, left, likelihood, left_over, bare }
    }

    /// Returns the best set and its held-out error.
    pub(crate) fn best(&self) -> Option<(&'a Fit, f64)> {
        Some((self.weighed.first()?.fit, self.left.first()?.error))
    }

    /// Returns the log evidence of a further set, on the scale of the others.
    pub(crate) fn evidence(&self, records: &Records<'_>, set: &Predicted<'_>) -> f64 {
        let powers = self.likelihood.powers(&records.residuals(set.followed));
        let price = records.price(set.followed, self.likelihood.worth(), self.left_over);
        Left { error: 0.0, powers, price }.evidence(&self.likelihood) - self.bare
    }
}

impl Left {
    fn evidence(&self, likelihood: &Likelihood) -> f64 {
        let all: Vec<usize> = (0..self.powers.len()).collect();
        likelihood.log_of(&self.powers, &all) - self.price
    }
}
