//! Nominal simulator: the nominal oscillator with the effects that it already has.

use crate::active::Active;
use crate::chain::{Chain, Observed};
use crate::error::DynamicsError;
use crate::nominal::Nominal;
use crate::registry::{Effect, SystemEffect};
use crate::system::System;

/// Effect that a nominal simulator has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownEffect {
    /// Effect with its stated parameters.
    pub active: Active,
    /// `true` if recalibration may move its parameters; otherwise they are held as stated.
    pub recalibrate: bool,
}

/// Nominal oscillator with the effects that the simulator already has, each at most once.
#[derive(Debug, Clone, PartialEq)]
pub struct NominalSimulator {
    nominal: Nominal,
    effects: Vec<KnownEffect>,
}

/// Number of positions, around a turn, at which a weight's potential is evaluated to find its minimum.
const POSITIONS: usize = 720;

impl NominalSimulator {
    /// Creates a nominal simulator from an oscillator and effects in the system and in the measurement chain;
    /// the list may be empty.
    ///
    /// # Errors
    /// Returns the same errors as [`System::new`] and [`Chain::new`].
    pub fn new(nominal: Nominal, effects: Vec<KnownEffect>) -> Result<Self, DynamicsError> {
        let (system, chain): (Vec<Active>, Vec<Active>) = effects
            .iter()
            .map(|known| known.active)
            .partition(|active| matches!(active.effect(), Effect::System(_)));
        System::new(nominal, system)?;
        Chain::new(Observed::Position, 0.0, chain)?;
        Ok(Self { nominal, effects })
    }

    /// Returns the oscillator alone.
    #[must_use]
    pub fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// Returns the effects, in the order given.
    #[must_use]
    pub fn effects(&self) -> &[KnownEffect] {
        &self.effects
    }

    /// Returns the equilibrium in rad or m, and the stiffness against small swings about it: that of the
    /// spring and of a weight. Without a weight these are the rest angle and the stiffness of the oscillator.
    #[must_use]
    pub fn equilibrium(&self) -> (f64, f64) {
        let weight = |active: &Active| {
            let own = active.effect() == Effect::System(SystemEffect::Gravity);
            own.then(|| active.value("torque").zip(active.value("angle"))).flatten()
        };
        let (rest, stiffness) = (self.nominal.rest_angle(), self.nominal.stiffness());
        let Some((torque, angle)) = self.effects.iter().find_map(|known| weight(&known.active)) else {
            return (rest, stiffness);
        };
        let potential = |x: f64| 0.5 * stiffness * (x - rest).powi(2) - torque * libm::cos(x + angle);
        // The position hanging straight down, and `POSITIONS` positions within half a turn of the spring's
        // rest angle.
        let step = std::f64::consts::TAU / POSITIONS as f64;
        let around = (0..=POSITIONS).map(|index| rest + (index as f64 - 0.5 * POSITIONS as f64) * step);
        let lowest = around.chain([-angle]).min_by(|a, b| potential(*a).total_cmp(&potential(*b)));
        let place = lowest.unwrap_or(rest);
        (place, (stiffness + torque * libm::cos(place + angle)).max(0.0))
    }

    /// Returns the angular frequency of small undamped swings, in rad/s; 0 without spring and weight.
    #[must_use]
    pub fn angular_frequency(&self) -> f64 {
        (self.equilibrium().1 / self.nominal.inertia()).sqrt()
    }
}

impl From<&Nominal> for NominalSimulator {
    fn from(nominal: &Nominal) -> Self {
        Self { nominal: *nominal, effects: Vec::new() }
    }
}

impl From<&Self> for NominalSimulator {
    fn from(simulator: &Self) -> Self {
        simulator.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::{KnownEffect, NominalSimulator};
    use crate::{Active, Nominal};

    fn with(stiffness: f64, rest: f64, weight: &[f64]) -> NominalSimulator {
        let nominal = Nominal::new(2.0, 0.1, stiffness, rest).unwrap();
        let active = Active::new("gravity", weight).unwrap();
        NominalSimulator::new(nominal, vec![KnownEffect { active, recalibrate: true }]).unwrap()
    }

    #[test]
    fn a_weight_is_a_spring_to_small_swings() {
        let bare = NominalSimulator::from(&Nominal::new(2.0, 0.1, 8.0, 0.3).unwrap());
        assert_eq!(bare.equilibrium(), (0.3, 8.0));
        assert_eq!(bare.angular_frequency(), 2.0);
        assert_eq!(with(0.0, 0.0, &[8.0, 0.4]).equilibrium(), (-0.4, 8.0));
        assert_eq!(with(0.0, 0.0, &[8.0, 0.4]).angular_frequency(), 2.0);
        // Beside a spring both balance: k·(x − r) = −T·sin(x + φ).
        let (place, stiffness) = with(8.0, 0.3, &[2.0, 0.1]).equilibrium();
        assert!((8.0 * (place - 0.3) + 2.0 * (place + 0.1).sin()).abs() < 0.1, "{place}");
        assert!((stiffness - 8.0 - 2.0 * (place + 0.1).cos()).abs() < 1e-12, "{stiffness}");
    }

    #[test]
    fn an_effect_stands_in_it_once() {
        let active = Active::new("coulomb_friction", &[0.1]).unwrap();
        let known = KnownEffect { active, recalibrate: false };
        let nominal = Nominal::new(1.0, 0.1, 8.0, 0.0).unwrap();
        let error = NominalSimulator::new(nominal, vec![known, known]).unwrap_err();
        assert_eq!(error.to_string(), "`coulomb_friction` is given twice; combine the two into one");
    }
}
