//! Coefficients of the nominal simulator before and after recalibration.

use super::interval::WithInterval;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The nominal coefficients before and after recalibration and repair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Moment of inertia, or mass.
    pub inertia: CalibratedRow,
    /// Viscous damping.
    pub damping: CalibratedRow,
    /// Stiffness.
    pub stiffness: CalibratedRow,
    /// Rest angle: position at which the spring is relaxed.
    pub rest_angle: CalibratedRow,
    /// Effects of the nominal simulator; absent if it has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<KnownEffectRow>,
}

impl Calibration {
    /// Returns the oscillator's coefficients by name, then the parameters of the nominal simulator's effects
    /// under names such as `gravity.torque`.
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

/// An effect of the nominal simulator with its parameters before and after recalibration and repair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KnownEffectRow {
    /// Id of the effect.
    pub id: String,
    /// `true` if recalibration may change the effect's parameters; otherwise they are held fixed.
    pub recalibrate: bool,
    /// Parameters of the effect by name.
    pub parameters: BTreeMap<String, CalibratedRow>,
}

/// A coefficient of the nominal simulator before and after recalibration and repair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibratedRow {
    /// Value in the nominal simulator.
    pub nominal: f64,
    /// Symbol of the coefficient's unit.
    pub unit: String,
    /// Value after recalibration without effects; `null` if these data cannot determine it.
    pub recalibrated: Option<WithInterval>,
    /// Value after the repair with the named effects; `null` if these data cannot determine it.
    pub repaired: Option<WithInterval>,
    /// `true` if these data determine `repaired`; absent if `repaired` is `null`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub determined: Option<bool>,
}
