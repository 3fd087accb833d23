//! The gap budget as one stacked bar.

use results::BudgetShares;

use crate::format;
use crate::plot::Hue;

/// Below this share a stretch of the bar has no room for its number.
const LEAST_LABELED: f64 = 0.08;
/// A share below this rounds to zero.
const LEAST_SHOWN: f64 = 5e-4;

/// One stretch of the bar.
pub(super) struct Share {
    /// The class of cause.
    pub(super) name: &'static str,
    /// What it means.
    pub(super) meaning: &'static str,
    /// The share in percent, as it stands in the legend.
    pub(super) percent: String,
    /// The share, as the style sheet has it.
    pub(super) grow: String,
    /// The style sheet's variable of its color.
    pub(super) hue: &'static str,
    /// Whether there is room for the number.
    pub(super) labeled: bool,
}

/// The classes that have a share, in the order of the documents; none where recalibration leaves no gap.
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
