use super::{Moving, fit};
use crate::data::observations::Observations;
use crate::data::segments::{Data, cut};
use crate::fit::calibrate::baseline;
use crate::fit::fitted::{Fit, Point, first_starts};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::model::candidates::backlash::Backlash;
use crate::model::candidates::coulomb_friction::CoulombFriction;
use crate::model::candidates::flexible_coupling::FlexibleCoupling;
use crate::model::candidates::hysteresis::Hysteresis;
use crate::model::hypothesis::Calibrated;
use dynamics::reference::{Tolerance, simulate};
use dynamics::{Active, Coefficients, Nominal, Start, System};
use rand_distr::{Distribution, StandardNormal};
use record::{Clock, ClockChoice, Quantity, Record};
use seed::Seed;

fn nominal() -> Nominal {
    Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap()
}

/// 25 s of a swing at 3.5 Hz with dry friction that stops it before the record ends, with noise of 1 mrad.
fn observed(friction: f64, seed: u64) -> Observations {
    with_effects(vec![Active::new("coulomb_friction", &[friction]).unwrap()], seed)
}

/// The same with other effects.
fn with_effects(effects: Vec<Active>, seed: u64) -> Observations {
    let system = System::new(nominal(), effects).unwrap();
    let times: Vec<f64> = (0..2500).map(|i| f64::from(i) * 0.01).collect();
    let motion = simulate(&system, Start::release(0.6), None, &times, &Tolerance::default()).unwrap();
    let mut generator = Seed::new(seed).child("noise").generator();
    let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
    let values = motion.position.iter().map(|x| x + 1e-3 * noise()).collect();
    let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
    let clock = Clock::new(&record, ClockChoice::Host).unwrap();
    Observations::new(&record, &clock)
}

/// Sum of squares at a fit's point, evaluated again.
fn anew(data: &Data, found: &Fit) -> f64 {
    let stay = Stopping { steps: 0, ..Stopping::FINAL };
    fit(data, &found.hypothesis, found.point.clone(), Moving::All, stay).unwrap().squares
}

/// With dry friction, steps fail and segments begin again. The sum of squares that a fit reports must be the
/// one at its own point.
#[test]
fn squares_are_those_of_the_fits_own_point() {
    let mut checked = 0;
    for seed in 0..4 {
        let observations = observed(1.0 + 0.5 * seed as f64, seed);
        let kept = [vec![true; observations.len()]];
        let data = cut(&[observations], &kept, &(&nominal()).into()).unwrap();
        let base = baseline(&data, &(&nominal()).into()).unwrap().calibrated;
        for candidate in
            [Candidate::new(&CoulombFriction), Candidate::new(&Hysteresis), Candidate::new(&Backlash)]
        {
            let hypothesis = base.hypothesis.with(&[candidate]);
            let lows = candidate.parameters(&data.facts).into_iter();
            let values = lows.map(|p| if p.shape { 0.1 * p.upper } else { 0.05 });
            let globals = base.point.globals.iter().copied().chain(values).collect();
            let point = Point { globals, starts: base.point.starts.clone() };
            let Ok(found) = fit(&data, &hypothesis, point, Moving::All, Stopping::SEARCH) else { continue };
            let squares = anew(&data, &found);
            assert!(
                (squares / found.squares - 1.0).abs() < 1e-9,
                "{candidate:?} {seed}: {squares} {}",
                found.squares
            );
            checked += 1;
        }
    }
    assert!(checked > 8, "{checked}");
}

/// A second body swings on while friction holds the first one, where the samples hardly tell its state: without a bound
/// to the steps of that state these fits end at 9 to 42 times the noise.
#[test]
fn a_second_body_is_fitted_beside_friction_that_holds_the_first_one() {
    let (friction, body) = (5.0, [0.3, 400.0, 0.1]);
    let there = [("coulomb_friction", &[friction][..]), ("flexible_coupling", &body[..])];
    let there = there.map(|(id, values)| Active::new(id, values).unwrap());
    let observations = with_effects(there.into(), 3);
    let kept = [vec![true; observations.len()]];
    let data = cut(&[observations], &kept, &(&nominal()).into()).unwrap();
    let base = baseline(&data, &(&nominal()).into()).unwrap().calibrated;
    let second = Candidate::new(&FlexibleCoupling);
    let hypothesis = base.hypothesis.with(&[Candidate::new(&CoulombFriction), second]);
    let [inertia, stiffness, damping] = body;
    for (off, inertia_off, stiffness_off) in [(0.95, 0.95, 1.0), (0.8, 0.9, 1.1), (0.7, 0.7, 0.8)] {
        let body = second.fitted(&[inertia_off * inertia, stiffness_off * stiffness, damping]);
        let nominal = base.hypothesis.nominal_point().into_iter();
        let globals = nominal.chain([off * friction]).chain(body).collect();
        let point = Point { globals, starts: first_starts(&data, &hypothesis) };
        let found = fit(&data, &hypothesis, point, Moving::All, Stopping::SEARCH).unwrap();
        let left = (found.squares / found.freedom()).sqrt();
        assert!(left < 1.1e-3, "{off}: {left}");
    }
}

/// Two recordings of a joint that friction holds at 0.1 and 0.5 rad while its command changes its sign every second:
/// without a bound, the closest spring would be none.
#[test]
fn a_position_drive_keeps_a_part_of_its_stiffness() {
    let drive = Nominal::new(0.04, 0.6, 8.0, 0.0).unwrap();
    let drive = drive.with_coefficients(Coefficients { input_gain: 8.0, ..drive.coefficients() }).unwrap();
    let times: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.02).collect();
    let command: Vec<f64> = (0..1000).map(|i| if i / 50 % 2 == 0 { 0.02 } else { -0.02 }).collect();
    let mut generator = Seed::new(1).child("noise").generator();
    let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
    let held = [0.1, 0.5].map(|angle| {
        let values = times.iter().map(|_| angle + 1e-4 * noise()).collect();
        let record =
            Record::new(times.clone(), values, Some(command.clone()), Quantity::Position, "rad").unwrap();
        Observations::new(&record, &Clock::new(&record, ClockChoice::Host).unwrap())
    });
    let kept = [vec![true; times.len()], vec![true; times.len()]];
    let data = cut(&held, &kept, &(&drive).into()).unwrap();
    let found = baseline(&data, &(&drive).into()).unwrap().calibrated;
    let calibrated = found.hypothesis.calibrated.iter().zip(&found.point.globals);
    let stiffness = calibrated.filter(|(which, _)| **which == Calibrated::Stiffness).map(|(_, value)| *value);
    let stiffness: Vec<f64> = stiffness.collect();
    assert!(stiffness.iter().all(|own| *own >= 0.1 * 8.0) && stiffness.len() == 1, "{stiffness:?}");
}
