use super::run::{Run, Stepping};
use super::{Happening, Motion, Tolerance, Worker, simulate};
use crate::fixtures::{command, difference, everything, grid, nominal, with};
use crate::{Hold, Input, Nominal, Start, System};

fn free(system: &System, start: Start, times: &[f64]) -> Motion {
    simulate(system, start, None, times, &Tolerance::default()).unwrap()
}

/// The arithmetic-geometric mean.
fn mean(mut a: f64, mut g: f64) -> f64 {
    for _ in 0..60 {
        (a, g) = ((a + g) / 2.0, (a * g).sqrt());
    }
    a
}

/// Complete elliptic integral of the first kind of the parameter m = k².
fn elliptic(m: f64) -> f64 {
    std::f64::consts::FRAC_PI_2 / mean(1.0, (1.0 - m).sqrt())
}

/// The mean period of a motion released from rest, from its reversals. A dry friction of zero makes the
/// integrator report them.
fn period(nominal: Nominal, effects: &[(&str, &[f64])], release: f64) -> f64 {
    let mut effects = effects.to_vec();
    effects.push(("coulomb_friction", &[0.0]));
    let motion = free(&with(nominal, &effects), Start::release(release), &grid(20.0, 10.0));
    let reversals = motion.events.iter().filter(|event| event.happening == Happening::Reversal);
    2.0 * reversals.clone().next_back().unwrap().time / reversals.count() as f64
}

#[test]
fn viscous_damping_decays_as_the_closed_form() {
    let nominal = Nominal::new(0.5, 0.13, 241.0, 0.0).unwrap();
    let times = grid(25.0, 260.0);
    let motion = free(&with(nominal, &[]), Start { position: 0.7, velocity: 1.5 }, &times);
    let decay = nominal.damping() / 2.0 / nominal.inertia();
    let omega = (nominal.stiffness() / nominal.inertia() - decay * decay).sqrt();
    for ((time, position), velocity) in times.iter().zip(&motion.position).zip(&motion.velocity) {
        let (sine, cosine) = (omega * time).sin_cos();
        let quadrature = (1.5 + decay * 0.7) / omega;
        let shape = 0.7 * cosine + quadrature * sine;
        let slope = omega * (quadrature * cosine - 0.7 * sine) - decay * shape;
        let size = (-decay * time).exp();
        assert!((position - size * shape).abs() < 1e-11 * size, "{time}");
        assert!((velocity - size * slope).abs() < 1e-9 * size, "{time}");
    }
}

#[test]
fn coulomb_friction_takes_the_same_off_every_cycle_and_stops_within_its_band() {
    let (stiffness, friction) = (483.6, 2.1);
    let nominal = Nominal::new(1.0, 0.0, stiffness, 0.1).unwrap();
    let system = with(nominal, &[("coulomb_friction", &[friction])]);
    let motion = free(&system, Start::release(0.8), &grid(25.0, 260.0));
    let loss = 2.0 * friction / stiffness;
    let mut side = -1.0;
    for (number, event) in motion.events.iter().enumerate() {
        let amplitude = 0.7 - loss * (number + 1) as f64;
        assert!((side * (event.position - 0.1) / amplitude - 1.0).abs() < 1e-9, "{event:?}");
        side = -side;
    }
    let last = motion.events.last().unwrap();
    assert_eq!(last.happening, Happening::Stick);
    assert!((last.position - 0.1).abs() <= friction / stiffness);
    assert_eq!(motion.events.len(), ((0.7 - friction / stiffness) / loss).ceil() as usize);
    assert_eq!(motion.position.last(), Some(&last.position));
    assert_eq!(motion.velocity.last(), Some(&0.0));
    assert_eq!(motion.acceleration.last(), Some(&0.0));
}

