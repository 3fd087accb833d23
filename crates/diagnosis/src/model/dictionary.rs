//! What every candidate would add to the observed values, to first order, at a fit.

use crate::data::scales::Scales;
use crate::data::segments::Data;
use crate::fit::levenberg_marquardt::{Fit, solve};
use crate::model::candidate::{Candidate, Distortion};
use crate::model::contact::bent;
use crate::model::matrices::{element, entry};
use crate::model::projection::Projection;
use crate::model::tangent::{Path, matrix, plain_moment, stack};
use crate::noise::spectrum::{decaying_lines, frequencies, lines};
use crate::search::second_mode::{SecondMode, driven_modes};
use dynamics::{Coefficients, DynamicsError, MOST_PARAMETERS, SystemEffect};
use nalgebra::{DMatrix, DVector};
use record::Quantity;
use std::ops::Range;

/// A candidate at one shape: columns whose coefficients are its linear parameters.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) candidate: Candidate,
    /// Parameters that the columns are computed at, as the fit moves them.
    shape: Vec<f64>,
    pub(crate) columns: Range<usize>,
    /// Whether the coefficients cannot be negative.
    positive: bool,
}

/// All entries at a fit, projected on what the fit may not move.
#[derive(Debug, Clone)]
pub(crate) struct Dictionary {
    pub(crate) entries: Vec<Entry>,
    /// Projected columns.
    pub(crate) columns: DMatrix<f64>,
    /// Products of the columns with one another.
    pub(crate) products: DMatrix<f64>,
    /// Products of the columns with the projected residual.
    pub(crate) scores: DVector<f64>,
    /// Candidates that no columns stand for, with parameters to begin at and about what they would take away.
    pub(crate) further: Vec<(Candidate, Vec<f64>, f64)>,
    /// How many frequencies the lines of the residual were chosen from.
    pub(crate) frequencies: f64,
}

/// Part of a column's length that has to be left after the projection: what calibration and start states imitate to so
/// many digits cannot be seen in these records, and what is left of it is the linearization's error.
pub(crate) const INVISIBLE: f64 = 1e-4;

/// What a set of entries would take away.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gain {
    pub(crate) entries: Vec<usize>,
    /// Decrease of the squares.
    pub(crate) squares: f64,
    /// Coefficients of the entries' columns, in order.
    pub(crate) coefficients: Vec<f64>,
}

/// Shapes relative to the motion's scales.
const STRIBECK: [f64; 3] = [0.02, 0.06, 0.2];
const PLAY: [f64; 5] = [0.003, 0.01, 0.03, 0.1, 0.3];
const BENDING: [f64; 5] = [0.005, 0.02, 0.06, 0.2, 0.6];
const STOPS: [f64; 5] = [0.004, 0.015, 0.05, 0.12, 0.25];
const CLIPS: [f64; 6] = [0.998, 0.993, 0.98, 0.93, 0.85, 0.7];
const LIMITS: [f64; 4] = [0.95, 0.85, 0.7, 0.5];
const DELAYS: [f64; 2] = [0.01, 0.1];
const LINES: usize = 3;
/// A second body to begin with: how many lines, by how much of a radian it puts the swing out of phase over a
/// segment, its part of the inertia at most.
const SECOND_MODES: usize = 3;
const OUT_OF_PHASE: f64 = 0.1;
const FIRST_BODY: f64 = 0.02;

/// A second body's part of the inertia to begin with: it lowers the swing's frequency by half its part, and
/// over a long segment a body that is not yet where it belongs would lose count of the swings.
fn second_body(data: &Data) -> f64 {
    let phase = data.facts.frequency * data.longest_span();
    (2.0 * OUT_OF_PHASE / phase.max(1.0)).min(FIRST_BODY)
}

