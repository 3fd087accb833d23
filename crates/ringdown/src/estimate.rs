//! Estimates of the damping ratio.

use crate::error::Error;
use crate::record::Record;
use envelope::Extraction;
use estimator::{Cancel, Estimator, FitContext, Reached, Silent};
use experiment::{Experiment, Pipeline, Single, Task, resolve};
use oracle::DecayFit;
use oracle::classical::CLASSICAL;
use registry::ESTIMATORS;
use seed::Seed;
use settings::Document;
use workflow::estimate::{of_line, scaled};

/// Options of an estimate, with the defaults of the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateOptions {
    /// Pipeline from the record to its peaks; by default chosen by the record.
    pub pipeline: Pipeline,
    /// Root seed of all random draws.
    pub seed: u64,
    /// Limit on the training steps; `None` for the method's own limit, 0 for the untrained estimate.
    pub max_steps: Option<u64>,
    /// Settings of the method as lines of TOML, such as `hidden = [16]`. `trainer explain estimator` lists
    /// them.
    pub settings: String,
}

impl Default for EstimateOptions {
    fn default() -> Self {
        Self { pipeline: Pipeline::Auto, seed: 0, max_steps: None, settings: String::new() }
    }
}

/// A method that estimates a decay rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Method {
    /// Name in configurations, such as `pinn`.
    pub id: &'static str,
    /// Name in words.
    pub title: &'static str,
    /// Description in a sentence.
    pub summary: &'static str,
}

/// Returns all methods: the paper's classical ones, then the learned ones.
///
/// ```
/// assert!(ringdown_lab::methods().any(|method| method.id == "gaussian-process"));
/// ```
pub fn methods() -> impl Iterator<Item = Method> {
    let classical = CLASSICAL.iter().map(|own| Method { id: own.id, title: own.title, summary: own.summary });
    let learned = ESTIMATORS.iter().map(|own| Method { id: own.id, title: own.title, summary: own.summary });
    classical.chain(learned)
}

/// Estimated damping of a free decay, with least squares on the same peaks.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Damping ratio ζ = λ/√(λ² + ω²), or λ/ω in the paper's pipeline.
    pub damping_ratio: f64,
    /// Standard error of ζ for the scatter of the residuals on this record, if the method states one.
    pub damping_ratio_std_error: Option<f64>,
    /// Decay rate λ of the amplitude, in 1/s.
    pub decay_rate: f64,
    /// 95 % interval of λ, in 1/s, if the method states one.
    pub decay_rate_interval_95: Option<[f64; 2]>,
    /// Angular frequency ω = 2π/(median period), in rad/s.
    pub omega_rad_s: f64,
    /// Number of peaks.
    pub peaks: usize,
    /// ζ by closed-form least squares on the same peaks.
    pub least_squares: f64,
    /// Relative difference of ζ from least squares, in percent: a measure of the numerical solution, not of
    /// its truth.
    pub error_percent: f64,
    /// State in which the fit ended.
    pub reached: Reached,
    /// Reason why the fit stopped, as a sentence; without convergence it includes advice.
    pub because: String,
    /// Number of training steps taken.
    pub steps: u64,
    /// Law that the method discovered, if it discovers laws.
    pub equation: Option<String>,
}

/// Estimates the damping ratio of a free decay with a method of the registry.
///
/// # Errors
/// [`Error::Config`] for an unknown method or setting, [`Error::Envelope`] for a record without enough peaks,
/// [`Error::Fit`] if the method gives no estimate.
///
/// ```
/// use ringdown_lab::{EstimateOptions, Nominal, Simulation, estimate};
///
/// let record = Simulation::of(&Nominal::swinging(2.0, 0.01)?).noise(1e-4).run()?;
/// let found = estimate(&record, "sindy", &EstimateOptions::default())?;
/// assert!((found.damping_ratio - 0.01).abs() < 1e-4);
/// assert_eq!(found.reached, ringdown_lab::Reached::Converged);
/// # Ok::<(), ringdown_lab::Error>(())
/// ```
pub fn estimate(record: &Record, method: &str, options: &EstimateOptions) -> Result<Estimate, Error> {
    estimate_until(record, method, options, &Cancel::new())
}

/// Estimates like [`estimate`], with a way to stop. A request to stop ends the fit after its current step
/// with the best estimate so far; [`Estimate::reached`] is then [`Reached::Interrupted`].
///
/// # Errors
/// As [`estimate`].
pub fn estimate_until(
    record: &Record,
    method: &str,
    options: &EstimateOptions,
    cancel: &Cancel,
) -> Result<Estimate, Error> {
    let experiment = experiment(method, options)?;
    let prepared = Prepared::new(record, &experiment)?;
    match &experiment.task {
        Task::Estimate(Single::Learned { entry, estimator }) => {
            prepared.learned(entry.id, estimator.as_ref(), options, cancel)
        }
        Task::Estimate(Single::Classical(id)) => prepared.classical(id, options),
        Task::Compare(_) => Err(Error::Config("expected one method".to_owned())),
    }
}

