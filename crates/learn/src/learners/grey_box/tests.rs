//! Grey-box laws on motions whose law is known, made by small steps of Euler's method, which share no code with the
//! learner.

use crate::data::{DataSet, Making, Parts, Trajectory};
use crate::judge::{runs, score_of_runs, validation_error};
use crate::testing::{context, learner, making};
use dynamics::Hold;
use rand_distr::{Distribution, Normal};
use seed::Seed;

/// Steps from a sample to the next.
const FINE: usize = 400;

/// Returns a smooth random input: a sum of sines with random phases.
fn input(seed: u64, band: [f64; 2], duration: f64) -> impl Fn(f64) -> f64 {
    let mut generator = Seed::new(seed).child("phases").generator();
    let uniform = rand_distr::Uniform::new(0.0, std::f64::consts::TAU).unwrap();
    let lines = 30;
    let sines: Vec<[f64; 2]> = (0..lines)
        .map(|at| {
            let frequency = band[0] + (band[1] - band[0]) * f64::from(at) / f64::from(lines);
            // Whole periods over the record.
            [(frequency * duration).round() / duration, uniform.sample(&mut generator)]
        })
        .collect();
    move |time| sines.iter().map(|[f, phase]| (std::f64::consts::TAU * f * time + phase).sin()).sum()
}

/// Simulates a record of 1200 samples, with the input held between samples.
fn record(
    name: &str,
    interval: f64,
    drive: impl Fn(f64) -> f64,
    noise: f64,
    mut state: [f64; 3],
    rate: impl Fn(&mut [f64; 3], f64) -> [f64; 3],
) -> Trajectory {
    let times: Vec<f64> = (0..1200).map(|at| f64::from(at) * interval).collect();
    let input: Vec<f64> = times.iter().map(|time| drive(*time)).collect();
    let mut generator = Seed::new(7).child(name).generator();
    let normal = Normal::new(0.0, noise).unwrap();
    let mut values = Vec::new();
    for input in &input {
        values.push(state[0] + normal.sample(&mut generator));
        for _ in 0..FINE {
            let rates = rate(&mut state, *input);
            // The velocity first: for an oscillator, this keeps Euler's method stable.
            for at in [1, 0, 2] {
                state[at] += interval / FINE as f64 * rates[at];
            }
        }
    }
    Trajectory::new(name, times, values, Some(input)).unwrap()
}

fn data_set(records: [Trajectory; 3], period_s: f64, unit: &str) -> DataSet {
    let [train, validation, test] = records.map(|record| vec![record]);
    let making = Making {
        hold: Some(Hold::Zero),
        period_s: Some(period_s),
        warm_up_s: Some(30.0 * period_s / 20.0),
        unit: unit.to_owned(),
        ..making(None)
    };
    DataSet::of_parts(Parts { train, validation, test }, making).unwrap()
}

fn coefficient(model: &dyn crate::Model, name: &str) -> f64 {
    model.coefficients().iter().find(|own| own.name == name).unwrap().value
}

/// Every law is tried; the hidden state's law is found, with its coefficients.
#[test]
fn a_hysteretic_oscillator_is_found_among_the_laws() {
    let rate = |[x, v, z]: &mut [f64; 3], u: f64| {
        let force = 250.0 * *v - 8.0 * v.abs() * *z + 11.0 * *v * z.abs();
        [*v, 0.5 * u - 0.5 * *v - 250.0 * *x - *z, force]
    };
    let made = |seed: u64| {
        let drive = input(seed, [0.5, 6.0], 24.0);
        record(&format!("record-{seed}"), 0.02, move |time| 3.0 * drive(time), 1e-4, [0.0; 3], rate)
    };
    let data = data_set([made(1), made(2), made(3)], 0.28, "m");
    let fitted = learner("grey-box", &[]).fit(&data, &context()).unwrap();
    let model = fitted.model.as_ref();
    for (name, truth) in [
        ("u", 0.5),
        ("theta", 250.0),
        ("hysteresis.stiffness", 250.0),
        ("hysteresis.dissipation", 8.0),
        ("hysteresis.asymmetry", -11.0),
    ] {
        let found = coefficient(model, name);
        assert!((found / truth - 1.0).abs() < 0.1, "{name}: {found} for {truth}");
    }
    let score = score_of_runs(&runs(model, &data), &data);
    assert!(score.over_noise < 1.5, "{score:?}");
}

