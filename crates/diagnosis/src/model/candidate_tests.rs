use super::{Candidate, MainMode};
use crate::data::scales::Scales;
use crate::model::candidates::FlexibleCoupling;
use dynamics::{Coordinate, Nominal};
use record::Quantity;

const FACTS: Scales = Scales {
    amplitude: 0.7,
    highest: 0.7,
    lowest: -0.7,
    reading: 0.7,
    speed: 15.0,
    frequency: 22.0,
    torque: 340.0,
    input_torque: 1.0,
    duration: 25.0,
    interval: 1.0 / 260.0,
    rest_moved: 0.0,
    friction_known: false,
    inertia: 1.0,
    stiffness: 484.0,
    resolution: 1e-3,
    rate_error: 0.0,
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
    for candidate in Candidate::ALL.iter().chain(&[Candidate::UNNAMED]) {
        let parameters = candidate.parameters(&FACTS);
        for parameter in &parameters {
            assert!(parameter.lower < parameter.upper, "{} {}", candidate.id(), parameter.name);
        }
        if let Some(effect) = candidate.system() {
            let names: Vec<&str> = effect.description().parameters.iter().map(|p| p.name).collect();
            let fitted: Vec<&str> = parameters.iter().map(|p| p.name).collect();
            assert_eq!(names, fitted, "{}", candidate.id());
        }
    }
}

/// A light body of frequency 66 rad/s beside a swing of 22 rad/s that decays at 0.1/s: at its third
/// harmonic, which decays at 0.3/s.
#[test]
fn a_harmonic_is_no_second_body() {
    let coupling = Candidate::new(&FlexibleCoupling);
    let swing = MainMode { frequency: 22.0, decay_rate: 0.1, inertia: 1.0, starts_once: true };
    let is_itself = |line: f64, rate: f64, swing: &MainMode| coupling.is_itself(&[0.0, line, rate], swing);
    assert!(!is_itself(66.0, 0.3, &swing));
    assert!(!is_itself(66.0, 0.44, &swing));
    assert!(!is_itself(66.0, 0.21, &swing));
    // Struck once, it decays as it likes: a harmonic does not.
    assert!(is_itself(66.0, 0.46, &swing));
    assert!(is_itself(66.0, 0.19, &swing));
    assert!(!is_itself(66.0, 0.61, &MainMode { starts_once: false, ..swing }));
    assert!(is_itself(66.5, 0.3, &swing));
    // Near the swing itself no decay tells it apart, and a body that hardly swings is none.
    assert!(!is_itself(22.0, 2.0, &swing));
    assert!(!is_itself(60.0, 50.0, &swing));
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
