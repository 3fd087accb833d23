//! A handle on an effect that can be missing from a simulator and be fitted.

use crate::model::candidates::CandidateLaw;
pub(crate) use crate::model::candidates::{EvidenceClass, MainMode, Parameter};
use dynamics::{Class, Effect, SystemEffect};
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

impl Candidate {
    /// The handle on a law.
    pub(crate) const fn new(law: &'static dyn CandidateLaw) -> Self {
        Self(law)
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

    /// The candidate that it is at one of its own sizes. A set never holds both.
    pub(crate) fn generalizes(self) -> Option<Self> {
        self.0.generalizes().map(Self)
    }

    /// The simpler candidate that it tends to at an end of its shape, with the same first parameter.
    pub(crate) fn tends_to(self) -> Option<Self> {
        self.0.tends_to().map(Self)
    }
}
