//! Laws by name.

use super::bouc_wen::BoucWen;
use super::duffing::Duffing;
use super::polynomial::Polynomial;
use super::run::Runnable;
use super::two_tanks::TwoTanks;
use crate::data::DataSet;
use serde::{Deserialize, Serialize};

/// Law by name, as a model's file states it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Form {
    /// Polynomial acceleration.
    Polynomial(Polynomial),
    /// Duffing oscillator of a circuit.
    Duffing(Duffing),
    /// Oscillator with Bouc–Wen hysteresis.
    BoucWen(BoucWen),
    /// Two tanks in cascade.
    TwoTanks(TwoTanks),
}

/// Names of the laws in configurations.
pub(super) const NAMES: &[&str] = &["duffing", "polynomial-3", "polynomial-5", "bouc-wen", "two-tanks"];

impl Form {
    /// Returns the law with a name, for a data set; `None` for an unknown name.
    pub(super) fn named(name: &str, data: &DataSet) -> Option<Self> {
        Some(match name {
            "duffing" => Self::Duffing(Duffing::new(data)),
            "polynomial-3" => Self::Polynomial(Polynomial::new(3, data)),
            "polynomial-5" => Self::Polynomial(Polynomial::new(5, data)),
            "bouc-wen" => Self::BoucWen(BoucWen {}),
            "two-tanks" => Self::TwoTanks(TwoTanks::new(data)),
            _ => return None,
        })
    }

    /// Returns the law.
    pub(super) fn law(&self) -> &dyn Runnable {
        match self {
            Self::Polynomial(law) => law,
            Self::Duffing(law) => law,
            Self::BoucWen(law) => law,
            Self::TwoTanks(law) => law,
        }
    }
}
