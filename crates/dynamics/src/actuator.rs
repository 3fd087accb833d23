//! Actuator with an inner loop: the part of a joint that software makes.
//!
//! A position-commanded servo is a driven oscillator whose spring and damper are gains:
//! I·θ̈ + c·θ̇ + k·(θ − θ_rest) = kp·(u − θ) + kd·(u̇ − θ̇), or with −kd·θ̇ alone where the loop differentiates the
//! measured motion. [`Actuator::drive`] writes it as a nominal oscillator with the input gain kp and known effects, so
//! that everything that works on oscillators works on servo joints.

use crate::active::Active;
use crate::error::DynamicsError;
use crate::input::Hold;
use crate::nominal::{Coefficients, Nominal};
use crate::nominal_simulator::{KnownEffect, NominalSimulator};

/// Number of an actuator as its file states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stated {
    /// Known: its error does not matter.
    Known(f64),
    /// Known within a tolerance, half the width of its 95 % interval, in the unit of the value.
    About {
        /// Most probable value.
        value: f64,
        /// Half the width of its 95 % interval; above 0.
        tolerance: f64,
    },
    /// Not known: the records have to tell it.
    Unknown,
}

impl Stated {
    /// Returns the stated value; `None` if it is unknown.
    #[must_use]
    pub fn value(self) -> Option<f64> {
        match self {
            Self::Known(value) | Self::About { value, .. } => Some(value),
            Self::Unknown => None,
        }
    }

    /// Returns `true` if a recalibration may not move the number.
    #[must_use]
    pub fn is_known(self) -> bool {
        matches!(self, Self::Known(_))
    }
}

/// Quantity that is commanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Position in rad or m.
    Position,
    /// Velocity in rad/s or m/s.
    Velocity,
    /// Torque in N m, or force in N.
    Torque,
}

impl Command {
    /// Returns the name in configurations and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Torque => "torque",
        }
    }
}

/// Inner loop of an actuator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Commanded quantity.
    pub command: Command,
    /// Gain of the position error, in N m/rad; 0 for a velocity or torque command.
    pub proportional: Stated,
    /// Gain of the velocity (error), in N m s/rad.
    pub derivative: Stated,
    /// `true` if the derivative is that of the error, `false` if it is that of the measured motion alone.
    pub on_error: bool,
    /// Time from a command to its action, in s.
    pub delay: Stated,
    /// Command between its samples, if stated.
    pub hold: Option<Hold>,
    /// Largest torque in N m, if limited.
    pub torque_limit: Option<f64>,
    /// Speed in rad/s at which the largest torque has fallen to 0, if it falls.
    pub no_load_speed: Option<f64>,
    /// Half the width of the position errors that cause no torque, in rad.
    pub dead_band: Option<f64>,
    /// Inertia of the rotor as the joint feels it: its own times the square of the gear ratio, in kg m².
    pub reflected_inertia: f64,
}

/// Damping ratio of a loop whose derivative gain is unknown, where a recalibration begins.
const FIRST_DAMPING_RATIO: f64 = 0.7;

impl Actuator {
    /// Returns the gain of the command, in N m per unit of it; `None` if it is unknown.
    #[must_use]
    pub fn gain(&self) -> Option<f64> {
        match self.command {
            Command::Position => self.proportional.value(),
            Command::Velocity => self.derivative.value(),
            Command::Torque => Some(1.0),
        }
    }

    /// Returns the joint's simulator with the loop: a nominal oscillator with known effects. `joint` is the joint
    /// alone, `gain` stands in for the gain of the command if that is unknown.
    ///
    /// ```
    /// use dynamics::{Actuator, Command, Nominal, NominalSimulator, Stated};
    /// let joint = Nominal::new(0.02, 0.01, 0.0, 0.0)?;
    /// let servo = Actuator {
    ///     proportional: Stated::Known(3.0),
    ///     derivative: Stated::Known(0.12),
    ///     on_error: true,
    ///     ..Actuator::of(Command::Position)
    /// };
    /// let simulator = servo.drive(&NominalSimulator::from(&joint), 1.0)?;
    /// let oscillator = simulator.nominal();
    /// assert_eq!([oscillator.stiffness(), oscillator.damping(), oscillator.input_gain()], [3.0, 0.13, 3.0]);
    /// assert_eq!(simulator.effects()[0].active.values(), [0.04], "kd/kp in seconds");
    /// # Ok::<(), dynamics::DynamicsError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`NominalSimulator::new`], such as a loop with a delay around a joint that has one.
    pub fn drive(&self, joint: &NominalSimulator, gain: f64) -> Result<NominalSimulator, DynamicsError> {
        let own = joint.nominal().coefficients();
        let inertia = own.inertia + self.reflected_inertia;
        let gain = self.gain().unwrap_or(gain);
        let proportional = if self.command == Command::Position { gain } else { 0.0 };
        let critical = 2.0 * (inertia * (own.stiffness + proportional)).sqrt();
        let derivative = match self.command {
            Command::Velocity => gain,
            _ => self.derivative.value().unwrap_or(FIRST_DAMPING_RATIO * critical),
        };
        let stiffness = own.stiffness + proportional;
        let loaded = own.stiffness * own.rest_angle;
        let oscillator = Coefficients {
            inertia,
            damping: own.damping + derivative,
            stiffness,
            // Without a spring there is no rest angle.
            rest_angle: if stiffness > 0.0 { loaded / stiffness } else { 0.0 },
            input_gain: gain,
        };
        let nominal: Nominal = joint.nominal().with_coefficients(oscillator)?;
        let mut effects = joint.effects().to_vec();
        effects.extend(self.effects(derivative, proportional)?);
        NominalSimulator::new(nominal, effects)
    }

