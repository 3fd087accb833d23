//! Settings of the estimator.

use serde::Deserialize;
use settings::{Default, Field, Kind, Resolved, SettingsError};
use sparse::Term;
use sparse::config::{EVIDENCE, LIBRARY, MAX_STEPS, SETTLE_TOLERANCE, check_library, terms};

/// Settings of the weak-form sparse identification. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct WeakSindyConfig {
    /// Candidate terms of d ln A/dt, by name: `1`, `1/A`, `A`, `A^2`, `ln A`, `(ln A)^2`, `t`. The constant
    /// is always included, named or not.
    pub library: Vec<String>,
    /// Most test functions.
    pub test_functions: usize,
    /// Exponent p of the test functions (1 − u²)^p.
    pub exponent: i32,
    /// Points at which the terms are evaluated: along the law's `trajectory`, or at the measured `peaks`.
    pub terms_along: TermsAlong,
    /// Amount by which a richer law has to lower the information criterion.
    pub evidence: f64,
    /// Largest change of the trajectory, as a share of the spread of ln A, at which a law has settled.
    pub settle_tolerance: f64,
    /// Most regressions.
    pub max_steps: u64,
}

/// Points at which the terms of a law are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TermsAlong {
    /// Along the law's own trajectory, until it reproduces itself.
    Trajectory,
    /// At the measured peaks, with their scatter in the covariance: WENDy as published.
    Peaks,
}

impl WeakSindyConfig {
    /// Reads the settings from a checked configuration.
    ///
    /// # Errors
    /// [`SettingsError::UnknownName`] for an unknown term.
    pub(crate) fn read(settings: &Resolved) -> Result<Self, SettingsError> {
        let config: Self = settings.section("estimator")?;
        check_library(&config.library, settings)?;
        Ok(config)
    }

    /// Returns the terms, each once, in the order of [`Term::ALL`].
    pub(crate) fn terms(&self) -> impl Iterator<Item = Term> + '_ {
        terms(&self.library)
    }
}

/// Configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    LIBRARY,
    Field::new("test_functions", Kind::Integer { min: 3, max: 1000 }, Default::Integer(200))
        .meaning(
            "Most test functions, narrow ones first; a function that the others already span is \
                left out.",
        )
        .source("as many as there are steps between the peaks of a usual record: nothing is lost"),
    Field::new("exponent", Kind::Integer { min: 1, max: 3 }, Default::Integer(2))
        .meaning("Exponent p of the test functions (1 - u^2)^p.")
        .source("the smallest that vanishes smoothly at the ends"),
    Field::new("terms_along", Kind::Choice(&["trajectory", "peaks"]), Default::Text("trajectory"))
        .meaning(
            "Where the terms are evaluated in the end: along the law's \"trajectory\", or at the \
                measured \"peaks\" (WENDy as published).",
        )
        .source("the peaks' scatter biases 1/A: 0.09 % of the decay rate on the paper's envelope"),
    EVIDENCE,
    SETTLE_TOLERANCE,
    MAX_STEPS,
];
