use super::{evidence_class, is_flexible};
use crate::data::scales::{Repeats, Scales};
use crate::model::candidate::{Candidate, MainMode, Parameter};
use crate::model::candidates::flexible_coupling::FlexibleCoupling;
use crate::model::candidates::periodic_forcing::PeriodicForcing;
use crate::model::candidates::{Along, Lines, Mode};
use dynamics::{Coordinate, Hold, Input, Nominal, REGISTRY};
use record::Quantity;

const FACTS: Scales = Scales {
    noise: 0.0,
    damping: 0.0,
    drive_noise: 0.0,
    amplitude: 0.7,
    highest: 0.7,
    lowest: -0.7,
    reading: 0.7,
    speed: 15.0,
    frequency: 22.0,
    torque: 340.0,
    input_torque: 1.0,
    drive_torque: 340.0,
    drive_error: 0.7,
    duration: 25.0,
    interval: 1.0 / 260.0,
    rest_moved: 0.0,
    friction_known: false,
    inertia: 1.0,
    stiffness: 484.0,
    resolution: 1e-3,
    rate_error: 0.0,
    repeats: None,
    tolerance: Scales::UNKNOWN_NOISE,
};

#[test]
fn no_sine_is_taken_of_a_length() {
    let angle = Nominal::new(1.0, 0.2, 484.0, 0.0).unwrap();
    let length = angle.with_coordinate(Coordinate::Displacement);
    let ids = |nominal: &Nominal| -> Vec<&str> {
        let those = Candidate::that_apply(&FACTS, Quantity::Position, &nominal.into());
        those.into_iter().map(Candidate::id).collect()
    };
    let mut of_angles = ids(&angle);
    of_angles.retain(|id| !ids(&length).contains(id));
    of_angles.sort_unstable();
    assert_eq!(of_angles, ["gravity", "sensor_nonlinearity"]);
}

#[test]
fn parameters_are_the_laws_own() {
    for candidate in Candidate::ALL.iter().chain(&Candidate::NAMELESS) {
        let parameters = candidate.parameters(&FACTS);
        for parameter in &parameters {
            assert!(parameter.lower < parameter.upper, "{} {}", candidate.id(), parameter.name);
        }
        if let Some(effect) = candidate.system() {
            let names: Vec<&str> = effect.description().parameters.iter().map(|p| p.name).collect();
            let fitted: Vec<&str> = parameters.iter().map(|p| p.name).collect();
            assert!(names.starts_with(&fitted), "{}", candidate.id());
        }
    }
}

/// A swing of 22 rad/s that decays at 0.1/s, released once.
const SWING: MainMode<'static> = MainMode {
    inputs: &[],
    frequency: 22.0,
    decay_rate: 0.1,
    inertia: 1.0,
    resolution: 0.25,
    starts_once: true,
    repeats: None,
};

/// Four repetitions of a driven motion at 1.01 rad/s: everything that depends on it has lines at 2.02, 3.03,
/// ...
#[test]
fn a_multiple_of_what_repeats_is_no_forcing() {
    let forcing = Candidate::new(&PeriodicForcing);
    let driven = MainMode { repeats: Some(Repeats { frequency: 1.01, resolution: 0.25 }), ..SWING };
    for (frequency, is_itself) in
        [(1.0, false), (2.1, false), (1.5, true), (4.1, false), (4.4, true), (0.5, true)]
    {
        assert_eq!(forcing.is_itself(&[1.0, frequency, 0.0], &driven), is_itself, "{frequency}");
        assert!(forcing.is_itself(&[1.0, frequency, 0.0], &SWING), "{frequency}");
    }
}

/// A light body of frequency 66 rad/s beside a swing of 22 rad/s that decays at 0.1/s. It lies at the swing's
/// third harmonic, which decays at 0.3/s.
#[test]
fn a_harmonic_is_no_second_body() {
    let coupling = Candidate::new(&FlexibleCoupling);
    let swing = SWING;
    let is_itself = |line: f64, rate: f64, swing: &MainMode| coupling.is_itself(&[0.0, line, rate], swing);
    assert!(!is_itself(66.0, 0.3, &swing));
    assert!(!is_itself(66.0, 0.44, &swing));
    assert!(!is_itself(66.0, 0.21, &swing));
    // A body that is struck once decays at its own rate; a harmonic does not.
    assert!(is_itself(66.0, 0.46, &swing));
    assert!(is_itself(66.0, 0.19, &swing));
    assert!(!is_itself(66.0, 0.61, &MainMode { starts_once: false, ..swing }));
    assert!(is_itself(66.5, 0.3, &swing));
    // Near the swing itself no decay tells it apart, and a body that hardly swings is none.
    assert!(!is_itself(22.0, 2.0, &swing));
    assert!(!is_itself(60.0, 50.0, &swing));
    // Within half a turn of the swing over the record, the line is the swing's own on clocks that differ.
    assert!(is_itself(22.2, 0.1, &swing) && !is_itself(22.2, 0.1, &MainMode { resolution: 0.5, ..swing }));
}

#[test]
fn confusion_is_mutual() {
    for candidate in Candidate::ALL {
        for other in candidate.confused_with() {
            if candidate.system().is_some() && other.system().is_some() {
                assert!(other.confused_with().contains(candidate), "{} {}", candidate.id(), other.id());
            }
        }
    }
}

