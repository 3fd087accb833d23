//! The vocabulary: every candidate in the registry's order, and what is asked of all of them.

use crate::data::scales::Scales;
use crate::model::candidate::{Candidate, EvidenceClass};
use crate::model::candidates::{self, PositionTorque, UnlistedDamping, UnlistedStiffness};
use dynamics::{Active, Class, Effect, NominalSimulator};
use record::Quantity;

/// Whether an effect has a hidden motion of its own whose start is fitted with the record's.
#[must_use]
pub fn has_fitted_hidden_start(id: &str) -> bool {
    Candidate::find(id).is_some_and(|candidate| candidate.free_hidden() > 0)
}

/// Id of the class of effects that explain alike to which the effect with a public id belongs: `friction`, `restoring`,
/// `damping`, `play`, `drift`, `second_body`, `forcing`, `preload`, `actuator`, `sensor` or `stamps`; none for ids outside
/// the vocabulary.
#[must_use]
pub fn evidence_class(id: &str) -> Option<&'static str> {
    let effect = Effect::find(id).ok().filter(|effect| !dynamics::UNNAMED.contains(effect))?;
    EvidenceClass::of(effect).map(EvidenceClass::id)
}

/// Whether the effect with a public id can sit where it likes on a record and soak up what no law explains: a stop at any
/// deflection, a line at any frequency, a drift at any time. False for effects that no fit follows.
#[must_use]
pub fn is_flexible(id: &str) -> bool {
    Candidate::find(id).is_some_and(|candidate| candidate.is_flexible())
}

impl Candidate {
    /// Every candidate, in the vocabulary's order.
    pub(crate) const ALL: &'static [Self] = candidates::REGISTRY;

    /// A torque along the position, whatever its cause. It is none of the candidates for a name.
    pub(crate) const UNNAMED: Self = Self::new(&PositionTorque);

    /// A damping and a stiffness of higher order, whatever their causes. They are none of the candidates for a name either.
    pub(crate) const UNLISTED: [Self; 2] = [Self::new(&UnlistedDamping), Self::new(&UnlistedStiffness)];

    /// What is no candidate for a name.
    pub(crate) const NAMELESS: [Self; 3] = [Self::UNNAMED, Self::UNLISTED[0], Self::UNLISTED[1]];

    /// The candidate with a public id.
    fn find(id: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|candidate| candidate.id() == id)
    }

    /// The law that fits an effect, with a name or without one; none where no fit follows it.
    pub(crate) fn that_fits(effect: Effect) -> Option<Self> {
        Self::ALL.iter().chain(&Self::NAMELESS).copied().find(|candidate| candidate.effect() == effect)
    }

    /// Its place in [`Self::ALL`], and behind all of these in [`Self::NAMELESS`].
    pub(crate) fn rank(self) -> usize {
        let mut all = Self::ALL.iter().chain(&Self::NAMELESS);
        all.position(|other| *other == self).unwrap_or(Self::ALL.len())
    }

    /// What an effect is to a fit, with the law's parameters that a fit can move; none for effects of the measuring chain
    /// that change no value smoothly.
    pub(crate) fn of(active: &Active) -> Option<(Self, Vec<f64>)> {
        let candidate = Self::that_fits(active.effect())?;
        Some((candidate, candidate.stated(active)?))
    }

    /// Every candidate that can act on these records and that the nominal simulator does not have already.
    pub(crate) fn that_apply(facts: &Scales, quantity: Quantity, simulator: &NominalSimulator) -> Vec<Self> {
        let known: Vec<Self> =
            simulator.effects().iter().filter_map(|own| Some(Self::of(&own.active)?.0)).collect();
        let is_known =
            |own: &Self| known.iter().any(|known| known == own || known.generalizes() == Some(*own));
        let all = Self::ALL.iter().copied().filter(|own| !is_known(own));
        let applies = |own: &Self| own.is_observed_in(quantity) && own.applies(facts, simulator.nominal());
        all.filter(applies).collect()
    }

    /// What it is easily confused with: those are fitted wherever it is.
    ///
    /// The relation holds in both directions, whichever of the two files states it. What a sensor does to values is fitted
    /// beside an effect of the system only where that effect's file says so.
    pub(crate) fn confused_with(self) -> Vec<Self> {
        let stated = self.resembles().iter().filter_map(|id| Self::find(id));
        let states_it = |other: &Self| other.system().is_some() && other.resembles().contains(&self.id());
        let reverse = Self::ALL.iter().copied().filter(states_it);
        let mut all: Vec<Self> = stated.chain(reverse).filter(|other| *other != self).collect();
        all.sort_by_key(|other| other.rank());
        all.dedup();
        all
    }
}

impl EvidenceClass {
    /// The classes of candidates that take a place in a set, each once, in the order in which they come.
    pub(crate) fn among<'a>(candidates: impl IntoIterator<Item = &'a Candidate>) -> Vec<Self> {
        let mut classes = Vec::new();
        for own in candidates.into_iter().filter(|own| own.counts()) {
            if !classes.contains(&own.evidence_class()) {
                classes.push(own.evidence_class());
            }
        }
        classes
    }

    /// The class of an effect: what its candidate's file says, or, for an effect of the measuring chain that no fit
    /// follows, what its part of a gap budget says; none for an effect of the system that no fit follows.
    pub(crate) fn of(effect: Effect) -> Option<Self> {
        if let Some(candidate) = Candidate::that_fits(effect) {
            return Some(candidate.evidence_class());
        }
        match effect.description().class {
            Class::Clock => Some(Self::Stamps),
            Class::Sensor => Some(Self::Sensor),
            Class::Dissipative | Class::Conservative | Class::TimeDependent => None,
        }
    }
}

#[cfg(test)]
#[path = "vocabulary_tests.rs"]
mod tests;
