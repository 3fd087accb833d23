//! Accuracy of each learner on simulated systems whose law is known.

use super::library::Term;
use crate::baselines::{exact, recalibrated};
use crate::data::DataSet;
use crate::judge::{Truth, runs, score};
use crate::testing::{context, data_set, drag_and_cubic, friction_and_gravity, learner};
use dynamics::System;

/// Errors cannot be divided by the exact fit's standard errors for terms that the exact fit expresses
/// differently, so free runs and true weights are compared.
#[test]
fn sindy_finds_friction_and_gravity() {
    let system = friction_and_gravity();
    let data = data_set(&system, false, 1e-3);
    for id in ["sindy", "weak-sindy"] {
        let fitted = learner(id, &[]).fit(&data, &context()).unwrap();
        let names: Vec<&str> = fitted.model.coefficients().iter().map(|own| own.name.as_str()).collect();
        assert_eq!(
            names,
            ["theta", "theta_dot", "sign(theta_dot)", "sin(theta)"],
            "{id}: {:?}",
            fitted.model.equation()
        );
        let truth = Truth::new(&system, &data).unwrap().unwrap();
        for error in truth.coefficient_errors(fitted.model.as_ref()).unwrap() {
            assert!(error.std_errors.unwrap().abs() < 4.0, "{id}: {error:?}");
        }
        let scores = score(fitted.model.as_ref(), &runs(fitted.model.as_ref(), &data), &data);
        assert!(scores.over_noise < 1.1, "{id}: {scores:?}");
        assert!((0.9..=1.0).contains(&scores.coverage_95.unwrap()), "{id}: {scores:?}");
        assert!(truth.torque_error(fitted.model.as_ref()).unwrap() < 0.01);
    }
}

#[test]
fn sindy_finds_drag_and_a_stiffening_spring_under_an_input() {
    let system = drag_and_cubic();
    let data = data_set(&system, true, 2e-3);
    let fitted = learner("sindy", &["members=10"]).fit(&data, &context()).unwrap();
    let names: Vec<&str> = fitted.model.coefficients().iter().map(|own| own.name.as_str()).collect();
    let expected = ["theta", "theta_dot", "theta^3", "theta_dot*|theta_dot|", "u"];
    assert_eq!(names, expected, "{:?}", fitted.model.equation());
    let scores = score(fitted.model.as_ref(), &runs(fitted.model.as_ref(), &data), &data);
    let best = exact(&system, &data, &context()).unwrap();
    let ceiling = score(best.model.as_ref(), &runs(best.model.as_ref(), &data), &data);
    assert!(scores.free_run_rmse < 1.05 * ceiling.free_run_rmse, "{scores:?} {ceiling:?}");
}

/// The law needs a sine, which only the user's terms contain, beside a term that it does not need.
#[test]
fn sindy_takes_the_users_own_terms() {
    let system = friction_and_gravity();
    let data = data_set(&system, false, 1e-3);
    let law = ["library=theta,theta_dot,sign(theta_dot)", "terms=sin(theta),theta*|theta_dot|", "members=0"];
    let fitted = learner("sindy", &law).fit(&data, &context()).unwrap();
    let names: Vec<&str> = fitted.model.coefficients().iter().map(|own| own.name.as_str()).collect();
    assert_eq!(
        names,
        ["theta", "theta_dot", "sign(theta_dot)", "sin(theta)"],
        "{:?}",
        fitted.model.equation()
    );
    let truth = Truth::new(&system, &data).unwrap().unwrap();
    assert!(truth.torque_error(fitted.model.as_ref()).unwrap() < 0.01);
    let bytes = fitted.model.stored().unwrap().to_bytes().unwrap();
    let again = (super::find("sindy").unwrap().restore)(&crate::Stored::from_bytes(&bytes).unwrap()).unwrap();
    assert_eq!(runs(again.as_ref(), &data), runs(fitted.model.as_ref(), &data));
}

#[test]
fn without_a_refit_noise_leaves_a_bias() {
    let system = friction_and_gravity();
    let data = data_set(&system, false, 1e-3);
    let error = |refit: &str| {
        let fitted = learner("sindy", &[refit, "members=0"]).fit(&data, &context()).unwrap();
        score(fitted.model.as_ref(), &runs(fitted.model.as_ref(), &data), &data).free_run_rmse
    };
    assert!(error("refit=false") > 1.5 * error("refit=true"));
}

#[test]
fn the_true_coefficients_are_those_of_the_law() {
    let system = drag_and_cubic();
    let data = data_set(&system, true, 2e-3);
    let truth = Truth::new(&system, &data).unwrap().unwrap();
    let found = truth.coefficients(&Term::ALL).unwrap();
    let of = |term: Term| found.iter().find(|(own, _)| *own == term).map(|(_, value)| *value);
    assert!((of(Term::Cube).unwrap() + 30.0).abs() < 1e-3 && (of(Term::Drag).unwrap() + 0.2).abs() < 1e-6);
}

