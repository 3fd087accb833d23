use super::{Free, FullState, Model, Response, Settings};
use crate::fixtures::{cases, command, difference, everything, grid, nominal, with};
use crate::reference::{Tolerance, simulate};
use crate::{Active, Effect, Hold, Input, Nominal, Start, System};

/// `true` for an effect of the input's path.
fn is_driven(id: &str) -> bool {
    Effect::find(id).unwrap().description().driven_only
}

fn system(effects: &[(&str, &[f64])]) -> System {
    with(nominal(), effects)
}

#[test]
fn trajectories_are_the_references_for_every_effect() {
    let times = grid(25.0, 260.0);
    let settings = Settings { velocity: true, acceleration: true, ..Settings::default() };
    for case in cases() {
        for hold in [Hold::Zero, Hold::Linear] {
            let driven = is_driven(case.0);
            if !driven && hold == Hold::Linear {
                continue;
            }
            let input = driven.then(|| command(25.0, hold));
            let system = system(&[case]);
            let start = Start::release(0.7);
            let exact = simulate(&system, start, input.as_ref(), &times, &Tolerance::default()).unwrap();
            let mut model = Model::new(&system, &[], settings).unwrap();
            let response = model.run(start.into(), input.as_ref(), &times).unwrap();
            let worst = difference(&response.position, &exact.position);
            let speed = difference(&response.velocity, &exact.velocity);
            assert!(worst < 1e-8, "{}: {worst:e}", case.0);
            assert!(speed < 1e-6, "{}: {speed:e}", case.0);
        }
    }
}

/// Outputs that are not requested are not written, and their absence changes nothing else.
#[test]
fn sensitivities_of_rates_are_left_out_on_request() {
    let system = system(&[("coulomb_friction", &[0.5])]);
    let free = [Free::StartPosition, Free::Damping];
    let times = grid(3.0, 100.0);
    let all = Settings { velocity: true, acceleration: true, ..Settings::default() };
    let some = Settings { rate_sensitivities: false, ..all };
    let run = |settings| {
        Model::new(&system, &free, settings).unwrap().run(Start::release(0.7).into(), None, &times)
    };
    let (all, some) = (run(all).unwrap(), run(some).unwrap());
    assert_eq!(all.velocity_sensitivity.len(), 2 * times.len());
    assert!(some.velocity_sensitivity.is_empty() && some.acceleration_sensitivity.is_empty());
    let bare = Response { velocity_sensitivity: Vec::new(), acceleration_sensitivity: Vec::new(), ..all };
    assert_eq!(some, bare);
}

/// Every quantity of a system that can be free.
fn everything_free(system: &System) -> Vec<Free> {
    let nominal = [Free::Inertia, Free::Damping, Free::Stiffness, Free::RestAngle, Free::InputGain];
    let effects = system.effects().iter().flat_map(|active| {
        let description = active.effect().description();
        description
            .parameters
            .iter()
            .map(|parameter| Free::Effect { id: description.id, parameter: parameter.name })
    });
    nominal.into_iter().chain(effects).chain([Free::StartPosition, Free::StartVelocity]).collect()
}

/// The system and start with one quantity moved.
fn moved(system: &System, start: Start, free: Free, by: f64) -> (System, Start) {
    let mut coefficients = system.nominal().coefficients();
    let mut start = start;
    let mut effects = system.effects().to_vec();
    match free {
        Free::Inertia => coefficients.inertia += by,
        Free::Damping => coefficients.damping += by,
        Free::Stiffness => coefficients.stiffness += by,
        Free::RestAngle => coefficients.rest_angle += by,
        Free::InputGain => coefficients.input_gain += by,
        Free::StartPosition => start.position += by,
        Free::StartVelocity => start.velocity += by,
        Free::StartHidden(_) => panic!("hidden states have a test of their own"),
        Free::Effect { id, parameter } => {
            let active = effects.iter_mut().find(|active| active.id() == id).unwrap();
            let index = active.effect().description().parameter_index(parameter).unwrap();
            let mut values = active.values().to_vec();
            values[index] += by;
            *active = Active::new(id, &values).unwrap();
        }
    }
    let nominal = system.nominal().with_coefficients(coefficients).unwrap();
    (System::new(nominal, effects).unwrap(), start)
}

/// The size of an effect's parameter. Other quantities may be moved by any amount, except the gain: a held
/// input passes the edge of saturation at once.
fn size(system: &System, free: Free) -> f64 {
    if free == Free::InputGain {
        return 0.1;
    }
    let Free::Effect { id, parameter } = free else { return f64::INFINITY };
    system.effects().iter().find(|active| active.id() == id).unwrap().value(parameter).unwrap().abs()
}

