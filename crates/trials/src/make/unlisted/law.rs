//! Properties of laws outside the vocabulary that trials use.

use crate::effects::EffectClass;
use crate::make::draws::Draws;
use crate::make::open_law::OpenLaw;
use crate::make::recalibration::Absorbed;
use crate::make::situation::Situation;

/// Law outside the vocabulary.
#[derive(Clone, Copy)]
pub(crate) struct UnlistedLaw {
    /// Name used in hidden truths.
    pub(crate) name: &'static str,
    /// Class of effects to which the law belongs by its mechanism; `None` if to none.
    pub(crate) class: Option<EffectClass>,
    /// Quantities that the nearest effects of the vocabulary absorb, besides a recalibration, if a case hides
    /// the law alone; `None` if no case does.
    pub(crate) alone: Option<Absorbed>,
    /// Draws the law's shape for a system, with a description.
    pub(crate) draw: fn(&Situation, &mut Draws) -> (OpenLaw, String),
}
