//! Events that are hard to detect, in both integrators.

use crate::fixtures::{difference, grid, with};
use crate::reference::{Happening, Motion, Tolerance, simulate};
use crate::sensitivity::{Model, Response, Settings};
use crate::{DynamicsError, Nominal, Start, System};

fn undamped() -> Nominal {
    Nominal::new(1.0, 0.0, 484.0, 0.0).unwrap()
}

fn by_reference(system: &System, start: Start, times: &[f64], relative: f64) -> Motion {
    let tolerance = Tolerance { relative, ..Tolerance::default() };
    simulate(system, start, None, times, &tolerance).unwrap()
}

fn by_series(system: &System, start: Start, times: &[f64], tolerance: f64) -> Response {
    let settings = Settings { tolerance, ..Settings::default() };
    Model::new(system, &[], settings).unwrap().run(start.into(), None, times).unwrap()
}

#[test]
fn a_visit_to_the_stop_shorter_than_a_step_is_not_missed() {
    // Regression: the reference looked only at the nodes of its steps. Without loss every swing comes back to
    // the stop, to the same depth beyond it; a visit lasts between a fortieth and a third of a step.
    let times = grid(3.0, 260.0);
    for depth in [1e-6, 1e-5, 1e-4, 1e-3] {
        let system = with(undamped(), &[("end_stop", &[-0.7 + depth, 2e5, 0.0])]);
        let start = Start { position: 0.7, velocity: 0.0 };
        for relative in [1e-9, 1e-10, 1e-11, 1e-12, 1e-13] {
            let motion = by_reference(&system, start, &times, relative);
            let response = by_series(&system, start, &times, relative);
            let contacts = motion.events.len();
            // Ten and a half periods, each with an entry and an exit.
            assert!((20..=22).contains(&contacts), "{depth:e} {relative:e}: {contacts}");
            assert_eq!(response.events, contacts, "{depth:e} {relative:e}");
            assert!(difference(&response.position, &motion.position) < 1e4 * relative);
        }
    }
}

#[test]
fn what_breaks_away_slowly_gets_under_way() {
    // A break-away begins with an excess torque that is mere rounding. At any tolerance it must neither look
    // like a reversal nor be rejected.
    let nominal = Nominal::new(1.0, 0.015_978_212_424_646_535, 484.0, 0.005_668_251_830_754_811).unwrap();
    let effects: &[(&str, &[f64])] = &[
        ("stribeck_friction", &[12.817_984_421_130_23, 21.090_230_131_449_058, 0.212_827_681_809_169_03]),
        ("end_stop", &[0.160_974_507_526_673_2, 3_154_893.486_676_456, 0.188_475_014_734_657_08]),
        ("periodic_forcing", &[16.111_675_995_045_136, 1.546_994_913_947_955_3, -0.085_855_245_454_893_98]),
    ];
    let system = with(nominal, effects);
    let times = grid(4.0, 260.0);
    let start = Start::release(0.994_696_515_124_913_6);
    let exact = by_reference(&system, start, &times, 1e-13);
    assert!(exact.events.iter().any(|event| event.happening == Happening::BreakAway));
    for step in 0..100 {
        let tolerance = 1e-9 * 0.9_f64.powi(step);
        let response = by_series(&system, start, &times, tolerance);
        let off = difference(&response.position, &exact.position);
        assert!(off < 1e-6, "{tolerance:e}: {off:e}");
        assert_eq!(response.events, exact.events.len(), "{tolerance:e}");
    }
}

#[test]
fn a_torque_that_just_reaches_the_hold_moves_nothing() {
    let times = grid(10.0, 50.0);
    for (hold, frequency) in [(1.0, 2.0), (0.3, 37.0), (7.0, 0.9)] {
        let forcing = [hold, frequency, 0.0];
        let system = with(
            undamped(),
            &[("coulomb_friction", &[hold * (1.0 + 1e-12)]), ("periodic_forcing", &forcing)],
        );
        let start = Start::release(0.0);
        let motion = by_reference(&system, start, &times, 1e-12);
        let response = by_series(&system, start, &times, 1e-10);
        assert!(motion.position.iter().chain(&response.position).all(|position| *position == 0.0));
        // With equality to rounding the body may slip, but not far.
        let system = with(undamped(), &[("coulomb_friction", &[hold]), ("periodic_forcing", &forcing)]);
        let motion = by_reference(&system, start, &times, 1e-12);
        let response = by_series(&system, start, &times, 1e-10);
        let all = motion.position.iter().chain(&response.position);
        assert!(all.copied().all(|position| position.abs() < 1e-12));
    }
}

