//! Handle on an effect that a simulator may lack and a fit can add.

use crate::model::candidates::CandidateLaw;
pub(crate) use crate::model::candidates::{EvidenceClass, MainMode, Parameter};
use dynamics::{Class, Effect, SystemEffect};
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Deref;

/// Effect that can be fitted: a handle on its [`CandidateLaw`].
///
/// Two candidates are equal if their laws are. An effect may have a second law, which generalizes the first: a set
/// never holds both.
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
        self.0.type_id() == other.0.type_id()
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
    /// Creates the handle on a law.
    pub(crate) const fn new(law: &'static dyn CandidateLaw) -> Self {
        Self(law)
    }

    /// Returns the public id.
    pub(crate) fn id(self) -> &'static str {
        self.effect().id()
    }

    /// Returns the class of the gap budget that the effect belongs to.
    pub(crate) fn class(self) -> Class {
        self.effect().description().class
    }

    /// Returns the effect of the system; `None` for an effect of the measurement chain.
    pub(crate) fn system(self) -> Option<SystemEffect> {
        match self.effect() {
            Effect::System(effect) => Some(effect),
            Effect::MeasuringChain(_) => None,
        }
    }

    /// Returns the candidate that this one becomes at one of its own sizes. A set never holds both.
    pub(crate) fn generalizes(self) -> Option<Self> {
        self.0.generalizes().map(Self)
    }

    /// Returns `true` if the candidate is a further law of the effect that it generalizes.
    pub(crate) fn refines(self) -> bool {
        self.generalizes().is_some_and(|simpler| simpler.effect() == self.effect())
    }

    /// Returns the simpler candidate that this one tends to at an end of its shape, with the same first
    /// parameters.
    pub(crate) fn tends_to(self) -> Option<Self> {
        self.0.tends_to().map(Self)
    }
}
