//! The problems of a study, read or drawn.

use crate::error::TrainerError;
use crate::predict::split::{Split, SplitKind, splits};
use envelope::Envelope;
use experiment::{
    DataSettings, Law, Pipeline, PredictionStudy, Problem, ProblemSource, ScatterKind, SimulatedProblem,
};
use oracle::DecayFit;
use record::{Clock, ClockChoice, read_file};
use runs::result::{DataSummary, LawSummary};
use seed::Seed;
use simulator::{DecayLaw, EnvelopeSimulation, Scatter};
use std::path::Path;
use workflow::summarize;

/// A problem that is ready to be studied.
pub(crate) struct Ready {
    pub(crate) id: String,
    pub(crate) title: String,
    pub(crate) origin: String,
    pub(crate) unit: String,
    pub(crate) data: Option<DataSummary>,
    pub(crate) truth: Option<Truth>,
    /// The draws of a simulation, or the one envelope of a record.
    pub(crate) envelopes: Vec<Envelope>,
    pub(crate) splits: Vec<Split>,
}

/// What is known of a simulated problem and shown to no method.
pub(crate) struct Truth {
    /// Noise-free ln A of every peak.
    pub(crate) log_amplitudes: Vec<f64>,
    pub(crate) law: LawSummary,
    /// For each split, minus the least-squares slope of the noise-free ln A over the peaks seen, in 1/s.
    pub(crate) projected_slopes: Vec<f64>,
}

/// A problem whose record is not there.
pub(crate) struct Missing {
    pub(crate) id: String,
    pub(crate) title: String,
    pub(crate) origin: String,
    pub(crate) reason: String,
}

/// Reads or draws a problem. A record that is absent is no error; one that cannot be used is.
pub(crate) fn prepare(
    study: &PredictionStudy,
    problem: &Problem,
) -> Result<Result<Ready, Missing>, TrainerError> {
    match &problem.source {
        ProblemSource::Simulated(simulated) => draw(study, problem, simulated).map(Ok),
        ProblemSource::Record { data, pipeline } if Path::new(&data.path).exists() => {
            read(study, problem, data, *pipeline).map(Ok)
        }
        ProblemSource::Record { data, .. } => Ok(Err(Missing {
            id: problem.id.clone(),
            title: problem.title.clone(),
            origin: data.statements().origin.unwrap_or_default().name().to_owned(),
            reason: missing(&problem.id, data),
        })),
    }
}

/// Why a record's row is left out, and what puts it in.
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
) -> Result<Ready, TrainerError> {
    let (record, source) = read_file(Path::new(&data.path), &data.read_options())?;
    let clock_of = |choice| Clock::new(&record, choice).map_err(|fault| fault.in_file(&source.path));
    let (clock, believed) = (clock_of(data.clock)?, clock_of(ClockChoice::Auto)?);
    let extraction = study
        .envelope
        .extract(pipeline, &record, &clock)
        .map_err(|error| TrainerError::Envelope { file: data.path.clone(), source: error })?;
    let summary = summarize(&record, &source, &clock, &believed, data.statements());
    Ok(Ready {
        id: problem.id.clone(),
        title: problem.title.clone(),
        origin: summary.origin.clone(),
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
) -> Result<Ready, TrainerError> {
    let refuse = |source| TrainerError::Simulation { problem: problem.id.clone(), source };
    let simulation = simulation(simulated);
    let truth = simulation.truth().map_err(refuse)?;
    let seed = Seed::new(study.seed).child("simulated problems").child(&problem.id);
    let envelopes = (0..study.settings.draws)
        .map(|number| truth.draw(&seed.child(&number.to_string())))
        .collect::<Result<Vec<_>, _>>()
        .map_err(refuse)?;
    let splits = splits(&problem.id, simulated.peaks, &study.settings)?;
    let log_amplitudes = truth.log_amplitudes();
    let slope = |times: Vec<f64>, logs: Vec<f64>| -> Result<f64, TrainerError> {
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
        origin: "simulated".to_owned(),
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

/// The best exponential through an envelope.
pub(crate) fn line(problem: &str, envelope: &Envelope) -> Result<DecayFit, TrainerError> {
    oracle::decay_rate(envelope)
        .map_err(|source| TrainerError::Oracle { file: format!("problem.{problem}"), source })
}

impl Ready {
    /// The splits that a draw is fitted on: every one of a record; of a simulation one fold of
    /// interpolation, the next one for the next draw, and extrapolation.
    pub(crate) fn splits_of(&self, draw: usize) -> impl Iterator<Item = usize> + '_ {
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
