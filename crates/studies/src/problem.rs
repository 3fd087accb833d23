//! Problems of a study, read from records or simulated.

use crate::error::StudyError;

use crate::split::{Split, splits};
use envelope::Envelope;
use experiment::{
    DataSettings, Law, Pipeline, PredictionStudy, Problem, ProblemSource, ScatterKind, SimulatedProblem,
};
use oracle::DecayFit;
use record::{Clock, ClockChoice, Origin, read_file};
use results::{DataSummary, LawSummary, SplitKind};
use seed::Seed;
use simulator::{DecayLaw, EnvelopeSimulation, Scatter};
use std::path::Path;

/// Problem that is ready to be studied.
pub struct Ready {
    /// Name in the configuration.
    pub id: String,
    /// Title in tables.
    pub title: String,
    /// Origin of the numbers.
    pub origin: Origin,
    /// Unit of the amplitudes.
    pub unit: String,
    /// Summary of the record; `None` for a simulation.
    pub data: Option<DataSummary>,
    /// Truth of a simulation; `None` for a record.
    pub truth: Option<Truth>,
    /// Envelopes: the draws of a simulation, or the single envelope of a record.
    pub envelopes: Vec<Envelope>,
    /// All splits into fitted and held-out peaks.
    pub splits: Vec<Split>,
}

/// Truth of a simulated problem, which no method sees.
pub struct Truth {
    /// Noise-free ln A of every peak.
    pub log_amplitudes: Vec<f64>,
    /// Law of the decay.
    pub law: LawSummary,
    /// For each split, minus the least-squares slope of the noise-free ln A over the fitted peaks, in 1/s.
    pub projected_slopes: Vec<f64>,
}

/// Problem whose record file is missing.
pub struct Missing {
    /// Name in the configuration.
    pub id: String,
    /// Title in tables.
    pub title: String,
    /// Origin that the configuration states.
    pub origin: Origin,
    /// Sentence that names the file and its source.
    pub reason: String,
}

/// Reads or simulates a problem. A missing record is not an error; an unusable record is.
///
/// # Errors
/// [`StudyError`] with the problem or the file at fault.
pub fn prepare(study: &PredictionStudy, problem: &Problem) -> Result<Result<Ready, Missing>, StudyError> {
    match &problem.source {
        ProblemSource::Simulated(simulated) => draw(study, problem, simulated).map(Ok),
        ProblemSource::Record { data, pipeline } if Path::new(&data.path).exists() => {
            read(study, problem, data, *pipeline).map(Ok)
        }
        ProblemSource::Record { data, .. } => Ok(Err(Missing {
            id: problem.id.clone(),
            title: problem.title.clone(),
            origin: data.statements().origin.unwrap_or(Origin::Unstated),
            reason: missing(&problem.id, data),
        })),
    }
}

/// Explains why a record's row is missing, and how to add it.
fn missing(id: &str, data: &DataSettings) -> String {
    let path = &data.path;
    match &data.source {
        Some(source) => format!(
            "the record {path} is not there; its row is left out. Get it from {source}, and name it with \
             problem.{id}.path=FILE"
        ),
        None => format!("the record {path} is not there; its row is left out"),
    }
}

fn read(
    study: &PredictionStudy,
    problem: &Problem,
    data: &DataSettings,
    pipeline: Pipeline,
) -> Result<Ready, StudyError> {
    let (record, source) = read_file(Path::new(&data.path), &data.read_options())?;
    let clock_of = |choice| Clock::new(&record, choice).map_err(|fault| fault.in_file(&source.path));
    let (clock, believed) = (clock_of(data.clock)?, clock_of(ClockChoice::Auto)?);
    let extraction = study
        .envelope
        .extract(pipeline, &record, &clock)
        .map_err(|error| StudyError::Envelope { file: data.path.clone(), source: error })?;
    let summary = DataSummary::new(&record, &source, &clock, &believed, data.statements());
    Ok(Ready {
        id: problem.id.clone(),
        title: problem.title.clone(),
        origin: summary.origin,
        unit: summary.unit.clone(),
        data: Some(summary),
        truth: None,
        splits: splits(&problem.id, extraction.envelope.len(), &study.settings)?,
        envelopes: vec![extraction.envelope],
    })
}