/// The shapes that a candidate is tried at, as parameters of the fit with unit coefficients.
pub(crate) fn shapes(candidate: Candidate, facts: &Scales) -> Vec<Vec<f64>> {
    let grid = |scale: f64, parts: &[f64]| -> Vec<f64> { parts.iter().map(|part| part * scale).collect() };
    let of = |values: Vec<f64>, make: &dyn Fn(f64) -> Vec<f64>| values.into_iter().map(make).collect();
    match candidate {
        Candidate::System(effect) => match effect {
            SystemEffect::StribeckFriction => of(grid(facts.speed, &STRIBECK), &|v| vec![1.0, 1.0, v]),
            SystemEffect::Gravity => vec![vec![1.0, 0.0]],
            SystemEffect::Backlash => of(grid(facts.amplitude, &PLAY), &|b| vec![b]),
            SystemEffect::Hysteresis => of(grid(facts.amplitude, &BENDING), &|d| vec![1.0, d]),
            SystemEffect::EndStop => {
                let span = facts.highest - facts.lowest;
                let upper = STOPS.iter().map(|part| facts.highest - part * span);
                let lower = STOPS.iter().map(|part| facts.lowest + part * span);
                upper.chain(lower).map(|angle| vec![angle, 1.0, 0.0]).collect()
            }
            SystemEffect::InputDelay => of(grid(1.0 / facts.frequency, &DELAYS), &|d| vec![d]),
            SystemEffect::InputSaturation => of(grid(facts.input_torque, &LIMITS), &|t| vec![t]),
            // Their frequencies come from the residual.
            SystemEffect::PeriodicForcing | SystemEffect::FlexibleCoupling => Vec::new(),
            _ => vec![vec![1.0]],
        },
        Candidate::Chain(Distortion::Saturation) => of(grid(facts.reading, &CLIPS), &|bound| vec![bound]),
        Candidate::Chain(Distortion::Nonlinearity) => vec![vec![1.0, 0.0]],
        Candidate::Chain(_) => vec![vec![1.0]],
    }
}

/// The columns of a candidate at a shape, on one path.
fn columns(
    candidate: Candidate,
    shape: &[f64],
    path: &Path,
    data: &Data,
    nominal: &Coefficients<f64>,
) -> Vec<Vec<f64>> {
    let (x, rate, _) = path.observed(data.quantity);
    let torque = |values: &[f64]| law(candidate, values, path, nominal);
    let respond = |torques: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        torques.iter().map(|torque| path.response(torque, data.quantity)).collect()
    };
    match (candidate, shape) {
        (Candidate::System(SystemEffect::StribeckFriction), &[_, _, v]) => {
            let sizes = [torque(&[1.0, 1.0, v]), torque(&[0.0, 1.0, v])];
            respond(sizes.into_iter().skip(usize::from(data.facts.friction_known)).collect())
        }
        (Candidate::System(SystemEffect::Gravity), _) => {
            respond(vec![torque(&[1.0, 0.0]), torque(&[1.0, std::f64::consts::FRAC_PI_2])])
        }
        (Candidate::System(SystemEffect::PeriodicForcing), &[_, frequency, _]) => respond(vec![
            torque(&[1.0, frequency, 0.0]),
            torque(&[1.0, frequency, std::f64::consts::FRAC_PI_2]),
        ]),
        (Candidate::System(SystemEffect::Hysteresis), &[_, displacement]) => {
            respond(vec![bending(displacement, path, data, nominal)])
        }
        (Candidate::System(SystemEffect::InputDelay), &[delay]) => {
            let input = data.inputs.get(path.record).and_then(Option::as_ref);
            let shifted = path.times.iter().zip(&path.input).map(|(time, now)| {
                input.map_or(0.0, |i| nominal.input_gain * crate::model::tangent::held(i, time - delay) - now)
            });
            respond(vec![shifted.collect()])
        }
        (Candidate::System(_), shape) => respond(vec![torque(shape)]),
        (Candidate::Chain(distortion), shape) => match (distortion, shape) {
            (Distortion::Lag, _) => vec![rate.iter().map(|rate| -rate).collect()],
            (Distortion::Nonlinearity, _) => {
                vec![x.iter().map(|x| x.sin()).collect(), x.iter().map(|x| x.cos()).collect()]
            }
            (Distortion::Drift, _) => vec![path.times.clone()],
            (Distortion::Clock, _) => {
                vec![rate.iter().zip(&path.times).map(|(rate, t)| -0.5 * t * t * rate).collect()]
            }
            (Distortion::Saturation, &[bound]) => {
                vec![x.iter().map(|x| x.clamp(-bound, bound) - x).collect()]
            }
            (Distortion::Saturation, _) => Vec::new(),
            (Distortion::ReadingHysteresis, _) => {
                vec![rate.iter().map(|rate| if *rate < 0.0 { 1.0 } else { -1.0 }).collect()]
            }
        },
    }
}

