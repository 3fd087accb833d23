//! Tests of each step against its definition and its statistics, and of the chain as a whole.

use super::{Chain, Observed, SampledMotion, Samples, transform};
use crate::active::Active;
use crate::error::DynamicsError;
use crate::law::Values;
use crate::registry::{ChainEffect, Effect, REGISTRY};
use crate::scalar::Dual;
use crate::units::Coordinate;
use seed::Seed;
use std::collections::BTreeSet;

const RATE: f64 = 260.0;
const OMEGA: f64 = 21.75;

/// 0.7·cos ωt, position, velocity and acceleration, for some samples at 260 Hz.
struct Cosine {
    times: Vec<f64>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Cosine {
    fn new(count: usize) -> Self {
        let times: Vec<f64> = (0..count).map(|i| i as f64 / RATE).collect();
        let series = |f: &dyn Fn(f64) -> f64| times.iter().map(|&t| f(OMEGA * t)).collect();
        Self {
            position: series(&|phase| 0.7 * phase.cos()),
            velocity: series(&|phase| -0.7 * OMEGA * phase.sin()),
            acceleration: series(&|phase| -0.7 * OMEGA * OMEGA * phase.cos()),
            times,
        }
    }

    fn sampled(&self) -> SampledMotion<'_, f64> {
        SampledMotion {
            times_s: &self.times,
            position: &self.position,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
        }
    }

    fn observe(&self, chain: &Chain, seed: u64) -> Result<Samples<f64>, DynamicsError> {
        let seed = Seed::new(seed);
        chain.observe(&self.sampled(), Coordinate::Angle, |id| seed.child(id).generator())
    }
}

fn chain(noise: f64, effects: &[(&str, &[f64])]) -> Chain {
    let effects = effects.iter().map(|(id, values)| Active::new(id, values).unwrap()).collect();
    Chain::new(Observed::Position, noise, effects).unwrap()
}

fn observe(count: usize, effects: &[(&str, &[f64])]) -> Samples<f64> {
    Cosine::new(count).observe(&chain(0.0, effects), 1).unwrap()
}

fn mean_and_deviation(list: impl Iterator<Item = f64>) -> (f64, f64) {
    let list: Vec<f64> = list.collect();
    let mean = list.iter().sum::<f64>() / list.len() as f64;
    let square = list.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / list.len() as f64;
    (mean, square.sqrt())
}

#[test]
fn the_registry_holds_the_vocabularys_chain() {
    let ids: BTreeSet<&str> = REGISTRY
        .iter()
        .filter(|effect| matches!(effect, Effect::MeasuringChain(_)))
        .map(|effect| effect.id())
        .collect();
    let vocabulary = [
        "sensor_quantization",
        "sensor_saturation",
        "sensor_lag",
        "sensor_nonlinearity",
        "sensor_drift",
        "timestamp_batching",
        "timestamp_jitter",
        "clock_drift",
        "dropouts",
        "outliers",
    ];
    assert_eq!(ids, BTreeSet::from(vocabulary));
}

#[test]
fn an_empty_chain_changes_nothing() {
    let cosine = Cosine::new(300);
    for (observed, expected) in [
        (Observed::Position, &cosine.position),
        (Observed::Velocity, &cosine.velocity),
        (Observed::Acceleration, &cosine.acceleration),
    ] {
        let samples = cosine.observe(&Chain::new(observed, 0.0, vec![]).unwrap(), 0).unwrap();
        assert_eq!(&samples.values, expected);
        assert_eq!(samples.stamps_s, cosine.times);
        assert_eq!(samples.indices, (0..300).collect::<Vec<_>>());
    }
}

#[test]
fn noise_is_white_and_normal() {
    let count = 40_000;
    let cosine = Cosine::new(count);
    let samples = cosine.observe(&chain(3e-3, &[]), 5).unwrap();
    let errors: Vec<f64> =
        samples.values.iter().zip(&cosine.position).map(|(seen, truth)| (seen - truth) / 3e-3).collect();
    let (mean, deviation) = mean_and_deviation(errors.iter().copied());
    // Four standard errors each.
    let bound = 4.0 / (count as f64).sqrt();
    assert!(mean.abs() < bound && (deviation - 1.0).abs() < bound, "{mean} {deviation}");
    let lagged = errors.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / count as f64;
    assert!(lagged.abs() < bound, "{lagged}");
    let beyond = errors.iter().filter(|error| error.abs() > 1.959_964).count() as f64 / count as f64;
    assert!((beyond - 0.05).abs() < 4.0 * (0.05_f64 * 0.95 / count as f64).sqrt(), "{beyond}");
}

