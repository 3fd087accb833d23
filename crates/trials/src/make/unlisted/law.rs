//! What trials know of a law outside the vocabulary.

use crate::effects::EffectClass;
use crate::make::draws::Draws;
use crate::make::open_law::OpenLaw;
use crate::make::recalibration::Absorbed;
use crate::make::situation::Situation;

/// A law outside the vocabulary.
#[derive(Clone, Copy)]
pub(crate) struct UnlistedLaw {
    /// Its name in hidden truths.
    pub(crate) name: &'static str,
    /// The class of effects that it belongs to by its mechanism, if to one.
    pub(crate) class: Option<EffectClass>,
    /// What the vocabulary nearest to it absorbs beside a recalibration, where a case hides it alone; `None` where none does.
    pub(crate) alone: Option<Absorbed>,
    /// Draws its shape for a system, and says it in words.
    pub(crate) draw: fn(&Situation, &mut Draws) -> (OpenLaw, String),
}