/// A law's torque along a path.
fn law(candidate: Candidate, values: &[f64], path: &Path, nominal: &Coefficients<f64>) -> Vec<f64> {
    let Candidate::System(effect) = candidate else { return Vec::new() };
    let mut own = [0.0; MOST_PARAMETERS];
    for (slot, value) in own.iter_mut().zip(values) {
        *slot = *value;
    }
    (0..path.len())
        .map(|index| {
            let mut moment = plain_moment(path, index, nominal);
            moment.region = effect.region(&own, &moment);
            effect.torque(&own, &moment)
        })
        .collect()
}

/// −z along a path, for Dahl's law: exact between samples of a motion in one direction.
fn bending(displacement: f64, path: &Path, data: &Data, nominal: &Coefficients<f64>) -> Vec<f64> {
    let position = &path.motion.position;
    let rest = nominal.rest_angle + data.facts.rest_moved;
    let mut z = match (position.first(), path.motion.velocity.first()) {
        (Some(position), Some(velocity)) if !path.first => {
            bent(position - rest, velocity / data.facts.frequency, displacement).z
        }
        _ => 0.0,
    };
    let mut torque = vec![-z];
    for (before, after) in position.iter().zip(position.iter().skip(1)) {
        let way = after - before;
        let direction = if way < 0.0 { -1.0 } else { 1.0 };
        z = direction - (direction - z) * (-way.abs() / displacement).exp();
        torque.push(-z);
    }
    torque
}

impl Dictionary {
    /// Every candidate that is not in the fit's hypothesis.
    pub(crate) fn at(data: &Data, fit: &Fit, candidates: &[Candidate]) -> Result<Self, DynamicsError> {
        let projection = Projection::at(data, fit)?;
        let paths = Path::of(data, fit)?;
        let others: Vec<Candidate> =
            candidates.iter().copied().filter(|c| !fit.hypothesis.candidates.contains(c)).collect();
        let system = fit.hypothesis.system(&data.facts, &fit.point.globals)?;
        Ok(Self::from_paths(data, fit, &paths, &projection, &system.nominal().coefficients(), &others))
    }

