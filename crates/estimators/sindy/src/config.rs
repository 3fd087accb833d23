//! The settings.

use serde::Deserialize;
use settings::{Default, Field, Kind, Origin, Resolved, SettingsError};
use sparse::Term;

/// Settings of the sparse identification. The ranges and defaults are in the registry's fields.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SindyConfig {
    /// Candidate terms of d ln A/dt, by name: `1`, `1/A`, `A`, `A^2`, `ln A`, `(ln A)^2`, `t`. The
    /// constant is always among them, named or not.
    pub library: Vec<String>,
    /// How far a richer law has to lower the information criterion.
    pub evidence: f64,
    /// Largest change of the trajectory, as a share of the spread of ln A, at which a law has settled.
    pub settle_tolerance: f64,
    /// Most regressions.
    pub max_steps: u64,
}

impl SindyConfig {
    /// The settings of a checked configuration.
    ///
    /// # Errors
    /// [`SettingsError::UnknownName`] for a term that is not known.
    pub(crate) fn read(settings: &Resolved) -> Result<Self, SettingsError> {
        let config: Self = settings.section("estimator")?;
        if let Some(unknown) = config.library.iter().find(|name| Term::named(name).is_none()) {
            let origin = settings
                .settings()
                .iter()
                .find(|setting| setting.key() == "estimator.library")
                .map_or(Origin::Default, |setting| setting.origin.clone());
            let known = Term::ALL.iter().map(|term| term.name().to_owned()).collect();
            return Err(SettingsError::unknown_name(origin, "library term", unknown, known));
        }
        Ok(config)
    }

    /// The terms, each once, in the order of [`Term::ALL`].
    pub(crate) fn terms(&self) -> impl Iterator<Item = Term> + '_ {
        Term::ALL.into_iter().filter(|term| self.library.iter().any(|name| name == term.name()))
    }
}

/// The configuration keys.
pub(crate) const FIELDS: &[Field] = &[
    Field {
        key: "library",
        kind: Kind::Texts { at_least: 1, at_most: 7 },
        default: Default::Texts(&["1", "1/A", "A"]),
        unit: "",
        meaning: "Candidate terms of d ln A/dt: \"1\" (viscous damping, in every law), \"1/A\" (dry friction), \
                  \"A\" (quadratic drag), \"A^2\", \"ln A\", \"(ln A)^2\", \"t\".",
        source: "the three dampings of a pendulum; with more terms, look-alikes are taken for them",
    },
    Field {
        key: "evidence",
        kind: Kind::Float { min: 0.0, max: 1e6 },
        default: Default::Float(2.0),
        unit: "",
        meaning: "How far a richer law has to lower the Bayesian information criterion.",
        source: "Kass, Raftery, J. Am. Stat. Assoc. 90 (1995) 773: positive evidence from 2, strong from 6",
    },
    Field {
        key: "settle_tolerance",
        kind: Kind::Float { min: 1e-13, max: 1e-2 },
        default: Default::Float(1e-11),
        unit: "",
        meaning: "Largest change of a law's trajectory, as a share of the spread of ln A, at which it has settled.",
        source: "a hundred times the rounding of ln A",
    },
    Field {
        key: "max_steps",
        kind: Kind::Integer { min: 0, max: 1_000_000 },
        default: Default::Integer(1000),
        unit: "",
        meaning: "Most regressions, over all laws.",
        source: "some thirty times what the shipped record takes",
    },
];
