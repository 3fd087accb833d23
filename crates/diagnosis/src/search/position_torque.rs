//! Fit of a torque without a name that repeats along the position, beside a set.

#![allow(clippy::indexing_slicing, reason = "two columns have two coefficients")]

use crate::data::segments::Data;
use crate::fit::fitted::{Fit, Point};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::significance::ratio;
use crate::fit::stopping::Stopping;
use crate::linear::dictionary::{Acting, INVISIBLE, Moment, Smooth, columns_of};
use crate::linear::projection::Projection;
use crate::linear::tangent::{Path, matrix};
use crate::model::candidate::Candidate;
use crate::sets::archive::vanished;
use dynamics::DynamicsError;
use nalgebra::{DMatrix, DVector};

/// Step of the grid of wavenumbers, in radians of the wave per amplitude. Over a swing, waves this far apart
/// are nearly orthogonal, and a fit still converges from halfway between two of them.
const STEP: f64 = 1.5;

/// Number of parameters of the torque: a size, a wavenumber and a phase.
const PARAMETERS: f64 = 3.0;

/// Strongest torque along the position, to first order.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave {
    wavenumber: f64,
    /// Amplitudes of the torques along −sin and −cos of the phase.
    torques: [f64; 2],
    /// Squares that the torque would explain.
    gain: f64,
}

/// Fits a set with such a torque beside it. `None` if the nominal simulator has such a torque, if the log
/// evidence that its gain to first order promises over the set alone, at the autocorrelation time `time`,
/// stays below `bound`, or if the fitted torque vanishes.
///
/// # Errors
/// Returns an error if the motion cannot be computed.
pub(crate) fn beside(data: &Data, named: &Fit, time: f64, bound: f64) -> Result<Option<Fit>, DynamicsError> {
    if named.hypothesis.knows(Candidate::UNNAMED) {
        return Ok(None);
    }
    let Some(wave) = strongest(data, named)? else { return Ok(None) };
    let promised = Fit { squares: (named.squares - wave.gain).max(f64::MIN_POSITIVE), ..named.clone() };
    if evidence(data, &promised, named, time) < bound {
        return Ok(None);
    }
    let followed = with(data, named, wave).ok();
    Ok(followed.filter(|followed| !vanished(data, followed)))
}

/// Returns the log evidence, in nats, of a set with such a torque over the set without it, at the
/// autocorrelation time `time`. The torque pays for its parameters and for being the best of many
/// wavenumbers.
pub(crate) fn evidence(data: &Data, with: &Fit, without: &Fit, time: f64) -> f64 {
    let worth = (without.samples() as f64 / time).max(2.0);
    let looked = wavenumbers(data).len().max(1) as f64;
    ratio(with, without, time) - 0.5 * PARAMETERS * libm::log(worth) - libm::log(looked)
}

/// Returns the wavenumbers that are searched; empty if the samples are too far apart for any.
fn wavenumbers(data: &Data) -> Vec<f64> {
    let [lowest, highest] = data.facts.waves();
    let step = STEP / data.facts.amplitude;
    let steps = (highest - lowest) / step;
    let count = if steps >= 0.0 { steps as usize + 1 } else { 0 };
    (0..count).map(|index| lowest + index as f64 * step).collect()
}

fn strongest(data: &Data, named: &Fit) -> Result<Option<Wave>, DynamicsError> {
    let wavenumbers = wavenumbers(data);
    if wavenumbers.is_empty() {
        return Ok(None);
    }
    let projection = Projection::at(data, named)?;
    let paths = Path::of(data, named)?;
    let mut residual = DMatrix::from_iterator(projection.rows(), 1, named.stacked());
    projection.apply(&mut residual);
    let waves = wavenumbers
        .into_iter()
        .filter_map(|wavenumber| wave(data, &paths, &projection, &residual, wavenumber));
    Ok(waves.max_by(|a, b| a.gain.total_cmp(&b.gain)))
}

/// Returns the torques at one wavenumber that explain most; `None` if calibration and start states imitate
/// them.
fn wave(
    data: &Data,
    paths: &[Path],
    projection: &Projection,
    residual: &DMatrix<f64>,
    wavenumber: f64,
) -> Option<Wave> {
    let functions: [Smooth; 2] = [
        Box::new(move |moment: Moment| -libm::sin(wavenumber * moment.position)),
        Box::new(move |moment: Moment| -libm::cos(wavenumber * moment.position)),
    ];
    let columns = columns_of(paths, data.quantity, &functions, Acting::Torque);
    let mut columns = matrix(projection.rows(), &columns);
    let raw = columns.norm();
    projection.apply(&mut columns);
    if columns.norm() <= INVISIBLE * raw {
        return None;
    }
    let scores: DVector<f64> = columns.tr_mul(residual).column(0).clone_owned();
    let solution = columns.tr_mul(&columns).lu().solve(&scores)?;
    let gain = solution.dot(&scores);
    let torques = [solution[0], solution[1]];
    (gain.is_finite() && gain > 0.0).then_some(Wave { wavenumber, torques, gain })
}

/// Fits the named set with a wave beside it, beginning where the set's fit ended.
fn with(data: &Data, named: &Fit, wave: Wave) -> Result<Fit, DynamicsError> {
    let hypothesis =
        named.hypothesis.with(&[named.hypothesis.candidates.as_slice(), &[Candidate::UNNAMED]].concat());
    let [sine, cosine] = wave.torques;
    // The torque's parameters come last, behind those of every candidate.
    let globals = [named.point.globals.as_slice(), &[sine, wave.wavenumber, cosine]].concat();
    let point = Point { globals, starts: named.point.starts.clone() };
    fit(data, &hypothesis, point, Moving::All, Stopping::FINAL)
}