    fn from_paths(
        data: &Data,
        fit: &Fit,
        paths: &[Path],
        projection: &Projection,
        nominal: &Coefficients<f64>,
        candidates: &[Candidate],
    ) -> Self {
        let residuals: Vec<&[f64]> = fit.residuals.iter().map(|e| e.as_slice()).collect();
        let mut entries = Vec::new();
        let mut all: Vec<Vec<f64>> = Vec::new();
        for &candidate in candidates {
            let mut shapes = shapes(candidate, &data.facts);
            if candidate == Candidate::System(SystemEffect::PeriodicForcing) {
                shapes = lines(data, &residuals, LINES)
                    .into_iter()
                    .map(|line| vec![1.0, line.frequency, 0.0])
                    .collect();
            }
            for shape in shapes {
                let by_path: Vec<Vec<Vec<f64>>> =
                    paths.iter().map(|path| columns(candidate, &shape, path, data, nominal)).collect();
                let count = by_path.first().map_or(0, Vec::len);
                let from = all.len();
                for column in 0..count {
                    all.push(by_path.iter().filter_map(|c| c.get(column)).flatten().copied().collect());
                }
                let positive = match candidate {
                    Candidate::System(
                        SystemEffect::CubicStiffness
                        | SystemEffect::AsymmetricStiffness
                        | SystemEffect::ConstantTorque
                        | SystemEffect::Gravity
                        | SystemEffect::StiffnessDrift
                        | SystemEffect::DampingDrift
                        | SystemEffect::PeriodicForcing,
                    ) => false,
                    Candidate::System(_) => true,
                    Candidate::Chain(distortion) => {
                        matches!(
                            distortion,
                            Distortion::Lag | Distortion::Saturation | Distortion::ReadingHysteresis
                        )
                    }
                };
                entries.push(Entry { candidate, shape, columns: from..from + count, positive });
            }
        }
        let mut columns = matrix(projection.rows(), &all);
        let raw: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
        projection.apply(&mut columns);
        for (mut column, raw) in columns.column_iter_mut().zip(raw) {
            if column.norm() <= INVISIBLE * raw {
                column.fill(0.0);
            }
        }
        let residual: Vec<f64> = fit.residuals.iter().flat_map(|e| e.iter().copied()).collect();
        let mut residual = DMatrix::from_vec(residual.len(), 1, residual);
        projection.apply(&mut residual);
        let coupling = Candidate::System(SystemEffect::FlexibleCoupling);
        let mut further = Vec::new();
        if candidates.contains(&coupling) {
            let body = second_body(data) * nominal.inertia;
            let lines = decaying_lines(data, &residuals, SECOND_MODES).into_iter();
            further.extend(lines.map(|(line, rate)| (coupling, vec![body, line.frequency, rate], line.gain)));
            let driven = driven_modes(data, paths, projection, &residual, SECOND_MODES).into_iter();
            further.extend(driven.map(|SecondMode { frequency, rate, inertia, gain }| {
                (coupling, vec![inertia.min(body), frequency, rate], gain)
            }));
        }
        Self {
            products: columns.tr_mul(&columns),
            scores: columns.tr_mul(&residual).column(0).clone_owned(),
            columns,
            entries,
            further,
            frequencies: frequencies(data),
        }
    }

    /// The candidate of a gain's first entry.
    pub(crate) fn candidate(&self, gain: &Gain) -> Option<Candidate> {
        gain.entries.first().and_then(|&index| self.entries.get(index)).map(|entry| entry.candidate)
    }

    /// How many frequencies a gain is the best of: 1 for entries without one.
    pub(crate) fn looked(&self, gain: &Gain) -> f64 {
        let forcing = Candidate::System(SystemEffect::PeriodicForcing);
        let mut entries = gain.entries.iter().filter_map(|&index| self.entries.get(index));
        if entries.any(|entry| entry.candidate == forcing) { self.frequencies } else { 1.0 }
    }