/// The sixth-order central difference of a list of numbers.
fn central(step: f64, at: &dyn Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let mut sum: Vec<f64> = Vec::new();
    for (distance, weight) in [(1.0, 0.75), (2.0, -0.15), (3.0, 1.0 / 60.0)] {
        for side in [-1.0, 1.0] {
            let values = at(side * distance * step);
            sum.resize(values.len(), 0.0);
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += side * weight * value / step;
            }
        }
    }
    sum
}

const EXACT: Settings = Settings {
    tolerance: 1e-15,
    degree: 16,
    velocity: true,
    acceleration: true,
    rate_sensitivities: true,
    most_steps: 1_000_000,
};

/// A motion whose columns are checked.
struct Case<'a> {
    name: &'a str,
    system: &'a System,
    start: Start,
    input: Option<&'a Input>,
    times: &'a [f64],
}

/// Compares every column of position, velocity and acceleration with differences of the model itself and of
/// the reference. Samples that an event passes while a quantity is moved are left out: the motion has a kink
/// there. `reach` is how far, in rad, a quantity may move the motion.
fn check_columns(case: &Case<'_>, reach: f64, bar: f64) {
    let Case { name, system, start, input, times } = *case;
    let free = everything_free(system);
    let columns = free.len();
    let tight = Tolerance { relative: 1e-14, ..Tolerance::default() };
    let exact = simulate(system, start, input, times, &tight).unwrap();
    let delay = system.input_delay();
    let knots = input.map(|input| input.times().to_vec()).unwrap_or_default();
    let kinks: Vec<f64> =
        exact.events.iter().map(|event| event.time).chain(knots.iter().map(|knot| knot + delay)).collect();
    let clear: Vec<bool> =
        times.iter().map(|time| kinks.iter().all(|kink| (kink - time).abs() > 1e-3)).collect();
    assert!(clear.iter().filter(|clear| **clear).count() > times.len() / 3, "{name}");
    let mut model = Model::new(system, &free, EXACT).unwrap();
    let response = model.run(start.into(), input, times).unwrap();
    for (column, quantity) in free.iter().enumerate() {
        if input.is_none() && *quantity == Free::InputGain {
            continue;
        }
        let of = |list: &[f64]| -> Vec<f64> { list.iter().skip(column).step_by(columns).copied().collect() };
        let own = [
            of(&response.position_sensitivity),
            of(&response.velocity_sensitivity),
            of(&response.acceleration_sensitivity),
        ];
        let largest = |list: &[f64]| list.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        assert!(largest(&own[0]) > 0.0, "{name}: {quantity:?} has no influence");
        let together = |position: Vec<f64>, velocity: Vec<f64>, acceleration: Vec<f64>| {
            [position, velocity, acceleration].concat()
        };
        let itself = |by: f64| {
            let (system, start) = moved(system, start, *quantity, by);
            let response = Model::new(&system, &[], EXACT).unwrap().run(start.into(), input, times).unwrap();
            together(response.position, response.velocity, response.acceleration)
        };
        let reference = |by: f64| {
            let (system, start) = moved(system, start, *quantity, by);
            let motion = simulate(&system, start, input, times, &tight).unwrap();
            together(motion.position, motion.velocity, motion.acceleration)
        };
        let off = |difference: &[f64]| -> f64 {
            let orders = own.iter().zip(difference.chunks(times.len()));
            let relative = orders.map(|(own, other)| {
                let samples = own.iter().zip(other).zip(&clear).filter(|(_, clear)| **clear);
                let worst = samples.map(|((own, other), _)| (own - other).abs()).fold(0.0, f64::max);
                worst / largest(own)
            });
            relative.fold(0.0, f64::max)
        };
        // A long step is free of rounding, a short one of curvature; neither can make a wrong column look
        // right.
        let steps = [0.02, 0.002].map(|part| (reach / largest(&own[0])).min(part * size(system, *quantity)));
        for (what, at) in [("itself", &itself as &dyn Fn(f64) -> Vec<f64>), ("the reference", &reference)] {
            let found: Vec<f64> =
                steps.iter().map(|step| off(&central(*step, at))).take_while(|off| *off > bar).collect();
            assert!(found.len() < steps.len(), "{name}: {quantity:?} against {what}: {found:?}");
        }
    }
}

