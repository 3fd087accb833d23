use super::integrator::{TorqueLaw, motions};
use super::laws::{DragPower, HertzStop, LuGre, SineSpring};
use super::situation::{Motion, Situation};
use super::unlisted::Maxwell;
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Active, Nominal, Start, System};
use truth::{Excitation, Sampling, Waveform};

/// Smallest noise of the default configuration, in rad.
const SMALLEST_NOISE: f64 = 2e-4;

pub(super) fn situation(driven: bool) -> Situation {
    let omega = 7.0 * std::f64::consts::PI;
    let excitation =
        Excitation { waveform: Waveform::Chirp, amplitude: 12.0, frequency_hz: 1.0, end_frequency_hz: 7.0 };
    Situation {
        nominal: Nominal::new(1.0, 2.0 * 0.006 * omega, omega * omega, 0.02).unwrap(),
        starts: vec![Start::release(0.7)],
        amplitude: 0.68,
        excitation: driven.then_some(excitation),
        sampling: Sampling {
            rate_hz: 260.0,
            samples: 2600,
            first_stamp_s: 0.0,
            stamp_decimals: 6,
            value_decimals: 9,
        },
        noise: 1e-3,
    }
}

fn split(situation: &Situation, law: &dyn TorqueLaw) -> Motion {
    motions(situation, &[law], &|_| Vec::new()).unwrap().remove(0)
}

/// Returns the largest difference from the reference integrator's motion with an effect of the vocabulary.
fn off(situation: &Situation, law: &dyn TorqueLaw, id: &str, values: &[f64]) -> f64 {
    let system = System::new(situation.nominal, vec![Active::new(id, values).unwrap()]).unwrap();
    let input = situation.input().unwrap();
    let start = situation.starts[0];
    let exact = simulate(&system, start, input.as_ref(), &situation.times(), &Tolerance::default()).unwrap();
    let found = split(situation, law);
    let speed = situation.omega();
    let largest = |one: &[f64], other: &[f64]| {
        one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
    };
    largest(&found.position, &exact.position).max(largest(&found.velocity, &exact.velocity) / speed)
}

#[test]
fn drag_of_power_two_is_the_references() {
    for driven in [false, true] {
        let law = DragPower { coefficient: 0.02, exponent: 2.0, velocity: 3.0 };
        let off = off(&situation(driven), &law, "quadratic_drag", &[0.02]);
        assert!(off < 0.01 * SMALLEST_NOISE, "{off:e}");
    }
}

#[test]
fn a_sine_spring_of_no_steepness_is_the_references_cubic_spring() {
    for hyperbolic in [false, true] {
        let law = SineSpring { coefficient: 20.0, steepness: 5e-3, hyperbolic };
        let off = off(&situation(false), &law, "cubic_stiffness", &[20.0]);
        assert!(off < 0.01 * SMALLEST_NOISE, "{off:e}");
    }
}

/// After a reversal, bristles take the time √(2·bend/(ω²·A)) to turn over. The difference falls with the
/// square root of the bend and is extrapolated to zero bend.
#[test]
fn bristles_that_hardly_bend_are_coulombs_friction() {
    let situation = situation(false);
    let at = |bend: f64| split(&situation, &LuGre { torque: 0.4, static_torque: 0.4, velocity: 1.0, bend });
    let system =
        System::new(situation.nominal, vec![Active::new("coulomb_friction", &[0.4]).unwrap()]).unwrap();
    let exact =
        simulate(&system, situation.starts[0], None, &situation.times(), &Tolerance::default()).unwrap();
    let (coarse, fine) = (at(4e-5), at(1e-5));
    let off = |found: &dyn Fn(usize) -> f64| {
        (0..exact.position.len()).map(|i| (found(i) - exact.position[i]).abs()).fold(0.0, f64::max)
    };
    let ratio = off(&|i| coarse.position[i]) / off(&|i| fine.position[i]);
    assert!((ratio / 2.0 - 1.0).abs() < 0.05, "{ratio}");
    let extrapolated = off(&|i| 2.0 * fine.position[i] - coarse.position[i]);
    assert!(extrapolated < 0.1 * SMALLEST_NOISE, "{extrapolated:e}");
}

#[test]
fn without_a_law_it_is_the_closed_form_with_any_input() {
    let law = Maxwell { stiffness: 0.0, time: 1.0 };
    for driven in [false, true] {
        let off = off(&situation(driven), &law, "coulomb_friction", &[0.0]);
        assert!(off < 1e-10, "{off:e}");
    }
}

#[test]
fn smooth_and_kinked_laws_are_exact_far_below_the_noise() {
    let laws: [&dyn TorqueLaw; 2] = [
        &HertzStop { deflection: -0.5, stiffness: 500.0, dissipation: 0.01 },
        &LuGre { torque: 0.4, static_torque: 0.8, velocity: 2.0, bend: 1e-3 },
    ];
    for law in laws {
        let coarse = split(&situation(false), law);
        // There are at least sixteen steps between samples, so four times the rate gives shorter steps.
        let mut finer = situation(false);
        finer.sampling.rate_hz *= 4.0;
        finer.sampling.samples *= 4;
        let fine = split(&finer, law);
        let off = coarse
            .position
            .iter()
            .zip(fine.position.iter().step_by(4))
            .map(|(one, other)| (one - other).abs())
            .fold(0.0, f64::max);
        assert!(off < 0.03 * SMALLEST_NOISE, "{off:e}");
    }
}
