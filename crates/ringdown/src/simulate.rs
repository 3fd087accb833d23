//! Simulation of records.

use crate::error::Error;
use crate::nominal::{Nominal, config};
use crate::record::{Arrays, Record};
use dynamics::chain::{Chain, Observed};
use dynamics::{Active, Effect, Start, System};
use record::{Origin, Quantity, Source, Statements};
use truth::{Draws, Sampling, TRUTH_SCHEMA, Truth};
pub use truth::{Excitation, Waveform};
use workflow::Loaded;

/// A simulation of one record: a system with effects, an initial state, and a measurement chain.
///
/// By default it starts at rest at 0.5 rad (or m) and is sampled at 200 Hz for 20 s, without noise and with
/// seed 0.
///
/// ```
/// use ringdown_lab::{Nominal, Simulation};
///
/// let pendulum = Simulation::of(&Nominal::swinging(1.0, 0.0)?)
///     .with_effect("quadratic_drag", &[("coefficient", 0.05)])?
///     .with_effect("sensor_quantization", &[("step", 0.001)])?
///     .sampled(100.0, 10.0);
/// let record = pendulum.run()?;
/// assert_eq!(record.len(), 1000);
/// // The same seed gives the same bits.
/// assert_eq!(record.values(), pendulum.run()?.values());
/// # Ok::<(), ringdown_lab::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Simulation {
    nominal: dynamics::Nominal,
    effects: Vec<Active>,
    start: Start,
    excitation: Option<Excitation>,
    observed: Observed,
    noise: f64,
    rate_hz: f64,
    seconds: f64,
    seed: u64,
}

/// Simulates one record: [`Simulation::run`].
///
/// # Errors
/// As [`Simulation::run`].
pub fn simulate(simulation: &Simulation) -> Result<Record, Error> {
    simulation.run()
}

impl Simulation {
    /// Creates a simulation of a nominal simulator with its effects.
    #[must_use]
    pub fn of(nominal: &Nominal) -> Self {
        Self {
            nominal: nominal.stated.nominal,
            effects: nominal.stated.simulator.effects().iter().map(|known| known.active).collect(),
            start: Start::release(0.5),
            excitation: None,
            observed: Observed::Position,
            noise: 0.0,
            rate_hz: 200.0,
            seconds: 20.0,
            seed: 0,
        }
    }

    /// Adds an effect to the system or to the measurement chain; [`effects`](crate::effects) lists all
    /// effects.
    ///
    /// # Errors
    /// [`Error::Config`] for an unknown effect or parameter, or a value out of range.
    pub fn with_effect(mut self, id: &str, parameters: &[(&str, f64)]) -> Result<Self, Error> {
        self.effects.push(Active::named(id, parameters).map_err(config)?);
        Ok(self)
    }

    /// Sets the initial state: a release from rest at a position in rad or m.
    #[must_use]
    pub fn released_at(self, position: f64) -> Self {
        Self { start: Start::release(position), ..self }
    }

    /// Sets the initial state: a position in rad or m and a velocity in rad/s or m/s.
    #[must_use]
    pub fn starting(self, position: f64, velocity: f64) -> Self {
        Self { start: Start { position, velocity }, ..self }
    }

    /// Sets an input that drives the system; the record contains it too.
    ///
    /// ```
    /// use ringdown_lab::{Excitation, Nominal, Simulation, Waveform};
    ///
    /// let chirp = Excitation { waveform: Waveform::Chirp, amplitude: 2.0, frequency_hz: 1.0, end_frequency_hz: 8.0 };
    /// let record = Simulation::of(&Nominal::swinging(3.5, 0.02)?.driven(1.0)?).starting(0.0, 0.0).driven_by(chirp).run()?;
    /// assert_eq!(record.input().map(<[f64]>::len), Some(record.len()));
    /// # Ok::<(), ringdown_lab::Error>(())
    /// ```
    #[must_use]
    pub fn driven_by(self, excitation: Excitation) -> Self {
        Self { excitation: Some(excitation), ..self }
    }

    /// Sets the observed quantity: position, velocity or acceleration.
    #[must_use]
    pub fn observing(self, quantity: Quantity) -> Self {
        let observed = match quantity {
            Quantity::Position => Observed::Position,
            Quantity::Velocity => Observed::Velocity,
            Quantity::Acceleration => Observed::Acceleration,
        };
        Self { observed, ..self }
    }

    /// Sets the sampling rate in hertz and the length in seconds.
    #[must_use]
    pub fn sampled(self, rate_hz: f64, seconds: f64) -> Self {
        Self { rate_hz, seconds, ..self }
    }

    /// Sets the standard deviation of the sensor's white noise, in the unit of the observed quantity.
    #[must_use]
    pub fn noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// Sets the root seed of all random draws.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Integrates the motion and passes it through the measurement chain. The record is marked as simulated.
    ///
    /// # Errors
    /// [`Error::Config`] for effects that contradict each other, [`Error::Simulation`] for an impossible
    /// motion or sampling.
    pub fn run(&self) -> Result<Record, Error> {
        let (acting, sensing): (Vec<Active>, Vec<Active>) =
            self.effects.iter().partition(|active| matches!(active.effect(), Effect::System(_)));
        let truth = Truth {
            schema: TRUTH_SCHEMA.to_owned(),
            system: System::new(self.nominal, acting).map_err(config)?,
            start: self.start,
            excitation: self.excitation,
            chain: Chain::new(self.observed, self.noise, sensing).map_err(config)?,
            sampling: Sampling {
                rate_hz: self.rate_hz,
                samples: (self.rate_hz * self.seconds).round() as usize,
                first_stamp_s: 0.0,
                stamp_decimals: 9,
                value_decimals: 9,
            },
            draws: Draws { seed: self.seed, branch: vec!["simulate".to_owned()] },
        };
        let record = simulator::generate(&truth)?;
        // The digest is that of the file as it would be read again.
        let text = simulator::csv_text(&record, 9, 9);
        let unit = record.unit();
        let arrays = Arrays::default();
        let source = Source {
            path: "simulated".to_owned(),
            digest: runs::digest(text.as_bytes()),
            statements: Statements { origin: Some(Origin::Simulated), ..Statements::default() },
            findings: Vec::new(),
            reading: record::Reading {
                sentence: format!("simulated; values in {unit}"),
                format: "simulation".to_owned(),
                quantity: record.quantity(),
                coordinate: match unit {
                    unit if unit.starts_with("rad") => record::Coordinate::Angle,
                    _ => record::Coordinate::Displacement,
                },
                ..record::Reading::default()
            },
        };
        let columns = if record.input().is_some() { "time, values, input" } else { "time, values" };
        Ok(Record {
            loaded: Loaded { record, source, clock: arrays.clock, origin: None, columns: columns.to_owned() },
        })
    }
}
