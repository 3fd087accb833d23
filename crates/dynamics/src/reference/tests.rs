use super::{Tolerance, simulate};
use crate::{Active, Nominal, Start, System};

fn system(nominal: Nominal, effects: &[(&str, &[f64])]) -> System {
    System::new(nominal, effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect())
        .unwrap()
}

/// 3.5 Hz, damping ratio 0.006, per unit of inertia.
fn nominal() -> Nominal {
    let omega = 7.0 * std::f64::consts::PI;
    Nominal::new(1.0, 2.0 * 0.006 * omega, omega * omega, 0.0).unwrap()
}

fn grid(duration: f64, rate: f64) -> Vec<f64> {
    (0..=(duration * rate) as usize).map(|i| i as f64 / rate).collect()
}

#[test]
fn viscous_damping_decays_as_the_closed_form() {
    let nominal = nominal();
    let times = grid(25.0, 260.0);
    let motion =
        simulate(&system(nominal, &[]), Start::release(0.7), None, &times, &Tolerance::default()).unwrap();
    let decay = nominal.damping() / 2.0;
    let omega = (nominal.stiffness() - decay * decay).sqrt();
    let mut worst = 0.0_f64;
    for (time, position) in times.iter().zip(&motion.position) {
        let exact =
            0.7 * (-decay * time).exp() * ((omega * time).cos() + decay / omega * (omega * time).sin());
        worst = worst.max((position - exact).abs());
    }
    assert!(worst < 1e-11, "{worst}");
}

fn mean(a: f64, g: f64) -> f64 {
    // The arithmetic-geometric mean.
    let (mut a, mut g) = (a, g);
    for _ in 0..60 {
        (a, g) = ((a + g) / 2.0, (a * g).sqrt());
    }
    a
}

/// Complete elliptic integral of the first kind, modulus k.
fn elliptic(k: f64) -> f64 {
    std::f64::consts::FRAC_PI_2 / mean(1.0, (1.0 - k * k).sqrt())
}

/// Times of maxima of a free motion, from a system whose friction is too small to matter: it makes the
/// integrator report reversals.
fn reversals(motion: &super::Motion) -> Vec<f64> {
    motion
        .events
        .iter()
        .filter(|event| matches!(event.happening, super::Happening::Reversal))
        .map(|event| event.time)
        .collect()
}

#[test]
fn coulomb_friction_takes_the_same_off_every_cycle_and_stops_within_its_band() {
    let (stiffness, friction) = (483.6, 2.1);
    let nominal = Nominal::new(1.0, 0.0, stiffness, 0.1).unwrap();
    let times = grid(25.0, 260.0);
    let system = system(nominal, &[("coulomb_friction", &[friction])]);
    let motion = simulate(&system, Start::release(0.8), None, &times, &Tolerance::default()).unwrap();
    let loss = 2.0 * friction / stiffness;
    let mut amplitude = 0.7;
    let mut side = -1.0;
    for event in &motion.events {
        amplitude -= loss;
        let expected = 0.1 + side * amplitude;
        assert!((event.position - expected).abs() < 1e-12, "{event:?} {expected}");
        side = -side;
    }
    let last = motion.events.last().unwrap();
    assert_eq!(last.happening, super::Happening::Stick);
    assert!((last.position - 0.1).abs() <= friction / stiffness);
    assert_eq!(motion.events.len(), ((0.7 - friction / stiffness) / loss).ceil() as usize);
    assert_eq!(motion.position.last(), Some(&last.position));
    assert_eq!(motion.velocity.last(), Some(&0.0));
}

#[test]
fn the_pendulums_period_is_its_elliptic_integral_up_to_170_degrees() {
    for degrees in [1.0, 10.0, 40.0, 90.0, 135.0, 170.0_f64] {
        let release = degrees.to_radians();
        let nominal = Nominal::new(1.0, 0.0, 0.0, 0.0).unwrap();
        let system = system(nominal, &[("gravity", &[37.0, 0.0]), ("coulomb_friction", &[0.0])]);
        let motion =
            simulate(&system, Start::release(release), None, &grid(20.0, 100.0), &Tolerance::default())
                .unwrap();
        let reversals = reversals(&motion);
        let period = 4.0 * elliptic((release / 2.0).sin()) / 37.0_f64.sqrt();
        let found = 2.0 * reversals.last().unwrap() / reversals.len() as f64;
        assert!((found / period - 1.0).abs() < 1e-10, "{degrees}: {found} {period}");
    }
}

const EVERYTHING: &[(&str, &[f64])] = &[
    ("coulomb_friction", &[0.1]),
    ("stribeck_friction", &[0.05, 0.2, 0.5]),
    ("quadratic_drag", &[0.002]),
    ("cubic_stiffness", &[30.0]),
    ("asymmetric_stiffness", &[9.0]),
    ("gravity", &[60.0, 0.4]),
    ("constant_torque", &[1.5]),
    ("backlash", &[0.004]),
    ("hysteresis", &[0.3, 0.01]),
    ("end_stop", &[-0.55, 20_000.0, 0.05]),
    ("stiffness_drift", &[0.002]),
    ("damping_drift", &[0.02]),
    ("periodic_forcing", &[4.0, 31.0, 0.3]),
    ("flexible_coupling", &[0.05, 180.0, 0.2]),
    ("input_delay", &[0.0031]),
    ("input_saturation", &[8.0]),
];

fn command(duration: f64, hold: crate::Hold) -> crate::Input {
    let times = grid(duration, 50.0);
    let values = times.iter().map(|t| 12.0 * (19.0 * t + 0.8 * t * t).sin()).collect();
    crate::Input::new(times, values, hold).unwrap()
}

#[test]
fn with_every_effect_on_the_energy_balances() {
    let nominal = nominal();
    let system = system(nominal, EVERYTHING);
    let times = grid(30.0, 260.0);
    for hold in [crate::Hold::Zero, crate::Hold::Linear] {
        let input = command(30.0, hold);
        let motion =
            simulate(&system, Start::release(0.7), Some(&input), &times, &Tolerance::default()).unwrap();
        let energy = |i: usize| {
            0.5 * motion.velocity[i].powi(2) + 0.5 * nominal.stiffness() * motion.position[i].powi(2)
        };
        let mut worst = 0.0_f64;
        for i in 0..times.len() {
            let work: f64 = motion.accounts.iter().map(|account| account.work[i]).sum();
            worst = worst.max((energy(i) - energy(0) - work).abs());
        }
        assert!(worst < 1e-8 * energy(0), "{worst}");
    }
}

#[test]
fn collocation_has_twice_as_many_orders_as_stages() {
    // A swinging pendulum with damping: smooth, nonlinear, not reversible.
    let nominal = Nominal::new(1.0, 0.3, 2.0, 0.1).unwrap();
    let system = system(nominal, &[("gravity", &[9.0, 0.2]), ("cubic_stiffness", &[1.5])]);
    let times = [0.0, 2.0];
    let start = Start { position: 1.2, velocity: 0.5 };
    let exact = simulate(&system, start, None, &times, &Tolerance::default()).unwrap().position[1];
    for (stages, steps) in [(1, 4000.0), (2, 200.0), (3, 60.0), (4, 20.0)] {
        let error = |steps: f64| {
            let stepping = super::run::Stepping::Fixed(2.0 / steps);
            let run = super::run::Run::new(&system, start, None, &times, stepping, stages).unwrap();
            (run.motion(&times).unwrap().position[1] - exact).abs()
        };
        let order = (error(steps) / error(2.0 * steps)).log2();
        assert!((order - 2.0 * stages as f64).abs() < 0.05, "{stages} stages: order {order}");
    }
}
