//! Half swings as independent evidence: amplitude and duration of every half swing over a whole
//! record, and the log evidence that they give for laws of loss.
//!
//! Segments with their own start states lose the change of the amplitude over the whole record; half swings
//! keep it. Real disturbances affect the phase first and leave the amplitude quiet, so half swings are a
//! second witness with other weaknesses than a fit. They distinguish classes of laws, not kinds within a
//! class.
//!
//! Half swings give evidence for losses only. Durations and centers of the swings also tell of the restoring torque,
//! but in training banks that added nothing to the evidence from fits.

#![allow(clippy::indexing_slicing, reason = "there is a coefficient for every term")]

mod averaging;
mod regression;
#[cfg(test)]
mod tests;
mod turning_points;

use crate::data::observations::Observations;
use crate::noise::statistics::median;
use averaging::Restoring;
use dynamics::effects::{CoulombFriction, QuadraticDrag};
use record::Quantity;
use regression::{Hypothesis, Increments, Prior, by_replacement, hypotheses};
use std::f64::consts::PI;
use turning_points::{Turn, turning_points};

/// Half swing: the motion from one turning point to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct HalfSwing {
    /// Mean time of its two turning points, in seconds since the record's first sample.
    time_s: f64,
    /// Half the distance between its turning points, in the observed unit.
    amplitude: f64,
    /// Time between its turning points in seconds, and its standard error.
    duration_s: f64,
    duration_error_s: f64,
}

/// Evidence from half swings for laws of loss, in nats: the log evidence of the best combination with the law minus
/// that of the best combination without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Witness {
    /// Evidence for a loss that does not depend on the amplitude: dry friction.
    pub(crate) friction: Option<f64>,
    /// Evidence for a loss that grows with the square of the amplitude: quadratic drag.
    pub(crate) drag: Option<f64>,
}

/// Fewest half swings from which evidence for laws is computed.
const FEWEST: usize = 8;
/// Largest relative change of the duration that the prior admits, over the amplitudes or over the record.
const LARGEST_CHANGE: f64 = 0.5;

/// Run of successive turning points of one record.
struct Run {
    turns: Vec<Turn>,
    swings: Vec<HalfSwing>,
}

/// Finds the half swings of all freely swinging records of a system and computes their evidence for laws of loss.
/// Returns `None` if no record swings freely or fewer than [`FEWEST`] half swings stand out.
///
/// `kept` marks the samples that are not outliers and belong to the free swing. `angular_frequency` in rad/s
/// is the nominal simulator's; it is a hint that has to be right within a factor of two. Driven records and
/// records of velocity or acceleration are left out. All records share the laws; each has its own amplitudes.
pub(crate) fn half_swings(
    records: &[Observations],
    kept: &[Vec<bool>],
    angular_frequency: f64,
) -> Option<Witness> {
    let mut runs = Vec::new();
    for (record, kept) in records.iter().zip(kept) {
        if record.input.is_none() && record.quantity == Quantity::Position {
            let found = turning_points(record, kept, angular_frequency);
            runs.extend(found.into_iter().map(|turns| Run { swings: swings(&turns), turns }));
        }
    }
    let swings: Vec<HalfSwing> = runs.iter().flat_map(|run| run.swings.iter().copied()).collect();
    if swings.len() < FEWEST {
        return None;
    }
    // A loss lengthens the swing in second order, and the laws of loss are averaged over the swing that the
    // durations determine. So each is computed once with the other's result.
    let typical = median(&swings.iter().map(|swing| swing.duration_s).collect::<Vec<_>>());
    let (_, lost) = losses(&runs, &swings, &|_| Restoring::harmonic(PI / typical));
    let durations = durations(&runs, &swings, &lost);
    Some(losses(&runs, &swings, &|swing| restoring(durations.as_ref(), &swings, swing)).0)
}

fn swings(turns: &[Turn]) -> Vec<HalfSwing> {
    let pairs = turns.iter().zip(turns.iter().skip(1));
    let swing = |(one, next): (&Turn, &Turn)| HalfSwing {
        time_s: 0.5 * (one.time_s + next.time_s),
        amplitude: 0.5 * (next.value - one.value).abs(),
        duration_s: next.time_s - one.time_s,
        duration_error_s: (one.time_variance + next.time_variance).sqrt(),
    };
    pairs.map(swing).collect()
}

fn largest(swings: &[HalfSwing]) -> f64 {
    swings.iter().map(|swing| swing.amplitude).fold(f64::MIN_POSITIVE, f64::max)
}