#[test]
fn columns_are_the_derivatives_for_every_effect_through_its_events() {
    let times = grid(2.0, 130.0);
    let start = Start { position: 0.6, velocity: 2.0 };
    for case in cases() {
        let driven = is_driven(case.0);
        let linear = || command(2.0, Hold::Linear);
        let inputs = [command(2.0, Hold::Zero), linear(), linear().thinned(5)].map(Some);
        for input in if driven { &inputs[..] } else { &[None] } {
            let system = system(&[case]);
            let (name, input) = (case.0, input.as_ref());
            // With a held command an edge that is met near a knot is soon met on its other side.
            let reach = if driven { 3e-5 } else { 1e-3 };
            check_columns(&Case { name, system: &system, start, input, times: &times }, reach, 1e-7);
        }
    }
}

/// The contact of the field's benchmark of hysteresis stiffens in the direction of motion.
#[test]
fn columns_are_the_derivatives_of_a_contact_that_never_slides() {
    let (system, times) = (system(&[("hysteresis", &[60.0, 0.4, -1.4, 1.2])]), grid(2.0, 130.0));
    let start = Start { position: 0.6, velocity: 2.0 };
    check_columns(
        &Case { name: "never slides", system: &system, start, input: None, times: &times },
        1e-3,
        1e-7,
    );
}

#[test]
fn columns_are_the_derivatives_with_every_effect_on() {
    let times = grid(0.8, 300.0);
    let start = Start { position: 0.6, velocity: 2.0 };
    let (system, input) = (system(&everything()), command(0.8, Hold::Linear));
    let (name, input) = ("everything", Some(&input));
    check_columns(&Case { name, system: &system, start, input, times: &times }, 2e-4, 1e-7);
}

#[test]
fn columns_pass_through_sticking_and_breaking_away() {
    let effects: &[(&str, &[f64])] = &[
        ("stribeck_friction", &[8.0, 9.0, 0.4]),
        ("periodic_forcing", &[30.0, 4.0, 0.2]),
        ("flexible_coupling", &[0.05, 180.0, 0.2]),
    ];
    let system = system(effects);
    let start = Start { position: 0.3, velocity: 2.0 };
    let times = grid(3.0, 150.0);
    let motion = simulate(&system, start, None, &times, &Tolerance::default()).unwrap();
    let breaks = motion.events.iter().filter(|e| e.happening == crate::reference::Happening::BreakAway);
    assert!(breaks.count() > 2);
    let name = "stick and slip";
    check_columns(&Case { name, system: &system, start, input: None, times: &times }, 1e-5, 1e-7);
}

#[test]
fn every_effect_at_once_is_the_references_motion() {
    let times = grid(10.0, 260.0);
    for hold in [Hold::Zero, Hold::Linear] {
        let input = command(10.0, hold);
        let system = system(&everything());
        let start = Start::release(0.7);
        let exact = simulate(&system, start, Some(&input), &times, &Tolerance::default()).unwrap();
        let mut model = Model::new(&system, &[], Settings::default()).unwrap();
        let response = model.run(start.into(), Some(&input), &times).unwrap();
        let worst = difference(&response.position, &exact.position);
        assert!(worst < 1e-7, "{worst:e}");
    }
}

#[test]
fn the_sampling_does_not_matter() {
    // From 20 to 5000 samples a period, and uneven times.
    let system = system(&[("coulomb_friction", &[0.3]), ("gravity", &[40.0, 0.2])]);
    let mut model = Model::new(&system, &[Free::Stiffness], Settings::default()).unwrap();
    let start = Start::release(0.7);
    let uneven: Vec<f64> = grid(8.0, 70.0).iter().map(|t| t + 0.004 * (37.0 * t).sin()).collect();
    for times in [grid(8.0, 70.0), grid(8.0, 17_500.0), uneven] {
        let exact = simulate(&system, start, None, &times, &Tolerance::default()).unwrap();
        let response = model.run(start.into(), None, &times).unwrap();
        assert!(difference(&response.position, &exact.position) < 1e-9);
        assert!(response.steps < 400, "{}", response.steps);
    }
}