/// Checks a learner's torque on systems whose nominal oscillator is known, at the states of the test records.
fn torque_within_five_percent(id: &str, overrides: &[&str], systems: usize) {
    let free = friction_and_gravity();
    let driven = drag_and_cubic();
    let all = [(&free, data_set(&free, false, 1e-3)), (&driven, data_set(&driven, true, 2e-3))];
    for (system, data) in all.into_iter().take(systems) {
        let truth = Truth::new(system, &data).unwrap().unwrap();
        let best = recalibrated(&data, &context()).unwrap().model;
        let linear = score(best.as_ref(), &runs(best.as_ref(), &data), &data).free_run_rmse;
        let fitted = learner(id, overrides).fit(&data, &context()).unwrap();
        let model = fitted.model.as_ref();
        let (error, scores) = (truth.torque_error(model).unwrap(), score(model, &runs(model, &data), &data));
        assert!(scores.free_run_rmse < 0.5 * linear, "{scores:?} against {linear}");
        assert!(error < 0.05, "torque {error}, {scores:?}");
    }
}

#[test]
fn a_neural_ode_learns_the_torque_within_five_percent() {
    torque_within_five_percent("neural-ode", &["samples=1500", "restarts=2"], 1);
}

#[test]
fn a_gaussian_process_learns_the_torque_within_five_percent() {
    torque_within_five_percent("gaussian-process", &["samples=1500"], 2);
}

/// The posterior is nearly normal here, so Laplace's approximation of the exact fit can check it.
#[test]
fn a_posterior_has_the_exact_fits_center_and_width() {
    let system = friction_and_gravity();
    let data = data_set(&system, false, 1e-3);
    let law = r#"library=["theta","theta_dot","sign(theta_dot)","sin(theta)"]"#;
    let fitted = learner("bayesian", &[law, "warm_up=30", "draws=120"]).fit(&data, &context()).unwrap();
    let best = exact(&system, &data, &context()).unwrap();
    // In the order of the library; the exact fit has damping, stiffness, friction and gravity.
    let of = |name: &str| best.model.coefficients().iter().find(|own| own.name == name).unwrap().clone();
    let names = ["stiffness", "damping", "coulomb_friction.torque", "gravity.torque"];
    for (own, expected) in fitted.model.coefficients().iter().zip(names.map(of)) {
        let (error, width) = (expected.std_error.unwrap(), own.std_error.unwrap());
        assert!((own.value + expected.value).abs() < 0.5 * error, "{own:?} {expected:?}");
        assert!((0.7..1.4).contains(&(width / error)), "{own:?} {expected:?}");
    }
}

fn a_pinn_infers_coefficients_of(system: &System, data: &DataSet, library: &str) {
    let pinn = learner("pinn", &[&format!("library={library}"), "samples=2000"]);
    let fitted = pinn.fit(data, &context()).unwrap();
    let truth = Truth::new(system, data).unwrap().unwrap();
    for error in truth.coefficient_errors(fitted.model.as_ref()).unwrap() {
        assert!(error.std_errors.unwrap().abs() < 3.0, "{error:?}");
        let size = (error.value - error.truth) / error.std_errors.unwrap();
        assert!(size < 0.3 * error.truth.abs(), "{error:?}");
    }
}

#[test]
fn a_pinn_infers_coefficients_of_free_swings_within_three_standard_errors() {
    let system = friction_and_gravity();
    let law = r#"["theta","theta_dot","sign(theta_dot)","sin(theta)"]"#;
    a_pinn_infers_coefficients_of(&system, &data_set(&system, false, 1e-3), law);
}

#[test]
fn a_pinn_infers_coefficients_under_an_input_within_three_standard_errors() {
    let system = drag_and_cubic();
    let law = r#"["theta","theta_dot","theta_dot*|theta_dot|","theta^3","u"]"#;
    a_pinn_infers_coefficients_of(&system, &data_set(&system, true, 2e-3), law);
}

#[test]
fn symbolic_regression_finds_a_law_that_predicts() {
    let system = friction_and_gravity();
    let data = data_set(&system, false, 1e-3);
    let fitted = learner("symbolic", &[]).fit(&data, &context()).unwrap();
    let truth = Truth::new(&system, &data).unwrap().unwrap();
    let error = truth.torque_error(fitted.model.as_ref()).unwrap();
    assert!(error < 0.02, "{error} {:?}", fitted.model.equation());
}

/// All that training learns is in the weights: without a step, the model is the nominal simulator.
#[test]
fn an_untrained_network_is_the_nominal_simulator() {
    let system = friction_and_gravity();
    let data = data_set(&system, false, 1e-3);
    let fitted =
        learner("neural-ode", &["max_steps=0", "pretraining_steps=0"]).fit(&data, &context()).unwrap();
    let truth = Truth::new(&system, &data).unwrap().unwrap();
    assert!((truth.torque_error(fitted.model.as_ref()).unwrap() - 1.0).abs() < 1e-9);
}