#[test]
fn the_pendulums_period_is_its_elliptic_integral_up_to_170_degrees() {
    let nominal = Nominal::new(1.0, 0.0, 0.0, 0.0).unwrap();
    for degrees in [1.0, 10.0, 40.0, 90.0, 135.0, 170.0_f64] {
        let release = degrees.to_radians();
        let found = period(nominal, &[("gravity", &[37.0, 0.0])], release);
        let exact = 4.0 * elliptic((release / 2.0).sin().powi(2)) / 37.0_f64.sqrt();
        assert!((found / exact - 1.0).abs() < 1e-12, "{degrees}: {found} {exact}");
    }
}

#[test]
fn the_duffing_oscillators_period_is_its_elliptic_integral() {
    // Kovacic, Brennan, The Duffing Equation, section 2.3, hardening and softening.
    let nominal = Nominal::new(1.0, 0.0, 480.0, 0.0).unwrap();
    for (cubic, amplitude) in [(900.0, 0.7), (50.0, 1.2), (-150.0, 0.9), (-480.0, 0.99)] {
        let found = period(nominal, &[("cubic_stiffness", &[cubic])], amplitude);
        let square = amplitude * amplitude * cubic;
        let omega = (480.0_f64 + square).sqrt();
        let exact = 4.0 * elliptic(square / (2.0 * (480.0 + square))) / omega;
        assert!((found / exact - 1.0).abs() < 1e-10, "{cubic}: {found} {exact}");
    }
}