fn span(swings: &[HalfSwing]) -> f64 {
    let times = || swings.iter().map(|swing| swing.time_s);
    (times().fold(f64::MIN, f64::max) - times().fold(f64::MAX, f64::min)).max(f64::MIN_POSITIVE)
}

/// Indices of the terms that explain durations, and the power of the amplitude in each.
const CONSTANT: usize = 0;
const SQUARE: usize = 1;
const FOURTH: usize = 2;
const PLAY: std::ops::Range<usize> = 3..5;
const PRESLIDING: std::ops::Range<usize> = 5..7;
const TIME: usize = 7;
const LOSS: usize = 8;
const POWERS: [i32; TIME] = [0, 2, 4, -1, -2, -1, -2];
/// Largest relative lengthening of a swing that loses all its amplitude: 1/(2π²) under viscous damping, and
/// of this order under other laws.
const LARGEST_LENGTHENING: f64 = 0.1;

/// Regresses the durations on even and inverse powers of the amplitude and on time. Returns the best
/// combination.
///
/// Inverse powers either lengthen the small swings (backlash) or shorten them (friction that bends before it
/// slides), never both. A fourth power is admitted only with a second one.
fn durations(runs: &[Run], swings: &[HalfSwing], lost: &[Vec<f64>]) -> Option<Hypothesis> {
    let increments = of_durations(runs, swings, lost);
    let priors = of_terms(median(&swings.iter().map(|swing| swing.duration_s).collect::<Vec<_>>()));
    let any = |acts: &[bool], terms: std::ops::Range<usize>| {
        acts.get(terms).is_some_and(|acts| acts.contains(&true))
    };
    let one = |acts: &[bool], term: usize| any(acts, term..term + 1);
    let allowed = |acts: &[bool]| {
        (one(acts, SQUARE) || !one(acts, FOURTH)) && !(any(acts, PLAY) && any(acts, PRESLIDING))
    };
    let found = hypotheses(&increments, &priors, &allowed);
    found.into_iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))
}

/// Returns the durations of each run and the terms that explain them.
fn of_durations(runs: &[Run], swings: &[HalfSwing], lost: &[Vec<f64>]) -> Vec<Increments> {
    let (most, span) = (largest(swings), span(swings));
    let least = swings.iter().map(|swing| swing.amplitude).fold(most, f64::min);
    let power = |term: usize, swing: &HalfSwing| {
        let power = POWERS[term];
        let part = (swing.amplitude / if power < 0 { least } else { most }).powi(power);
        if PRESLIDING.contains(&term) { -part } else { part }
    };
    runs.iter()
        .zip(lost)
        .map(|(run, lost)| {
            let shares = run.swings.iter().zip(lost).map(|(swing, lost)| (lost / swing.amplitude).powi(2));
            let each = |term: &dyn Fn(&HalfSwing) -> f64| run.swings.iter().map(term).collect::<Vec<f64>>();
            let powers = (0..TIME).map(|term| each(&|swing| power(term, swing)));
            let variances = each(&|swing| swing.duration_error_s.powi(2));
            let shared = run.turns.iter().skip(1).map(|turn| -turn.time_variance).collect();
            Increments {
                values: each(&|swing| swing.duration_s),
                terms: powers.chain([each(&|swing| swing.time_s / span), shares.collect()]).collect(),
                covariance: [variances, shared, vec![0.0; run.swings.len()]],
            }
        })
        .collect()
}

/// Returns the priors of the terms of a duration; `typical` is the typical duration in s.
fn of_terms(typical: f64) -> Vec<Prior> {
    let change = LARGEST_CHANGE * typical;
    let mut priors = vec![Prior::Within(change); LOSS + 1];
    for (term, prior) in priors.iter_mut().enumerate() {
        match term {
            CONSTANT => *prior = Prior::Always,
            LOSS => *prior = Prior::Within(LARGEST_LENGTHENING * typical),
            term if PLAY.contains(&term) || PRESLIDING.contains(&term) => *prior = Prior::UpTo(change),
            _ => {}
        }
    }
    priors
}

/// Returns the restoring torque implied by the durations, with its drift up to the time of a swing.
fn restoring(durations: Option<&Hypothesis>, swings: &[HalfSwing], swing: &HalfSwing) -> Restoring {
    let of = |term: usize| durations.map_or(0.0, |found| found.coefficients[term]);
    let base = of(CONSTANT).max(f64::MIN_POSITIVE);
    let most = largest(swings);
    let least = swings.iter().map(|swing| swing.amplitude).fold(most, f64::min);
    let drifted = base + of(TIME) * swing.time_s / span(swings);
    Restoring::of_period(
        PI / drifted.max(0.5 * base),
        [of(SQUARE) / base / most.powi(2), of(FOURTH) / base / most.powi(4), of(PLAY.start) * least / base],
    )
}

