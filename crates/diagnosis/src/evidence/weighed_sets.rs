//! Sets of effects weighed by their residuals.
//!
//! If something is left that no law explains, sets are weighed by their held-out predictions: an effect that
//! absorbs a left-over in one part of a record does not predict the next one. But such predictions contain
//! the errors of coefficients fitted to half of the records, and two sets that leave the same noise can
//! differ by a hundred nats. So if nothing is left, sets are weighed by the residuals of the samples that
//! they were fitted to, and pay for their parameters.

use crate::data::segments::Data;
use crate::evidence::context::Predicted;
use crate::evidence::held_out::HeldOut;
use crate::evidence::likelihood::{BANDS, Likelihood, View};
use crate::evidence::score::{further_starts, parameter_price};
use crate::evidence::weights::{Weighed, price, share};
use crate::fit::fitted::Fit;
use crate::noise::floor;
use nalgebra::DVector;

/// Residuals that sets are weighed by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Basis {
    /// Held-out residuals.
    HeldOut,
    /// Residuals of the samples that the sets were fitted to.
    Fitted,
}

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
    /// Price of the set's effects and, for [`Basis::Fitted`], of its parameters, in nats.
    pub(crate) price: f64,
}

/// Sets with their evidence, best first, and the residual of each.
pub(crate) struct WeighedSets<'a> {
    pub(crate) weighed: Vec<Weighed<'a>>,
    pub(crate) left: Vec<Left>,
    pub(crate) likelihood: Likelihood,
    basis: Basis,
    /// Probability that something is left beside the best set.
    pub(crate) left_over: f64,
    /// Log evidence of the recalibrated simulator; the evidence of all sets is relative to it.
    bare: f64,
}

impl Basis {
    /// Returns the residuals of a set by segment.
    fn residuals(self, records: &Records<'_>, set: &Fit, held_out: &HeldOut) -> Vec<DVector<f64>> {
        match self {
            Self::HeldOut => held_out.residuals.clone(),
            Self::Fitted => records.data.by_part(&set.residuals),
        }
    }

    /// Returns the view of the residuals. If nothing is left, no line rises above the noise, so no taper is
    /// needed.
    fn view(self) -> View {
        match self {
            Self::HeldOut => View::Tapered,
            Self::Fitted => View::Whole,
        }
    }

    /// Returns the price of a set in nats.
    fn price(self, records: &Records<'_>, set: &Fit, worth: f64, left_over: f64) -> f64 {
        let effects = price(records.segments, set, records.vocabulary, left_over);
        let parameters = set.globals().saturating_sub(records.bare.globals()) + further_starts(set);
        match self {
            Self::HeldOut => effects,
            Self::Fitted => effects + parameter_price(parameters, worth),
        }
    }
}

impl<'a> WeighedSets<'a> {
    /// Weighs sets as if nothing were left; the last of `sets` is the recalibrated simulator.
    pub(crate) fn of(records: &Records<'_>, sets: &[(&'a Fit, &HeldOut)], basis: Basis) -> Self {
        let residuals: Vec<Vec<DVector<f64>>> =
            sets.iter().map(|(fit, held)| basis.residuals(records, fit, held)).collect();
        let square = |own: &&Vec<DVector<f64>>| own.iter().map(DVector::norm_squared).sum::<f64>();
        let closest = residuals.iter().min_by(|a, b| square(a).total_cmp(&square(b)));
        // Without sets there are no residuals.
        let closest = closest.map(Vec::as_slice).unwrap_or_default();
        let noise = floor::floor(records.segments, closest).value;
        let likelihood = Likelihood::of(records.segments, closest, noise, basis.view());
        let of = |((fit, held), own): (&(&'a Fit, &HeldOut), &Vec<DVector<f64>>)| {
            let powers = likelihood.powers(own);
            let left = Left { error: held.mean_square().sqrt(), powers, price: 0.0 };
            (Weighed { fit, evidence: 0.0, probability: 0.0 }, left)
        };
        let (weighed, left) = sets.iter().zip(&residuals).map(of).unzip();
        Self { weighed, left, likelihood, basis, left_over: 0.0, bare: 0.0 }.priced(records, 0.0)
    }

    /// Returns the same sets with their prices for a given probability of a left-over.
    pub(crate) fn priced(self, records: &Records<'_>, left_over: f64) -> Self {
        let Self { weighed, left, likelihood, basis, .. } = self;
        let mut all: Vec<(Weighed<'a>, Left)> = weighed.into_iter().zip(left).collect();
        for (own, left) in &mut all {
            left.price = basis.price(records, own.fit, likelihood.worth(), left_over);
            own.evidence = left.evidence(&likelihood);
        }
        let is_bare = |own: &&(Weighed<'_>, Left)| std::ptr::eq(own.0.fit, records.bare);
        // Evidence is relative to the bare set, which is one of them.
        let bare = all.iter().find(is_bare).map_or(0.0, |bare| bare.0.evidence);
        all.sort_by(|a, b| b.0.evidence.total_cmp(&a.0.evidence));
        let (mut weighed, left): (Vec<Weighed<'a>>, Vec<Left>) = all.into_iter().unzip();
        share(&mut weighed);
        for own in &mut weighed {
            own.evidence -= bare;
        }
        Self { weighed, left, likelihood, basis, left_over, bare }
    }

    /// Returns the best set and its held-out error.
    pub(crate) fn best(&self) -> Option<(&'a Fit, f64)> {
        Some((self.weighed.first()?.fit, self.left.first()?.error))
    }

    /// Returns the log evidence of a further set, on the scale of the others.
    pub(crate) fn evidence(&self, records: &Records<'_>, set: &Predicted<'_>) -> f64 {
        let residuals = self.basis.residuals(records, set.followed, &set.after);
        let powers = self.likelihood.powers(&residuals);
        let price = self.basis.price(records, set.followed, self.likelihood.worth(), self.left_over);
        Left { error: 0.0, powers, price }.evidence(&self.likelihood) - self.bare
    }
}

impl Left {
    fn evidence(&self, likelihood: &Likelihood) -> f64 {
        let all: Vec<usize> = (0..self.powers.len()).collect();
        likelihood.log_of(&self.powers, &all) - self.price
    }
}
