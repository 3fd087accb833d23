//! Gap budget as one stacked bar.

use results::BudgetShares;

use crate::format;
use crate::plot::Hue;

/// Smallest share whose stretch of the bar has room for its number.
const LEAST_LABELED: f64 = 0.08;
/// Smallest share that does not round to zero.
const LEAST_SHOWN: f64 = 5e-4;

/// One stretch of the bar.
pub(super) struct Share {
    /// Class of cause.
    pub(super) name: &'static str,
    /// Meaning of the class.
    pub(super) meaning: &'static str,
    /// Share in percent, as shown in the legend.
    pub(super) percent: String,
    /// Share, as the style sheet uses it.
    pub(super) grow: String,
    /// Style-sheet variable of the color.
    pub(super) hue: &'static str,
    /// `true` if there is room for the number.
    pub(super) labeled: bool,
}

/// Returns the classes that have a share, in the order of the documents; empty if recalibration leaves no
/// gap.
pub(super) fn shares(budget: &BudgetShares) -> Vec<Share> {
    [
        ("dissipative", "takes energy out of the motion", budget.dissipative, Hue::Estimate),
        ("conservative", "depends on position, gives its energy back", budget.conservative, Hue::Oracle),
        ("time-dependent", "drifts, forcing, delays", budget.time_dependent, Hue::Second),
        ("sensor", "distorts the values", budget.sensor, Hue::Third),
        ("clock", "distorts the times", budget.clock, Hue::Fourth),
    ]
    .into_iter()
    .filter(|(_, _, share, _)| share.is_finite() && *share >= LEAST_SHOWN)
    .map(|(name, meaning, share, hue)| Share {
        name,
        meaning,
        percent: format::quantity(&format::fixed(100.0 * share, 1), "%"),
        grow: format!("{share:.5}"),
        hue: hue.name(),
        labeled: share >= LEAST_LABELED,
    })
    .collect()
}