#[test]
fn segments_chain_to_the_whole() {
    let system = system(&everything());
    let input = command(4.0, Hold::Linear);
    let times = grid(4.0, 100.0);
    let own = [Free::Stiffness, Free::Effect { id: "hysteresis", parameter: "displacement" }];
    let state = [
        Free::StartPosition,
        Free::StartVelocity,
        Free::StartHidden(0),
        Free::StartHidden(1),
        Free::StartHidden(2),
    ];
    let settings = Settings { tolerance: 1e-13, ..Settings::default() };
    let start = FullState { position: 0.6, velocity: 2.0, hidden: None };
    let whole = Model::new(&system, &own, settings).unwrap().run(start, Some(&input), &times).unwrap();
    let mut part = Model::new(&system, &[own.as_slice(), state.as_slice()].concat(), settings).unwrap();
    let first = part.run(start, Some(&input), &times[..201]).unwrap();
    let second = part.run(first.end, Some(&input), &times[200..]).unwrap();
    assert!(difference(&second.position, &whole.position[200..]) < 1e-9);
    for (sample, row) in second.position_sensitivity.chunks(7).enumerate() {
        for parameter in 0..2 {
            // d(second) = ∂second/∂parameter + Σ ∂second/∂start · ∂end of the first/∂parameter.
            let through: f64 = (0..5).map(|s| row[2 + s] * first.end_sensitivity[s * 7 + parameter]).sum();
            let direct = whole.position_sensitivity[(200 + sample) * 2 + parameter];
            let off = (row[parameter] + through - direct).abs();
            assert!(off < 1e-7 * (1.0 + direct.abs()), "{sample} {parameter}: {off:e} of {direct}");
        }
    }
}

#[test]
fn new_values_are_as_a_new_model() {
    let times = grid(3.0, 100.0);
    let free = [
        Free::Stiffness,
        Free::StartPosition,
        Free::Effect { id: "quadratic_drag", parameter: "coefficient" },
    ];
    let start = FullState { position: 0.7, ..FullState::default() };
    let mut model = Model::new(&system(&[("quadratic_drag", &[0.05])]), &free, Settings::default()).unwrap();
    let mut response = Response::default();
    model.run_into(start, None, &times, &mut response).unwrap();
    model.set(&[500.0, 0.02]).unwrap();
    model.run_into(start, None, &times, &mut response).unwrap();
    let nominal = nominal();
    let other = Nominal::new(1.0, nominal.damping(), 500.0, nominal.rest_angle()).unwrap();
    let other = with(other, &[("quadratic_drag", &[0.02])]);
    let fresh = Model::new(&other, &free, Settings::default()).unwrap().run(start, None, &times).unwrap();
    assert_eq!(response, fresh);
    // A coefficient of the wrong sign is a finding of a fit, not an error.
    model.set(&[500.0, -0.02]).unwrap();
    model.run_into(start, None, &times, &mut response).unwrap();
    assert!(response.position.iter().all(|position| position.is_finite()));
}

#[test]
fn what_cannot_be_free_is_named() {
    let system = system(&[("quadratic_drag", &[0.05])]);
    let refusal = |free: &[Free]| Model::new(&system, free, Settings::default()).unwrap_err().to_string();
    assert_eq!(
        refusal(&[Free::Effect { id: "gravity", parameter: "torque" }]),
        "`gravity.torque` cannot be free: the system does not have this effect"
    );
    assert_eq!(
        refusal(&[Free::Effect { id: "quadratic_drag", parameter: "torque" }]),
        "`quadratic_drag.torque` cannot be free: the effect does not have this parameter"
    );
    assert_eq!(
        refusal(&[Free::StartHidden(0)]),
        "`hidden state 0` cannot be free: the system has fewer hidden states"
    );
    assert_eq!(refusal(&[Free::Damping, Free::Damping]), "`Damping` cannot be free: it is named twice");
    let mut model = Model::new(&system, &[Free::Inertia], Settings::default()).unwrap();
    assert_eq!(
        model.set(&[-1.0]).unwrap_err().to_string(),
        "nominal `inertia` is -1; expected a finite number above 0"
    );
}

#[test]
fn the_series_has_the_order_of_its_degree() {
    // A swinging pendulum with damping, in steps of one size: with so wide a tolerance nothing else cuts
    // them.
    let nominal = Nominal::new(1.0, 0.3, 2.0, 0.1).unwrap();
    let system = with(nominal, &[("gravity", &[9.0, 0.2]), ("cubic_stiffness", &[1.5])]);
    let start = Start { position: 1.2, velocity: 0.5 };
    let exact = simulate(&system, start, None, &[0.0, 2.0], &Tolerance::default()).unwrap().position[1];
    for (degree, steps) in [(2, 3200), (3, 800), (4, 400)] {
        let error = |steps: usize| {
            let settings = Settings { tolerance: 1e9, degree, ..Settings::default() };
            let mut model = Model::new(&system, &[], settings).unwrap();
            let at = |step: usize| 2.0 * step as f64 / steps as f64;
            let end = (0..steps).fold(FullState::from(start), |state, step| {
                let response = model.run(state, None, &[at(step), at(step + 1)]).unwrap();
                assert!(response.steps == 1, "{}", response.steps);
                response.end
            });
            (end.position - exact).abs()
        };
        let order = (error(steps) / error(2 * steps)).log2();
        assert!((order - degree as f64).abs() < 0.05, "degree {degree}: order {order}");
    }
}
