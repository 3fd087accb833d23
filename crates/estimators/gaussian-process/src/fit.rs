//! Training of the process, and its estimate.

use crate::ascent::{Bounds, Ended, Summit, climb};
use crate::config::GaussianProcessConfig;
use crate::likelihood::{Evaluation, Process, Slope};
use envelope::Envelope;
use estimator::{
    Estimate, Estimator, FitContext, FitError, ModelFile, Prediction, Reached, Scaling, Step, Stop,
    Uncertainty,
};
use nalgebra::{Cholesky, Matrix5, Vector5};
use rand::RngExt;
use std::ops::ControlFlow;

/// Fewest peaks: one more than the number of parameters.
const FEWEST_PEAKS: usize = 6;

/// Least standard deviation of signal and noise, in standard deviations of ln A: the resolution of a
/// covariance matrix in doubles.
const LEAST_DEVIATION: f64 = 1e-6;

impl Estimator for GaussianProcessConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        if envelope.len() < FEWEST_PEAKS {
            return Err(FitError::TooFewPeaks {
                estimator: "gaussian-process",
                found: envelope.len(),
                needed: FEWEST_PEAKS,
            });
        }
        if envelope.len() > self.most_peaks {
            return Err(FitError::TooManyPeaks {
                estimator: "gaussian-process",
                found: envelope.len(),
                most: self.most_peaks,
            });
        }
        let scaling = Scaling::of(envelope)?;
        let times = context.input("times", scaling.unit_times(envelope));
        let projection = Projection::new(&times);
        let process = Process::new(self.kernel, self.signal_scale, &times, &scaling.scaled_logs(envelope));
        let rate =
            |at: &Evaluation| -scaling.rate_per_unit_time(projection.slope(process.fitted(at).as_slice()));
        let trained = self.train(&process, context, rate)?;
        describe(&scaling, &process, &projection, &trained, context.query_times())
    }
}

/// Best result of all starts.
struct Trained {
    best: Evaluation,
    stop: Stop,
    steps: u64,
    degrees_of_freedom: f64,
}

impl GaussianProcessConfig {
    /// Returns the bounds of the scales; a and b are free. A signal held at zero has the least standard
    /// deviation.
    fn bounds(&self, context: &FitContext<'_>) -> Bounds {
        let least = LEAST_DEVIATION.ln();
        let free = f64::INFINITY;
        let most_signal: f64 = if context.is_at_zero() { LEAST_DEVIATION } else { 10.0 };
        let longest = self.longest_length.max(self.shortest_length);
        Bounds {
            least: Vector5::new(-free, -free, least, self.shortest_length.ln(), least),
            most: Vector5::new(free, free, most_signal.ln(), longest.ln(), 10.0_f64.ln()),
        }
    }

    /// Draws a start: a and b uniform about zero; the logarithms of the signal (0.05 to 0.2 standard
    /// deviations of ln A), the length scale (the whole allowed range) and the noise (0.5 to 2) uniform. The
    /// noise is large and the signal small, so that the process does not follow the data before it is
    /// trained.
    fn start(&self, context: &FitContext<'_>, number: u64) -> Vector5<f64> {
        let mut generator = context.seed(&format!("start {number}")).generator();
        let mut between = |from: f64, to: f64| from + (to - from) * generator.random::<f64>();
        let bounds = self.bounds(context);
        let signal = |drawn: f64| drawn.clamp(bounds.least.z, bounds.most.z);
        Vector5::new(
            between(-self.initial_scale, self.initial_scale),
            between(-self.initial_scale, self.initial_scale),
            signal(between(0.05_f64.ln(), 0.2_f64.ln())),
            between(bounds.least.w, bounds.most.w),
            between(0.5_f64.ln(), 2.0_f64.ln()),
        )
    }

