//! The sets that a search has fitted.

use crate::data::segments::Data;
use crate::evidence::score::score;
use crate::fit::fitted::{Fit, Point};
use crate::model::candidate::{Candidate, MainMode};
use crate::model::hypothesis::Hypothesis;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Every set that was fitted, best fit of each.
#[derive(Debug, Clone, Default)]
pub(crate) struct Archive {
    pub(crate) fits: Vec<Fit>,
    /// Sets with a strength that ended at zero: the data have no use for it, or with the wrong sign.
    pub(crate) rejected: Vec<Vec<Candidate>>,
    /// Where fits have begun, to the bit: [`Self::is_new`].
    begun: BTreeSet<Vec<u64>>,
}

impl Archive {
    /// The calibrated simulator alone.
    pub(crate) fn of(calibrated: &Fit) -> Self {
        Self::from(vec![calibrated.clone()], Vec::new())
    }

    /// Some fits, and sets that were rejected.
    pub(crate) fn from(fits: Vec<Fit>, rejected: Vec<Vec<Candidate>>) -> Self {
        Self { fits, rejected, begun: BTreeSet::new() }
    }

    /// Whether no fit of so many steps at most has begun at a point yet: another one would end where that has.
    pub(crate) fn is_new(&mut self, hypothesis: &Hypothesis, point: &Point, steps: usize) -> bool {
        let ranks = hypothesis.ranks().into_iter().chain([steps]).map(|number| number as u64);
        let values = point.globals.iter().chain(point.starts.iter().flatten());
        self.begun.insert(ranks.chain(values.map(|value| value.to_bits())).collect())
    }

    /// Squares that a fit of a set has to come below to be of use: those that are known of it.
    pub(crate) fn known_squares(&self, hypothesis: &Hypothesis) -> f64 {
        self.find(&hypothesis.candidates).map_or(f64::INFINITY, |known| known.squares)
    }

    pub(crate) fn find(&self, candidates: &[Candidate]) -> Option<&Fit> {
        self.fits.iter().find(|fit| fit.hypothesis.candidates == candidates)
    }

    /// Whether the search was led by a set that is gone where every sample is `refined`, and has not looked around what is
    /// left: the sets of those that stay, and the candidates without what none of them holds.
    pub(crate) fn misled(
        &self,
        refined: &Self,
        candidates: &[Candidate],
    ) -> Option<(Vec<Fit>, Vec<Candidate>)> {
        let leader = &self.ranked(self.autocorrelation_time()).first().copied()?.hypothesis.candidates;
        if refined.find(leader).is_some() {
            return None;
        }
        let stays = |candidate: &Candidate| {
            refined.fits.iter().any(|fit| fit.hypothesis.candidates.contains(candidate))
        };
        let gone = |candidate: &Candidate| leader.contains(candidate) && !stays(candidate);
        let others: Vec<Candidate> =
            candidates.iter().copied().filter(|candidate| !gone(candidate)).collect();
        let known = self.fits.iter().filter(|fit| refined.find(&fit.hypothesis.candidates).is_some());
        let known: Vec<Fit> = known.filter(|fit| !fit.hypothesis.candidates.is_empty()).cloned().collect();
        (others.len() < candidates.len() && !known.is_empty()).then_some((known, others))
    }

    /// Takes a fit that is better than what is known of its set; a set with a vanished member is rejected.
    pub(crate) fn admit(&mut self, data: &Data, fit: Fit) {
        if vanished(data, &fit) {
            self.rejected.push(fit.hypothesis.candidates);
            return;
        }
        match self.fits.iter_mut().find(|known| known.hypothesis.candidates == fit.hypothesis.candidates) {
            Some(known) if fit.squares < known.squares => *known = fit,
            Some(_) => {}
            None => self.fits.push(fit),
        }
    }

    /// Takes a set out.
    pub(crate) fn reject(&mut self, candidates: &[Candidate]) {
        self.fits.retain(|known| known.hypothesis.candidates != candidates);
        self.rejected.push(candidates.to_vec());
    }

    /// The smallest autocorrelation time among the sets that fit nearly best: that of the richest adequate model.
    pub(crate) fn autocorrelation_time(&self) -> f64 {
        let best = self.fits.iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        best.map_or(1.0, Fit::autocorrelation_time)
    }