/// Returns the increments of the amplitude and those of its terms. Increments two places apart share an error.
fn of_amplitudes(run: &Run, terms: Vec<Vec<f64>>) -> Increments {
    let ends = run.turns.iter().zip(run.turns.iter().skip(2));
    let variances: Vec<f64> =
        ends.map(|(from, to)| 0.25 * (from.value_variance + to.value_variance)).collect();
    let shared = run.turns.iter().skip(2).map(|turn| -0.25 * turn.value_variance).collect();
    let amplitudes = run.swings.iter().map(|swing| swing.amplitude);
    let values = amplitudes.clone().zip(amplitudes.skip(1)).map(|(one, next)| next - one).collect();
    Increments { values, terms, covariance: [variances, vec![0.0; run.swings.len()], shared] }
}

/// Largest coefficient of a law that the prior admits, relative to the one that explains the whole loss.
const ROOM: f64 = 1.5;

/// Indices of the terms of the loss, beside a viscous one: dry, and with the square of the velocity. A cubic term and a
/// viscous one that changes in time were tried too: each replaces true drag and friction more often than it
/// prevents false ones.
const DRY: usize = 0;
const QUADRATIC: usize = 2;

/// Regresses the loss of amplitude on the laws, each averaged over the swing that the durations determine.
/// Returns the evidence, and the loss of each swing of each run under the best combination.
fn losses(
    runs: &[Run],
    swings: &[HalfSwing],
    restoring: &dyn Fn(&HalfSwing) -> Restoring,
) -> (Witness, Vec<Vec<f64>>) {
    let most = largest(swings);
    let omega = restoring(&HalfSwing { time_s: 0.0, ..HalfSwing::default() }).angular_frequency;
    // Units of the coefficients: the amplitude, and shares of it, lost in a harmonic half swing.
    let laws = |swing: &HalfSwing| {
        let (restoring, a) = (restoring(swing), swing.amplitude);
        [
            restoring.loss::<CoulombFriction>(&[0.5 * omega * omega, 0.0, 0.0, 0.0], a),
            restoring.viscous(2.0 * omega / PI, a),
            restoring.loss::<QuadraticDrag>(&[0.75, 0.0, 0.0, 0.0], a),
        ]
    };
    let of_laws = |run: &Run| run.swings.iter().map(laws).collect::<Vec<_>>();
    let lost: Vec<Vec<[f64; QUADRATIC + 1]>> = runs.iter().map(of_laws).collect();
    let increments: Vec<Increments> = runs
        .iter()
        .zip(&lost)
        .map(|(run, lost)| {
            let term = |law: usize| {
                let own: Vec<f64> = lost.iter().filter_map(|laws| laws.get(law)).copied().collect();
                own.iter().zip(own.iter().skip(1)).map(|(one, next)| -0.5 * (one + next)).collect()
            };
            of_amplitudes(run, (0..=QUADRATIC).map(term).collect())
        })
        .collect();
    // The prior's bound: the coefficient at which one law explains the whole loss, times `ROOM`.
    let all: f64 = -increments.iter().flat_map(|run| &run.values).sum::<f64>();
    let bound = |term: usize| {
        let own: f64 = -increments.iter().filter_map(|run| run.terms.get(term)).flatten().sum::<f64>();
        ROOM * all.max(1e-6 * most) / own.max(f64::MIN_POSITIVE)
    };
    let priors: Vec<Prior> = (0..=QUADRATIC).map(|term| Prior::UpTo(bound(term))).collect();
    let one = |acts: &[bool], term: usize| acts.get(term).is_some_and(|acts| *acts);
    let found = hypotheses(&increments, &priors, &|_| true);
    let witness = Witness {
        friction: by_replacement(&found, &|acts| one(acts, DRY)),
        drag: by_replacement(&found, &|acts| one(acts, QUADRATIC)),
    };
    let Some(best) = found.iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence)) else {
        return (witness, lost.iter().map(|run| vec![0.0; run.len()]).collect());
    };
    let sum = |laws: &[f64; QUADRATIC + 1]| {
        laws.iter().zip(&best.coefficients).map(|(law, own)| law * own).sum::<f64>()
    };
    (witness, lost.iter().map(|run| run.iter().map(sum).collect()).collect())
}
