//! Tests of the interface from the outside, as another program uses it.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests")]

use ringdown_lab::contract::Cancel;
use ringdown_lab::learning::{
    Ahead, Context, DataSet, Fitted, LearnError, Learner, Model, Past, Predicted, Reached,
};
use ringdown_lab::{
    Arrays, DiagnosisOptions, Error, EstimateOptions, Excitation, LearnOptions, Nominal, OwnLearner,
    Quantity, Reading, Record, Simulation, Unit, Waveform, diagnose, diagnose_watched, estimate_until, learn,
    simulate,
};
use std::cell::RefCell;

fn arm() -> Nominal {
    Nominal::swinging(3.5, 0.005).unwrap()
}

#[test]
fn a_record_written_as_csv_is_read_again_to_the_bit() {
    let record = simulate(&Simulation::of(&arm()).sampled(100.0, 2.0).noise(1e-3)).unwrap();
    let text = record.to_csv(9);
    assert!(text.starts_with("# origin: simulated\n"));
    let again = Record::parse("again.csv", text.as_bytes(), &Reading::default()).unwrap();
    assert_eq!((again.stamps_s(), again.values()), (record.stamps_s(), record.values()));

    // Arrays do not state their origin, and neither does the file.
    let own = Record::new(record.stamps_s().to_vec(), record.values().to_vec(), Arrays::default()).unwrap();
    assert!(own.to_csv(9).starts_with("time_s,angle_rad\n"));
}

#[test]
fn arrays_are_brought_to_si_units_and_tell_their_quantity() {
    let time: Vec<f64> = (0..20).map(f64::from).collect();
    let of = |unit, quantity| {
        let arrays = Arrays { unit, quantity, input: Some(vec![2.0; 20]), ..Arrays::default() };
        let arrays = Arrays { input_unit: Some(Unit::MillinewtonMeter), ..arrays };
        Record::new(time.clone(), vec![3.0; 20], arrays).unwrap()
    };
    let gyroscope = of(Unit::DegreePerSecond, None);
    assert_eq!((gyroscope.quantity(), gyroscope.unit()), (Quantity::Velocity, "rad/s"));
    assert!((gyroscope.values()[0] - 3.0_f64.to_radians()).abs() < 1e-15);
    assert!((gyroscope.input().unwrap()[0] - 2e-3).abs() < 1e-18);
    // A voltage represents the quantity that is stated for it.
    assert_eq!(of(Unit::Volt, None).quantity(), Quantity::Position);
    assert_eq!(of(Unit::Volt, Some(Quantity::Velocity)).quantity(), Quantity::Velocity);
}

#[test]
fn what_the_simulator_has_already_is_not_named() {
    let record = Simulation::of(&arm())
        .with_effect("coulomb_friction", &[("torque", 1.0)])
        .unwrap()
        .sampled(150.0, 12.0)
        .noise(2e-4)
        .run()
        .unwrap();
    let named = |nominal: &Nominal| {
        let found = diagnose(std::slice::from_ref(&record), nominal, &DiagnosisOptions::default()).unwrap();
        found.verdict().effects.clone()
    };
    assert_eq!(named(&arm()), ["coulomb_friction"]);
    let knowing = arm().with_effect("coulomb_friction", &[("torque", 0.8)]).unwrap();
    assert!(named(&knowing).is_empty());
    // The text is a nominal simulator that contains the effect.
    let again = Nominal::parse("again.toml", &knowing.to_toml()).unwrap();
    assert_eq!(again.to_toml(), knowing.to_toml());
}

#[test]
fn a_driven_displacement_needs_its_input_and_its_unit() {
    let drive = arm().of_a_displacement().unwrap().driven(2.0).unwrap();
    let chirp =
        Excitation { waveform: Waveform::Chirp, amplitude: 5.0, frequency_hz: 1.0, end_frequency_hz: 6.0 };
    let simulation = Simulation::of(&drive).starting(0.0, 0.0).driven_by(chirp).noise(1e-5);
    let record = simulation.run().unwrap();
    assert_eq!(record.unit(), "m");
    let found = diagnose(std::slice::from_ref(&record), &drive, &DiagnosisOptions::default()).unwrap();
    assert!(found.verdict().effects.is_empty(), "{:?}", found.verdict());
    // The guess from the record has the input gain.
    let guessed = Nominal::guess(&record).unwrap().coefficients();
    assert!((guessed.input_gain / 2.0 - 1.0).abs() < 0.01, "{guessed:?}");

    let free = Simulation::of(&drive).run().unwrap();
    let error = diagnose(&[free], &drive, &DiagnosisOptions::default()).unwrap_err();
    assert!(matches!(error, Error::Record(_)) && error.to_string().contains("input"), "{error}");
    let angle = Simulation::of(&arm()).run().unwrap();
    let error = diagnose(&[angle], &drive, &DiagnosisOptions::default()).unwrap_err();
    assert!(error.to_string().contains("is in rad"), "{error}");
}