/// Estimates the damping ratio of a free decay with a custom estimator; messages refer to it as `name`.
///
/// # Errors
/// As [`estimate`].
pub fn estimate_with(
    record: &Record,
    name: &str,
    estimator: &dyn Estimator,
    options: &EstimateOptions,
) -> Result<Estimate, Error> {
    Prepared::new(record, &experiment("ols", &EstimateOptions { max_steps: None, ..options.clone() })?)?
        .learned(name, estimator, options, &Cancel::new())
}

/// Extracts the peaks of a record.
///
/// # Errors
/// As [`estimate`].
///
/// ```
/// use ringdown_lab::{EstimateOptions, Nominal, Simulation, peaks};
///
/// let record = Simulation::of(&Nominal::swinging(2.0, 0.01)?).sampled(200.0, 10.0).run()?;
/// let found = peaks(&record, &EstimateOptions::default())?;
/// // Both half cycles count: four peaks a second, but for those at the ends.
/// assert!((38..=41).contains(&found.envelope.len()));
/// # Ok::<(), ringdown_lab::Error>(())
/// ```
pub fn peaks(record: &Record, options: &EstimateOptions) -> Result<Extraction, Error> {
    Ok(Prepared::new(record, &experiment("ols", &EstimateOptions { max_steps: None, ..options.clone() })?)?
        .extraction)
}

/// Returns the configuration that the command line would run.
fn experiment(method: &str, options: &EstimateOptions) -> Result<Experiment, Error> {
    let text = |value: &str| toml::Value::String(value.to_owned()).to_string();
    let cap = options.max_steps.map_or_else(String::new, |cap| format!("max_steps = {cap}\n"));
    let configuration = format!(
        "[envelope]\npipeline = {}\n[fit]\n{cap}[estimator]\nname = {}\n{}\n",
        text(options.pipeline.name()),
        text(method),
        options.settings,
    );
    let document = Document::parse("options", &configuration)?;
    let classical: Vec<&str> = CLASSICAL.iter().map(|own| own.id).collect();
    Ok(resolve(&document, ESTIMATORS, &classical)?)
}

/// Envelope of a record, and least squares on it.
struct Prepared {
    extraction: Extraction,
    reference: DecayFit,
}

impl Prepared {
    fn new(record: &Record, experiment: &Experiment) -> Result<Self, Error> {
        let name = || record.name().to_owned();
        let settings = &experiment.envelope;
        let extraction = settings
            .extract(settings.pipeline, &record.loaded.record, &record.clock()?)
            .map_err(|source| Error::Envelope { record: name(), source })?;
        let reference = oracle::decay_rate(&extraction.envelope)
            .map_err(|source| Error::LeastSquares { record: name(), source })?;
        Ok(Self { extraction, reference })
    }

    fn learned(
        &self,
        name: &str,
        estimator: &dyn Estimator,
        options: &EstimateOptions,
        cancel: &Cancel,
    ) -> Result<Estimate, Error> {
        let seed = Seed::new(options.seed).child(name);
        let context = FitContext::new(seed, options.max_steps, &Silent, cancel);
        let fit = estimator.fit(&self.extraction.envelope, &context).map_err(|source| Error::Fit {
            method: name.to_owned(),
            seed: options.seed,
            source,
        })?;
        self.estimate(name, fit, options.seed)
    }

    fn classical(&self, id: &str, options: &EstimateOptions) -> Result<Estimate, Error> {
        let route = CLASSICAL
            .iter()
            .find(|own| own.id == id)
            .ok_or_else(|| Error::Config(format!("`{id}` is no method")))?;
        let envelope = &self.extraction.envelope;
        let fit = (route.fit)(envelope, &Seed::new(options.seed).child(id))
            .map_err(|source| Error::LeastSquares { record: id.to_owned(), source })?;
        self.estimate(id, of_line(envelope, fit, &[]), options.seed)
    }

    /// Creates an estimate from a method's. The stated error assumes equal scatter of the peaks and is rescaled to the
    /// scatter of this record.
    fn estimate(&self, method: &str, found: estimator::Estimate, seed: u64) -> Result<Estimate, Error> {
        let rate = found.decay_rate;
        if !rate.is_finite() {
            return Err(Error::NotFinite { method: method.to_owned(), seed });
        }
        let envelope = &self.extraction.envelope;
        let stated = scaled(&self.reference, found.uncertainty, rate);
        let damping_ratio = envelope.damping_ratio(rate);
        Ok(Estimate {
            damping_ratio,
            damping_ratio_std_error: stated.map(|own| envelope.damping_ratio_error(rate, own.std_error)),
            decay_rate: rate,
            decay_rate_interval_95: stated.map(|own| own.interval_95),
            omega_rad_s: envelope.omega_rad_s(),
            peaks: envelope.len(),
            least_squares: self.reference.zeta,
            error_percent: scoring::error_percent(damping_ratio, self.reference.zeta),
            reached: found.stop.reached,
            because: found.stop.because,
            steps: found.steps,
            equation: found.equation,
        })
    }
}
