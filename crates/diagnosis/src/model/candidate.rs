//! A handle on an effect that can be missing from a simulator and be fitted.

use crate::data::scales::Scales;
use crate::model::candidates::{self, CandidateLaw};
pub(crate) use crate::model::candidates::{EvidenceClass, MainMode, Parameter};
use dynamics::{Active, Class, Effect, NominalSimulator, SystemEffect};
use record::Quantity;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Deref;

/// An effect that can be fitted: its [`CandidateLaw`], and its place in the registry.
///
/// Two candidates are equal where their effects are; there is one law for each effect.
#[derive(Clone, Copy)]
pub(crate) struct Candidate(&'static dyn CandidateLaw);

impl Deref for Candidate {
    type Target = dyn CandidateLaw;

    fn deref(&self) -> &Self::Target {
        self.0
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.effect() == other.effect()
    }
}

impl Eq for Candidate {}

impl Hash for Candidate {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.effect().hash(state);
    }
}

impl fmt::Debug for Candidate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

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
    pub(crate) const UNNAMED: Self = Self::new(&candidates::PositionTorque);

    /// A damping and a stiffness of higher order, whatever their causes. They are none of the candidates for a name either.
    pub(crate) const UNLISTED: [Self; 2] =
        [Self::new(&candidates::UnlistedDamping), Self::new(&candidates::UnlistedStiffness)];

    /// What is no candidate for a name.
    pub(crate) const NAMELESS: [Self; 3] = [Self::UNNAMED, Self::UNLISTED[0], Self::UNLISTED[1]];

    /// The handle on a law.
    pub(crate) const fn new(law: &'static dyn CandidateLaw) -> Self {
        Self(law)
    }

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

    /// The public id.
    pub(crate) fn id(self) -> &'static str {
        self.effect().id()
    }

    /// Its part of a gap budget.
    pub(crate) fn class(self) -> Class {
        self.effect().description().class
    }

    /// The effect in the system; none for one of the measuring chain.
    pub(crate) fn system(self) -> Option<SystemEffect> {
        match self.effect() {
            Effect::System(effect) => Some(effect),
            Effect::MeasuringChain(_) => None,
        }
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

#[cfg(test)]
#[path = "candidate_tests.rs"]
mod tests;