    /// Returns an actuator with unknown gains, without delay and limits.
    #[must_use]
    pub fn of(command: Command) -> Self {
        Self {
            command,
            proportional: Stated::Unknown,
            derivative: Stated::Unknown,
            on_error: false,
            delay: Stated::Known(0.0),
            hold: None,
            torque_limit: None,
            no_load_speed: None,
            dead_band: None,
            reflected_inertia: 0.0,
        }
    }

    /// Returns the effects of the loop.
    fn effects(&self, derivative: f64, proportional: f64) -> Result<Vec<KnownEffect>, DynamicsError> {
        let known = |id: &str, parameters: &[(&str, f64)], recalibrate: bool| {
            Active::named(id, parameters).map(|active| KnownEffect { active, recalibrate })
        };
        let mut effects = Vec::new();
        if self.command == Command::Position && self.on_error {
            let is_known = self.proportional.is_known() && self.derivative.is_known();
            effects.push(known("command_derivative", &[("time", derivative / proportional)], !is_known)?);
        }
        let delay = self.delay.value().unwrap_or(0.0);
        if delay > 0.0 || !self.delay.is_known() {
            effects.push(known("input_delay", &[("delay", delay)], !self.delay.is_known())?);
        }
        if let Some(torque) = self.torque_limit {
            effects.push(match self.no_load_speed {
                Some(speed) => {
                    known("speed_torque_limit", &[("torque", torque), ("no_load_speed", speed)], false)?
                }
                None if self.command == Command::Torque => {
                    known("input_saturation", &[("torque", torque)], false)?
                }
                None => known("torque_limit", &[("torque", torque)], false)?,
            });
        }
        if let Some(half_width) = self.dead_band {
            effects.push(known("drive_dead_band", &[("half_width", half_width)], false)?);
        }
        Ok(effects)
    }
}

#[cfg(test)]
mod tests {
    use super::{Actuator, Command, Stated};
    use crate::{Nominal, NominalSimulator};

    fn joint() -> NominalSimulator {
        NominalSimulator::from(&Nominal::new(0.02, 0.01, 1.0, 0.4).unwrap())
    }

    #[test]
    fn a_position_loop_is_a_spring_that_the_command_moves() {
        let servo = Actuator {
            proportional: Stated::About { value: 3.0, tolerance: 1.0 },
            derivative: Stated::Unknown,
            delay: Stated::Unknown,
            reflected_inertia: 0.02,
            ..Actuator::of(Command::Position)
        };
        let simulator = servo.drive(&joint(), 9.0).unwrap();
        let own = simulator.nominal().coefficients();
        assert_eq!([own.inertia, own.stiffness, own.input_gain], [0.04, 4.0, 3.0]);
        // Without a command both springs balance: 1·(θ − 0.4) = −3·θ.
        assert_eq!(own.rest_angle, 0.1);
        assert!((own.damping - 0.01 - 1.4 * (0.04_f64 * 4.0).sqrt()).abs() < 1e-15);
        assert_eq!(simulator.effects().len(), 1);
        assert!(simulator.effects()[0].recalibrate && simulator.effects()[0].active.id() == "input_delay");
    }

    #[test]
    fn a_velocity_loop_is_a_damper_and_a_torque_acts_as_it_is() {
        let drive = Actuator { derivative: Stated::Known(0.5), ..Actuator::of(Command::Velocity) };
        let own = drive.drive(&joint(), 9.0).unwrap().nominal().coefficients();
        assert_eq!([own.damping, own.stiffness, own.input_gain, own.rest_angle], [0.51, 1.0, 0.5, 0.4]);
        let drive = Actuator { derivative: Stated::Known(0.0), ..Actuator::of(Command::Torque) };
        let own = drive.drive(&joint(), 9.0).unwrap().nominal().coefficients();
        assert_eq!([own.damping, own.stiffness, own.input_gain], [0.01, 1.0, 1.0]);
    }

    #[test]
    fn an_unknown_gain_takes_the_one_that_stands_in() {
        let own = Actuator::of(Command::Position).drive(&joint(), 9.0).unwrap().nominal().coefficients();
        assert_eq!([own.stiffness, own.input_gain], [10.0, 9.0]);
    }
}
