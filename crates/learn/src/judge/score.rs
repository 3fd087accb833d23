//! Scores of free runs, prediction horizon, one-step error, and coverage.

#![allow(clippy::indexing_slicing, reason = "a warm-up ends within its part")]

use crate::data::{DataSet, Trajectory, span_s};
use crate::{Ahead, LearnError, Model, Past, Predicted};
use rand_distr::{Distribution, StandardNormal};
use seed::Seed;

/// Free run of one test trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Name of the trajectory.
    pub name: String,
    /// Times after the warm-up, in seconds.
    pub times_s: Vec<f64>,
    /// Observed positions at these times.
    pub observed: Vec<f64>,
    /// Predicted positions, or the reason why the model predicted none.
    pub predicted: Result<Predicted, LearnError>,
}

/// Scores over a test part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// Root mean square error of the free run over all test samples after the warm-ups; infinite if a run
    /// failed.
    pub free_run_rmse: f64,
    /// Root mean square error of the free run divided by the sensor's noise (× noise).
    pub over_noise: f64,
    /// Prediction horizon: time until the root mean square error over a quarter of a period exceeds three
    /// times the noise. Median over trajectories, in seconds; a run that never exceeds it counts with its
    /// whole length.
    pub horizon_s: f64,
    /// Root mean square error one sample ahead of a moving past; infinite if a step failed.
    pub one_step_rmse: f64,
    /// Share of the observations within the stated 95 % band; `None` if the model states no band.
    pub coverage_95: Option<f64>,
}

/// Number of samples along a test trajectory at which one step is predicted.
const STEPS: usize = 50;

/// Error at the end of the horizon, as a multiple of the noise.
const FLOORS: f64 = 3.0;

fn past(part: &Trajectory, from: usize, to: usize) -> Past<'_> {
    Past {
        times_s: &part.times_s()[from..to],
        values: &part.values()[from..to],
        input: part.input().map(|input| &input[from..to]),
    }
}

fn ahead(part: &Trajectory, from: usize, to: usize) -> Ahead<'_> {
    Ahead { times_s: &part.times_s()[from..to], input: part.input().map(|input| &input[from..to]) }
}

/// Runs a model freely over each test trajectory from its warm-up, with bands if the model states them.
#[must_use]
pub fn runs(model: &dyn Model, data: &DataSet) -> Vec<Run> {
    let run = |part: &Trajectory| {
        let (now, end) = (data.warm_up_samples(part), part.len());
        Run {
            name: part.name().to_owned(),
            times_s: ahead(part, now, end).times_s.to_vec(),
            observed: part.values()[now..].to_vec(),
            predicted: model.banded_run(&past(part, 0, now), &ahead(part, now, end)),
        }
    };
    data.test.iter().map(run).collect()
}

/// Runs a model freely as [`runs`] does, but on noise: past and input are white and normal, with the
/// trajectory's own means and standard deviations.
///
/// An error that does not grow shows that the model's prediction does not depend on what it is given.
#[must_use]
pub fn runs_on_noise(model: &dyn Model, data: &DataSet, seed: &Seed) -> Vec<Run> {
    let run = |(number, part): (usize, &Trajectory)| {
        let (now, end) = (data.warm_up_samples(part), part.len());
        let seed = seed.child("noise for input").child(&number.to_string());
        let values = noise_like(part.values(), &seed.child("position"));
        let input = part.input().map(|input| noise_like(input, &seed.child("input")));
        let (before, after) = (past(part, 0, now), ahead(part, now, end));
        let past = Past { values: &values[..now], input: cut(&input, 0, now), ..before };
        let ahead = Ahead { input: cut(&input, now, end), ..after };
        Run {
            name: part.name().to_owned(),
            times_s: after.times_s.to_vec(),
            observed: part.values()[now..].to_vec(),
            predicted: model.free_run(&past, &ahead),
        }
    };
    data.test.iter().enumerate().map(run).collect()
}

fn cut(of: &Option<Vec<f64>>, from: usize, to: usize) -> Option<&[f64]> {
    of.as_ref().and_then(|of| of.get(from..to))
}

/// Draws normal numbers with the mean and the standard deviation of `values`.
fn noise_like(values: &[f64], seed: &Seed) -> Vec<f64> {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    let mut generator = seed.generator();
    let mut draw = |_: &f64| {
        let standard: f64 = StandardNormal.sample(&mut generator);
        mean + spread * standard
    };
    values.iter().map(&mut draw).collect()
}

/// Returns the root mean square error of one free run; infinite if the run failed.
#[must_use]
pub fn run_error(run: &Run) -> f64 {
    let Ok(predicted) = &run.predicted else { return f64::INFINITY };
    let squares = run.observed.iter().zip(&predicted.values).map(|(a, b)| (a - b).powi(2));
    finite((squares.sum::<f64>() / run.observed.len().max(1) as f64).sqrt())
}

/// Returns the root mean square error of free runs over the validation part, without bands; infinite if a run
/// fails. For a model that was fitted to that part after it had been chosen, the error from before.
#[must_use]
pub fn validation_error(model: &dyn Model, data: &DataSet) -> f64 {
    model.validation().unwrap_or_else(|| root_mean(&validation_squares(model, data)))
}

