//! Hidden truths of cases.

use dynamics::Active;
use serde::{Deserialize, Serialize};

/// Value of the `schema` field in the text of a hidden truth.
pub const HIDDEN_SCHEMA: &str = "ringdown.trial/1";

/// Kind of case, which determines what a right answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bank {
    /// Nothing is missing and the nominal simulator is exact.
    None,
    /// Nothing is missing; the nominal coefficients are wrong.
    Calibration,
    /// One effect of the vocabulary.
    Single,
    /// Two effects of the vocabulary.
    Pair,
    /// One effect of the vocabulary that the diagnosis is told not to consider: `unknown` is right.
    LeftOut,
    /// A law outside the vocabulary: `unknown` is right.
    Foreign,
    /// One effect; several releases of one system.
    Releases,
    /// One effect; a measured input.
    Driven,
    /// One effect by a law that differs from the vocabulary's, with another integrator and correlated
    /// disturbances.
    Stressed,
    /// One effect, added to the residual that a diagnosis left of a measured record.
    Measured,
    /// One effect, in records of a physics engine.
    Engine,
    /// Two to six effects of very different size, together with smooth laws outside the vocabulary.
    Composite,
    /// Rigs from a folder that another program made: composite ones and simpler ones.
    Rigs,
}

/// Kind of answer that a case asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// Nothing is missing.
    Nothing,
    /// Effects of the vocabulary are hidden.
    Effects,
    /// The acting law has no name: right is `unknown`, or a class that the truth allows.
    Unknown,
    /// A small law outside the vocabulary acts: no name is right, whatever the status.
    NoName,
}

impl Hidden {
    /// Returns the truth of a case in which nothing acts; acting effects are added by struct update.
    pub(crate) fn nothing(bank: Bank, noise: f64, made: String) -> Self {
        Self {
            schema: HIDDEN_SCHEMA.to_owned(),
            bank,
            effects: Vec::new(),
            foreign: None,
            unlisted: Vec::new(),
            allowed: Vec::new(),
            nuisances: Vec::new(),
            miscalibrated: false,
            without: None,
            noise,
            records: Vec::new(),
            made,
        }
    }

    /// Returns the kind of answer that the case asks for.
    pub(crate) fn asked(&self) -> Asked {
        match self {
            Self { bank: Bank::LeftOut, .. } | Self { foreign: Some(_), .. } => Asked::Unknown,
            Self { effects, .. } if !effects.is_empty() => Asked::Effects,
            Self { unlisted, .. } if !unlisted.is_empty() => Asked::NoName,
            _ => Asked::Nothing,
        }
    }
}

impl Bank {
    /// Returns the name used in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Calibration => "calibration",
            Self::Single => "single",
            Self::Pair => "pair",
            Self::LeftOut => "left-out",
            Self::Foreign => "foreign",
            Self::Releases => "releases",
            Self::Driven => "driven",
            Self::Stressed => "stressed",
            Self::Measured => "measured",
            Self::Engine => "engine",
            Self::Composite => "composite",
            Self::Rigs => "rigs",
        }
    }
}

/// Hidden truth of a case: the effects, and everything else that determines its records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hidden {
    /// Schema of the text, [`HIDDEN_SCHEMA`].
    pub schema: String,
    /// Kind of case.
    pub bank: Bank,
    /// Hidden effects of the vocabulary, the most detectable first; empty if there are none.
    pub effects: Vec<HiddenEffect>,
    /// Law outside the vocabulary for which `unknown` is right; `None` if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foreign: Option<Foreign>,
    /// Smooth laws outside the vocabulary that act beside the hidden effects, or alone if they are too small
    /// to ask for an answer.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unlisted: Vec<Unlisted>,
    /// Identifiers of the classes that an answer may name for a law outside the vocabulary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allowed: Vec<String>,
    /// Identifiers of measurement-chain effects that occur in records of every bank (nuisances). They count
    /// neither for nor against an answer.
    pub nuisances: Vec<String>,
    /// `true` if the nominal coefficients are wrong.
    pub miscalibrated: bool,
    /// Identifier of the effect that the diagnosis is told not to consider; `None` for no such effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without: Option<String>,
    /// Standard deviation of the sensor's white noise, in the unit of the observed quantity.
    pub noise: f64,
    /// Truths of the records, if the system can be expressed in the vocabulary; otherwise empty. A repaired
    /// simulator is compared with their motion.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub records: Vec<truth::Truth>,
    /// Origin of the records in words, for repeating the case.
    pub made: String,
}

/// Law outside the vocabulary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Foreign {
    /// Description of the law.
    pub law: String,
    /// Size in noise units: the part that neither a recalibration nor the nearest effects of the vocabulary
    /// can absorb.
    pub detectability: f64,
}

/// Smooth law outside the vocabulary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unlisted {
    /// Description of the law.
    pub law: String,
    /// Root mean square of the part that no recalibration can absorb, divided by the noise's standard
    /// deviation (× noise).
    pub floors: f64,
    /// Identifier of the class of effects to which the law belongs by its mechanism; `None` if to none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class: Option<String>,
}

/// Hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HiddenEffect {
    /// Identifier in the vocabulary.
    pub id: String,
    /// Parameters of the vocabulary's law, or the closest ones if another law acted, in SI units.
    pub parameters: Vec<f64>,
    /// Law that acted: `vocabulary`, or the name of another law.
    pub law: String,
    /// Size in noise units: the root of the sum of squares, over all samples, of the part that no
    /// recalibration can absorb, divided by the noise's standard deviation.
    pub detectability: f64,
    /// Size as a root mean square instead of a root of the sum of squares (× noise); `None` unless several
    /// effects act.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floors: Option<f64>,
}

impl HiddenEffect {
    /// Returns effects that act by the vocabulary's law, each with its detectability, the most detectable
    /// first.
    pub(crate) fn by_the_vocabulary(hidden: &[(Active, f64)]) -> Vec<Self> {
        let effect = |(active, detectability): &(Active, f64)| Self {
            id: active.id().to_owned(),
            parameters: active.values().to_vec(),
            law: "vocabulary".to_owned(),
            detectability: *detectability,
            floors: None,
        };
        let mut effects: Vec<Self> = hidden.iter().map(effect).collect();
        effects.sort_by(|one, other| other.detectability.total_cmp(&one.detectability));
        effects
    }
}