/// Parameters inside their bounds, none of them 0.
fn inside(candidate: Candidate) -> Vec<f64> {
    let bounded = |p: Parameter| match (p.lower.is_finite(), p.upper.is_finite()) {
        (true, true) => p.lower + 0.3 * (p.upper - p.lower),
        (true, false) => p.lower + 0.7,
        _ => 0.4,
    };
    candidate.parameters(&FACTS).into_iter().map(bounded).collect()
}

#[test]
fn a_fits_parameters_come_back_from_the_laws_with_their_derivatives() {
    for candidate in Candidate::ALL.iter().chain(&Candidate::NAMELESS).copied() {
        let fitted = inside(candidate);
        let again = candidate.fitted(&candidate.values(&fitted));
        for (own, again) in fitted.iter().zip(&again) {
            assert!((own - again).abs() <= 1e-12 * own.abs(), "{candidate:?} {fitted:?} {again:?}");
        }
        let stated = candidate.slopes(&fitted);
        for column in 0..fitted.len() {
            let h = 1e-6 * fitted[column].abs();
            let at = |by: f64| {
                let mut moved = fitted.clone();
                moved[column] += by;
                candidate.values(&moved)
            };
            for (row, (above, below)) in at(h).into_iter().zip(at(-h)).enumerate() {
                let unit = f64::from(u8::from(row == column));
                let own = stated.iter().find(|slope| (slope.0, slope.1) == (row, column));
                let own = own.map_or(unit, |slope| slope.2);
                let difference = (above - below) / (2.0 * h);
                assert!((own - difference).abs() < 1e-6 * (1.0 + own.abs()), "{candidate:?} {row} {column}");
            }
        }
    }
}

/// A quarter of a swing that passes through all of its positions, seen by its torques.
#[test]
fn every_shape_has_columns_and_their_coefficients_are_parameters() {
    let times: Vec<f64> = (0..200).map(|i| f64::from(i) / 260.0).collect();
    let position: Vec<f64> = times.iter().map(|t| 0.7 * (22.0 * t).cos()).collect();
    let velocity: Vec<f64> = times.iter().map(|t| -15.0 * (22.0 * t).sin()).collect();
    let command = Input::new(times.clone(), velocity.iter().map(|v| v / 15.0).collect(), Hold::Zero).unwrap();
    let nominal = Nominal::new(1.0, 0.2, 484.0, 0.0).unwrap().coefficients();
    let along = Along {
        times: &times,
        position: &position,
        velocity: &velocity,
        observed: &position,
        rate: &velocity,
        input: command.values(),
        input_rate: command.values(),
        command: Some(&command),
        first: true,
        facts: &FACTS,
        nominal: &nominal,
        respond: &|torque: &[f64]| torque.to_vec(),
    };
    for candidate in Candidate::ALL {
        for shape in candidate.shapes_for(&FACTS, &OneLine) {
            let columns = candidate.columns(&shape, &along);
            assert!(!columns.is_empty(), "{candidate:?}");
            let seen = |column: &Vec<f64>| column.len() == times.len() && column.iter().any(|x| *x != 0.0);
            assert!(columns.iter().all(seen), "{candidate:?} {shape:?}");
            let parameters = candidate.linear_parameters(&shape, &vec![1.0; columns.len()]);
            assert_eq!(parameters.len(), candidate.parameters(&FACTS).len(), "{candidate:?}");
        }
        for (start, _) in candidate.starts(&FACTS, 1.0, &OneLine) {
            assert_eq!(start.len(), candidate.parameters(&FACTS).len(), "{candidate:?}");
        }
    }
}

/// A residual with one line.
struct OneLine;

impl Lines for OneLine {
    fn steady(&self, _most: usize) -> Vec<f64> {
        vec![31.0]
    }

    fn decaying(&self, _most: usize) -> Vec<Mode> {
        vec![Mode { frequency: 31.0, rate: 0.5, inertia: None, gain: 1.0 }]
    }

    fn driven(&self, _most: usize) -> Vec<Mode> {
        vec![Mode { frequency: 31.0, rate: 0.5, inertia: Some(0.1), gain: 1.0 }]
    }

    fn longest_span(&self) -> f64 {
        2.0
    }
}

#[test]
fn every_effect_of_the_vocabulary_has_a_class() {
    let of = |id: &str| evidence_class(id).unwrap();
    for effect in REGISTRY {
        assert!(!of(effect.id()).is_empty());
    }
    assert_eq!(of("hysteresis"), "friction");
    assert_eq!(of("gravity"), "restoring");
    assert_eq!(of("damping_drift"), "damping");
    assert_eq!(of("clock_drift"), "drift");
    // No fit includes these.
    assert_eq!(of("timestamp_jitter"), "stamps");
    assert_eq!(of("dropouts"), "stamps");
    assert_eq!(of("outliers"), "sensor");
    assert_eq!(evidence_class("unknown"), None);
    assert_eq!(evidence_class("friction"), None);
}

#[test]
fn what_can_sit_anywhere_on_a_record_is_flexible() {
    let flexible: Vec<&str> =
        REGISTRY.iter().map(|effect| effect.id()).filter(|id| is_flexible(id)).collect();
    let all = [
        "end_stop",
        "stiffness_drift",
        "damping_drift",
        "periodic_forcing",
        "flexible_coupling",
        "torque_limit",
        "speed_torque_limit",
        "clock_drift",
    ];
    assert_eq!(flexible, all);
}