/// Returns the square root of the mean; infinite if it is not a finite number.
pub(crate) fn root_mean(squares: &[f64]) -> f64 {
    finite((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Returns the squared errors of free runs over the validation part, one for each sample after the warm-ups;
/// empty if a run fails.
pub(crate) fn validation_squares(model: &dyn Model, data: &DataSet) -> Vec<f64> {
    let mut squares = Vec::new();
    for part in &data.validation {
        let (now, end) = (data.warm_up_samples(part), part.len());
        let Ok(found) = model.free_run(&past(part, 0, now), &ahead(part, now, end)) else {
            return Vec::new();
        };
        let observed = &part.values()[now..];
        squares.extend(observed.iter().zip(&found.values).map(|(a, b)| (a - b).powi(2)));
    }
    squares
}

/// Scores a model's free runs, and its single steps along the test part.
#[must_use]
pub fn score(model: &dyn Model, runs: &[Run], data: &DataSet) -> Score {
    Score { one_step_rmse: one_step(model, data), ..score_of_runs(runs, data) }
}

/// Scores free runs alone; `one_step_rmse` is NaN.
#[must_use]
pub fn score_of_runs(runs: &[Run], data: &DataSet) -> Score {
    let (mut sum, mut count, mut covered, mut stated) = (0.0, 0_usize, 0_usize, 0_usize);
    let mut horizons = Vec::new();
    for run in runs {
        count += run.observed.len();
        let Ok(predicted) = &run.predicted else {
            sum = f64::INFINITY;
            horizons.push(0.0);
            continue;
        };
        let errors: Vec<f64> = run.observed.iter().zip(&predicted.values).map(|(a, b)| a - b).collect();
        sum += errors.iter().map(|error| error * error).sum::<f64>();
        horizons.push(horizon(&run.times_s, &errors, FLOORS * data.noise, 0.25 * data.period_s));
        if let Some(std) = &predicted.std {
            stated += errors.len();
            covered += errors.iter().zip(std).filter(|(error, std)| error.abs() <= 1.96 * **std).count();
        }
    }
    let free_run_rmse = finite((sum / count.max(1) as f64).sqrt());
    Score {
        free_run_rmse,
        over_noise: free_run_rmse / data.noise,
        horizon_s: median(&mut horizons),
        one_step_rmse: f64::NAN,
        coverage_95: (stated > 0).then(|| covered as f64 / stated as f64),
    }
}

fn finite(error: f64) -> f64 {
    if error.is_finite() { error } else { f64::INFINITY }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    0.5 * (values[last / 2] + values[values.len() / 2])
}

/// Returns the time from the first sample until the root mean square error over the last `window_s` exceeds
/// `bound`.
fn horizon(times_s: &[f64], errors: &[f64], bound: f64, window_s: f64) -> f64 {
    let Some(&first) = times_s.first() else { return 0.0 };
    let (mut sum, mut oldest) = (0.0, 0);
    let squares: Vec<f64> = errors.iter().map(|error| error * error).collect();
    for (place, (&time, square)) in times_s.iter().zip(&squares).enumerate() {
        sum += square;
        while times_s.get(oldest).is_some_and(|&begin| begin < time - window_s) {
            sum -= squares[oldest];
            oldest += 1;
        }
        let full = time - first >= window_s;
        let mean = sum / (place + 1 - oldest) as f64;
        if (full && mean > bound * bound) || !mean.is_finite() {
            return (time - first - window_s).max(0.0);
        }
    }
    span_s(times_s)
}

fn one_step(model: &dyn Model, data: &DataSet) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for part in &data.test {
        let length = data.warm_up_samples(part);
        let places = part.len().saturating_sub(length);
        for now in (length..part.len()).step_by((places / STEPS).max(1)) {
            let found = model.free_run(&past(part, now - length, now), &ahead(part, now, now + 1));
            let Some(value) = found.ok().and_then(|found| found.values.first().copied()) else {
                return f64::INFINITY;
            };
            let Some(observed) = part.values().get(now) else { continue };
            sum += (observed - value).powi(2);
            count += 1;
        }
    }
    finite((sum / count.max(1) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_horizon_ends_where_the_error_passes_the_bound() {
        let times: Vec<f64> = (0..1000).map(|at| f64::from(at) * 0.01).collect();
        let errors: Vec<f64> = times.iter().map(|time| if *time < 5.0 { 0.1 } else { 1.0 }).collect();
        let found = horizon(&times, &errors, 0.5, 0.2);
        assert!((4.7..5.1).contains(&found), "{found}");
        assert!((horizon(&times, &errors, 2.0, 0.2) - 9.99).abs() < 1e-9);
    }

    #[test]
    fn one_outlier_does_not_end_a_horizon() {
        let times: Vec<f64> = (0..1000).map(|at| f64::from(at) * 0.01).collect();
        let errors: Vec<f64> = (0..1000).map(|at| if at == 300 { 1.0 } else { 0.1 }).collect();
        assert!((horizon(&times, &errors, 0.3, 0.25) - 9.99).abs() < 1e-9);
    }
}