    /// Joint gain of some entries, their sizes not negative where the law says so; `None` where an entry is
    /// left without its size.
    pub(crate) fn gain(&self, entries: &[usize]) -> Option<Gain> {
        let chosen: Vec<&Entry> = entries.iter().filter_map(|index| self.entries.get(*index)).collect();
        let all: Vec<(usize, bool)> = chosen
            .iter()
            .flat_map(|entry| entry.columns.clone().map(|column| (column, entry.positive)))
            .collect();
        // A size that comes out negative is zero, and the others are solved for anew.
        let visible = |at: &usize| all.get(*at).is_some_and(|own| entry(&self.products, own.0, own.0) > 0.0);
        let mut kept: Vec<usize> = (0..all.len()).filter(visible).collect();
        let solution = loop {
            let columns: Vec<usize> = kept.iter().filter_map(|&at| all.get(at).map(|own| own.0)).collect();
            if columns.is_empty() {
                return None;
            }
            let products = self.products.select_rows(&columns).select_columns(&columns);
            let scores =
                DMatrix::from_iterator(columns.len(), 1, columns.iter().map(|&c| element(&self.scores, c)));
            let solution = solve(&products, &scores)?;
            let below = |(place, at): (usize, &usize)| {
                let positive = all.get(*at).is_some_and(|own| own.1);
                let value = solution.get(place).copied().unwrap_or(0.0);
                (positive && value < 0.0).then_some((place, value * entry(&products, place, place).sqrt()))
            };
            let worst = kept.iter().enumerate().filter_map(below).min_by(|a, b| a.1.total_cmp(&b.1));
            match worst {
                Some((place, _)) => _ = kept.remove(place),
                None => break solution,
            }
        };
        let mut coefficients = vec![0.0; all.len()];
        let mut squares = 0.0;
        for (at, value) in kept.iter().zip(solution.iter()) {
            if let (Some(slot), Some(own)) = (coefficients.get_mut(*at), all.get(*at)) {
                *slot = *value;
                squares += value * element(&self.scores, own.0);
            }
        }
        let mut from = 0;
        for entry in chosen {
            let own = coefficients.get(from..from + entry.columns.len())?;
            from += own.len();
            // The last column is the one without which the candidate would be another.
            if own.last().is_none_or(|size| *size == 0.0) {
                return None;
            }
        }
        (squares.is_finite() && squares > 0.0).then(|| Gain {
            entries: entries.to_vec(),
            squares,
            coefficients,
        })
    }

    /// The parameters that an entry's coefficients stand for.
    pub(crate) fn parameters(&self, entry: usize, coefficients: &[f64]) -> Vec<f64> {
        let Some(entry) = self.entries.get(entry) else { return Vec::new() };
        match (entry.candidate, entry.shape.as_slice(), coefficients) {
            (Candidate::System(SystemEffect::StribeckFriction), &[_, _, v], &[p, q]) => vec![p, q, v],
            (Candidate::System(SystemEffect::StribeckFriction), &[_, _, v], &[q]) => vec![0.0, q, v],
            (Candidate::System(SystemEffect::PeriodicForcing), &[_, frequency, _], &[p, q]) => {
                vec![p, frequency, q]
            }
            (Candidate::System(SystemEffect::Hysteresis), &[_, displacement], &[c]) => vec![c, displacement],
            (Candidate::System(SystemEffect::EndStop), &[angle, ..], &[c]) => vec![angle, c, 0.0],
            // The shape is the parameter itself; the coefficient of its secant corrects it within reason.
            (Candidate::System(SystemEffect::Backlash | SystemEffect::InputDelay), &[size], &[c]) => {
                vec![size * c.clamp(0.3, 3.0)]
            }
            (
                Candidate::System(SystemEffect::InputSaturation) | Candidate::Chain(Distortion::Saturation),
                &[size],
                _,
            ) => vec![size],
            (_, _, coefficients) => coefficients.to_vec(),
        }
    }
}

/// Where the motion is at a sample: what a torque or a sensor without a name may depend on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) time: f64,
    /// Torque of the input; 0 without one.
    pub(crate) input: f64,
}

/// A function of the motion.
pub(crate) type Smooth = Box<dyn Fn(Moment) -> f64 + Sync>;

/// What functions of the motion do to what is observed: as torques, or added to the sensor's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Acting {
    Torque,
    Sensor,
}

/// The change of what is observed by functions of the motion, not projected: for what has no name.
pub(crate) fn columns_of(
    paths: &[Path],
    quantity: Quantity,
    functions: &[Smooth],
    acting: Acting,
) -> Vec<Vec<f64>> {
    functions
        .iter()
        .map(|function| {
            stack(paths, |path| {
                let motion = path.motion.position.iter().zip(&path.motion.velocity);
                let along: Vec<f64> = motion
                    .zip(path.times.iter().zip(&path.input))
                    .map(|((&position, &velocity), (&time, &input))| {
                        function(Moment { position, velocity, time, input })
                    })
                    .collect();
                match acting {
                    Acting::Torque => path.response(&along, quantity),
                    Acting::Sensor => along,
                }
            })
        })
        .collect()
}
