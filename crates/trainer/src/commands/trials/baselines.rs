//! Simpler diagnosers, one line each.

use crate::commands::diagnose::GivenCase;
use diagnosis::single_effect;
use trials::{WEAK_FORM, WEAK_FORM_METHOD, weak_form};

/// A simpler diagnoser: its id, what it does in a sentence, and the effect that it names in a case, or nothing.
pub(super) struct Diagnoser {
    pub(super) id: &'static str,
    pub(super) method: &'static str,
    pub(super) names: fn(&GivenCase) -> Option<&'static str>,
}

/// Every simpler diagnoser that looks at records.
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
