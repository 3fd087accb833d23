//! Simpler diagnosers, used as baselines.

use crate::commands::diagnose::GivenCase;
use diagnosis::single_effect;
use trials::{WEAK_FORM, WEAK_FORM_METHOD, weak_form};

/// Simpler diagnoser: its id, a sentence about its method, and the effect that it names in a case, if any.
pub(super) struct Diagnoser {
    pub(super) id: &'static str,
    pub(super) method: &'static str,
    pub(super) names: fn(&GivenCase) -> Option<&'static str>,
}

/// All simpler diagnosers that use records.
pub(super) const DIAGNOSERS: &[Diagnoser] = &[
    Diagnoser {
        id: WEAK_FORM,
        method: WEAK_FORM_METHOD,
        names: |given| weak_form(&given.records, &given.nominal),
    },
    Diagnoser {
        id: "single-effect-bic",
        method: "every effect alone, fitted beside the calibration in segments of six periods; the smallest Bayesian \
                 information criterion for white noise",
        names: |given| single_effect(&given.observations, &given.nominal).ok().flatten(),
    },
];
