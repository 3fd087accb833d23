//! Registry of effects, one line each.
//!
//! [`REGISTRY`] is the only list of effects: simulator, diagnosis and documents read it. An effect in the
//! system is a file under `effects/`, one in the measurement chain a file under `chain/`; either takes a line
//! in `registry!`. Effects that can be simulated and fitted but have no name in the vocabulary are in
//! [`UNNAMED`].

use crate::chain::{self, Extent, Observed, Sampled, SampledMotion, Samples, Step};
use crate::description::Description;
use crate::effects;
use crate::error::DynamicsError;
use crate::export::Export;
use crate::law::{Hidden, Law, Margins, Moment, Values};
use crate::nominal::Nominal;
use crate::scalar::Scalar;
use rand::Rng;

/// Generates the enumeration of effects and dispatches every call to the effect's own law, at compile time.
macro_rules! system_effects {
    ($($name:ident,)+) => {
        /// Effect that acts in the system.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum SystemEffect {
            $(#[doc = concat!("See [`effects::", stringify!($name), "`].")] $name,)+
        }

        impl SystemEffect {
            /// Every effect that acts in the system.
            pub const ALL: &'static [Self] = &[$(Self::$name,)+];

            /// Returns the description: id, equation, parameters, signature and reference.
            #[must_use]
            pub const fn description(self) -> &'static Description {
                match self { $(Self::$name => effects::$name::DESCRIPTION,)+ }
            }

            /// Returns [`Law::EXPORT`] of the effect.
            #[must_use]
            pub const fn export(self) -> Export {
                match self { $(Self::$name => effects::$name::EXPORT,)+ }
            }

            /// Returns [`Law::DIRECTED`] of the effect.
            #[must_use]
            pub const fn directed(self) -> bool {
                match self { $(Self::$name => effects::$name::DIRECTED,)+ }
            }

            /// Calls [`Law::torque`] of the effect.
            #[inline]
            pub fn torque<S: Scalar>(self, values: &Values<S>, moment: &Moment<S>) -> S {
                match self { $(Self::$name => effects::$name::torque(values, moment),)+ }
            }

            /// Calls [`Law::hidden_rate`] of the effect.
            #[inline]
            pub fn hidden_rate<S: Scalar>(self, values: &Values<S>, moment: &Moment<S>) -> Hidden<S> {
                match self { $(Self::$name => effects::$name::hidden_rate(values, moment),)+ }
            }

            /// Calls [`Law::relaxed`] of the effect.
            pub fn relaxed<S: Scalar>(self, position: S, velocity: S) -> Hidden<S> {
                match self { $(Self::$name => effects::$name::relaxed(position, velocity),)+ }
            }

            /// Calls [`Law::holding_torque`] of the effect.
            pub fn holding_torque<S: Scalar>(self, values: &Values<S>, moment: &Moment<S>) -> Option<S> {
                match self { $(Self::$name => effects::$name::holding_torque(values, moment),)+ }
            }

            /// Calls [`Law::input_delay`] of the effect.
            pub fn input_delay<S: Scalar>(self, values: &Values<S>) -> Option<S> {
                match self { $(Self::$name => effects::$name::input_delay(values),)+ }
            }

            /// Calls [`Law::region`] of the effect.
            pub fn region(self, values: &Values<f64>, moment: &Moment<f64>) -> i8 {
                match self { $(Self::$name => effects::$name::region(values, moment),)+ }
            }

            /// Calls [`Law::margins`] of the effect.
            #[inline]
            pub fn margins<S: Scalar>(self, values: &Values<S>, moment: &Moment<S>) -> Margins<S> {
                match self { $(Self::$name => effects::$name::margins(values, moment),)+ }
            }

            /// Calls [`Law::beyond`] of the effect.
            pub fn beyond(self, region: i8, edge: usize) -> i8 {
                match self { $(Self::$name => effects::$name::beyond(region, edge),)+ }
            }

            /// Calls [`Law::settle`] of the effect.
            pub fn settle(self, region: i8, direction: f64, hidden: Hidden<f64>) -> Hidden<f64> {
                match self { $(Self::$name => effects::$name::settle(region, direction, hidden),)+ }
            }

            /// Calls [`Law::check`] of the effect.
            ///
            /// # Errors
            /// Returns the same errors as [`Law::check`].
            pub fn check(self, values: &Values<f64>, nominal: &Nominal) -> Result<(), DynamicsError> {
                match self { $(Self::$name => effects::$name::check(values, nominal),)+ }
            }
        }
    };
}