fn draw(
    study: &PredictionStudy,
    problem: &Problem,
    simulated: &SimulatedProblem,
) -> Result<Ready, StudyError> {
    let refuse = |source| StudyError::Simulation { problem: problem.id.clone(), source };
    let simulation = simulation(simulated);
    let truth = simulation.truth().map_err(refuse)?;
    let seed = Seed::new(study.seed).child("simulated problems").child(&problem.id);
    let envelopes = (0..study.settings.draws)
        .map(|number| truth.draw(&seed.child(&number.to_string())))
        .collect::<Result<Vec<_>, _>>()
        .map_err(refuse)?;
    let splits = splits(&problem.id, simulated.peaks, &study.settings)?;
    let log_amplitudes = truth.log_amplitudes();
    let slope = |times: Vec<f64>, logs: Vec<f64>| -> Result<f64, StudyError> {
        let envelope = Envelope::new(times, logs, 1.0).map_err(|error| refuse(error.into()))?;
        Ok(line(&problem.id, &envelope)?.decay_rate)
    };
    let projected_slopes = splits
        .iter()
        .map(|split| slope(split.seen_of(truth.times_s()), split.seen_of(&log_amplitudes)))
        .collect::<Result<_, _>>()?;
    let whole = slope(truth.times_s().to_vec(), log_amplitudes.clone())?;
    let draws = [study.settings.draws, study.settings.draws_seeded.min(study.settings.draws)];
    Ok(Ready {
        id: problem.id.clone(),
        title: problem.title.clone(),
        origin: Origin::Simulated,
        unit: "rad".to_owned(),
        data: None,
        truth: Some(Truth {
            law: law(simulated, &simulation, whole, draws),
            log_amplitudes,
            projected_slopes,
        }),
        envelopes,
        splits,
    })
}

fn simulation(problem: &SimulatedProblem) -> EnvelopeSimulation {
    let decay_rate = problem.decay_rate;
    EnvelopeSimulation {
        law: match problem.kind {
            Law::Exponential => DecayLaw::Exponential { decay_rate },
            Law::CoulombViscous => DecayLaw::CoulombViscous { decay_rate, dead_zone: problem.dead_zone },
            Law::ViscousQuadratic => {
                DecayLaw::ViscousQuadratic { decay_rate, quadratic_rate: problem.quadratic_rate }
            }
        },
        initial_amplitude: problem.amplitude,
        period_s: problem.period_s,
        peaks: problem.peaks,
        scatter: match problem.scatter {
            ScatterKind::Amplitude => Scatter::Amplitude(problem.scatter_size),
            ScatterKind::Logarithm => Scatter::Logarithm(problem.scatter_size),
        },
    }
}

fn law(
    problem: &SimulatedProblem,
    simulation: &EnvelopeSimulation,
    projected_slope: f64,
    draws: [usize; 2],
) -> LawSummary {
    let mut parameters = vec![
        format!("A₀ = {} rad", problem.amplitude),
        format!("T = {} s", problem.period_s),
        format!("λ = {} 1/s", problem.decay_rate),
    ];
    let mut exactness = simulation.law.exactness().to_owned();
    match simulation.law {
        DecayLaw::Exponential { .. } => {}
        DecayLaw::CoulombViscous { dead_zone, .. } => parameters.push(format!("x_c = {dead_zone} rad")),
        DecayLaw::ViscousQuadratic { quadratic_rate, .. } => {
            parameters.push(format!("q = {quadratic_rate} 1/(s rad)"));
        }
    }
    if let Some(error) = simulation.law.averaging_error(problem.amplitude, problem.period_s) {
        exactness.push_str(&format!(", which is {error:.1e}"));
    }
    LawSummary {
        equation: simulation.law.equation().to_owned(),
        parameters: parameters.join(", "),
        exactness,
        viscous_rate: simulation.law.viscous_rate(),
        projected_slope,
        scatter: match simulation.scatter {
            Scatter::Amplitude(size) => {
                format!("Gaussian, {size} rad on the amplitude, so that ln A scatters more as A falls")
            }
            Scatter::Logarithm(size) => format!("Gaussian, {size} on ln A"),
        },
        draws,
    }
}

/// Fits the best exponential to an envelope.
///
/// # Errors
/// [`StudyError::Oracle`] if no line can be fitted.
pub(crate) fn line(problem: &str, envelope: &Envelope) -> Result<DecayFit, StudyError> {
    oracle::decay_rate(envelope).map_err(|source| StudyError::Oracle { problem: problem.to_owned(), source })
}

impl Ready {
    /// Returns the indices of the splits on which a draw is fitted. For a record these are all splits. For a
    /// simulation they are extrapolation and one fold of interpolation, a different fold for each successive
    /// draw.
    pub fn splits_of(&self, draw: usize) -> impl Iterator<Item = usize> + '_ {
        let folds = self.splits.iter().filter(|split| split.kind == SplitKind::Interpolation).count();
        let is_record = self.truth.is_none();
        self.splits
            .iter()
            .enumerate()
            .filter(move |(index, split)| {
                is_record || split.kind == SplitKind::Extrapolation || *index == draw % folds
            })
            .map(|(index, _)| index)
    }
}
