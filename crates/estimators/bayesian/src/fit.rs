//! Fit by closed form and by sampling.

use crate::config::{BayesianConfig, Method};
use crate::model::{Conjugate, Model, Prior, Statistics};
use crate::sampler::{LARGEST_R_HAT, Sample, loss_at_start};
use envelope::Envelope;
use estimator::{
    Estimate, Estimator, FitContext, FitError, ModelFile, Prediction, Reached, Scaling, Step, Stop,
    Uncertainty,
};
use nalgebra::Vector3;

/// Fewest peaks for sampling. With fewer, the posterior has no fourth moment, and the Monte-Carlo error of a
/// variance is undefined.
const FEWEST_SAMPLED: usize = 7;

/// Distance of the closed form from the sampler's mean, in Monte-Carlo standard errors, above which they
/// disagree: by chance once in two million fits.
const AT_ODDS: f64 = 5.0;

impl Estimator for BayesianConfig {
    fn fit(&self, envelope: &Envelope, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let scaling = Scaling::of(envelope)?;
        let times = scaling.unit_times(envelope);
        let prior = Prior {
            width: self.prior_width,
            noise_shape: self.prior_noise_shape,
            noise_rate: self.prior_noise_rate,
        };
        let model = Model { prior, statistics: Statistics::new(&times, &scaling.scaled_logs(envelope)) };
        let fit = Fit { config: self, envelope, scaling, times, model };
        match self.method {
            Method::Conjugate => fit.in_closed_form(context),
            Method::Nuts => fit.by_sampling(context),
        }
    }
}

/// Fit in progress.
struct Fit<'a> {
    config: &'a BayesianConfig,
    envelope: &'a Envelope,
    scaling: Scaling,
    times: Vec<f64>,
    model: Model,
}

/// Result of either method, in scaled units except for the interval.
struct Found {
    start: f64,
    rate: f64,
    scatter: f64,
    uncertainty: Option<Uncertainty>,
    /// Query times τ, with the predictive standard deviation at each.
    asked: Vec<(f64, Option<f64>)>,
    stop: Stop,
    steps: u64,
    /// Further lines of the posterior's file.
    remarks: String,
}

