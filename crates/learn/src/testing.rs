//! Simulated data sets for tests, made by the reference integrator, which shares no code with this crate's
//! integrator.

use crate::data::{DataSet, Making, Split, SplitKind, Trajectory};
use crate::{Context, Learner};
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Active, Hold, Input, Nominal, NominalSimulator, Start, System};
use estimator::Cancel;
use rand_distr::{Distribution, Normal};
use seed::Seed;
use settings::{Document, Resolved, Section};

pub(crate) static NEVER: Cancel = Cancel::new();

pub(crate) fn context() -> Context<'static> {
    Context { seed: Seed::new(1), max_steps: None, cancel: &NEVER, observe: &|_| (), checkpoints: None }
}

/// Dry friction and gravity on a spring, swinging freely: θ̈ = −16·θ − 0.12·θ̇ − 0.15·sign θ̇ − 24·sin θ.
pub(crate) fn friction_and_gravity() -> System {
    let effects = vec![
        Active::new("coulomb_friction", &[0.15]).unwrap(),
        Active::new("gravity", &[24.0, 0.0]).unwrap(),
    ];
    System::new(Nominal::new(1.0, 0.12, 16.0, 0.0).unwrap(), effects).unwrap()
}

/// Drag and a hardening spring, driven: θ̈ = −40·θ − 0.3·θ̇ − 0.2·θ̇|θ̇| − 30·θ³ + u.
pub(crate) fn drag_and_cubic() -> System {
    let effects = vec![
        Active::new("quadratic_drag", &[0.2]).unwrap(),
        Active::new("cubic_stiffness", &[30.0]).unwrap(),
    ];
    System::new(Nominal::new(1.0, 0.3, 40.0, 0.0).unwrap(), effects).unwrap()
}

/// Simulates a record of 10 s at 50 Hz with noise.
pub(crate) fn record(system: &System, number: usize, driven: bool, noise: f64) -> Trajectory {
    record_held(system, number, driven.then_some(Hold::Zero), noise)
}

/// Simulates such a record; an input is held or interpolated linearly between samples.
pub(crate) fn record_held(system: &System, number: usize, hold: Option<Hold>, noise: f64) -> Trajectory {
    let times: Vec<f64> = (0..500).map(|at| f64::from(at) * 0.02).collect();
    let force = |time: f64| {
        let frequency = 0.4 + 0.13 * number as f64;
        10.0 * (std::f64::consts::TAU * (frequency + 0.08 * time) * time).sin()
    };
    let input = hold.map(|_| times.iter().map(|&time| force(time)).collect::<Vec<_>>());
    let given = input.as_ref().zip(hold);
    let given = given.map(|(input, hold)| Input::new(times.clone(), input.clone(), hold).unwrap());
    let start = Start { position: 1.2 - 0.15 * number as f64, velocity: 0.3 };
    let motion = simulate(system, start, given.as_ref(), &times, &Tolerance::default()).unwrap();
    let mut generator = Seed::new(number as u64).child("noise").generator();
    let normal = Normal::new(0.0, noise).unwrap();
    let values = motion.position.iter().map(|value| value + normal.sample(&mut generator)).collect();
    Trajectory::new(format!("record-{number}"), times, values, input).unwrap()
}

pub(crate) fn making(nominal: Option<NominalSimulator>) -> Making {
    Making {
        split: Split {
            kind: SplitKind::Record,
            test_records: 2,
            validation_records: 1,
            test_share: 0.25,
            validation_share: 0.2,
        },
        unit: "rad".to_owned(),
        nominal,
        hold: Some(Hold::Zero),
        warm_up_s: None,
        period_s: None,
        noise: None,
    }
}

/// Makes six records of a system whose nominal oscillator is known and whose effects are not.
pub(crate) fn data_set(system: &System, driven: bool, noise: f64) -> DataSet {
    let records: Vec<Trajectory> = (0..6).map(|number| record(system, number, driven, noise)).collect();
    DataSet::new(&records, making(Some(NominalSimulator::from(system.nominal())))).unwrap()
}

/// Builds a learner with its default settings, except for overrides `key=value`.
pub(crate) fn learner(id: &str, overrides: &[&str]) -> Box<dyn Learner> {
    let entry = crate::learners::find(id).unwrap();
    let mut document = Document::default();
    for line in overrides {
        document.apply_override(&format!("{id}.{line}")).unwrap();
    }
    let sections = [Section { name: entry.id, fields: entry.fields }];
    (entry.build)(&Resolved::new(&document, &sections).unwrap()).unwrap()
}
