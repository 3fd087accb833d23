//! Detection of stale readings: rows that repeat the reading before because no new one had arrived.

use crate::data::observations::Observations;
use crate::measurement::neighbors::white_noise;
use crate::noise::statistics::quantile;
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

/// Largest number of samples on either side over which the speed is measured.
const AROUND: usize = 3;

/// Probability of a repeat by chance below which a sample counts as in motion.
const SELDOM: f64 = 0.01;

/// Number of standard deviations of their count, and number beside, by which repeats in motion exceed those
/// that chance makes.
const BY_CHANCE: f64 = 5.0;

/// Largest ratio of a repeat's probability by chance to that of a stale reading.
const CLEARLY: f64 = 0.1;

/// Share of the smallest distances that bounds the step of readings without a lattice, and the share of unlike
/// readings from which on distances between any two count, not only those from row to row.
const SMALLEST: f64 = 0.02;
const UNLIKE: f64 = 0.5;

/// Marks the readings that are stale: a row repeats the one before although the body moved on.
///
/// Fresh readings agree by chance if rounding is coarse beside motion and noise: with a probability of
/// E[(1 − |d|/q)₊] for a change d of normal distribution and steps q (a triangular kernel). If repeats in
/// motion, where chance hardly makes any, are more than this explains, readings do get stale, and each
/// repeat whose probability by chance is less than a tenth of the stale share is one. Values at an end of the
/// range are left aside: there a sensor may be saturated. The time is that of one sort.
pub(crate) fn stale(observations: &Observations) -> Vec<bool> {
    let values = &observations.values;
    let none = vec![false; values.len()];
    let repeats: Vec<bool> =
        (0..values.len()).map(|at| at > 0 && values.get(at) == values.get(at - 1)).collect();
    if !repeats.contains(&true) {
        return none;
    }
    let step = observations.resolution.unwrap_or_else(|| unlike(values));
    let deviation = std::f64::consts::SQRT_2 * noise(observations, &repeats).max(1e-9 * step);
    let Ok(change) = Normal::new(0.0, deviation) else { return none };
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Speed in values per row, and the probability that two fresh readings agree.
    let odds: Vec<Option<(f64, f64)>> = values
        .iter()
        .enumerate()
        .map(|(at, value)| {
            // An outlier at one end makes a speed too large, so the smallest of several counts.
            let over = |around: usize| {
                let (from, to) = (at.saturating_sub(around + 1), (at + around).min(values.len() - 1));
                Some((values.get(to)? - values.get(from)?).abs() / (to - from).max(1) as f64)
            };
            let speed = (1..=AROUND).filter_map(over).fold(f64::INFINITY, f64::min);
            (*value > lowest && *value < highest).then(|| (speed, agree(&change, deviation, speed, step)))
        })
        .collect();
    let (mut moving, mut found, mut expected) = (0.0, 0.0, 0.0);
    for (odds, repeats) in odds.iter().zip(&repeats) {
        if let Some((speed, chance)) = odds
            && *speed > step
            && *chance < SELDOM
        {
            moving += 1.0;
            expected += chance;
            found += f64::from(u8::from(*repeats));
        }
    }
    if found <= expected + BY_CHANCE * (expected.sqrt() + 1.0) {
        return none;
    }
    let share = (found - expected) / moving;
    let is_stale = |own: &Option<(f64, f64)>| own.is_some_and(|(_, chance)| chance < CLEARLY * share);
    repeats.iter().zip(&odds).map(|(repeats, odds)| *repeats && is_stale(odds)).collect()
}

/// Returns the step within which readings without a lattice may agree.
fn unlike(values: &[f64]) -> f64 {
    let distances = |values: &[f64]| -> Vec<f64> {
        let all = values.windows(2).filter_map(|w| Some((w.last()? - w.first()?).abs()));
        all.filter(|distance| *distance > 0.0).collect()
    };
    let changes = distances(values);
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let gaps = distances(&sorted);
    let are_unlike = gaps.len() as f64 > UNLIKE * changes.len() as f64;
    quantile(if are_unlike { &gaps } else { &changes }, SMALLEST)
}

/// Returns the noise of the samples that no repeat is near.
fn noise(observations: &Observations, repeats: &[bool]) -> f64 {
    let fresh: Vec<bool> = repeats.iter().map(|repeats| !repeats).collect();
    white_noise(observations, &fresh)
}