    fn train(
        &self,
        process: &Process,
        context: &FitContext<'_>,
        rate: impl Fn(&Evaluation) -> f64,
    ) -> Result<Trained, FitError> {
        let limit = context.step_limit(self.max_steps);
        let mut best: Option<Evaluation> = None;
        let (mut steps, mut climbed, mut ended) = (0, 0, Ended::Converged);
        for number in 1..=self.starts {
            let start = process.evaluate(self.start(context, number));
            let start = start.ok_or(FitError::NotFinite { loss: f64::NAN })?;
            let phase = format!("start {number} of {}", self.starts);
            let watch = |step: u64, at: &Evaluation| {
                // The start of a later ascent does not count as a step.
                if step > 0 || number == 1 {
                    context.observe(&Step {
                        step: steps + step,
                        planned: limit,
                        phase: phase.clone(),
                        loss: -at.value,
                        decay_rate: rate(at),
                    });
                }
                if context.is_canceled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let (Summit { at, ended: how }, taken) =
                climb(process, &self.bounds(context), start, self.tolerance, limit - steps, watch);
            steps += taken;
            ended = how;
            if best.as_ref().is_none_or(|best| at.value > best.value) {
                best = Some(at);
            }
            if ended != Ended::Converged {
                break;
            }
            climbed += 1;
        }
        let mut best = best.ok_or(FitError::NotFinite { loss: f64::NAN })?;
        if ended == Ended::Converged && steps >= limit {
            ended = Ended::StepsSpent;
        }
        if ended == Ended::Converged {
            // For the last digits of a and b: the second solution removes the rounding error of the first.
            for _ in 0..2 {
                let value = best.value;
                best = process.settle_mean(best).ok_or(FitError::NotFinite { loss: -value })?;
            }
            steps += 1;
            context.observe(&Step {
                step: steps,
                planned: limit,
                phase: "the mean's last digits".to_owned(),
                loss: -best.value,
                decay_rate: rate(&best),
            });
        }
        let stop = self.stop(ended, climbed, steps, &best);
        let degrees_of_freedom = degrees_of_freedom(&process.slope(&best), &self.bounds(context), &best);
        Ok(Trained { best, stop, steps, degrees_of_freedom })
    }

    fn stop(&self, ended: Ended, climbed: u64, steps: u64, best: &Evaluation) -> Stop {
        let starts = self.starts;
        match ended {
            Ended::Converged => Stop {
                reached: Reached::Converged,
                because: format!(
                    "every one of {starts} starts reached a maximum; the best has a log likelihood, prior \
                     included, of {:.3}",
                    best.value
                ),
            },
            Ended::Lost => Stop {
                reached: Reached::Diverged,
                because: format!(
                    "the likelihood has no finite derivatives after {steps} steps; choose a shorter \
                     estimator.longest_length"
                ),
            },
            Ended::StepsSpent => Stop {
                reached: Reached::BudgetSpent,
                because: format!(
                    "the budget of {steps} steps ended after {climbed} of {starts} starts; raise \
                     estimator.max_steps or fit.max_steps"
                ),
            },
            Ended::Interrupted => Stop {
                reached: Reached::Interrupted,
                because: format!("interrupted after {steps} steps, {climbed} of {starts} starts done"),
            },
        }
    }
}

/// Returns the degrees of freedom of the noise's variance by Satterthwaite's rule, 2·σ_n⁴/var(σ_n²) =
/// 1/(2·var(ln σ_n)). The variance comes from the inverse of the likelihood's curvature, so that the interval
/// widens if signal and noise are hard to tell apart. The result is at most the number of peaks minus the
/// effective number of parameters.
///
/// References: Satterthwaite, Biom. Bull. 2 (1946) 110; Giesbrecht, Burns, Biometrics 41 (1985) 477.
fn degrees_of_freedom(slope: &Slope, bounds: &Bounds, at: &Evaluation) -> f64 {
    let held = bounds.held(&at.parameters, &slope.gradient);
    let free = held.map(|held| f64::from(u8::from(!held)));
    let mut curvature = slope.curvature.component_mul(&(free * free.transpose()));
    curvature += Matrix5::from_diagonal(&(Vector5::repeat(1.0) - free));
    // Noise at its lower bound is smaller than stated and has no uncertainty.
    let factor = Cholesky::new(curvature).filter(|_| free.iter().next_back() == Some(&1.0));
    let satterthwaite = factor.map_or(f64::INFINITY, |factor| 0.5 / factor.inverse().m55);
    satterthwaite.min(slope.degrees_of_freedom)
}

/// Projection on a line: the least-squares slope of function values over the times.
struct Projection {
    weights: Vec<f64>,
    /// Sum of squares of the times about their mean.
    squares: f64,
}

impl Projection {
    fn new(times: &[f64]) -> Self {
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        let squares = times.iter().map(|time| (time - mean).powi(2)).sum::<f64>();
        Self { weights: times.iter().map(|time| (time - mean) / squares).collect(), squares }
    }

    fn slope(&self, values: &[f64]) -> f64 {
        self.weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
    }
}

fn describe(
    scaling: &Scaling,
    process: &Process,
    projection: &Projection,
    trained: &Trained,
    query_times: &[f64],
) -> Result<Estimate, FitError> {
    let function = process.fitted(&trained.best);
    let decay_rate = -scaling.rate_per_unit_time(projection.slope(function.as_slice()));
    let fitted: Vec<f64> = function.iter().map(|&z| scaling.log_amplitude(z)).collect();
    if !(decay_rate.is_finite() && fitted.iter().all(|log| log.is_finite())) {
        return Err(FitError::NotFinite { loss: -trained.best.value });
    }
    let [_, slope, log_signal, log_length, log_noise] = trained.best.parameters.into();
    let noise = log_noise.exp();
    let degrees = trained.degrees_of_freedom;
    let std_error = scaling.rate_per_unit_time(noise / projection.squares.sqrt());
    let known = degrees >= 1.0 && trained.stop.reached == Reached::Converged;
    let uncertainty = known.then(|| Uncertainty::students_t(decay_rate, std_error, degrees)).flatten();
    let text = format!(
        "# Gaussian process: ln A = line + signal of the given length scale + noise.\n\
         decay_rate_of_the_mean_per_s = {:?}\nsignal_of_log_amplitude = {:?}\nlength_s = {:?}\n\
         noise_of_log_amplitude = {:?}\ndegrees_of_freedom = {degrees:?}\nlog_likelihood = {:?}\n",
        -scaling.rate_per_unit_time(2.0 * slope),
        scaling.deviation(log_signal.exp()),
        scaling.duration() * log_length.exp(),
        scaling.deviation(noise),
        trained.best.value
    );
    Ok(Estimate {
        decay_rate,
        log_amplitude: fitted.first().copied().unwrap_or(f64::NAN),
        uncertainty,
        stop: trained.stop.clone(),
        steps: trained.steps,
        parameters: trained.best.parameters.len(),
        fitted_log_amplitudes: fitted,
        predictions: query_times
            .iter()
            .map(|&time| {
                let (mean, variance) = process.predict(&trained.best, scaling.unit_time(time));
                let std_error = known.then(|| scaling.deviation(variance.sqrt()));
                Prediction::new(scaling.log_amplitude(mean), std_error)
            })
            .collect(),
        equation: None,
        model: Some(ModelFile { name: "process.toml".to_owned(), bytes: text.into_bytes() }),
    })
}
