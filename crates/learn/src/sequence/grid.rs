//! Resampling to even times: sequence models count samples, records have timestamps.

#![allow(clippy::indexing_slicing, reason = "indices are clipped to the samples")]

use crate::data::{Trajectory, interpolated, span_s};
use crate::{Ahead, LearnError, Past};
use dynamics::{Hold, Input};

/// Returns the mean of an input over `interval` seconds from `time` on. Before the first and after the last
/// sample, the input is constant.
fn averaged(input: &Input, (time, interval): (f64, f64)) -> f64 {
    // Midpoint rule: with even timestamps, the first midpoint of a held input reads the sample itself.
    let parts = 8;
    let mid = |part: i32| input.at(time + (f64::from(part) + 0.5) * interval / f64::from(parts));
    (0..parts).map(mid).sum::<f64>() / f64::from(parts)
}

/// Resamples a trajectory at even times from its first sample on.
pub(crate) fn evened(part: &Trajectory, interval: f64, hold: Hold) -> Result<Trajectory, LearnError> {
    let Some(&first) = part.times_s().first() else { return Ok(part.clone()) };
    let count = (part.duration_s() / interval * (1.0 + 1e-9)).floor() as usize + 1;
    let times: Vec<f64> = (0..count).map(|at| first + at as f64 * interval).collect();
    let values = times.iter().map(|&time| interpolated(part.times_s(), part.values(), time)).collect();
    let given = |input: &[f64]| Input::new(part.times_s().to_vec(), input.to_vec(), hold);
    let input = part.input().map(given).transpose()?;
    let mean = |input: Input| times.iter().map(|&time| averaged(&input, (time, interval))).collect();
    let input = input.map(mean);
    Trajectory::new(part.name(), times, values, input)
}

/// Returns the positions at the last `count` even times of a past; the last one is its last sample.
/// The first sample of a past that is too short is repeated before it if `repeats` is set.
pub(crate) fn past_positions(
    past: &Past<'_>,
    interval: f64,
    count: usize,
    repeats: bool,
) -> Result<Vec<f64>, LearnError> {
    // Jitter may shorten a past by part of an interval; the cubic interpolation bridges this gap.
    let there = (span_s(past.times_s) / interval + 0.5).floor() as usize + 1;
    if repeats && there < count && !past.values.is_empty() {
        let own = past_positions(past, interval, there, false)?;
        return Ok(std::iter::repeat_n(past.values[0], count - there).chain(own).collect());
    }
    let is_long = there >= count && past.times_s.len() >= 4;
    let Some(last) = past.times_s.last().filter(|_| is_long) else {
        return Err(LearnError::ShortPast {
            samples: there.min(past.times_s.len()),
            needed: count,
            needed_s: (count as f64 - 1.0) * interval,
        });
    };
    let time = |back: usize| last - back as f64 * interval;
    Ok((0..count).rev().map(|back| interpolated(past.times_s, past.values, time(back))).collect())
}

/// Returns the input at the last `before` even times of a past (including its last sample) and at `after`
/// later times; `None` without an input.
///
/// # Errors
/// [`LearnError::UnequalColumns`] if there is not one input for every time.
pub(crate) fn inputs(
    (past, ahead): (&Past<'_>, &Ahead<'_>),
    hold: Hold,
    interval: f64,
    [before, after]: [usize; 2],
) -> Result<Option<Vec<f64>>, LearnError> {
    let (Some(last), Some(past_input), Some(ahead_input)) = (past.times_s.last(), past.input, ahead.input)
    else {
        return Ok(None);
    };
    let (input, times) = ([past_input, ahead_input].concat(), [past.times_s, ahead.times_s].concat());
    if input.len() != times.len() {
        return Err(LearnError::UnequalColumns {
            record: "past and future".to_owned(),
            column: "input",
            found: input.len(),
            times: times.len(),
        });
    }
    let input = Input::new(times, input, hold)?;
    let time = |at: usize| last + (at as f64 - before as f64 + 1.0) * interval;
    Ok(Some((0..before + after).map(|at| averaged(&input, (time(at), interval))).collect()))
}

/// Interpolates values at the times of a record from values at even times that start at `first`.
pub(crate) fn read_back(values: &[f64], first: f64, interval: f64, times: &[f64]) -> Vec<f64> {
    let even: Vec<f64> = (0..values.len()).map(|at| first + at as f64 * interval).collect();
    times.iter().map(|&time| interpolated(&even, values, time)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_stamps_give_the_samples_themselves() {
        let times: Vec<f64> = (0..50).map(|at| 3.0 + f64::from(at) * 0.02).collect();
        let values: Vec<f64> = times.iter().map(|time| (7.0 * time).sin()).collect();
        let input: Vec<f64> = times.iter().map(|time| (5.0 * time).cos()).collect();
        let part = Trajectory::new("a", times, values, Some(input)).unwrap();
        let even = evened(&part, 0.02, Hold::Zero).unwrap();
        assert_eq!(even.len(), 50);
        for (own, expected) in even.values().iter().zip(part.values()) {
            assert!((own - expected).abs() < 1e-9);
        }
        for (own, expected) in even.input().unwrap().iter().zip(part.input().unwrap()) {
            assert!((own - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn uneven_stamps_are_evened_and_read_back() {
        let times: Vec<f64> =
            (0..200).map(|at| 0.02 * f64::from(at) + 0.006 * f64::from(at * at % 7) / 7.0).collect();
        let motion = |time: f64| (6.0 * time).sin();
        let values: Vec<f64> = times.iter().map(|&time| motion(time)).collect();
        let past = Past { times_s: &times[..100], values: &values[..100], input: None };
        let even = past_positions(&past, 0.02, 40, false).unwrap();
        let last = times[99];
        assert!((even[0] - motion(last - 39.0 * 0.02)).abs() < 1e-4);
        let ahead: Vec<f64> = (0..100).map(|at| motion(last + 0.02 * f64::from(at))).collect();
        let back = read_back(&ahead, last, 0.02, &times[100..190]);
        for (own, &time) in back.iter().zip(&times[100..190]) {
            assert!((own - motion(time)).abs() < 1e-4);
        }
    }

    #[test]
    fn a_past_that_is_too_short_says_how_long_it_has_to_be() {
        let times = [0.0, 0.1, 0.2, 0.3, 0.4];
        let past = Past { times_s: &times, values: &times, input: None };
        let error = past_positions(&past, 0.1, 8, false).unwrap_err().to_string();
        assert!(error.contains("5 of the 8 samples") && error.contains("0.700 s"), "{error}");
    }
}