/// Reading of a sensor that shows little of low levels, and the level at a reading.
fn reading(level: f64) -> f64 {
    3.0 + 0.8 * ((level - 3.5) / 0.8).exp().ln_1p()
}

fn level(reading: f64) -> f64 {
    3.5 + 0.8 * ((reading - 3.0) / 0.8).exp_m1().ln()
}

/// Makes a record of two tanks: the upper one runs over at times, and the lower one, which has no rim, is read by a sensor.
fn tank_record(seed: u64, start: [f64; 3]) -> Trajectory {
    let rate = |[lower, upper, _]: &mut [f64; 3], u: f64| {
        *upper = upper.min(7.0);
        let (inflow, outflow) = (0.05 * u, 0.06 * upper.max(0.0).sqrt());
        let over = if *upper >= 7.0 { (inflow - outflow).max(0.0) } else { 0.0 };
        [outflow + 0.6 * over - 0.05 * lower.max(0.0).sqrt(), inflow - outflow - over, 0.0]
    };
    let drive = input(seed, [0.0005, 0.01], 4800.0);
    let drive = move |time| (2.5 + 0.5 * drive(time)).max(0.0);
    let made = record(&format!("record-{seed}"), 4.0, drive, 0.01, start, rate);
    let values = made.values().iter().map(|value| reading(*value)).collect();
    Trajectory::new("tanks", made.times_s().to_vec(), values, made.input().map(<[f64]>::to_vec)).unwrap()
}

fn tank_data() -> DataSet {
    data_set([1, 2, 3].map(|seed| tank_record(seed, [5.0, 4.0, 0.0])), 240.0, "V")
}

#[test]
fn two_tanks_are_found_with_their_overflow_and_the_sensors_curve() {
    let data = tank_data();
    let fitted = learner("grey-box", &["laws=two-tanks,polynomial-3"]).fit(&data, &context()).unwrap();
    let model = fitted.model.as_ref();
    // Levels are told but for their unit, which is that of the highest reading.
    let top = data.train[0].values().iter().copied().fold(0.0, f64::max);
    let unit = top / level(top);
    let near = |name: &str, found: f64, truth: f64, tolerance: f64| {
        let off = (found / truth - 1.0).abs();
        assert!(off < tolerance, "{name}: {found} for {truth}, {:?}", model.equation());
    };
    near("rim", coefficient(model, "upper.rim"), 7.0 * unit, 0.1);
    near("share", coefficient(model, "overflow.share"), 0.6, 0.15);
    let curve = model.coefficients().iter();
    let curve = curve.filter_map(|own| Some((own.name.strip_prefix("lower at reading ")?, own.value)));
    // The lowest reading is hardly more than the sensor's floor, and its level hardly told.
    let points: Vec<(&str, f64)> = curve.skip(1).collect();
    assert_eq!(points.len(), 4);
    for (reading, found) in points {
        near(reading, found, level(reading.parse().unwrap()) * unit, 0.05);
    }
}

/// A few samples of a slow system tell little of a hidden state: without what the training tells of it, starts lie far off.
#[test]
fn a_short_past_starts_from_a_probable_hidden_state() {
    let data = tank_data();
    let fitted = learner("grey-box", &["laws=two-tanks"]).fit(&data, &context()).unwrap();
    let model = super::GreyBox::restored(&fitted.model.stored().unwrap()).unwrap();
    let prior = model.about.prior.unwrap();
    let part = &data.validation[0];
    let starts: Vec<f64> =
        (0..40).map(|at| model.start(&part.part(20 * at, 20 * at + 3)).unwrap()[1]).collect();
    let off: f64 = starts.iter().map(|own| ((own - prior.mean) / prior.spread).powi(2)).sum();
    assert!(off / 40.0 < 2.0, "{starts:?} {prior:?}");
    let mut without = model;
    without.about.prior = None;
    let starts = (0..40).map(|at| without.start(&part.part(20 * at, 20 * at + 3)).unwrap()[1]);
    let wild: f64 = starts.map(|own| ((own - prior.mean) / prior.spread).powi(2)).sum();
    assert!(wild > 1.5 * off, "{wild} {off}");
}

