//! Settings of the estimator.

use serde::Deserialize;
use settings::{Field, Resolved, SettingsError};
use sparse::Term;
use sparse::config::{EVIDENCE, LIBRARY, MAX_STEPS, SETTLE_TOLERANCE, check_library, terms};

/// Settings of the sparse identification. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SindyConfig {
    /// Candidate terms of d ln A/dt, by name: `1`, `1/A`, `A`, `A^2`, `ln A`, `(ln A)^2`, `t`. The constant
    /// is always included, named or not.
    pub library: Vec<String>,
    /// Amount by which a richer law has to lower the information criterion.
    pub evidence: f64,
    /// Largest change of the trajectory, as a share of the spread of ln A, at which a law has settled.
    pub settle_tolerance: f64,
    /// Most regressions.
    pub max_steps: u64,
}

impl SindyConfig {
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
pub(crate) const FIELDS: &[Field] = &[LIBRARY, EVIDENCE, SETTLE_TOLERANCE, MAX_STEPS];
