//! What a case hides.

use dynamics::Active;
use serde::{Deserialize, Serialize};

/// The `schema` of a hidden truth's text.
pub const HIDDEN_SCHEMA: &str = "ringdown.trial/1";

/// The kind of a case: what is asked of the diagnosis there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bank {
    /// Nothing is missing and the nominal simulator is exact.
    None,
    /// Nothing is missing; the nominal coefficients are off.
    Calibration,
    /// One effect of the vocabulary.
    Single,
    /// Two effects of the vocabulary.
    Pair,
    /// One effect of the vocabulary that the diagnosis is told not to consider: `unknown` is right.
    LeftOut,
    /// Something outside the vocabulary: `unknown` is right.
    Foreign,
    /// One effect, several releases of one system.
    Releases,
    /// One effect, a measured input.
    Driven,
    /// One effect by a law unlike the vocabulary's own, with another integrator and correlated disturbances.
    Stressed,
    /// One effect added to what a diagnosis left over of a measured record.
    Measured,
    /// One effect in records of a physics engine.
    Engine,
    /// Two to six effects of very different size, beside smooth laws outside the vocabulary.
    Composite,
    /// Rigs of a folder that another program made: composite ones and simpler ones.
    Rigs,
}

/// What an answer is held to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// Nothing is missing.
    Nothing,
    /// Effects of the vocabulary are hidden.
    Effects,
    /// What acts is not to be named: `unknown`, or a class that the truth allows.
    Unknown,
    /// A law outside the vocabulary acts that is small: no name, whatever the status.
    NoName,
}

impl Hidden {
    /// The truth of a case in which nothing acts; struct update adds what does.
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

    /// What the case asks of an answer.
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
    /// Its name in results.
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

/// Hidden truth of a case: effects, and whatever else its records follow from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hidden {
    /// [`HIDDEN_SCHEMA`].
    pub schema: String,
    /// The kind of case.
    pub bank: Bank,
    /// The hidden effects of the vocabulary, the most detectable first; empty where none is.
    pub effects: Vec<HiddenEffect>,
    /// Law from outside the vocabulary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foreign: Option<Foreign>,
    /// Smooth laws outside the vocabulary that act beside the hidden effects, or alone where they are too small to ask
    /// for an answer.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unlisted: Vec<Unlisted>,
    /// Ids of classes that an answer may name for what acts from outside the vocabulary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allowed: Vec<String>,
    /// Ids of effects of the measurement chain that come with records of every bank alike. They count neither for nor
    /// against an answer.
    pub nuisances: Vec<String>,
    /// True if the nominal coefficients are off.
    pub miscalibrated: bool,
    /// The effect that the diagnosis is told not to consider.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without: Option<String>,
    /// Standard deviation of the sensor's white noise, in the observed quantity's unit.
    pub noise: f64,
    /// The system as it is, where it can be said in the vocabulary: a repaired simulator is laid beside its motion.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub records: Vec<truth::Truth>,
    /// Origin of the records, in words; for whoever repeats one.
    pub made: String,
}

/// Something outside the vocabulary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Foreign {
    /// Law, in words.
    pub law: String,
    /// Its size in noise units: what neither a recalibration nor the vocabulary nearest to it can absorb.
    pub detectability: f64,
}

/// A smooth law outside the vocabulary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unlisted {
    /// Law, in words.
    pub law: String,
    /// Root mean square of what no recalibration can absorb of it, over the noise's standard deviation.
    pub floors: f64,
    /// Id of the class of effects that it belongs to by its mechanism, if it does to one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class: Option<String>,
}

/// A hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HiddenEffect {
    /// Its id in the vocabulary.
    pub id: String,
    /// Its parameters by the vocabulary's law, or the nearest to them where the law is another, in SI units.
    pub parameters: Vec<f64>,
    /// The law that acted: `vocabulary`, or its name.
    pub law: String,
    /// Its size in noise units: the root of the sum of squares, over all samples, of what no recalibration
    /// can absorb of it, over the noise's standard deviation.
    pub detectability: f64,
    /// Size as a root mean square in place of the root of the sum: × noise. Only where several effects act.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floors: Option<f64>,
}

impl HiddenEffect {
    /// Effects that act by the vocabulary's law, each with its detectability, the most detectable first.
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