/// Swings twice as wide as in training: a polynomial of fifth degree fits the training part as well, and is wrong there.
#[test]
fn a_duffing_oscillator_is_preferred_to_a_longer_polynomial_and_extrapolates() {
    let rate = |[x, v, _]: &mut [f64; 3], u: f64| {
        let bent = 0.1 * (*v / 0.3).tanh();
        [*v, 3.0 * u - 1.5 * *v - 320.0 * *x - 4000.0 * x.powi(3) + bent, 0.0]
    };
    let made = |seed: u64, size: f64| {
        let drive = input(seed, [0.5, 6.0], 24.0);
        record(&format!("record-{seed}"), 0.02, move |time| size * drive(time), 1e-4, [0.0; 3], rate)
    };
    let data = data_set([made(1, 0.5), made(2, 0.5), made(3, 1.0)], 0.35, "m");
    let fitted = learner("grey-box", &["laws=polynomial-5,duffing"]).fit(&data, &context()).unwrap();
    let model = fitted.model.as_ref();
    assert_eq!(model.parameters(), 12);
    let cubic = coefficient(model, "theta^3");
    assert!((cubic / -4000.0 - 1.0).abs() < 0.05, "{cubic}");
    let score = score_of_runs(&runs(model, &data), &data);
    assert!(score.over_noise < 3.0, "{score:?}");
}

/// A law that has seen the validation part tells its error from before.
#[test]
fn a_refitted_law_states_the_error_by_which_it_was_chosen() {
    let data = crate::testing::data_set(&crate::testing::drag_and_cubic(), true, 2e-3);
    let fit = |setting: &str| {
        let quick = ["max_steps=3", "laws=polynomial-3", setting];
        learner("grey-box", &quick).fit(&data, &context()).unwrap().model
    };
    let (before, after) = (fit("fit_validation=false"), fit("fit_validation=true"));
    assert_eq!(before.validation(), None);
    assert_eq!(validation_error(after.as_ref(), &data), validation_error(before.as_ref(), &data));
    assert_ne!(runs(after.as_ref(), &data), runs(before.as_ref(), &data));
    let restored = super::GreyBox::restored(&after.stored().unwrap()).unwrap();
    assert_eq!(validation_error(&restored, &data), validation_error(before.as_ref(), &data));
}

/// The test part is nobody's business until the end: a learner that gets none gives the same model.
#[test]
fn a_learner_needs_no_test_part() {
    let system = crate::testing::drag_and_cubic();
    let data = crate::testing::data_set(&system, true, 2e-3);
    let quick = ["samples=600", "max_steps=3"];
    let fit = |data: &DataSet| learner("grey-box", &quick).fit(data, &context()).unwrap().model;
    let (with, without) = (fit(&data), fit(&data.without_test()));
    assert_eq!(runs(with.as_ref(), &data), runs(without.as_ref(), &data));
}

#[test]
fn an_unknown_law_is_refused_with_the_known_ones() {
    let entry = crate::learners::find("grey-box").unwrap();
    let mut document = settings::Document::default();
    document.apply_override("grey-box.laws=[\"bouc-wenn\"]").unwrap();
    let sections = [settings::Section { name: entry.id, fields: entry.fields }];
    let resolved = settings::Resolved::new(&document, &sections).unwrap();
    let Err(error) = (entry.build)(&resolved) else { panic!("the law is unknown") };
    let error = error.to_string();
    assert!(error.contains("bouc-wenn") && error.contains("bouc-wen"), "{error}");
}
