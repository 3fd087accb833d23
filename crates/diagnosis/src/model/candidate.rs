//! What can be missing from a simulator and be fitted: effects of the system and smooth effects of the sensor.

use crate::data::scales::Scales;
use dynamics::{Active, ChainEffect, Class, Coordinate, Effect, NominalSimulator, SystemEffect};
use record::Quantity;
use std::f64::consts::PI;

/// An effect of the measuring chain that changes values smoothly enough to be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Distortion {
    Lag,
    Nonlinearity,
    Drift,
    Clock,
    Saturation,
    /// A reading that stays behind in either direction of motion: of a sensor with steps.
    ReadingHysteresis,
}

/// An effect that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Candidate {
    System(SystemEffect),
    Chain(Distortion),
}

/// Effects that explain alike: what a record tells first is which of these a system has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EvidenceClass {
    /// Dry friction and what depends on the way that the body came.
    Friction,
    /// Torques along the position.
    Restoring,
    /// Torques along the velocity.
    Damping,
    /// Clearances and stops.
    Play,
    /// Springs and clocks that change over the record.
    Drift,
    /// A mode of its own.
    SecondBody,
    /// A torque that comes from outside.
    Forcing,
    /// A torque that is always there.
    Preload,
    /// What happens to the input before it acts.
    Actuator,
    /// What happens to the values.
    Sensor,
    /// What happens to the stamps.
    Stamps,
}

impl EvidenceClass {
    /// The id of [`Self`] in an answer.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Restoring => "restoring",
            Self::Damping => "damping",
            Self::Play => "play",
            Self::Drift => "drift",
            Self::SecondBody => "second_body",
            Self::Forcing => "forcing",
            Self::Preload => "preload",
            Self::Actuator => "actuator",
            Self::Sensor => "sensor",
            Self::Stamps => "stamps",
        }
    }
}

/// A parameter that a fit moves. Its name and unit go to the answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Parameter {
    pub(crate) name: &'static str,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Whether the effect is gone where this parameter is 0 (and 0 is its bound): a fit that ends there
    /// rejects the effect.
    pub(crate) strength: bool,
    /// Whether it says how the effect looks rather than how large it is: a width, a frequency, a phase. It means
    /// nothing while the effect has no size.
    pub(crate) shape: bool,
    /// Whether the effect is another, simpler one where this parameter is at its lower end: a fit that ends
    /// there rejects it too. Stribeck friction whose excess is gone at the slowest speeds is Coulomb
    /// friction.
    pub(crate) simpler: bool,
}

const fn any(name: &'static str) -> Parameter {
    Parameter {
        name,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        strength: false,
        shape: false,
        simpler: false,
    }
}

const fn positive(name: &'static str) -> Parameter {
    Parameter { name, lower: 0.0, upper: f64::INFINITY, strength: true, shape: false, simpler: false }
}

const fn between(name: &'static str, lower: f64, upper: f64) -> Parameter {
    Parameter { name, lower, upper, strength: false, shape: true, simpler: false }
}

/// A second mode's decay over the longest record as a logarithm at least, and its damping ratio at most.
const LEAST_DECAY: f64 = 0.3;
const MOST_DAMPED: f64 = 0.7;

/// A second body's part of the inertia: smaller ones move nothing, larger ones are the body themselves.
const SMALLEST_BODY: f64 = 1e-9;
const LARGEST_BODY: f64 = 1e2;

/// Factor in the decay rate, either way, beyond which a line at a harmonic is another body's. Those by which a second
/// body stands in for a sensor that is not linear decayed 0.9 to 1.2 times as fast as the harmonic (training banks).
const ANOTHER_DECAY: f64 = 1.5;

/// The swing that a second body is told from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MainMode {
    /// Angular frequency in rad/s.
    pub(crate) frequency: f64,
    /// Decay rate of its amplitude in 1/s.
    pub(crate) decay_rate: f64,
    pub(crate) inertia: f64,
    /// Whether each record has one start state, at its beginning.
    pub(crate) starts_once: bool,
}