    /// Fits by the score that [`crate::evidence::score::score`] gives at an autocorrelation time, best first.
    pub(crate) fn ranked(&self, time: f64) -> Vec<&Fit> {
        let mut ranked: Vec<&Fit> = self.fits.iter().collect();
        ranked.sort_by(|a, b| score(b, time).total_cmp(&score(a, time)));
        ranked
    }

    /// The best of these scores.
    pub(crate) fn highest(&self, time: f64) -> f64 {
        self.fits.iter().map(|fit| score(fit, time)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Whether a member is not what its name says, beside the swing as it is fitted.
pub(crate) fn is_another(data: &Data, fit: &Fit) -> bool {
    let parts = fit.hypothesis.parts(&data.facts, &fit.point.globals);
    let mut members = fit.hypothesis.candidates.iter().zip(parts);
    let starts_once = data.segments.len() <= data.inputs.len();
    let (frequency, decay_rate, inertia) = match fit.hypothesis.swinging(&data.facts, &fit.point.globals) {
        Ok((nominal, stiffness)) => {
            let inertia = nominal.inertia();
            ((stiffness / inertia).max(0.0).sqrt(), 0.5 * nominal.damping() / inertia, inertia)
        }
        Err(_) => (data.facts.frequency, f64::INFINITY, data.facts.inertia),
    };
    let (resolution, repeats) = (TAU / data.facts.duration, data.facts.repeats);
    let swing = MainMode { frequency, decay_rate, inertia, resolution, starts_once, repeats };
    members.any(|(candidate, part)| !candidate.is_itself(part, &swing))
}

/// Members with a size at zero.
pub(crate) fn gone(data: &Data, fit: &Fit) -> Vec<Candidate> {
    let parts = fit.hypothesis.parts(&data.facts, &fit.point.globals);
    let members = fit.hypothesis.candidates.iter().zip(parts);
    let at_zero = |(candidate, part): &(&Candidate, &[f64])| {
        let parameters = candidate.parameters(&data.facts);
        parameters.iter().zip(*part).any(|(own, value)| own.strength && *value <= own.lower)
    };
    members.filter(at_zero).map(|(candidate, _)| *candidate).collect()
}

/// A size at zero, or a shape at which the candidate is a simpler one or another: it is not there.
pub(crate) fn vanished(data: &Data, fit: &Fit) -> bool {
    let parameters = fit.hypothesis.parameters(&data.facts);
    let calibrated = fit.hypothesis.calibrated.len();
    let mut own = parameters.iter().zip(&fit.point.globals).skip(calibrated);
    own.any(|(parameter, value)| (parameter.strength || parameter.simpler) && *value <= parameter.lower)
        || is_another(data, fit)
}

#[cfg(test)]
mod tests {
    use super::Archive;
    use crate::evidence::score::calibrated_swing;
    use crate::fit::fitted::Fit;
    use crate::model::candidate::Candidate;
    use crate::model::candidates::flexible_coupling::FlexibleCoupling;
    use crate::model::candidates::gravity::Gravity;
    use crate::model::candidates::quadratic_drag::QuadraticDrag;

    const GRAVITY: Candidate = Candidate::new(&Gravity);
    const SECOND_BODY: Candidate = Candidate::new(&FlexibleCoupling);

    #[test]
    fn a_search_led_by_what_does_not_stay_is_made_again_without_it() {
        let (_, base) = calibrated_swing();
        let set = |candidates: &[Candidate], part: f64| Fit {
            hypothesis: base.hypothesis.with(candidates),
            squares: part * base.squares,
            ..base.clone()
        };
        let (leader, other) = (set(&[GRAVITY, SECOND_BODY], 0.1), set(&[GRAVITY], 0.5));
        let pool = |fits: &[&Fit]| Archive::from(fits.iter().map(|fit| (*fit).clone()).collect(), Vec::new());
        let found = pool(&[&base, &leader, &other]);
        let all = [GRAVITY, SECOND_BODY, Candidate::new(&QuadraticDrag)];
        assert_eq!(found.misled(&pool(&[&base, &leader]), &all), None);
        let (known, others) = found.misled(&pool(&[&base, &other]), &all).unwrap();
        assert_eq!(known, [other]);
        assert_eq!(others, [all[0], all[2]]);
        assert_eq!(found.misled(&pool(&[&base]), &all), None, "there is nothing left to go on from");
    }
}