#[test]
fn under_quadratic_drag_the_reciprocal_amplitude_grows_linearly() {
    // Averaging: d(1/A)/dt = 4βω/(3π), with a relative error of the order of (βA)².
    let (omega, drag) = (22.0_f64, 0.004);
    let nominal = Nominal::new(1.0, 0.0, omega * omega, 0.0).unwrap();
    let system = with(nominal, &[("quadratic_drag", &[drag])]);
    let motion = free(&system, Start::release(0.7), &grid(25.0, 10.0));
    let peaks: Vec<(f64, f64)> =
        motion.events.iter().map(|event| (event.time, 1.0 / event.position.abs())).collect();
    let rate = 4.0 * drag * omega / (3.0 * std::f64::consts::PI);
    for pair in peaks.windows(2) {
        let found = (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
        let bar = (drag / pair[0].1).powi(2);
        assert!((found / rate - 1.0).abs() < bar, "{found} {rate} {bar}");
    }
}

#[test]
fn with_every_effect_on_the_energy_balances() {
    let nominal = nominal();
    let system = with(nominal, &everything());
    let times = grid(30.0, 260.0);
    for hold in [Hold::Zero, Hold::Linear] {
        let input = command(30.0, hold);
        let motion =
            simulate(&system, Start::release(0.7), Some(&input), &times, &Tolerance::default()).unwrap();
        let energy = |i: usize| {
            let deflection = motion.position[i] - nominal.rest_angle();
            0.5 * motion.velocity[i].powi(2) + 0.5 * nominal.stiffness() * deflection.powi(2)
        };
        assert_eq!(motion.accounts.len(), 2 + everything().len());
        for (i, time) in times.iter().enumerate() {
            let work: f64 = motion.accounts.iter().map(|account| account.work[i]).sum();
            assert!((energy(i) - energy(0) - work).abs() < 1e-11 * energy(0), "{time}");
        }
        for account in &motion.accounts {
            let largest = account.work.iter().fold(0.0_f64, |largest, work| largest.max(work.abs()));
            let idle = account.worker == Worker::Effect("input_delay");
            assert_eq!(largest > 1e-3, !idle, "{:?}: {largest}", account.worker);
            let dissipative =
                |id: &str| id.ends_with("_friction") || id == "friction_drift" || id == "quadratic_drag";
            if account.worker == Worker::Damping
                || matches!(account.worker, Worker::Effect(id) if dissipative(id))
            {
                assert!(account.work.windows(2).all(|pair| pair[1] <= pair[0] + 1e-12));
            }
        }
    }
}

#[test]
fn a_contact_gives_back_less_than_it_took() {
    let nominal = Nominal::new(1.0, 0.0, 480.0, 0.0).unwrap();
    for (dissipation, loses) in [(0.0, false), (0.2, true)] {
        let stop = [-0.4, 30_000.0, dissipation];
        let system = with(nominal, &[("end_stop", &stop)]);
        let motion = free(&system, Start::release(0.7), &grid(5.0, 100.0));
        let account = motion.accounts.last().unwrap();
        let work = *account.work.last().unwrap();
        assert!(motion.events.len() > 10);
        assert!(if loses { work < -5.0 } else { work.abs() < 1e-9 }, "{work}");
    }
}

#[test]
fn stuck_it_breaks_away_when_the_forcing_exceeds_the_hold() {
    // Forcing 3·sin(2t) against a hold of 1: it breaks away at arcsin(1/3)/2.
    let nominal = Nominal::new(1.0, 0.5, 100.0, 0.0).unwrap();
    let effects: &[(&str, &[f64])] = &[("coulomb_friction", &[1.0]), ("periodic_forcing", &[3.0, 2.0, 0.0])];
    let times = grid(10.0, 50.0);
    let motion = free(&with(nominal, effects), Start::release(0.0), &times);
    let first = motion.events.first().unwrap();
    assert_eq!(first.happening, Happening::BreakAway);
    assert!((first.time - (1.0_f64 / 3.0).asin() / 2.0).abs() < 1e-12, "{first:?}");
    let sticks = motion.events.iter().filter(|event| event.happening == Happening::Stick);
    assert!(sticks.count() > 3);
    for (time, position) in times.iter().zip(&motion.position).filter(|(time, _)| **time < first.time) {
        assert_eq!(*position, 0.0, "{time}");
    }
    // A fast forcing that a step of the free oscillator's size would miss.
    let effects: &[(&str, &[f64])] =
        &[("coulomb_friction", &[1.0]), ("periodic_forcing", &[1.001, 900.0, 0.0])];
    let motion = free(&with(nominal, effects), Start::release(0.0), &times);
    assert!((motion.events[0].time - (1.0_f64 / 1.001).asin() / 900.0).abs() < 1e-12);
}

#[test]
fn a_hidden_body_goes_on_while_the_friction_holds() {
    let nominal = Nominal::new(1.0, 0.0, 0.0, 0.0).unwrap();
    let effects: &[(&str, &[f64])] =
        &[("coulomb_friction", &[50.0]), ("flexible_coupling", &[0.5, 200.0, 0.1])];
    let start = Start { position: 0.0, velocity: 1.0 };
    let motion = free(&with(nominal, effects), start, &grid(3.0, 100.0));
    let happenings: Vec<Happening> = motion.events.iter().map(|event| event.happening).collect();
    assert_eq!(happenings, [Happening::Stick]);
    // With constant braking F the coupling swings between 0 and 2·F·I₂/(I₁ + I₂): a light hidden body never
    // overcomes the hold that stopped it, a heavy one does.
    let loose: &[(&str, &[f64])] =
        &[("coulomb_friction", &[10.0]), ("flexible_coupling", &[9.0, 200.0, 0.1])];
    let motion = free(&with(nominal, loose), start, &grid(3.0, 100.0));
    assert!(motion.events.iter().any(|event| event.happening == Happening::BreakAway));
}

/// The friction is so small compared with the spring that rounding of the angle, with a rest angle that is
/// not 0, changes the torque by more than the tolerance's part of the hold.
#[test]
fn what_rounding_moves_while_stuck_shortens_no_step() {
    let nominal = Nominal::new(4e-4, 2.8e-4, 0.7, -0.0376).unwrap();
    let body: &[f64] = &[7.8e-5, 2.93, 3.1e-4];
    for friction in [1e-5, 4.4e-6, 1e-6] {
        let system = with(nominal, &[("flexible_coupling", body), ("coulomb_friction", &[friction])]);
        let motion = free(&system, Start::release(-0.5255521524700675), &grid(30.0, 260.0));
        assert!(motion.events.iter().any(|event| event.happening == Happening::Stick), "{friction}");
        assert!(motion.steps < 3000, "{friction}: {}", motion.steps);
    }
}

#[test]
fn collocation_has_twice_as_many_orders_as_stages() {
    // A swinging pendulum with damping: smooth, nonlinear, not reversible.
    let nominal = Nominal::new(1.0, 0.3, 2.0, 0.1).unwrap();
    let system = with(nominal, &[("gravity", &[9.0, 0.2]), ("cubic_stiffness", &[1.5])]);
    let times = [0.0, 2.0];
    let start = Start { position: 1.2, velocity: 0.5 };
    let exact = free(&system, start, &times).position[1];
    for (stages, steps) in [(1, 4000.0), (2, 200.0), (3, 60.0), (4, 20.0)] {
        let error = |steps: f64| {
            let run = Run::new(&system, start, None, &times, Stepping::Fixed(2.0 / steps), stages).unwrap();
            (run.motion(&times).unwrap().position[1] - exact).abs()
        };
        let order = (error(steps) / error(2.0 * steps)).log2();
        assert!((order - 2.0 * f64::from(stages as u32)).abs() < 0.05, "{stages} stages: order {order}");
    }
}

#[test]
fn tolerances_are_kept() {
    let system = with(nominal(), &everything());
    let times = grid(5.0, 100.0);
    let input = command(5.0, Hold::Linear);
    let at = |relative| {
        let tolerance = Tolerance { relative, ..Tolerance::default() };
        simulate(&system, Start::release(0.7), Some(&input), &times, &tolerance).unwrap()
    };
    let exact = at(1e-14);
    for relative in [1e-6, 1e-8, 1e-10, 1e-12] {
        let off = difference(&at(relative).position, &exact.position);
        assert!(off < 100.0 * relative, "{relative:e}: {off:e}");
    }
}

#[test]
fn the_input_acts_as_held_delayed_and_clipped() {
    // A double integrator: the position is the input's second integral.
    let nominal = Nominal::new(2.0, 0.0, 0.0, 0.0).unwrap();
    let input = |hold| Input::new(vec![0.0, 1.0, 2.0], vec![0.0, 4.0, 4.0], hold).unwrap();
    let at_two = |effects: &[(&str, &[f64])], hold| {
        let motion = simulate(
            &with(nominal, effects),
            Start::release(0.0),
            Some(&input(hold)),
            &[0.0, 2.0],
            &Tolerance::default(),
        );
        motion.unwrap().position[1]
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-13, "{a} {b}");
    // Acceleration 2 from 1 s on; with linear hold also 2t before.
    close(at_two(&[], Hold::Zero), 1.0);
    close(at_two(&[], Hold::Linear), 1.0 / 3.0 + 1.0 + 1.0);
    close(at_two(&[("input_delay", &[0.5])], Hold::Zero), 0.25);
    close(at_two(&[("input_saturation", &[1.0])], Hold::Zero), 0.25);
    // 2t up to 0.25 s, then 0.5.
    let ramp = 0.25_f64.powi(3) / 3.0 + 0.0625 * 1.75 + 0.25 * 1.75_f64.powi(2);
    close(at_two(&[("input_saturation", &[1.0])], Hold::Linear), ramp);
}

#[test]
fn a_failing_landing_repeats_the_step() {
    // Regression: at this tolerance a step toward the end of the pre-sliding failed to converge when it was
    // cut to end there, and the stale polynomial of the uncut step was used.
    let system = with(nominal(), &[("hysteresis", &[0.3, 0.002]), ("stribeck_friction", &[0.05, 0.2, 0.5])]);
    let times = grid(3.0, 1000.0);
    let motion = free(&system, Start::release(0.7), &times);
    for (pair, speed) in motion.position.windows(3).zip(motion.velocity.iter().skip(1)) {
        let slope = (pair[2] - pair[0]) * 500.0;
        assert!((slope - speed).abs() < 2e-3, "{slope} {speed}");
    }
}