/// Where a law has a size and an angle, a fit moves their Cartesian pair: the law is linear in it, and
/// nothing goes round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Polar {
    size: usize,
    angle: usize,
}

/// Whether an effect has a hidden motion of its own whose start is fitted with the record's.
#[must_use]
pub fn has_fitted_hidden_start(id: &str) -> bool {
    Candidate::ALL.iter().any(|candidate| candidate.id() == id && candidate.free_hidden() > 0)
}

impl Candidate {
    /// Every candidate.
    pub(crate) const ALL: &'static [Self] = &[
        Self::System(SystemEffect::CoulombFriction),
        Self::System(SystemEffect::StribeckFriction),
        Self::System(SystemEffect::QuadraticDrag),
        Self::System(SystemEffect::CubicStiffness),
        Self::System(SystemEffect::AsymmetricStiffness),
        Self::System(SystemEffect::Gravity),
        Self::System(SystemEffect::Backlash),
        Self::System(SystemEffect::Hysteresis),
        Self::System(SystemEffect::EndStop),
        Self::System(SystemEffect::StiffnessDrift),
        Self::System(SystemEffect::DampingDrift),
        Self::System(SystemEffect::PeriodicForcing),
        Self::System(SystemEffect::FlexibleCoupling),
        Self::System(SystemEffect::InputDelay),
        Self::System(SystemEffect::InputSaturation),
        Self::System(SystemEffect::ConstantTorque),
        Self::Chain(Distortion::Saturation),
        Self::Chain(Distortion::Lag),
        Self::Chain(Distortion::Nonlinearity),
        Self::Chain(Distortion::Drift),
        Self::Chain(Distortion::Clock),
        Self::Chain(Distortion::ReadingHysteresis),
    ];

    /// A torque along the position, whatever its cause. It is none of the candidates for a name.
    pub(crate) const UNNAMED: Self = Self::System(SystemEffect::PositionTorque);

    /// Its place in [`Self::ALL`].
    pub(crate) fn rank(self) -> usize {
        Self::ALL.iter().position(|other| *other == self).unwrap_or(Self::ALL.len())
    }

    /// The public id.
    pub(crate) fn id(self) -> &'static str {
        match self {
            Self::System(effect) => effect.description().id,
            Self::Chain(Distortion::Lag) => "sensor_lag",
            Self::Chain(Distortion::Nonlinearity) => "sensor_nonlinearity",
            Self::Chain(Distortion::Drift) => "sensor_drift",
            Self::Chain(Distortion::Clock) => "clock_drift",
            Self::Chain(Distortion::Saturation) => "sensor_saturation",
            Self::Chain(Distortion::ReadingHysteresis) => "sensor_quantization",
        }
    }

    /// Whether it takes one of the places that a set has. How a sensor's steps are counted does not: that the sensor has
    /// steps shows without any fit.
    pub(crate) fn counts(self) -> bool {
        self != Self::Chain(Distortion::ReadingHysteresis)
    }

    /// The class of effects that it explains alike with.
    pub(crate) fn evidence_class(self) -> EvidenceClass {
        match self.id() {
            "coulomb_friction" | "stribeck_friction" | "hysteresis" => EvidenceClass::Friction,
            "cubic_stiffness" | "asymmetric_stiffness" | "gravity" => EvidenceClass::Restoring,
            "quadratic_drag" | "damping_drift" => EvidenceClass::Damping,
            "backlash" | "end_stop" => EvidenceClass::Play,
            "stiffness_drift" | "clock_drift" => EvidenceClass::Drift,
            "flexible_coupling" => EvidenceClass::SecondBody,
            "periodic_forcing" => EvidenceClass::Forcing,
            "constant_torque" => EvidenceClass::Preload,
            "input_delay" | "input_saturation" => EvidenceClass::Actuator,
            _ => EvidenceClass::Sensor,
        }
    }

    /// Whether every mechanism may be expected to have it: dry friction, drag, a weight, a spring that bends.
    pub(crate) fn is_plain(self) -> bool {
        let id = self.id();
        ["coulomb_friction", "quadratic_drag", "cubic_stiffness", "asymmetric_stiffness", "gravity"]
            .contains(&id)
    }

    /// Its part of a gap budget.
    pub(crate) fn class(self) -> Class {
        match self {
            Self::System(effect) => effect.description().class,
            Self::Chain(Distortion::Clock) => Class::Clock,
            Self::Chain(_) => Class::Sensor,
        }
    }

    /// What an effect is to a fit, with the law's parameters that a fit can move; none for effects of the measuring chain
    /// that change no value smoothly.
    pub(crate) fn of(active: &Active) -> Option<(Self, Vec<f64>)> {
        let value = |name: &str| active.value(name).unwrap_or_default();
        let whole = |distortion: Distortion| Some((Self::Chain(distortion), active.values().to_vec()));
        match active.effect() {
            Effect::System(effect) => Some((Self::System(effect), active.values().to_vec())),
            Effect::MeasuringChain(effect) => match effect {
                ChainEffect::SensorLag => whole(Distortion::Lag),
                ChainEffect::SensorNonlinearity => whole(Distortion::Nonlinearity),
                ChainEffect::SensorDrift => whole(Distortion::Drift),
                ChainEffect::SensorSaturation => whole(Distortion::Saturation),
                ChainEffect::ClockDrift => Some((Self::Chain(Distortion::Clock), vec![value("change")])),
                ChainEffect::SensorQuantization if value("hysteresis") > 0.0 => {
                    Some((Self::Chain(Distortion::ReadingHysteresis), vec![value("hysteresis")]))
                }
                _ => None,
            },
        }
    }

    /// Every candidate that can act on these records and that the nominal simulator does not have already.
    pub(crate) fn that_apply(facts: &Scales, quantity: Quantity, simulator: &NominalSimulator) -> Vec<Self> {
        let known: Vec<Self> =
            simulator.effects().iter().filter_map(|own| Some(Self::of(&own.active)?.0)).collect();
        let is_known =
            |own: &Self| known.iter().any(|known| known == own || known.generalizes() == Some(*own));
        let all = Self::ALL.iter().copied().filter(|own| !is_known(own));
        all.filter(|candidate| candidate.applies(facts, quantity, simulator)).collect()
    }

    /// Whether a fit of records of a quantity can follow it: a lag and a clock move what is observed by its time
    /// derivative, which an acceleration has not.
    pub(crate) fn is_observed_in(self, quantity: Quantity) -> bool {
        match self {
            Self::Chain(Distortion::Lag | Distortion::Clock) => quantity != Quantity::Acceleration,
            Self::Chain(Distortion::ReadingHysteresis | Distortion::Nonlinearity) => {
                quantity == Quantity::Position
            }
            _ => true,
        }
    }

    /// Whether it can act on these records at all.
    fn applies(self, facts: &Scales, quantity: Quantity, simulator: &NominalSimulator) -> bool {
        let nominal = simulator.nominal();
        let spring = nominal.stiffness() > 0.0;
        let is_angle = nominal.coordinate() == Coordinate::Angle;
        match self {
            Self::System(SystemEffect::InputDelay | SystemEffect::InputSaturation) => {
                facts.input_torque > 0.0
            }
            Self::System(
                SystemEffect::Backlash | SystemEffect::StiffnessDrift | SystemEffect::FlexibleCoupling,
            ) => spring,
            // On a spring it is a shift of the rest angle, which is part of the calibration.
            Self::System(SystemEffect::ConstantTorque) => !spring,
            // A lag of one frequency is an amplitude and a phase besides: inside the start state.
            Self::Chain(Distortion::Lag) => facts.input_torque > 0.0 && self.is_observed_in(quantity),
            Self::Chain(Distortion::ReadingHysteresis) => {
                facts.resolution > 0.0 && self.is_observed_in(quantity)
            }
            // Sines of the coordinate: a length is not the argument of one.
            Self::System(SystemEffect::Gravity) => is_angle,
            Self::Chain(Distortion::Nonlinearity) => is_angle && self.is_observed_in(quantity),
            _ => self.is_observed_in(quantity),
        }
    }

    /// The candidate that it is at one of its own sizes: Stribeck friction without its excess is Coulomb
    /// friction. A set never holds both.
    pub(crate) fn generalizes(self) -> Option<Self> {
        match self {
            Self::System(SystemEffect::StribeckFriction) => Some(Self::System(SystemEffect::CoulombFriction)),
            _ => None,
        }
    }

    /// The simpler candidate that it tends to at an end of its shape, with the same first parameter: hysteresis that
    /// builds up at once is Coulomb friction.
    pub(crate) fn tends_to(self) -> Option<Self> {
        match self {
            Self::System(SystemEffect::Hysteresis) => Some(Self::System(SystemEffect::CoulombFriction)),
            _ => self.generalizes(),
        }
    }

    /// What it is easily confused with: those are fitted wherever it is.
    pub(crate) fn confused_with(self) -> Vec<Self> {
        let of = |id: &str| Self::ALL.iter().copied().find(|other| other.id() == id);
        let ids: &[&str] = match self {
            Self::System(effect) => effect.description().confused_with,
            Self::Chain(Distortion::Nonlinearity) => &["asymmetric_stiffness", "gravity", "cubic_stiffness"],
            Self::Chain(Distortion::Drift) => &["stiffness_drift"],
            Self::Chain(Distortion::Clock) => &["stiffness_drift", "cubic_stiffness"],
            Self::Chain(Distortion::Saturation) => &["end_stop"],
            Self::Chain(Distortion::Lag) => &["input_delay"],
            Self::Chain(Distortion::ReadingHysteresis) => &["coulomb_friction", "hysteresis"],
        };
        // The relation holds in both directions, whichever of the two files states it.
        let stated = ids.iter().filter_map(|id| of(id));
        let reverse = Self::ALL.iter().copied().filter(|other| match other {
            Self::System(effect) => effect.description().confused_with.contains(&self.id()),
            Self::Chain(_) => false,
        });
        let mut all: Vec<Self> = stated.chain(reverse).filter(|other| *other != self).collect();
        all.sort_by_key(|other| other.rank());
        all.dedup();
        all
    }

    /// Parameters as a fit moves them, with bounds; [`Self::values`] turns them into the law's.
    pub(crate) fn parameters(self, facts: &Scales) -> Vec<Parameter> {
        let a = facts.amplitude;
        match self {
            Self::System(effect) => match effect {
                SystemEffect::CoulombFriction => vec![positive("torque")],
                SystemEffect::StribeckFriction => vec![
                    Parameter {
                        strength: false,
                        upper: if facts.friction_known { 0.0 } else { f64::INFINITY },
                        ..positive("torque")
                    },
                    positive("static_torque"),
                    Parameter { simpler: true, ..between("velocity", 1e-3 * facts.speed, 0.5 * facts.speed) },
                ],
                SystemEffect::QuadraticDrag => vec![positive("coefficient")],
                SystemEffect::CubicStiffness | SystemEffect::AsymmetricStiffness => vec![any("coefficient")],
                SystemEffect::Gravity => vec![any("torque"), any("angle")],
                SystemEffect::ConstantTorque => vec![any("torque")],
                SystemEffect::Backlash => {
                    vec![Parameter { strength: true, shape: false, ..between("half_width", 0.0, 0.9 * a) }]
                }
                SystemEffect::Hysteresis => {
                    vec![positive("torque"), between("displacement", 1e-3 * a, 0.5 * a)]
                }
                SystemEffect::EndStop => vec![
                    between("angle", facts.lowest, facts.highest),
                    Parameter { upper: 1e5 * facts.stiffness, ..positive("stiffness") },
                    Parameter { strength: false, ..positive("dissipation") },
                ],
                SystemEffect::StiffnessDrift | SystemEffect::DampingDrift => vec![any("rate")],
                SystemEffect::PeriodicForcing => vec![
                    any("torque"),
                    // A forcing that does not repeat within the records is a drift.
                    between("frequency", 4.0 * PI / facts.duration, PI / facts.interval),
                    any("phase"),
                ],
                SystemEffect::PositionTorque => {
                    let [lowest, highest] = facts.waves();
                    let wavenumber = between("wavenumber", lowest, highest);
                    vec![any("torque"), Parameter { simpler: true, ..wavenumber }, any("phase")]
                }
                SystemEffect::FlexibleCoupling => {
                    let [slowest, fastest] = facts.modes();
                    let decay = between("damping", LEAST_DECAY / facts.duration, MOST_DAMPED * fastest);
                    vec![
                        Parameter {
                            lower: SMALLEST_BODY * facts.inertia,
                            upper: LARGEST_BODY * facts.inertia,
                            ..positive("inertia")
                        },
                        Parameter { simpler: true, ..between("stiffness", slowest, fastest) },
                        Parameter { simpler: true, ..decay },
                    ]
                }
                SystemEffect::InputDelay => {
                    vec![Parameter {
                        strength: true,
                        shape: false,
                        ..between("delay", 0.0, 1.0 / facts.frequency)
                    }]
                }
                SystemEffect::InputSaturation => {
                    vec![between("torque", 1e-3 * facts.input_torque, facts.input_torque)]
                }
            },
            Self::Chain(Distortion::Lag) => {
                vec![Parameter {
                    strength: true,
                    shape: false,
                    ..between("time_constant", 0.0, 0.5 / facts.frequency)
                }]
            }
            Self::Chain(Distortion::Nonlinearity) => {
                vec![any("amplitude"), any("phase")]
            }
            Self::Chain(Distortion::Drift) => vec![any("rate")],
            Self::Chain(Distortion::Clock) => {
                vec![Parameter {
                    shape: false,
                    ..between("change", -0.4 / facts.duration, 0.4 / facts.duration)
                }]
            }
            Self::Chain(Distortion::Saturation) => {
                vec![between("bound", 1e-3 * facts.reading, facts.reading)]
            }
            Self::Chain(Distortion::ReadingHysteresis) => {
                vec![Parameter { upper: 2.0 * facts.resolution, ..positive("hysteresis") }]
            }
        }
    }

    fn polar(self) -> Option<Polar> {
        match self {
            Self::System(SystemEffect::Gravity) | Self::Chain(Distortion::Nonlinearity) => {
                Some(Polar { size: 0, angle: 1 })
            }
            Self::System(SystemEffect::PeriodicForcing | SystemEffect::PositionTorque) => {
                Some(Polar { size: 0, angle: 2 })
            }
            _ => None,
        }
    }

    /// The law's parameters from a fit's. They differ where the law has a size and an angle, which are fitted
    /// as (size·cos, size·sin); for Stribeck friction, whose second is fitted as the excess of the static
    /// torque, so that it stays at least the first; and for a second body, whose stiffness k and damping c
    /// are fitted as its frequency and decay rate on a body at rest, k = I·ω² and c = 2·I·r: these are what a
    /// record shows, and no step makes the motion faster than its samples.
    pub(crate) fn values(self, fitted: &[f64]) -> Vec<f64> {
        let mut values = fitted.to_vec();
        if let Some(Polar { size, angle }) = self.polar()
            && let (Some(&p), Some(&q)) = (fitted.get(size), fitted.get(angle))
        {
            for (place, value) in [(size, p.hypot(q)), (angle, q.atan2(p))] {
                if let Some(slot) = values.get_mut(place) {
                    *slot = value;
                }
            }
        }
        if let (Self::System(SystemEffect::StribeckFriction), [torque, excess, _]) =
            (self, values.as_mut_slice())
        {
            *excess += *torque;
        }
        if let (Self::System(SystemEffect::FlexibleCoupling), [inertia, stiffness, damping]) =
            (self, values.as_mut_slice())
        {
            *stiffness = *stiffness * *stiffness * *inertia;
            *damping *= 2.0 * *inertia;
        }
        values
    }

    /// A fit's parameters from the law's: the inverse of [`Self::values`].
    pub(crate) fn fitted(self, values: &[f64]) -> Vec<f64> {
        let mut fitted = values.to_vec();
        if let Some(Polar { size, angle }) = self.polar()
            && let (Some(&length), Some(&turned)) = (values.get(size), values.get(angle))
        {
            let (sine, cosine) = turned.sin_cos();
            for (place, value) in [(size, length * cosine), (angle, length * sine)] {
                if let Some(slot) = fitted.get_mut(place) {
                    *slot = value;
                }
            }
        }
        match (self, fitted.as_mut_slice()) {
            (Self::System(SystemEffect::StribeckFriction), [torque, excess, _]) => *excess -= *torque,
            (Self::System(SystemEffect::FlexibleCoupling), [inertia, stiffness, damping]) => {
                *stiffness = (*stiffness / *inertia).sqrt();
                *damping /= 2.0 * *inertia;
            }
            _ => {}
        }
        fitted
    }

    /// Derivatives of [`Self::values`]: row, column and value of what differs from the unit matrix.
    pub(crate) fn slopes(self, fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        if self == Self::System(SystemEffect::StribeckFriction) {
            return vec![(1, 0, 1.0)];
        }
        if let (Self::System(SystemEffect::FlexibleCoupling), &[inertia, frequency, rate]) = (self, fitted) {
            return vec![
                (1, 0, frequency * frequency),
                (1, 1, 2.0 * inertia * frequency),
                (2, 0, 2.0 * rate),
                (2, 2, 2.0 * inertia),
            ];
        }
        let Some(Polar { size, angle }) = self.polar() else { return Vec::new() };
        let at = |place: usize| fitted.get(place).copied().unwrap_or(0.0);
        let (p, q) = (at(size), at(angle));
        let length = p.hypot(q);
        if length == 0.0 {
            return vec![(angle, angle, 0.0)];
        }
        let (cosine, sine) = (p / length, q / length);
        vec![
            (size, size, cosine),
            (size, angle, sine),
            (angle, size, -sine / length),
            (angle, angle, cosine / length),
        ]
    }

    /// Whether fitted values are what the effect's name says, beside a swing.
    ///
    /// A second body that hardly swings at all is a drift, and one whose line in the spectrum lies within its
    /// own half-width of the swing's or of a harmonic is no second line: it shows a damping or a force that
    /// changes with amplitude. Only where it is struck once, at a record's beginning, does its decay tell it
    /// from the harmonic of order n: that one decays n times as fast as the swing. At the ends of its
    /// parameters' ranges one whose mode does not decay within the records is a forcing, one much slower than
    /// the swing a drift.
    pub(crate) fn is_itself(self, fitted: &[f64], swing: &MainMode) -> bool {
        match (self, fitted) {
            (Self::System(SystemEffect::FlexibleCoupling), &[body, mode, rate]) => {
                let line = mode * (1.0 + body / swing.inertia).sqrt();
                let order = (line / swing.frequency).round().max(1.0);
                // Beside the swing itself it has to stand clear of the swing's own line too.
                let width = if order > 1.0 { rate } else { rate.max(swing.decay_rate) };
                let apart = (line - order * swing.frequency).abs() > width;
                let harmonic = order * swing.decay_rate;
                let differs = rate > ANOTHER_DECAY * harmonic || rate * ANOTHER_DECAY < harmonic;
                let decays_apart = swing.starts_once && order > 1.0 && differs;
                rate <= MOST_DAMPED * mode && (apart || decays_apart)
            }
            _ => true,
        }
    }

    /// Hidden state variables that a segment in the middle of a record cannot know and has to fit.
    pub(crate) fn free_hidden(self) -> usize {
        match self {
            Self::System(SystemEffect::FlexibleCoupling) => 2,
            _ => 0,
        }
    }
}

#[cfg(test)]
#[path = "candidate_tests.rs"]
mod tests;