#[test]
fn from_rest_in_balance_a_fast_forcing_is_resolved() {
    // Regression: with a state of zero the first step was scaled by the oscillator's own frequency.
    for frequency in [300.0, 2_000.0, 20_000.0_f64] {
        let system = with(undamped(), &[("periodic_forcing", &[5.0, frequency, 0.4])]);
        let times = grid(0.2, 5_000.0);
        let (start, omega) = (Start::release(0.0), 22.0_f64);
        let response = by_series(&system, start, &times, 1e-10);
        let gain = 5.0 / (omega * omega - frequency * frequency);
        let (sine, cosine) = 0.4_f64.sin_cos();
        for (time, position) in times.iter().zip(&response.position) {
            let own = sine * (omega * time).cos() + cosine * frequency / omega * (omega * time).sin();
            let exact = gain * ((frequency * time + 0.4).sin() - own);
            let largest = gain.abs() * frequency / omega;
            assert!((position - exact).abs() < 1e-8 * largest, "{frequency} {time}: {position} {exact}");
        }
    }
}

#[test]
fn a_motion_that_runs_away_says_so() {
    // Regression: stages with rates that were not numbers passed as converged.
    let start = Start { position: 1.2, velocity: 3.0 };
    for effect in [("cubic_stiffness", -480.0), ("asymmetric_stiffness", -480.0), ("cubic_stiffness", -1e300)]
    {
        let system = with(undamped(), &[(effect.0, &[effect.1])]);
        let times = grid(5.0, 100.0);
        let reference = simulate(&system, start, None, &times, &Tolerance::default()).unwrap_err();
        let mut model = Model::new(&system, &[], Settings::default()).unwrap();
        let series = model.run(start.into(), None, &times).unwrap_err();
        for error in [reference, series] {
            let ended = matches!(error, DynamicsError::Diverged { time_s, .. } | DynamicsError::StepTooSmall { time_s, .. } if time_s < 1.0);
            assert!(ended, "{effect:?}: {error}");
        }
    }
}

#[test]
fn a_release_inside_the_dead_zone_is_refused_only_where_nothing_else_pulls() {
    let nominal = Nominal::new(1.0, 0.2, 484.0, 0.1).unwrap();
    let backlash: (&str, &[f64]) = ("backlash", &[0.05]);
    let checked = |other: Option<(&str, &[f64])>, start| {
        let effects: Vec<(&str, &[f64])> = [Some(backlash), other].into_iter().flatten().collect();
        with(nominal, &effects).check_release(start)
    };
    let inside = Start::release(0.13);
    let in_balance: (&str, &[f64]) = ("gravity", &[3.0, -0.13]);
    for other in [None, Some(("quadratic_drag", &[0.1][..])), Some(in_balance)] {
        let refused = checked(other, inside);
        let expected = matches!(refused, Err(DynamicsError::ReleaseInsideDeadZone { half_width: 0.05, .. }));
        assert!(expected, "{other:?}: {refused:?}");
    }
    assert!(checked(Some(("gravity", &[3.0, 0.0])), inside).is_ok());
    assert!(checked(Some(("constant_torque", &[0.1])), inside).is_ok());
    assert!(checked(Some(("periodic_forcing", &[0.1, 3.0, 0.0])), inside).is_ok());
    assert!(checked(None, Start::release(0.16)).is_ok());
    assert!(checked(None, Start { position: 0.13, velocity: 0.1 }).is_ok());
    // The pull is followed: the body falls out of the dead zone.
    let system = with(nominal, &[backlash, ("constant_torque", &[0.1])]);
    let motion = by_reference(&system, inside, &grid(2.0, 100.0), 1e-12);
    assert!(motion.position.last().unwrap() - 0.1 > 0.05);
}