#[test]
fn readings_are_multiples_of_the_step_within_half_of_it() {
    let step = 0.01;
    let cosine = Cosine::new(2_000);
    let samples = cosine.observe(&chain(0.0, &[("sensor_quantization", &[step])]), 0).unwrap();
    for (seen, truth) in samples.values.iter().zip(&cosine.position) {
        assert!((seen / step - (seen / step).round()).abs() < 1e-9);
        assert!((seen - truth).abs() <= 0.5 * step * (1.0 + 1e-12));
    }
    // Uniform over the step if the motion sweeps many of them (Widrow).
    let (mean, deviation) =
        mean_and_deviation(samples.values.iter().zip(&cosine.position).map(|(seen, truth)| seen - truth));
    assert!(mean.abs() < 4e-4 && (deviation / step * 12_f64.sqrt() - 1.0).abs() < 0.05, "{mean} {deviation}");
}

#[test]
fn a_saturated_sensor_has_flat_tops() {
    let cosine = Cosine::new(1_000);
    let samples = cosine.observe(&chain(0.0, &[("sensor_saturation", &[0.5])]), 0).unwrap();
    for (seen, truth) in samples.values.iter().zip(&cosine.position) {
        assert_eq!(*seen, truth.clamp(-0.5, 0.5));
    }
    assert!(samples.values.contains(&0.5) && samples.values.contains(&-0.5));
}

#[test]
fn a_drift_is_a_line_in_time() {
    let cosine = Cosine::new(1_000);
    let samples = cosine.observe(&chain(0.0, &[("sensor_drift", &[2e-3])]), 0).unwrap();
    for ((seen, truth), time) in samples.values.iter().zip(&cosine.position).zip(&cosine.times) {
        assert_eq!(*seen, truth + 2e-3 * time);
    }
}

#[test]
fn a_drifting_clock_shows_its_polynomial() {
    let samples = observe(1_000, &[("clock_drift", &[1e-3, -2e-5])]);
    for (stamp, time) in samples.stamps_s.iter().zip(&samples.times_s) {
        let expected = time + 1e-3 * time - 1e-5 * time * time;
        assert!((stamp - expected).abs() < 1e-15, "{stamp} {expected}");
    }
}

#[test]
fn jitter_scatters_stamps_and_keeps_their_order() {
    let count = 40_000;
    let deviation = 0.1 / RATE;
    let samples = observe(count, &[("timestamp_jitter", &[deviation])]);
    let errors =
        samples.stamps_s.iter().zip(&samples.times_s).map(|(stamp, time)| (stamp - time) / deviation);
    let (mean, found) = mean_and_deviation(errors);
    let bound = 4.0 / (count as f64).sqrt();
    assert!(mean.abs() < bound && (found - 1.0).abs() < bound, "{mean} {found}");
    let coarse = observe(count, &[("timestamp_jitter", &[0.45 / RATE])]);
    assert!(coarse.stamps_s.windows(2).all(|pair| pair[0] <= pair[1]));
}

#[test]
fn bursts_share_the_time_of_their_end() {
    let (interval, scatter) = (0.062, 0.003);
    let samples = observe(40_000, &[("timestamp_batching", &[interval, scatter])]);
    let mut ends = samples.stamps_s.clone();
    ends.dedup();
    let (mean, deviation) = mean_and_deviation(ends.windows(2).map(|pair| pair[1] - pair[0]));
    let bound = 4.0 * scatter / (ends.len() as f64).sqrt();
    assert!((mean - interval).abs() < bound && (deviation - scatter).abs() < bound, "{mean} {deviation}");
    for (index, (stamp, time)) in samples.stamps_s.iter().zip(&samples.times_s).enumerate() {
        // No sample is stamped before it was taken, nor after the first burst that could carry it.
        assert!(stamp >= time);
        let before = ends.partition_point(|end| end < stamp);
        assert!(before == 0 || ends[before - 1] < *time, "{index}");
    }
}

#[test]
fn lost_samples_are_gone_with_their_stamps() {
    let count = 200_000;
    let (share, length) = (0.02, 5.0);
    let samples = observe(count, &[("dropouts", &[share, length])]);
    let lost = 1.0 - samples.values.len() as f64 / count as f64;
    let gaps: Vec<f64> = samples
        .indices
        .windows(2)
        .map(|pair| (pair[1] - pair[0] - 1) as f64)
        .filter(|lost| *lost > 0.0)
        .collect();
    // Gilbert's channel: about n·p/L gaps of geometric length, standard deviation √(L(L − 1)).
    let expected_gaps = count as f64 * share / length;
    let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
    let bound = 4.0 * (length * (length - 1.0)).sqrt() / expected_gaps.sqrt();
    assert!((mean - length).abs() < bound, "{mean}");
    assert!((lost - share).abs() < 4.0 * share * (2.0 / expected_gaps).sqrt(), "{lost}");
    for (at, &index) in samples.indices.iter().enumerate() {
        assert_eq!(samples.times_s[at], index as f64 / RATE);
        assert_eq!(samples.stamps_s[at], samples.times_s[at]);
    }
}