/// Generates the same for the measurement chain.
macro_rules! chain_effects {
    ($($name:ident,)+) => {
        /// Effect in the measurement chain.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum ChainEffect {
            $(#[doc = concat!("See [`chain::", stringify!($name), "`].")] $name,)+
        }

        impl ChainEffect {
            /// Every effect in the measurement chain, in the order in which they act.
            pub const ALL: &'static [Self] = &[$(Self::$name,)+];

            /// Returns the description: id, equation, parameters, signature and reference.
            #[must_use]
            pub const fn description(self) -> &'static Description {
                match self { $(Self::$name => chain::$name::DESCRIPTION,)+ }
            }

            /// Returns [`Step::DIFFERENTIABLE`] of the effect.
            #[must_use]
            pub const fn is_differentiable(self) -> bool {
                match self { $(Self::$name => chain::$name::DIFFERENTIABLE,)+ }
            }

            /// Calls [`Step::transform`] of the effect.
            pub fn transform<S: Sampled>(
                self,
                values: &Values<S>,
                motion: &SampledMotion<'_, S>,
                observed: Observed,
                samples: &mut Samples<S>,
            ) {
                match self { $(Self::$name => chain::$name::transform(values, motion, observed, samples),)+ }
            }

            /// Calls [`Step::distort`] of the effect.
            pub fn distort<R: Rng + ?Sized>(
                self,
                values: &Values<f64>,
                samples: &mut Samples<f64>,
                generator: &mut R,
            ) {
                match self { $(Self::$name => chain::$name::distort(values, samples, generator),)+ }
            }

            /// Calls [`Step::check`] of the effect.
            ///
            /// # Errors
            /// Returns the same errors as [`Step::check`].
            pub fn check(self, values: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
                match self { $(Self::$name => chain::$name::check(values, extent),)+ }
            }
        }
    };
}

macro_rules! registry {
    (system { $($system:ident,)+ } unnamed { $($unnamed:ident,)+ } measuring_chain { $($chain:ident,)+ }) => {
        system_effects! { $($system,)+ $($unnamed,)+ }
        chain_effects! { $($chain,)+ }

        /// Every effect of the vocabulary: those in the system in the order of the documents, then those in
        /// the measurement chain in the order in which they act.
        pub static REGISTRY: &[Effect] = &[
            $(Effect::System(SystemEffect::$system),)+
            $(Effect::MeasuringChain(ChainEffect::$chain),)+
        ];

        /// Torques that can act but are not effects of the vocabulary, since their cause is left open.
        pub static UNNAMED: &[Effect] = &[$(Effect::System(SystemEffect::$unnamed),)+];
    };
}

registry! {
    system {
    CoulombFriction,
    StribeckFriction,
    QuadraticDrag,
    CubicStiffness,
    AsymmetricStiffness,
    Gravity,
    ConstantTorque,
    Backlash,
    Hysteresis,
    EndStop,
    StiffnessDrift,
    DampingDrift,
    PeriodicForcing,
    FlexibleCoupling,
    InputDelay,
    InputSaturation,
    CommandDerivative,
    TorqueLimit,
    LoadFriction,
    DirectionalFriction,
    FrictionDrift,
    DriveDeadBand,
    SpeedTorqueLimit,
    }
    unnamed {
    PositionTorque,
    UnlistedDamping,
    UnlistedStiffness,
    }
    measuring_chain {
    SensorLag,
    SensorNonlinearity,
    SensorDrift,
    SensorSaturation,
    SensorQuantization,
    Outliers,
    Dropouts,
    ClockDrift,
    TimestampJitter,
    TimestampBatching,
    }
}

/// Effect of the registry, by the part of the simulation in which it acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Effect {
    /// In the system: it changes the motion.
    System(SystemEffect),
    /// In the measurement chain: it changes what a file says about the motion.
    MeasuringChain(ChainEffect),
}

impl Effect {
    /// Returns the description: id, equation, parameters, signature and reference.
    #[must_use]
    pub const fn description(self) -> &'static Description {
        match self {
            Self::System(effect) => effect.description(),
            Self::MeasuringChain(effect) => effect.description(),
        }
    }

    /// Returns the public id.
    #[must_use]
    pub const fn id(self) -> &'static str {
        self.description().id
    }

    /// Returns the effect with a public id, whether the vocabulary names it or not.
    ///
    /// # Errors
    /// Returns [`DynamicsError::UnknownEffect`] if there is none.
    pub fn find(id: &str) -> Result<Self, DynamicsError> {
        REGISTRY.iter().chain(UNNAMED).copied().find(|effect| effect.id() == id).ok_or_else(|| {
            DynamicsError::UnknownEffect {
                id: id.to_owned(),
                known: REGISTRY.iter().map(|effect| effect.id()).collect(),
            }
        })
    }
}
