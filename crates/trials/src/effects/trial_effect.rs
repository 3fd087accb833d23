//! Properties of an effect that trials use.

use super::effect_class::EffectClass;
use super::other_law::OtherLaw;
use super::size::Size;
use crate::hidden::Bank;
use crate::make::nuisances::Nuisance;
use dynamics::Effect;

/// Effect of the vocabulary as trials use it: the banks that hide it, the draw of its parameters, and its
/// class in scores.
#[derive(Clone, Copy)]
pub(crate) struct TrialEffect {
    /// Effect as defined by `dynamics`.
    pub(crate) effect: Effect,
    /// Class under which the effect is scored.
    pub(crate) class: EffectClass,
    /// Rule that derives its size from a detectability.
    pub(crate) size: Size,
    /// Banks that hide the effect, besides [`Bank::Single`], which hides every effect.
    ///
    /// - [`Bank::LeftOut`]: no other effect of the vocabulary is nearly the same, so with this effect left
    ///   out, `unknown` is the right answer. This excludes gravity and cubic stiffness, which can replace
    ///   each other; the dry frictions and hysteresis; stiffness drift and clock drift; a preload, which a
    ///   calibrated rest angle replaces; and effects that scatter values or timestamps, which look like
    ///   noise.
    /// - [`Bank::Releases`]: a second release adds information about the effect.
    /// - [`Bank::Measured`]: the effect can be placed under residuals of measured records, which have their
    ///   own timestamps.
    /// - [`Bank::Driven`]: the effect acts in driven records, unless it only acts in a release.
    /// - [`Bank::Stressed`]: the effect acts by [`other_law`](Self::other_law).
    pub(crate) banks: &'static [Bank],
    /// `true` if only a measured input reveals the effect.
    pub(crate) needs_input: bool,
    /// `true` if the effect moves the rest angle; recalibration must then leave the rest angle fixed.
    pub(crate) moves_rest_angle: bool,
    /// Nuisance, present in records of every bank, that does the same; it is omitted if the effect is hidden.
    pub(crate) nuisance: Option<Nuisance>,
    /// Law by which the effect acts in stressed and composite cases; `None` if it has none.
    pub(crate) other_law: Option<OtherLaw>,
    /// Effects that no composite case hides together with this one, because their contributions can hardly be
    /// separated.
    pub(crate) alike: &'static [Effect],
    /// Detectability, in noise units, at which the effect is distinguished from its closest rival in 19 of 20
    /// records, with one, two and three releases. Computed from the linearized law of a decay with 3.5 Hz and
    /// a damping ratio of 0.006, released at 40° (two releases: and 10°; three: 60°, 25°, 6°).
    pub(crate) separable: [f64; 3],
}

/// [`TrialEffect::separable`] of effects for which it has not been computed.
pub(crate) const SEPARABLE_OTHERWISE: [f64; 3] = [6.0; 3];

impl TrialEffect {
    /// Builds an effect that is only hidden alone, by the vocabulary's law; other properties are set by
    /// struct update.
    pub(crate) const fn new(effect: Effect, class: EffectClass, size: Size) -> Self {
        Self {
            effect,
            class,
            size,
            banks: &[],
            needs_input: false,
            moves_rest_angle: false,
            nuisance: None,
            other_law: None,
            alike: &[],
            separable: SEPARABLE_OTHERWISE,
        }
    }

    /// Returns the identifier in the vocabulary.
    pub(crate) const fn id(&self) -> &'static str {
        self.effect.id()
    }

    /// Returns `true` if a bank hides the effect.
    pub(crate) fn is_hidden_in(&self, bank: Bank) -> bool {
        bank == Bank::Single || self.banks.contains(&bank)
    }
}
