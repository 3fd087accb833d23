//! What trials know of an effect.

use super::effect_class::EffectClass;
use super::other_law::OtherLaw;
use super::size::Size;
use crate::hidden::Bank;
use crate::make::nuisances::Nuisance;
use dynamics::Effect;

/// What trials know of an effect of the vocabulary: where it is hidden, how it is drawn, what it is scored as.
#[derive(Clone, Copy)]
pub(crate) struct TrialEffect {
    /// The effect, as `dynamics` has it.
    pub(crate) effect: Effect,
    /// The class that it is scored under.
    pub(crate) class: EffectClass,
    /// How its size follows from a detectability.
    pub(crate) size: Size,
    /// Banks that hide it beside [`Bank::Single`], which hides every effect.
    ///
    /// - [`Bank::LeftOut`]: nothing else in the vocabulary is nearly the same thing, so that with it left out `unknown` is
    ///   the right answer. Not so of gravity and cubic stiffness, which replace one another, the dry frictions and
    ///   hysteresis, stiffness drift and clock drift, a preload and a calibrated rest angle, and of what scatters values or
    ///   stamps and is noise to whoever knows no better.
    /// - [`Bank::Releases`]: a second release tells something about it.
    /// - [`Bank::Measured`]: it is laid under residuals of measured records, whose stamps are their own.
    /// - [`Bank::Driven`]: it acts in driven records, wherever its place of action is no release.
    /// - [`Bank::Stressed`]: it acts by [`other_law`](Self::other_law).
    pub(crate) banks: &'static [Bank],
    /// Whether a measured input shows it and nothing else does.
    pub(crate) needs_input: bool,
    /// Whether it moves the rest angle, which no recalibration may make up for then.
    pub(crate) moves_rest_angle: bool,
    /// What comes with records of every bank and does the same; it is left out where the effect is hidden.
    pub(crate) nuisance: Option<Nuisance>,
    /// The law by which it acts in stressed and composite cases.
    pub(crate) other_law: Option<OtherLaw>,
    /// Effects that no composite case hides beside it: their sum has hardly two sides.
    pub(crate) alike: &'static [Effect],
    /// Size in noise units at which it is told from its closest rival in 19 of 20 records, with one, two and three
    /// releases; from the linearized law of a decay of 3.5 Hz with a damping ratio of 0.006, released at 40° (and
    /// 10°; at 60°, 25°, 6°).
    pub(crate) separable: [f64; 3],
}

/// [`TrialEffect::separable`] of an effect for which it is not worked out.
pub(crate) const SEPARABLE_OTHERWISE: [f64; 3] = [6.0; 3];

impl TrialEffect {
    /// An effect that is hidden alone only, by the vocabulary's law; struct update says what more there is to it.
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

    /// Its id in the vocabulary.
    pub(crate) const fn id(&self) -> &'static str {
        self.effect.id()
    }

    /// Whether a bank hides it.
    pub(crate) fn is_hidden_in(&self, bank: Bank) -> bool {
        bank == Bank::Single || self.banks.contains(&bank)
    }
}