#[test]
fn outliers_are_as_many_and_as_large_as_stated() {
    let count = 100_000;
    let cosine = Cosine::new(count);
    let samples = cosine.observe(&chain(0.0, &[("outliers", &[0.01, 0.2])]), 3).unwrap();
    let errors: Vec<f64> = samples
        .values
        .iter()
        .zip(&cosine.position)
        .map(|(seen, truth)| seen - truth)
        .filter(|error| *error != 0.0)
        .collect();
    let expected = 0.01 * count as f64;
    assert!((errors.len() as f64 - expected).abs() < 4.0 * expected.sqrt(), "{}", errors.len());
    let (mean, deviation) = mean_and_deviation(errors.iter().copied());
    let bound = 4.0 * 0.2 / expected.sqrt();
    assert!(mean.abs() < bound && (deviation - 0.2).abs() < bound, "{mean} {deviation}");
}

#[test]
fn wrong_readings_lie_on_the_sensors_lattice() {
    let step = 2.0 * std::f64::consts::PI / 4096.0;
    let samples = observe(20_000, &[("outliers", &[0.05, 0.2]), ("sensor_quantization", &[step])]);
    assert!(samples.values.iter().any(|value| value.abs() > 0.75));
    for value in samples.values {
        assert!((value / step - (value / step).round()).abs() < 1e-9);
    }
}

#[test]
fn the_order_is_the_hardwares_whatever_is_given() {
    let one: &[(&str, &[f64])] = &[
        ("sensor_quantization", &[0.01]),
        ("sensor_saturation", &[0.45]),
        ("sensor_lag", &[0.01]),
        ("clock_drift", &[1e-3, 0.0]),
        ("timestamp_batching", &[0.05, 0.0]),
    ];
    let mut other = one.to_vec();
    other.reverse();
    let (one, other) = (chain(1e-3, one), chain(1e-3, &other));
    assert_eq!(one, other);
    let ids: Vec<&str> = one.effects().map(Active::id).collect();
    assert_eq!(
        ids,
        ["sensor_lag", "sensor_saturation", "sensor_quantization", "clock_drift", "timestamp_batching"]
    );
    // A clipped reading is rounded afterward: the bound itself, 0.45, is a multiple of the step.
    let samples = Cosine::new(500).observe(&one, 0).unwrap();
    assert!(samples.values.iter().all(|value| value.abs() < 0.45 + 1e-12));
}

#[test]
fn a_further_step_changes_no_others_draws() {
    let cosine = Cosine::new(500);
    let plain = cosine.observe(&chain(1e-3, &[]), 7).unwrap();
    let jittered = cosine.observe(&chain(1e-3, &[("timestamp_jitter", &[1e-4])]), 7).unwrap();
    assert_eq!(plain.values, jittered.values);
    assert_ne!(plain.values, cosine.observe(&chain(1e-3, &[]), 8).unwrap().values);
}

#[test]
fn the_fits_side_agrees_with_the_simulators() {
    let steps: &[(&str, &[f64])] = &[
        ("sensor_lag", &[5e-3]),
        ("sensor_nonlinearity", &[0.01, 0.4]),
        ("sensor_drift", &[1e-3]),
        ("sensor_saturation", &[0.6, 0.05]),
        ("clock_drift", &[1e-3, 1e-5]),
    ];
    let cosine = Cosine::new(700);
    let seen = cosine.observe(&chain(0.0, steps), 0).unwrap();
    let own = |(id, values): &(&str, &[f64])| {
        let Effect::MeasuringChain(effect) = Effect::find(id).unwrap() else { panic!("{id}") };
        (effect, Active::new(id, values).unwrap().all_values())
    };
    let chain: Vec<(ChainEffect, Values<f64>)> = steps.iter().map(own).collect();
    assert!(chain.iter().all(|(effect, _)| effect.is_differentiable()));
    assert_eq!(transform(&chain, &cosine.sampled(), Observed::Position), seen);

    // Derivatives with respect to all eight parameters, against central differences.
    let shifted = |which: usize, by: f64| {
        let mut moved = chain.clone();
        let counts = moved.iter().map(|(effect, _)| effect.description().parameters.len());
        let places: Vec<(usize, usize)> =
            counts.enumerate().flat_map(|(step, count)| (0..count).map(move |at| (step, at))).collect();
        let (step, at) = places[which];
        moved[step].1[at] += by;
        transform(&moved, &cosine.sampled(), Observed::Position)
    };
    let series = |list: &[f64]| list.iter().map(|&x| Dual::<8>::from(x)).collect::<Vec<_>>();
    let (p, v, a) = (series(&cosine.position), series(&cosine.velocity), series(&cosine.acceleration));
    let motion = SampledMotion { times_s: &cosine.times, position: &p, velocity: &v, acceleration: &a };
    let mut index = 0;
    let duals: Vec<(ChainEffect, Values<Dual<8>>)> = chain
        .iter()
        .map(|(effect, values)| {
            let mut own = values.map(Dual::from);
            for value in own.iter_mut().take(effect.description().parameters.len()) {
                *value = Dual::variable(value.value, index);
                index += 1;
            }
            (*effect, own)
        })
        .collect();
    assert_eq!(index, 8);
    let exact = transform(&duals, &motion, Observed::Position);
    for which in 0..8 {
        let h = 1e-6;
        let (above, below) = (shifted(which, h), shifted(which, -h));
        for at in 0..cosine.times.len() {
            for (dual, above, below) in [
                (exact.values[at], above.values[at], below.values[at]),
                (exact.stamps_s[at], above.stamps_s[at], below.stamps_s[at]),
            ] {
                let difference = (above - below) / (2.0 * h);
                // At a sample that just saturates, the two sides differ.
                let edge = ((dual.value - 0.05).abs() - 0.6).abs() < 1e-4;
                assert!(edge || (dual.partials[which] - difference).abs() < 2e-3, "{which} {at}");
            }
        }
    }
}