/// Returns E[(1 − |d|/q)₊] for a change of mean `speed`. `change` is a normal distribution about zero with a standard
/// `deviation`.
fn agree(change: &Normal, deviation: f64, speed: f64, step: f64) -> f64 {
    // The integral of the normal distribution's probability.
    let ramp = |x: f64| x * change.cdf(x) + deviation * deviation * change.pdf(x);
    ((ramp(speed + step) + ramp(speed - step) - 2.0 * ramp(speed)) / step).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::stale;
    use crate::Observations;
    use rand::RngExt;
    use rand_distr::StandardNormal;
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    const NOISE: f64 = 1e-3;

    /// A decaying swing, of which each sample is lost with a probability and the last reading repeated; rounded
    /// if `step` is not zero. Returns what is stale, and what is found to be.
    fn found(seed: u64, lost: f64, step: f64, noise: f64) -> (Vec<bool>, Vec<bool>) {
        let mut generator = Seed::new(seed).child("stale").generator();
        let (mut values, mut is_stale) = (Vec::new(), Vec::new());
        for at in 0..3000 {
            let time = f64::from(at) / 100.0;
            let draw: f64 = generator.sample(StandardNormal);
            let exact = 0.7 * (-0.1 * time).exp() * (6.0 * time).cos() + noise * draw;
            let reading = if step > 0.0 { (exact / step).round() * step } else { exact };
            let is_lost = at > 0 && generator.random::<f64>() < lost;
            values.push(if is_lost { values[at as usize - 1] } else { reading });
            is_stale.push(is_lost);
        }
        let times = (0..3000).map(|at| f64::from(at) / 100.0).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        (is_stale, stale(&Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap())))
    }

    #[test]
    fn repeats_in_motion_are_stale() {
        for (seed, lost) in [0.01, 0.1, 0.3].into_iter().enumerate() {
            for step in [0.0, 1e-3, 4e-3] {
                let (are, named) = found(seed as u64, lost, step, NOISE);
                let of =
                    |want: bool| are.iter().zip(&named).filter(|(is, named)| **is == want && **named).count();
                let all = are.iter().filter(|is| **is).count();
                let least = if step > 0.0 { 0.25 } else { 0.85 };
                assert!(of(true) as f64 > least * all as f64, "{lost} {step}: {} of {all}", of(true));
                assert!(of(false) as f64 <= 0.02 * all as f64 + 3.0, "{lost} {step}: {}", of(false));
            }
        }
    }

    /// Coarse rounding repeats most readings, and a quiet sensor repeats exactly at its turning points.
    #[test]
    fn rounding_makes_none() {
        for (seed, step) in [0.0, 1e-3, 4e-3, 0.02, 0.1, 0.2].into_iter().enumerate() {
            for noise in [0.0, 0.1 * NOISE, NOISE, 20.0 * NOISE] {
                let (_, named) = found(seed as u64, 0.0, step, noise);
                assert!(!named.contains(&true), "{step} {noise}");
            }
        }
    }

    /// Isolated wrong readings are no motion.
    #[test]
    fn outliers_beside_coarse_steps_make_none() {
        for seed in 0..5 {
            let mut generator = Seed::new(seed).child("wrong").generator();
            let (times, values): (Vec<f64>, Vec<f64>) = (0..5000)
                .map(|at| {
                    let time = f64::from(at) / 250.0;
                    let draw: f64 = generator.sample(StandardNormal);
                    let wrong =
                        if generator.random::<f64>() < 0.02 { generator.sample(StandardNormal) } else { 0.0 };
                    let exact =
                        0.7 * (-0.1 * time).exp() * (6.0 * time).cos() + 3.0 * NOISE * draw + 0.5 * wrong;
                    (time, (exact / 1.5e-3).round() * 1.5e-3)
                })
                .unzip();
            let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
            let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
            assert!(!stale(&Observations::new(&record, &clock)).contains(&true), "{seed}");
        }
    }

    /// A sensor at the end of its range stays there for many samples.
    #[test]
    fn a_saturated_sensor_makes_none() {
        let times: Vec<f64> = (0..3000).map(|at| f64::from(at) / 100.0).collect();
        let mut generator = Seed::new(1).child("stale").generator();
        let mut value = |time: &f64| {
            let draw: f64 = generator.sample(StandardNormal);
            (0.7 * (6.0 * time).cos() + NOISE * draw).clamp(-0.5, 0.4)
        };
        let values = times.iter().map(&mut value).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        assert!(!stale(&Observations::new(&record, &clock)).contains(&true));
    }
}
