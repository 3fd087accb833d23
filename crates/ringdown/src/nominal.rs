//! The nominal simulator: the model of a system before any diagnosis.

use crate::error::Error;
use crate::record::Record;
use dynamics::{Active, Coefficients, Coordinate, KnownEffect, NominalSimulator};
use experiment::StatedNominal;
use std::path::Path;
use workflow::{Reading, WorkflowError, guess, nominal};

/// The nominal simulator: a linear oscillator with the effects that it already has.
///
/// I·θ̈ + c·θ̇ + k·(θ − θ_rest) = g·u(t), in SI units, or with everything divided by the inertia, which is
/// then 1.
#[derive(Debug, Clone)]
pub struct Nominal {
    pub(crate) stated: StatedNominal,
    pub(crate) name: String,
}

impl Nominal {
    /// Creates a nominal simulator of an angle in free motion from its coefficients.
    ///
    /// # Errors
    /// [`Error::Config`] unless the inertia is above 0, damping and stiffness are at least 0, and all numbers
    /// are finite.
    pub fn new(inertia: f64, damping: f64, stiffness: f64, rest_angle: f64) -> Result<Self, Error> {
        let nominal = dynamics::Nominal::new(inertia, damping, stiffness, rest_angle).map_err(config)?;
        Self::of(NominalSimulator::new(nominal, Vec::new()).map_err(config)?, false)
    }

    /// Creates a nominal simulator per unit of inertia from its natural frequency in hertz and its damping
    /// ratio.
    ///
    /// # Errors
    /// [`Error::Config`] unless the frequency is above 0 and the ratio is at least 0.
    ///
    /// ```
    /// use ringdown_lab::Nominal;
    ///
    /// let nominal = Nominal::swinging(3.5, 0.01)?;
    /// let stiffness = nominal.coefficients().stiffness;
    /// assert!((stiffness.sqrt() / std::f64::consts::TAU - 3.5).abs() < 1e-12);
    /// # Ok::<(), ringdown_lab::Error>(())
    /// ```
    pub fn swinging(natural_frequency_hz: f64, damping_ratio: f64) -> Result<Self, Error> {
        let text =
            format!("natural_frequency = {natural_frequency_hz:?}\ndamping_ratio = {damping_ratio:?}\n");
        Self::parse("nominal", &text)
    }

    /// Guesses a nominal simulator from a record: the nearest linear oscillator, as `trainer init` writes it.
    ///
    /// # Errors
    /// [`Error::Record`] if nothing moves or the record is shorter than a few swings.
    ///
    /// ```
    /// use ringdown_lab::{Nominal, Simulation};
    ///
    /// let record = Simulation::of(&Nominal::swinging(3.5, 0.01)?).noise(1e-4).run()?;
    /// let guessed = Nominal::guess(&record)?.coefficients();
    /// assert!((guessed.stiffness.sqrt() / std::f64::consts::TAU - 3.5).abs() < 1e-3);
    /// # Ok::<(), ringdown_lab::Error>(())
    /// ```
    pub fn guess(record: &Record) -> Result<Self, Error> {
        let source = &record.loaded.source;
        let oscillator = identify::identify(&record.loaded.record, &record.clock()?).map_err(|problem| {
            Error::Record(WorkflowError::Identify { file: source.path.clone(), source: problem })
        })?;
        Self::parse("nominal.toml", &guess::nominal_toml(&source.path, &oscillator, &source.reading))
    }

