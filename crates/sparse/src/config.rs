//! Settings that the sparse identification methods share.

use crate::term::Term;
use settings::{Default, Field, Kind, Origin, Resolved, SettingsError};

/// Candidate terms of a law.
pub const LIBRARY: Field =
    Field::new("library", Kind::Texts { at_least: 1, at_most: 7 }, Default::Texts(&["1", "1/A", "A"]))
        .meaning(
            "Candidate terms of d ln A/dt: \"1\" (viscous damping, in every law), \"1/A\" (dry \
                friction), \"A\" (quadratic drag), \"A^2\", \"ln A\", \"(ln A)^2\", \"t\".",
        )
        .source("the three dampings of a pendulum; with more terms, look-alikes are taken for them");

/// Evidence that a richer law needs.
pub const EVIDENCE: Field = Field::new("evidence", Kind::Float { min: 0.0, max: 1e6 }, Default::Float(2.0))
    .meaning(
        "Least reduction of the Bayesian information criterion for which a richer law is \
                chosen.",
    )
    .source(
        "Kass, Raftery, J. Am. Stat. Assoc. 90 (1995) 773: positive evidence from 2, strong \
                from 6",
    );

/// Change of the trajectory at which a law has settled.
pub const SETTLE_TOLERANCE: Field =
    Field::new("settle_tolerance", Kind::Float { min: 1e-13, max: 1e-2 }, Default::Float(1e-11))
        .meaning(
            "Largest change of a law's trajectory, as a share of the spread of ln A, at which it \
                has settled.",
        )
        .source("a hundred times the rounding of ln A");

/// Budget of regressions.
pub const MAX_STEPS: Field =
    Field::new("max_steps", Kind::Integer { min: 0, max: 1_000_000 }, Default::Integer(1000))
        .meaning("Most regressions, over all laws.")
        .source("some thirty times what the shipped record takes");

/// Returns the terms that a library names, each once, in the order of [`Term::ALL`]. Unknown names are
/// skipped here; [`check_library`] refuses them.
pub fn terms(library: &[String]) -> impl Iterator<Item = Term> + '_ {
    Term::ALL.into_iter().filter(|term| library.iter().any(|name| name == term.name()))
}

/// Checks that every name of a library is the name of a term.
///
/// # Errors
/// [`SettingsError::UnknownName`] for an unknown term, with the place that names it.
pub fn check_library(library: &[String], settings: &Resolved) -> Result<(), SettingsError> {
    let Some(unknown) = library.iter().find(|name| Term::named(name).is_none()) else { return Ok(()) };
    let mut all = settings.settings().iter();
    let setting = all.find(|setting| setting.key() == "estimator.library");
    let origin = setting.map_or(Origin::Default, |setting| setting.origin.clone());
    let known = Term::ALL.iter().map(|term| term.name().to_owned()).collect();
    Err(SettingsError::unknown_name(origin, "library term", unknown, known))
}