#[test]
fn a_model_predicts_the_same_from_its_file() {
    let system = drag_and_cubic();
    let data = data_set(&system, true, 2e-3);
    for entry in super::LEARNERS {
        let fitted = learner(entry.id, quick(entry)).fit(&data, &context()).unwrap();
        let bytes = fitted.model.stored().unwrap().to_bytes().unwrap();
        let again = (entry.restore)(&crate::Stored::from_bytes(&bytes).unwrap()).unwrap();
        assert_eq!(runs(again.as_ref(), &data), runs(fitted.model.as_ref(), &data), "{}", entry.id);
    }
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let system = friction_and_gravity();
    let data = data_set(&system, false, 1e-3);
    for entry in super::LEARNERS {
        let run =
            || runs(learner(entry.id, quick(entry)).fit(&data, &context()).unwrap().model.as_ref(), &data);
        assert_eq!(run(), run(), "{}", entry.id);
    }
}

/// Number of samples before a change of the input at which a prediction may already respond: models that
/// predict on a grid of their own read the input between the samples of this grid, which has 16 samples per
/// period.
const BETWEEN: usize = 7;

/// A change of the input late in the test part, at several places within the blocks of sequence models, must
/// not change any earlier prediction.
#[test]
fn no_model_looks_ahead() {
    let system = drag_and_cubic();
    let data = data_set(&system, true, 2e-3);
    for entry in super::LEARNERS {
        let fitted = learner(entry.id, quick(entry)).fit(&data, &context()).unwrap();
        let predicted = |data: &crate::data::DataSet| -> Vec<Vec<f64>> {
            let all = runs(fitted.model.as_ref(), data).into_iter();
            all.map(|run| run.predicted.map_or_else(|_| Vec::new(), |own| own.values)).collect()
        };
        let before = predicted(&data);
        for from in [300, 308, 316] {
            let other = |part: &crate::data::Trajectory| {
                let input = part.input().unwrap().iter().enumerate();
                let input = input.map(|(at, value)| if at < from { *value } else { 5.0 - value }).collect();
                let (times, values) = (part.times_s().to_vec(), part.values().to_vec());
                crate::data::Trajectory::new(part.name(), times, values, Some(input)).unwrap()
            };
            let changed =
                crate::data::DataSet { test: data.test.iter().map(other).collect(), ..data.clone() };
            for ((own, before), part) in predicted(&changed).iter().zip(&before).zip(&data.test) {
                // Predictions start at the end of the warm-up.
                let at = from - (part.len() - before.len());
                let same = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
                assert!(own.iter().zip(before).take(at - BETWEEN).all(same), "{} from {from}", entry.id);
                let is_moved = own.iter().zip(before).skip(at).any(|(a, b)| (a - b).abs() > 1e-3);
                assert!(is_moved || before.is_empty(), "{}: the input does nothing", entry.id);
            }
        }
    }
}

/// Settings that make a learner quick, chosen by the keys it has.
fn quick(entry: &crate::Entry) -> &'static [&'static str] {
    let has = |key: &str| entry.fields.iter().any(|field| field.key == key);
    if has("refit") {
        &["members=5", "refit_samples=1500"]
    } else if has("epochs") {
        &["epochs=1", "windows=32", "samples_per_period=16"]
    } else if has("generations") {
        &["generations=3", "population=20", "samples=600", "max_steps=2"]
    } else if has("window_periods") {
        &["samples=300", "max_steps=1"]
    } else if has("draws") {
        &["samples=600", "warm_up=5", "draws=10"]
    } else {
        &["samples=600", "max_steps=2"]
    }
}

/// A displacement has no sine, and a small swing has none that its cubic term does not reproduce.
#[test]
fn a_sine_is_a_term_only_where_it_can_be_told() {
    let system = friction_and_gravity();
    let large = data_set(&system, false, 1e-3);
    let has_sine = |data: &crate::data::DataSet| {
        let fitted =
            learner("sindy", &["refit=false", "members=0", "threshold=0"]).fit(data, &context()).unwrap();
        fitted.model.coefficients().iter().any(|own| own.name == "sin(theta)")
    };
    assert!(has_sine(&large));
    let displacement = crate::data::DataSet { unit: "m".to_owned(), ..large.clone() };
    assert!(!has_sine(&displacement));
    let tenth = |part: &crate::data::Trajectory| {
        let values = part.values().iter().map(|value| 0.1 * value).collect();
        crate::data::Trajectory::new(part.name(), part.times_s().to_vec(), values, None).unwrap()
    };
    let small = crate::data::DataSet { train: large.train.iter().map(tenth).collect(), ..large };
    assert!(!has_sine(&small));
}
