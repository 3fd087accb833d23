use super::integrator::motions;
use super::integrator_tests::situation;
use super::laws::DragPower;
use super::recalibration::{Absorbed, left_over};
use super::situation::{Motion, Situation};
use super::unlisted::Maxwell;
use dynamics::chain::Samples;
use dynamics::{Coefficients, Start, SystemEffect};

fn left(situation: &Situation, seen: Vec<Samples<f64>>, absorbed: Absorbed) -> f64 {
    left_over(situation, &seen, absorbed).unwrap()
}

fn seen(motions: Vec<Motion>) -> Vec<Samples<f64>> {
    motions.into_iter().map(Motion::seen).collect()
}

#[test]
fn another_oscillator_from_another_start_is_absorbed_even_after_turns_of_phase() {
    for driven in [false, true] {
        let believed = situation(driven);
        let is = believed.nominal.coefficients();
        // 5 % in stiffness shifts the phase by more than five radians after ten seconds.
        let other = Coefficients {
            inertia: if driven { 0.97 } else { 1.0 },
            damping: 1.3 * is.damping,
            stiffness: 1.05 * is.stiffness,
            rest_angle: -0.01,
            ..is
        };
        let actual = Situation {
            nominal: believed.nominal.with_coefficients(other).unwrap(),
            starts: vec![Start { position: 0.65, velocity: 1.0 }],
            ..believed.clone()
        };
        let found = left(&believed, seen(actual.motions(&[]).unwrap()), Absorbed::BY_RECALIBRATION);
        assert!(found < 1e-3 * believed.noise, "{found:e}");
        let kept = Absorbed { rest_angle: false, ..Absorbed::BY_RECALIBRATION };
        assert!(left(&believed, seen(actual.motions(&[]).unwrap()), kept) > 0.1);
    }
}

#[test]
fn stand_ins_absorb_their_own_law_and_no_other() {
    let situation = situation(false);
    let drag = DragPower { coefficient: 0.02, exponent: 2.0, velocity: 3.0 };
    let drag = || seen(motions(&situation, &[&drag], &|_| Vec::new()).unwrap());
    let with = |stand_ins: &'static [SystemEffect]| Absorbed { stand_ins, ..Absorbed::BY_RECALIBRATION };
    let alone = left(&situation, drag(), Absorbed::BY_RECALIBRATION);
    let near = left(&situation, drag(), with(&[SystemEffect::DampingDrift]));
    let same = left(&situation, drag(), with(&[SystemEffect::QuadraticDrag]));
    assert!(alone > 1.1 * near && near > 1000.0 * same, "{alone:e} {near:e} {same:e}");
}

#[test]
fn a_drift_of_the_sensor_is_absorbed_where_it_is_to_be() {
    let situation = situation(false);
    let nothing = Maxwell { stiffness: 0.0, time: 1.0 };
    let drifted = || {
        let mut seen = seen(motions(&situation, &[&nothing], &|_| Vec::new()).unwrap());
        for (value, time) in seen[0].values.iter_mut().zip(situation.times()) {
            *value += 1e-3 * time;
        }
        seen
    };
    let kept = left(&situation, drifted(), Absorbed::BY_RECALIBRATION);
    let absorbed = Absorbed { sensor_drift: true, ..Absorbed::BY_RECALIBRATION };
    assert!(kept > 0.1 && left(&situation, drifted(), absorbed) < 1e-7);
}