#[test]
fn the_same_record_twice_is_refused() {
    let record = Simulation::of(&arm()).run().unwrap();
    let twice = [record.clone(), record];
    let error = diagnose(&twice, &arm(), &DiagnosisOptions::default()).unwrap_err();
    assert!(error.to_string().contains("the same record"), "{error}");
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let unknown = Simulation::of(&arm()).with_effect("drag", &[]).unwrap_err();
    assert!(matches!(unknown, Error::Config(_)), "{unknown}");
    let endless = Simulation::of(&arm()).sampled(1e9, 1e9).run().unwrap_err();
    assert!(matches!(endless, Error::Simulation(_)), "{endless}");
}

#[test]
fn a_diagnosis_tells_its_stages_and_ends_after_any() {
    let record = simulate(&Simulation::of(&arm()).sampled(120.0, 6.0).noise(1e-3)).unwrap();
    let stages = RefCell::new(Vec::new());
    let watch = |stage: &'static str| {
        stages.borrow_mut().push(stage);
        stage != "calibration"
    };
    let error = diagnose_watched(&[record], &arm(), &DiagnosisOptions::default(), &watch).unwrap_err();
    assert!(matches!(error, Error::Diagnosis(_)) && error.to_string().contains("`calibration`"), "{error}");
    assert_eq!(stages.into_inner(), ["measurement chain", "calibration"]);
}

#[test]
fn a_request_to_stop_ends_a_fit_with_the_best_so_far() {
    let record = simulate(&Simulation::of(&arm()).noise(1e-4)).unwrap();
    let cancel = Cancel::new();
    cancel.request();
    let found = estimate_until(&record, "pinn", &EstimateOptions::default(), &cancel).unwrap();
    assert_eq!(found.reached, ringdown_lab::Reached::Interrupted);
}

#[test]
fn arrays_are_checked_without_being_taken() {
    let (time, mut values): (Vec<f64>, Vec<f64>) = (0..20).map(|i| (f64::from(i), 0.1)).unzip();
    Record::check("log", &time, &values, None).unwrap();
    values[3] = f64::NAN;
    let checked = Record::check("log", &time, &values, None).unwrap_err();
    let taken =
        Record::new(time, values, Arrays { name: "log".to_owned(), ..Arrays::default() }).unwrap_err();
    assert_eq!(checked.to_string(), taken.to_string());
    assert!(checked.to_string().starts_with("log:4"), "{checked}");
}

/// A learner whose model never moves.
struct Still;

impl Learner for Still {
    fn fit(&self, _: &DataSet, _: &Context<'_>) -> Result<Fitted, LearnError> {
        Ok(Fitted { model: Box::new(Self), reached: Reached::Converged, steps: 0 })
    }
}

impl Model for Still {
    fn free_run(&self, _: &Past<'_>, ahead: &Ahead<'_>) -> Result<Predicted, LearnError> {
        Ok(Predicted { values: vec![0.0; ahead.times_s.len()], std: None })
    }

    fn parameters(&self) -> usize {
        0
    }
}

#[test]
fn a_learner_of_ones_own_is_scored_beside_the_baselines() {
    let pendulum = Nominal::swinging(1.0, 0.01).unwrap();
    let run =
        |position| Simulation::of(&pendulum).released_at(position).noise(1e-3).sampled(50.0, 20.0).run();
    let records = [0.3, 0.5, 0.4].map(|position| run(position).unwrap());
    let options = LearnOptions {
        learners: Some(Vec::new()),
        baselines: Some(vec!["persistence".to_owned(), "nominal".to_owned()]),
        ..LearnOptions::default()
    };
    let own = [OwnLearner { id: "still", learner: &Still }];
    let told = learn(&records, Some(&pendulum), &options, &own, &Cancel::new(), &|_, _| ()).unwrap();
    let error = |id: &str| {
        let row = told.results.iter().find(|row| row.id == id).unwrap();
        row.test.as_ref().unwrap().free_run_rmse.unwrap()
    };
    // The nominal simulator is the truth; the error of standing still is the size of the swing.
    assert!(error("nominal") < 0.005 && error("still") > 0.05, "{} {}", error("nominal"), error("still"));
    assert_eq!(told.problems[0].origin.name(), "simulated");
}

#[test]
fn a_study_tells_which_records_have_missing_cells() {
    let read = |name: &str, missing: std::ops::Range<usize>| {
        let value = |at: usize| if missing.contains(&at) { f64::NAN } else { (0.12 * at as f64).cos() };
        let rows: String =
            (0..1000).map(|at| format!("{:.2},{:.6}\n", 0.02 * at as f64, value(at))).collect();
        let text = format!("time_s,angle_rad\n{rows}");
        Record::parse(&format!("{name}.csv"), text.as_bytes(), &Reading::default()).unwrap()
    };
    let records = [read("a", 0..0), read("b", 100..103), read("c", 0..0)];
    let options = LearnOptions {
        learners: Some(Vec::new()),
        baselines: Some(vec!["persistence".to_owned()]),
        ..LearnOptions::default()
    };
    let told = learn(&records, None, &options, &[], &Cancel::new(), &|_, _| ()).unwrap();
    assert_eq!(told.problems[0].missing, ["b: 3 missing cells left as gaps"]);
}
