//! Judgment: probabilities of the classes of effects, and the set that represents the probable ones.

use super::{Measured, Refined, Request};
use crate::answer::EffectClass;
use crate::error::DiagnosisError;
use crate::evidence::context::{Context, Held, Shift};
use crate::evidence::half_swings::half_swings;
use crate::evidence::inclusion::{Inclusion, asked};
use crate::evidence::weighed_sets::Records;
use crate::explain::conclusion::likely;
use crate::fit::fitted::Fit;
use crate::sets::weights::Weighed;
use std::cell::OnceCell;

/// Log evidence in nats by which the set of all likely classes may predict worse than the best set of some of
/// them.
const WORSE: f64 = 3.0;

/// Log evidence in nats by which the best set of likely classes alone may lie behind the best set. Beyond that the
/// simulator needs the other effects of that set, though none of them is likely by itself.
const BEHIND: f64 = 30.0;

/// Classes with their probabilities, and the repaired simulator.
pub(crate) struct Judged<'a> {
    pub(crate) inclusion: Inclusion<'a>,
    pub(crate) classes: Vec<EffectClass>,
    pub(crate) held: Held<'a>,
    /// Constant torque that explains the whole recalibration.
    pub(crate) shift: Option<Shift>,
    /// `true` if a constant torque would explain a part of the recalibration as well.
    pub(crate) is_shifted: bool,
}

impl<'a> Judged<'a> {
    /// Judges the refined sets. `completed` holds a set that no search has tried: that of all likely classes.
    pub(crate) fn of(
        request: &Request<'a>,
        measured: &Measured,
        refined: &'a Refined,
        work: &Context<'a>,
        completed: &'a OnceCell<Fit>,
    ) -> Result<Self, DiagnosisError> {
        let segments = &refined.segments;
        let mut predictions = work.predictions(&asked(&refined.weighed()))?;
        let bare = refined.archive.find(&[]).unwrap_or(&refined.base.calibrated);
        let vocabulary = refined.candidates.len();
        let inclusion =
            Inclusion::of(Records { data: &refined.data, segments, bare, vocabulary }, &predictions)?;
        let frequency = request.simulator.angular_frequency();
        let witness = half_swings(request.records, &measured.free, frequency);
        let classes = inclusion.classes(witness.as_ref(), &request.settings.seed);
        let names = likely(&classes);
        let within = inclusion.within(&names);
        // If no set is within these classes, nothing is named; evidence is relative to the set without effects.
        let (mut chosen, least) = match within {
            Some(w) => (w.fit.hypothesis.candidates.clone(), w.evidence - WORSE),
            None => (Vec::new(), -WORSE),
        };
        if let Some(fit) = inclusion.completed(&refined.data, &names) {
            let set = work.predicted(completed.get_or_init(|| fit));
            if let Some(set) = set.filter(|set| inclusion.evidence(set) > least) {
                chosen.clone_from(&set.followed.hypothesis.candidates);
                predictions.sets.push(set);
            }
        }
        let own = inclusion.sets.weighed.iter().find(|w| w.fit.hypothesis.candidates == chosen);
        let holds_all = |w: &&Weighed<'_>| {
            names.iter().all(|id| w.fit.hypothesis.counted().any(|own| own.evidence_class().id() == *id))
        };
        let fuller = inclusion.sets.weighed.first().filter(holds_all).filter(|_| !names.is_empty());
        if let (Some(own), Some(fuller)) = (own, fuller)
            && fuller.evidence - own.evidence > BEHIND
        {
            chosen.clone_from(&fuller.fit.hypothesis.candidates);
        }
        let held = work.held_out(predictions, &chosen)?;
        let has_one = chosen.iter().any(|own| own.id() == "constant_torque");
        let considers = request.settings.considers("constant_torque") && !has_one;
        let shift = if considers { work.shift(held.repaired) } else { None };
        let is_shifted = considers && chosen.is_empty() && work.moves_the_rest(held.repaired);
        Ok(Self { inclusion, classes, held, shift, is_shifted })
    }
}
