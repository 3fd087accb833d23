//! Candidate effects, and the samples on which sets of them are searched.

use super::{Measured, Request};
use crate::data::segments::Data;
use crate::error::DiagnosisError;
use crate::fit::calibrate::{Baseline, baseline, best_hold};
use crate::fit::fitted::Fit;
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::linear::dictionary::Dictionary;
use crate::model::candidate::Candidate;
use crate::residual::floor;
use crate::search::asked::Asked;
use crate::search::null;
use crate::search::weak_form::Proposed;
use dynamics::{Hold, Input};

/// Largest number of laws in a set that the weak form proposes.
const LARGEST: usize = 4;

/// Recalibrated simulator, and the effects that it may lack.
pub(crate) struct Question {
    pub(crate) data: Data,
    pub(crate) base: Baseline,
    pub(crate) candidates: Vec<Candidate>,
    /// Sets of each effect's first law, of up to `largest` effects, that the weak form proposes on all samples.
    pub(crate) proposed: Proposed,
    largest: usize,
    /// Number of input samples per knot of the input, on the coarse samples.
    knots: usize,
    /// Data with fewer samples and fewer knots of the input. `coarse_base` is the recalibrated simulator on
    /// them.
    pub(crate) coarse: Data,
    pub(crate) coarse_base: Fit,
    /// Increase of the score that an additional effect has to bring on the coarse samples.
    pub(crate) enough: f64,
}

impl Question {
    /// Creates the question. `hold` is the behavior of the input between its samples, if it is known already;
    /// otherwise the better one is chosen.
    pub(crate) fn of(
        request: &Request<'_>,
        measured: &Measured,
        hold: Option<Hold>,
    ) -> Result<Self, DiagnosisError> {
        let (simulator, settings) = (request.simulator, request.settings);
        let (data, base) = match hold {
            Some(hold) => {
                let data = measured.data.holding(hold)?;
                let base = baseline(&data, simulator)?;
                (data, base)
            }
            None => best_hold(&measured.data, simulator)?,
        };
        let data = data.for_noise(floor::floor(&data, &base.calibrated.residuals).value);
        let mut candidates = Candidate::that_apply(&data.facts, data.quantity, simulator);
        candidates.retain(|candidate| settings.considers(candidate.id()));
        let knots = data.spare_knots(&base.calibrated);
        Self::on(request, data, base, candidates, knots)
    }

    /// Creates the question on coarse samples, with one knot of the input per `knots` samples.
    fn on(
        request: &Request<'_>,
        data: Data,
        base: Baseline,
        candidates: Vec<Candidate>,
        knots: usize,
    ) -> Result<Self, DiagnosisError> {
        let coarse = data.with_fewer_knots(knots).strided();
        let known = &base.calibrated;
        let coarse_base = fit(&coarse, &known.hypothesis, known.point.clone(), Moving::All, Stopping::FINAL)?;
        let dictionary = Dictionary::at(&coarse, &coarse_base, &candidates)?;
        let settings = request.settings;
        let threshold = null::threshold(&dictionary, settings.false_alarm, &settings.seed);
        // On fewer samples a gain is smaller by this factor; the search must not stop for that reason.
        let finer = data.samples() as f64 / coarse.samples().max(1) as f64;
        let enough = 0.5 * threshold / finer;
        let largest = LARGEST.min(settings.most_effects);
        let first: Vec<Candidate> = candidates.iter().copied().filter(|own| !own.refines()).collect();
        let proposed = Proposed::of(&data, &base.calibrated, &first, largest);
        Ok(Self { data, base, candidates, proposed, largest, knots, coarse, coarse_base, enough })
    }

    /// Returns the sets with further laws of effects that the weak form proposes on all samples.
    pub(crate) fn refined(&self) -> Proposed {
        let all = Proposed::of(&self.data, &self.base.calibrated, &self.candidates, self.largest);
        all.with_members(|own| own.refines())
    }

    /// Returns the same question with more knots of the input, as many as a set needs that was found with
    /// fewer; `by` is the number of segments joined into one shooting interval. `None` if the present knots
    /// are enough.
    pub(crate) fn finer(
        &self,
        request: &Request<'_>,
        by: usize,
        set: &Fit,
    ) -> Result<Option<Self>, DiagnosisError> {
        let joined = self.data.joined(by);
        if self.knots == 1 || !joined.spoils(self.knots, set) {
            return Ok(None);
        }
        let knots = joined.spare_knots(set).min(self.knots / 2);
        let finer = Self::on(request, self.data.clone(), self.base.clone(), self.candidates.clone(), knots);
        finer.map(Some)
    }

    /// Returns what a search for sets of up to `most_effects` effects is asked, on the coarse samples.
    pub(crate) fn asked(&self, most_effects: usize) -> Asked<'_> {
        Asked {
            data: &self.coarse,
            calibrated: &self.coarse_base,
            candidates: &self.candidates,
            proposed: &self.proposed,
            most_effects,
            threshold: self.enough,
        }
    }

    /// Returns the behavior of the input between its samples; `None` without an input.
    pub(crate) fn hold(&self) -> Option<Hold> {
        self.data.inputs.iter().flatten().map(Input::hold).next()
    }

    /// Returns the other possible behaviors of the input between its samples.
    pub(crate) fn other_holds(&self) -> impl Iterator<Item = Hold> + use<> {
        let own = self.hold();
        Hold::ALL.into_iter().filter(move |hold| own.is_some_and(|own| own != *hold))
    }
}