    /// Reads a nominal simulator from a `nominal.toml`.
    ///
    /// # Errors
    /// [`Error::Config`] with file, line and column.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        Ok(Self { stated: nominal::read(path)?, name: path.display().to_string() })
    }

    /// Reads a nominal simulator from the text of a `nominal.toml`; messages refer to it as `name`.
    ///
    /// # Errors
    /// As [`Nominal::read`].
    ///
    /// ```
    /// use ringdown_lab::Nominal;
    ///
    /// let pendulum = "inertia = 0.02\ndamping = 0.001\nstiffness = 0.0\nrest_angle = 0.0\n\
    ///     [[effects]]\nid = \"gravity\"\nparameters = { torque = 0.9, angle = 0.0 }\n";
    /// assert_eq!(Nominal::parse("nominal.toml", pendulum)?.coefficients().inertia, 0.02);
    /// // A message says where.
    /// let error = Nominal::parse("nominal.toml", "inertia = 0.02\ndampin = 0.001\n").unwrap_err();
    /// assert!(error.to_string().starts_with("nominal.toml:2:1: "), "{error}");
    /// # Ok::<(), ringdown_lab::Error>(())
    /// ```
    pub fn parse(name: &str, text: &str) -> Result<Self, Error> {
        Ok(Self { stated: nominal::parse(name, text)?, name: name.to_owned() })
    }

    /// Adds an effect that the simulator already has, so that no diagnosis names it. Recalibration may change
    /// its parameters.
    ///
    /// # Errors
    /// [`Error::Config`] for an unknown effect or parameter, a value out of range, or an effect given twice.
    ///
    /// ```
    /// use ringdown_lab::Nominal;
    ///
    /// let arm = Nominal::swinging(3.5, 0.01)?.with_effect("coulomb_friction", &[("torque", 0.8)])?;
    /// assert!(arm.to_toml().contains("coulomb_friction"));
    /// # Ok::<(), ringdown_lab::Error>(())
    /// ```
    pub fn with_effect(self, id: &str, parameters: &[(&str, f64)]) -> Result<Self, Error> {
        let active = Active::named(id, parameters).map_err(config)?;
        let simulator = &self.stated.simulator;
        let effects = simulator.effects().iter().copied().chain([KnownEffect { active, recalibrate: true }]);
        let simulator = NominalSimulator::new(*simulator.nominal(), effects.collect()).map_err(config)?;
        Ok(Self { stated: StatedNominal { simulator, ..self.stated }, ..self })
    }

    /// Changes the coordinate from an angle to a displacement in meters.
    ///
    /// # Errors
    /// [`Error::Config`] if one of the effects is for angles only.
    pub fn of_a_displacement(self) -> Result<Self, Error> {
        let nominal = self.stated.nominal.with_coordinate(Coordinate::Displacement);
        let simulator = NominalSimulator::new(nominal, self.stated.simulator.effects().to_vec());
        let made = Self::of(simulator.map_err(config)?, self.stated.driven)?;
        Ok(Self { name: self.name, ..made })
    }

    /// Sets the gain of the input: torque or force per unit of the input.
    ///
    /// # Errors
    /// [`Error::Config`] for a gain that is not finite.
    pub fn driven(self, input_gain: f64) -> Result<Self, Error> {
        let nominal = self.stated.nominal;
        let nominal = nominal
            .with_coefficients(Coefficients { input_gain, ..nominal.coefficients() })
            .map_err(config)?;
        let simulator = NominalSimulator::new(nominal, self.stated.simulator.effects().to_vec());
        let made = Self::of(simulator.map_err(config)?, true)?;
        Ok(Self { name: self.name, ..made })
    }

    /// Returns reading options for records of this system: columns and units that fit its coordinate, and an
    /// input if it has an input gain.
    #[must_use]
    pub fn reading(&self, reading: Reading) -> Reading {
        reading.for_nominal(&self.stated)
    }

    /// Returns inertia, damping, stiffness, rest angle and input gain.
    #[must_use]
    pub fn coefficients(&self) -> Coefficients<f64> {
        self.stated.nominal.coefficients()
    }

    /// Returns the simulator as the text of a `nominal.toml`.
    #[must_use]
    pub fn to_toml(&self) -> String {
        export::nominal_text(&self.stated.simulator)
    }

    fn of(simulator: NominalSimulator, driven: bool) -> Result<Self, Error> {
        let stated = StatedNominal { driven, ..StatedNominal::from(simulator) };
        Ok(Self { stated, name: "nominal".to_owned() })
    }
}

pub(crate) fn config(error: impl std::fmt::Display) -> Error {
    Error::Config(error.to_string())
}
