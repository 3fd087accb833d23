//! Drawing of systems and their records from a plan.

use crate::generate::generate;
use crate::generation_error::GenerationError;
use crate::plan::{Plan, PlannedEffect};
use crate::prior::Prior;
use dynamics::chain::Chain;
use dynamics::{Active, Coefficients, Effect, Nominal, Range, Start, System};
use rand::RngExt;
use record::Record;
use seed::Seed;
use truth::{Draws, Sealed, TRUTH_SCHEMA, Truth};

/// Drawn system: the believed nominal oscillator, and the truth that generates each of its records.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnSystem {
    /// Nominal oscillator that a user would believe in: without the effects, and off by the calibration
    /// error.
    pub nominal: Nominal,
    /// Truths, one for each record; they differ in start and draws only.
    pub truths: Vec<Truth>,
}

impl Plan {
    /// Draws the system with a number from 0. It depends on the seed and the number alone.
    ///
    /// # Errors
    /// Returns [`GenerationError::Dynamics`] if the drawn numbers contradict each other.
    pub fn draw(&self, system: usize) -> Result<DrawnSystem, GenerationError> {
        let branch = ["simulate".to_owned(), format!("system {system}")];
        let seed = branch.iter().fold(Seed::new(self.seed), |node, name| node.child(name));
        let nominal = self.draw_nominal(&seed.child("nominal"))?;
        let (acting, sensing): (Vec<Active>, Vec<Active>) = self
            .draw_effects(&seed.child("effects"))?
            .into_iter()
            .partition(|active| matches!(active.effect(), Effect::System(_)));
        let noise = self.noise.draw(&seed.child("sensor"));
        let chain = Chain::new(self.observed, noise, sensing)?;
        let actual = System::new(nominal, acting)?;
        let truths = (0..self.records)
            .map(|record| {
                let name = format!("record {record}");
                let [position, velocity] =
                    self.start.each_ref().map(|number| number.draw(&seed.child(&name).child("start")));
                Truth {
                    schema: TRUTH_SCHEMA.to_owned(),
                    system: actual.clone(),
                    start: Start { position, velocity },
                    excitation: self.excitation,
                    chain: chain.clone(),
                    sampling: self.sampling,
                    draws: Draws {
                        seed: self.seed,
                        branch: branch.iter().cloned().chain([name.clone()]).collect(),
                    },
                }
            })
            .collect();
        Ok(DrawnSystem { nominal: self.believed(&nominal, &seed.child("calibration"))?, truths })
    }

    /// Generates a record of a system, with its truth under seal; both numbers from 0.
    ///
    /// # Errors
    /// Returns the same errors as [`Plan::draw`] and [`generate`], and [`GenerationError::NoSuchRecord`].
    pub fn record(&self, system: usize, record: usize) -> Result<(Record, Sealed<Truth>), GenerationError> {
        let drawn = self.draw(system)?;
        let truth = drawn.truths.get(record).ok_or(GenerationError::NoSuchRecord { record })?;
        Ok((generate(truth)?, Sealed::seal(truth)?))
    }

    fn draw_nominal(&self, seed: &Seed) -> Result<Nominal, GenerationError> {
        let [inertia, damping, stiffness, rest_angle, input_gain] =
            self.nominal.coefficients.each_ref().map(|number| number.draw(seed));
        let coefficients = Coefficients { inertia, damping, stiffness, rest_angle, input_gain };
        let nominal = Nominal::from_coefficients(coefficients)?.with_coordinate(self.nominal.coordinate);
        Ok(match self.nominal.sensor_resolution {
            Some(resolution) => nominal.with_sensor_resolution(resolution)?,
            None => nominal,
        })
    }

    /// Draws the effects of one system: each with its probability, or as many as requested, drawn without
    /// replacement with the probabilities as weights (Efraimidis, Spirakis, Information Processing Letters 97
    /// (2006) 181: the largest u^(1/w)).
    fn draw_effects(&self, seed: &Seed) -> Result<Vec<Active>, GenerationError> {
        let chance = |planned: &PlannedEffect| {
            seed.child(planned.effect.id()).child("presence").generator().random::<f64>()
        };
        let mut present: Vec<&PlannedEffect> = match self.effects_per_system {
            None => self.effects.iter().filter(|planned| chance(planned) < planned.probability).collect(),
            Some(_) => self.effects.iter().filter(|planned| planned.probability > 0.0).collect(),
        };
        if let Some(count) = self.effects_per_system {
            present.sort_by(|one, other| {
                let key = |planned: &PlannedEffect| libm::log(chance(planned)) / planned.probability;
                key(other).total_cmp(&key(one))
            });
            present.truncate(count);
        }
        present
            .into_iter()
            .map(|planned| {
                let own = seed.child(planned.effect.id());
                let values: Vec<f64> = planned.parameters.iter().map(|number| number.draw(&own)).collect();
                let active = Active::of(planned.effect, &values)?;
                Ok(planned.start.as_ref().map_or(Ok(active), |states| active.starting_at(states))?)
            })
            .collect()
    }

    fn believed(&self, actual: &Nominal, seed: &Seed) -> Result<Nominal, GenerationError> {
        let believed = |name: &str, mean: f64, deviation: f64, range: &Range| {
            Prior::Normal { mean, deviation }.draw(range, &mut seed.child(name).generator())
        };
        let is = actual.coefficients();
        let off = self.calibration;
        let relative = |name, value: f64, deviation| {
            // A coefficient of 0 is known to be 0: there is nothing to calibrate.
            if value == 0.0 { value } else { believed(name, value, deviation * value, &Range::POSITIVE) }
        };
        Ok(actual.with_coefficients(Coefficients {
            inertia: relative("inertia", is.inertia, off.inertia),
            damping: relative("damping", is.damping, off.damping),
            stiffness: relative("stiffness", is.stiffness, off.stiffness),
            rest_angle: believed("rest_angle", is.rest_angle, off.rest_angle, &Range::ANY),
            input_gain: is.input_gain,
        })?)
    }
}
