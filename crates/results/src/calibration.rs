//! What a calibration moves: the nominal simulator's numbers before and after.

use super::interval::WithInterval;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The nominal coefficients before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Moment of inertia, or mass.
    pub inertia: CalibratedRow,
    /// Viscous damping.
    pub damping: CalibratedRow,
    /// Stiffness.
    pub stiffness: CalibratedRow,
    /// Where the spring is relaxed.
    pub rest_angle: CalibratedRow,
    /// The effects that the nominal simulator has; absent where it has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<KnownEffectRow>,
}

impl Calibration {
    /// The coefficients of the oscillator by name, then the parameters of the effects that the nominal simulator has,
    /// as `gravity.torque`.
    #[must_use]
    pub fn rows(&self) -> Vec<(String, &CalibratedRow)> {
        let plain = [
            ("inertia", &self.inertia),
            ("damping", &self.damping),
            ("stiffness", &self.stiffness),
            ("rest_angle", &self.rest_angle),
        ];
        let own = self.effects.iter().flat_map(|effect| {
            effect.parameters.iter().map(|(name, row)| (format!("{}.{name}", effect.id), row))
        });
        plain.into_iter().map(|(name, row)| (name.to_owned(), row)).chain(own).collect()
    }
}

/// An effect that the nominal simulator has, before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KnownEffectRow {
    /// Its id.
    pub id: String,
    /// True if recalibration may move its parameters; otherwise they are held.
    pub recalibrate: bool,
    /// Its parameters by name.
    pub parameters: BTreeMap<String, CalibratedRow>,
}

/// A nominal coefficient before and after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibratedRow {
    /// Value in the nominal simulator.
    pub nominal: f64,
    /// Symbol of its unit.
    pub unit: String,
    /// Recalibrated without effects; `null` where these data cannot tell it.
    pub recalibrated: Option<WithInterval>,
    /// With the named effects; `null` where these data cannot tell it.
    pub repaired: Option<WithInterval>,
    /// True if these data determine what stands under `repaired`; absent where that is `null`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub determined: Option<bool>,
}
