//! Vocabulary: every candidate in the registry's order, and relations among them.

use crate::data::scales::Scales;
use crate::model::candidate::{Candidate, EvidenceClass};
use crate::model::candidates::{self, PositionTorque, UnlistedDamping, UnlistedStiffness};
use dynamics::{Active, Class, Effect, NominalSimulator};
use record::Quantity;

/// Returns the id of the class that the effect with a public id belongs to. A class holds effects that act
/// alike: `friction`, `restoring`, `damping`, `play`, `drift`, `second_body`, `forcing`, `preload`,
/// `actuator`, `sensor` or `stamps`. `None` for ids outside the vocabulary.
#[must_use]
pub fn evidence_class(id: &str) -> Option<&'static str> {
    let effect = Effect::find(id).ok().filter(|effect| !dynamics::UNNAMED.contains(effect))?;
    EvidenceClass::of(effect).map(EvidenceClass::id)
}

/// Returns `true` if the effect with a public id is flexible: it can act anywhere on a record and absorb what
/// no law explains, such as a stop at any deflection, a line at any frequency, or a drift at any time.
/// `false` for effects that no fit includes.
#[must_use]
pub fn is_flexible(id: &str) -> bool {
    Candidate::find(id).is_some_and(|candidate| candidate.is_flexible())
}

impl Candidate {
    /// Every candidate, in the vocabulary's order.
    pub(crate) const ALL: &'static [Self] = candidates::REGISTRY;

    /// Torque along the position, whatever its cause. It is not a candidate for a name.
    pub(crate) const UNNAMED: Self = Self::new(&PositionTorque);

    /// Damping and stiffness of higher order, whatever their causes. They are not candidates for a name
    /// either.
    pub(crate) const UNLISTED: [Self; 2] = [Self::new(&UnlistedDamping), Self::new(&UnlistedStiffness)];

    /// All laws that are not candidates for a name.
    pub(crate) const NAMELESS: [Self; 3] = [Self::UNNAMED, Self::UNLISTED[0], Self::UNLISTED[1]];

    /// Returns the candidate with a public id.
    fn find(id: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|candidate| candidate.id() == id)
    }

    /// Returns the law that fits an effect, with a name or without one; `None` if no fit includes it.
    pub(crate) fn that_fits(effect: Effect) -> Option<Self> {
        Self::ALL.iter().chain(&Self::NAMELESS).copied().find(|candidate| candidate.effect() == effect)
    }

    /// Returns the candidate's position in [`Self::ALL`], followed by that in [`Self::NAMELESS`].
    pub(crate) fn rank(self) -> usize {
        let mut all = Self::ALL.iter().chain(&Self::NAMELESS);
        all.position(|other| *other == self).unwrap_or(Self::ALL.len())
    }

    /// Returns the candidate for a stated effect, with the law's parameters that a fit can move; `None` for
    /// effects of the measurement chain that change no value smoothly.
    pub(crate) fn of(active: &Active) -> Option<(Self, Vec<f64>)> {
        let all = Self::ALL.iter().chain(&Self::NAMELESS).copied();
        let mut fits = all.filter(|candidate| candidate.effect() == active.effect());
        fits.find_map(|candidate| Some((candidate, candidate.stated(active)?)))
    }

    /// Returns every candidate that can act on these records and that the nominal simulator does not have
    /// already.
    pub(crate) fn that_apply(facts: &Scales, quantity: Quantity, simulator: &NominalSimulator) -> Vec<Self> {
        let known: Vec<Self> =
            simulator.effects().iter().filter_map(|own| Some(Self::of(&own.active)?.0)).collect();
        let is_known = |own: &Self| {
            known.iter().any(|known| known.effect() == own.effect() || known.generalizes() == Some(*own))
        };
        let all = Self::ALL.iter().copied().filter(|own| !is_known(own));
        let applies = |own: &Self| own.is_observed_in(quantity) && own.applies(facts, simulator.nominal());
        all.filter(applies).collect()
    }

    /// Returns the candidates that this one is easily confused with; they are fitted wherever it is.
    ///
    /// The relation holds in both directions, whichever of the two files states it. An effect of the sensor
    /// on values is fitted beside an effect of the system only if the latter's file says so.
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
    /// Returns the classes of the candidates that count in a set, each once, in order of appearance.
    pub(crate) fn among<'a>(candidates: impl IntoIterator<Item = &'a Candidate>) -> Vec<Self> {
        let mut classes = Vec::new();
        for own in candidates.into_iter().filter(|own| own.counts()) {
            if !classes.contains(&own.evidence_class()) {
                classes.push(own.evidence_class());
            }
        }
        classes
    }

    /// Returns the class of an effect: the one in its candidate's file or, for an effect of the measurement
    /// chain that no fit includes, the one for its class of the gap budget; `None` for an effect of the
    /// system that no fit includes.
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