#[test]
fn impossible_parameters_are_named() {
    let cosine = Cosine::new(2_600);
    let message = |id: &str, values: &[f64]| match Active::new(id, values) {
        Ok(active) => {
            let chain = Chain::new(Observed::Position, 0.0, vec![active]).unwrap();
            cosine.observe(&chain, 0).unwrap_err().to_string()
        }
        Err(error) => error.to_string(),
    };
    for (id, values, expected) in [
        ("sensor_lag", &[11.0][..], "`sensor_lag`: `time_constant` is 11, but must be at most 9.99"),
        ("sensor_lag", &[0.0], "`sensor_lag`: `time_constant` is 0; expected a finite number above 0"),
        ("sensor_quantization", &[2.0], "`sensor_quantization`: `step` is 2, but must be at most 1.39"),
        ("sensor_quantization", &[-1.0], "`sensor_quantization`: `step` is -1; expected"),
        ("sensor_saturation", &[0.0], "`sensor_saturation`: `bound` is 0; expected"),
        ("timestamp_batching", &[1e-3, 0.0], "a shorter burst holds zero samples"),
        ("timestamp_batching", &[6.0, 0.0], "`interval` is 6, but must be at most 4.99"),
        ("timestamp_batching", &[0.1, 0.05], "bursts overtake each other"),
        ("timestamp_jitter", &[0.01], "half the sample period"),
        ("clock_drift", &[0.0, -0.2], "the clock runs backward"),
        ("clock_drift", &[0.0, 1e9], "gains more than a second in a second"),
        ("dropouts", &[0.95, 1.0], "`dropouts`: `share` is 0.95; expected from 0 to 0.9"),
        ("dropouts", &[0.1, 0.0], "`dropouts`: `length` is 0; expected a finite number of 1 or above"),
        ("outliers", &[1.5, 1.0], "`outliers`: `probability` is 1.5; expected from 0 to 1"),
    ] {
        let found = message(id, values);
        assert!(found.contains(expected), "{found}");
    }
    let refused = |chain: Result<Chain, DynamicsError>| chain.unwrap_err().to_string();
    assert_eq!(
        refused(Chain::new(Observed::Position, -1e-3, vec![])),
        "the sensor's noise is -0.001; expected a finite number of 0 or above"
    );
    let friction = Active::new("coulomb_friction", &[1.0]).unwrap();
    assert!(refused(Chain::new(Observed::Position, 0.0, vec![friction])).contains("changes the motion"));
    let lag = Active::new("sensor_lag", &[1.0]).unwrap();
    assert!(refused(Chain::new(Observed::Position, 0.0, vec![lag, lag])).contains("given twice"));
    let eccentric = Active::new("sensor_nonlinearity", &[0.01, 0.0]).unwrap();
    let gyroscope = Chain::new(Observed::Velocity, 0.0, vec![eccentric]).unwrap();
    assert!(cosine.observe(&gyroscope, 0).unwrap_err().to_string().contains("needs an encoder"));
}

#[test]
fn a_chain_survives_its_text() {
    let chain = chain(3e-4, &[("clock_drift", &[1e-4, 0.0]), ("sensor_quantization", &[0.0015])]);
    let text = toml::to_string(&chain).unwrap();
    assert_eq!(toml::from_str::<Chain>(&text).unwrap(), chain, "{text}");
}