impl Fit<'_> {
    fn in_closed_form(&self, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let posterior = self.model.conjugate();
        let Conjugate { start, rate, rate_scale, degrees_of_freedom, scatter, .. } = posterior;
        let uncertainty = Uncertainty::students_t(
            self.scaling.rate_per_unit_time(rate),
            self.scaling.rate_per_unit_time(rate_scale),
            degrees_of_freedom,
        );
        let remarks = format!(
            "decay_rate_law = \"Student's t about decay_rate_per_s with scale std_error_per_s\"\n\
             degrees_of_freedom = {degrees_of_freedom:?}\n"
        );
        let stop = Stop { reached: Reached::Converged, because: self.check(&posterior, context) };
        let asked = self.asked(context, |time| posterior.predictive_deviation(time));
        self.describe(Found { start, rate, scatter, uncertainty, asked, stop, steps: 0, remarks })
    }

    /// Checks the closed form by sampling; returns the result as a sentence.
    fn check(&self, posterior: &Conjugate, context: &FitContext<'_>) -> String {
        if !self.config.check_by_sampling {
            return "the posterior is known in closed form; not checked by sampling".to_owned();
        }
        if self.envelope.len() < FEWEST_SAMPLED {
            return format!(
                "the posterior is known in closed form; sampling to check it takes {FEWEST_SAMPLED} peaks"
            );
        }
        let sample = Sample::draw(self.config, &self.model, context, |_, _, _| {});
        if sample.interrupted {
            return "the posterior is known in closed form; the sampler that checks it was interrupted"
                .to_owned();
        }
        if !sample.converged(self.config) {
            return format!(
                "the posterior is known in closed form; the sampler did not get far enough to check it: {}",
                self.shortfall(&sample)
            );
        }
        let sampled = sample.plain_mean(&Vector3::y());
        let off = (sampled.value - posterior.rate).abs() / sampled.error;
        let verdict = if off < AT_ODDS { "agrees" } else { "DISAGREES (please report it)" };
        format!(
            "the posterior is known in closed form, and the sampler {verdict}: its mean is {off:.1} \
             Monte-Carlo standard errors away, {}",
            sample.in_words()
        )
    }

    fn by_sampling(&self, context: &FitContext<'_>) -> Result<Estimate, FitError> {
        let config = self.config;
        if self.envelope.len() < FEWEST_SAMPLED {
            return Err(FitError::TooFewPeaks {
                estimator: "bayesian",
                found: self.envelope.len(),
                needed: FEWEST_SAMPLED,
            });
        }
        let loss = loss_at_start(config, &self.model, context);
        if !loss.is_finite() {
            return Err(FitError::NotFinite { loss });
        }
        let planned = context.step_limit(config.warm_up.saturating_add(config.draws));
        let sample = Sample::draw(config, &self.model, context, |step, loss, rate| {
            let phase = if step <= config.warm_up { "warm-up" } else { "draws" };
            context.observe(&Step {
                step,
                planned,
                phase: phase.to_owned(),
                loss,
                decay_rate: self.scaling.rate_per_unit_time(rate),
            });
        });
        let [start, rate, log_sigma] =
            [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| sample.mean(&axis));
        let converged = sample.converged(config);
        let uncertainty = (!sample.is_empty() && sample.steps > config.warm_up + 1).then(|| {
            let (deviation, [low, high]) = sample.spread(&Vector3::y());
            Uncertainty {
                std_error: self.scaling.rate_per_unit_time(deviation),
                interval_95: [self.scaling.rate_per_unit_time(low), self.scaling.rate_per_unit_time(high)],
            }
        });
        let error = self.scaling.rate_per_unit_time(rate.error);
        let stop = match (sample.interrupted, converged) {
            (true, _) => Stop {
                reached: Reached::Interrupted,
                because: format!("interrupted after {} transitions of each chain", sample.steps),
            },
            (false, true) => Stop {
                reached: Reached::Converged,
                because: format!(
                    "the chains agree: {}; Monte-Carlo error of the decay rate {error:.0e} 1/s",
                    sample.in_words()
                ),
            },
            (false, false) => Stop { reached: Reached::BudgetSpent, because: self.shortfall(&sample) },
        };
        let remarks = format!(
            "decay_rate_law = \"{} draws of the no-U-turn sampler\"\n\
             r_hat = {:?}\neffective_draws_bulk = {:?}\neffective_draws_tail = {:?}\n",
            config.chains as u64 * sample.steps.saturating_sub(config.warm_up),
            sample.diagnostics.r_hat,
            sample.diagnostics.bulk,
            sample.diagnostics.tail,
        );
        let (start, rate, scatter) = (start.value, rate.value, log_sigma.value.exp());
        let known = uncertainty.is_some();
        let asked = self.asked(context, |time| known.then(|| sample.predictive_deviation(time)));
        let steps = sample.steps;
        self.describe(Found { start, rate, scatter, uncertainty, asked, stop, steps, remarks })
    }

    /// Returns the query times τ, with the predictive standard deviation at each.
    fn asked(
        &self,
        context: &FitContext<'_>,
        deviation: impl Fn(f64) -> Option<f64>,
    ) -> Vec<(f64, Option<f64>)> {
        let times = context.query_times().iter().map(|&time| self.scaling.unit_time(time));
        times.map(|time| (time, deviation(time))).collect()
    }

    /// Returns the reason why a sample is insufficient, with advice.
    fn shortfall(&self, sample: &Sample) -> String {
        if sample.is_empty() {
            return format!(
                "{} transitions of each chain end within the warm-up of {}; raise fit.max_steps",
                sample.steps, self.config.warm_up
            );
        }
        format!(
            "{}, {} runaway trajectories after {} transitions of each chain; required are an R-hat below \
             {LARGEST_R_HAT}, at least {:.0} effective draws and no runaway trajectory: raise \
             estimator.draws, estimator.warm_up or estimator.target_acceptance",
            sample.in_words(),
            sample.divergences,
            sample.steps,
            self.config.least_effective_draws
        )
    }

    fn describe(&self, found: Found) -> Result<Estimate, FitError> {
        let decay_rate = self.scaling.rate_per_unit_time(found.rate);
        let at = |time: f64| self.scaling.log_amplitude(found.start - found.rate * time);
        let fitted: Vec<f64> = self.times.iter().map(|&time| at(time)).collect();
        if !(decay_rate.is_finite() && fitted.iter().all(|log| log.is_finite())) {
            return Err(FitError::NotFinite { loss: found.rate });
        }
        let log_amplitude = self.scaling.log_amplitude(found.start);
        let mut text = format!(
            "# Posterior of the line ln A = log_amplitude - decay_rate * t with Gaussian scatter.\n\
             decay_rate_per_s = {decay_rate:?}\nlog_amplitude = {log_amplitude:?}\n\
             scatter_of_log_amplitude = {:?}\n\
             damping_ratio = {:?}\n",
            self.scaling.deviation(found.scatter),
            self.envelope.damping_ratio(decay_rate)
        );
        if let Some(Uncertainty { std_error, interval_95: [low, high] }) = found.uncertainty {
            let zeta = |rate| self.envelope.damping_ratio(rate);
            text.push_str(&format!(
                "std_error_per_s = {std_error:?}\ndecay_rate_interval_95_per_s = [{low:?}, {high:?}]\n\
                 damping_ratio_interval_95 = [{:?}, {:?}]\n",
                zeta(low),
                zeta(high)
            ));
        }
        text.push_str(&found.remarks);
        Ok(Estimate {
            decay_rate,
            log_amplitude,
            uncertainty: found.uncertainty,
            stop: found.stop,
            steps: found.steps,
            parameters: 3,
            fitted_log_amplitudes: fitted,
            predictions: found
                .asked
                .iter()
                .map(|&(time, deviation)| {
                    let deviation = deviation.map(|scaled| self.scaling.deviation(scaled));
                    Prediction::new(at(time), deviation)
                })
                .collect(),
            equation: None,
            model: Some(ModelFile { name: "posterior.toml".to_owned(), bytes: text.into_bytes() }),
        })
    }
}
