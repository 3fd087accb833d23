//! Decision between two modes and one mode whose frequency or decay depends on its amplitude.

use super::fit::{Fit, Line};
use super::pencil::Blocks;
use super::samples::Samples;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Smallest rise of an envelope, in standard errors.
const RISE_ERRORS: f64 = 8.0;
/// Smallest rise of an envelope, as a share of what it rises to.
const RISE_SHARE: f64 = 0.1;
/// Smallest distance of two lines, in changes of the frequency between the halves of a record.
const CHANGES: f64 = 3.0;
/// Smallest distance of two lines, in widths of the wider one.
const WIDTHS: f64 = 2.0;
/// Smallest number of beats while both lines are visible.
const BEATS: f64 = 1.5;
/// Number of beats from which lines of about the same power need no rising envelope.
const MANY_BEATS: f64 = 10.0;
/// Largest power of the weaker of two lines with few beats, as a share of both.
const WEAKER: f64 = 0.2;
/// Largest part of a line's gain that its mirror image about the stronger line may have.
const MIRRORED: f64 = 0.3;
/// Amplitude that is visible whatever the residuals, as a share of the largest one.
const VISIBLE: f64 = 0.1;
/// Fewest blocks that show an envelope.
const FEWEST_BLOCKS: usize = 6;

/// Returns true if two lines of a fit are two modes.
///
/// Two lines beat: their envelope rises again, which that of one decaying swing never does. A weak line
/// beside a strong decaying one cannot make the envelope rise. It counts if it is farther away than the
/// strong line's frequency moves, far enough to be told from the strong line's own width, and on one side
/// only: the lines that describe a decay which is not exponential lie on both sides alike.
pub(super) fn are_two(samples: &Samples, fit: &Fit, strong: usize, weak: usize) -> bool {
    let Some((one, other)) = fit.lines.get(strong).zip(fit.lines.get(weak)) else { return false };
    let distance = (one.line.omega - other.line.omega).abs();
    let values = fit.residuals(samples, &[strong, weak]);
    let swing = Blocks::new(samples, &values, one.line.omega, 1.0);
    let rest = Blocks::new(samples, &fit.residuals(samples, &[]), one.line.omega, 1.0);
    if swing.amplitudes.len() < FEWEST_BLOCKS {
        return distance > 0.5 * one.line.omega;
    }
    let squares: f64 = rest.amplitudes.iter().map(|value| value.norm_sqr()).sum();
    let error = (0.5 * squares / rest.amplitudes.len() as f64).sqrt();
    if rises(&swing.amplitudes, error) {
        return true;
    }
    let faster = one.line.decay.max(other.line.decay).max(0.0);
    let beats = distance / TAU * (4.0 / faster.max(1e-9)).min(1.0);
    let share = other.energy / (one.energy + other.energy);
    distance > CHANGES * change(&swing, error)
        && distance > WIDTHS * faster
        && beats > BEATS
        && (beats > MANY_BEATS || share < WEAKER)
        && is_one_sided(samples, fit, strong, weak)
}

/// Returns true if the envelope rises clearly at some time.
fn rises(amplitudes: &[Complex<f64>], error: f64) -> bool {
    let mut least = f64::INFINITY;
    amplitudes.iter().any(|value| {
        let size = value.norm();
        least = least.min(size);
        size - least > (RISE_ERRORS * error).max(RISE_SHARE * size)
    })
}

/// Returns the difference of the angular frequencies of the first and the last half of the visible blocks.
fn change(blocks: &Blocks, error: f64) -> f64 {
    let largest = blocks.amplitudes.iter().map(|value| value.norm()).fold(0.0, f64::max);
    // A fit of the wrong kind has large residuals, which hide nothing of the swing.
    let least = (4.0 * error).min(VISIBLE * largest);
    let visible = blocks.amplitudes.iter().rposition(|value| value.norm() > least);
    let visible = visible.map_or(1, |last| last + 1).min(blocks.amplitudes.len());
    let (visible, _) = blocks.amplitudes.split_at(visible);
    let (first, last) = visible.split_at(visible.len() / 2);
    let turn = |half: &[Complex<f64>]| {
        let turns = half.windows(2).filter_map(|pair| match pair {
            [one, next] => Some(next * one.conj()),
            _ => None,
        });
        turns.sum::<Complex<f64>>()
    };
    // The turn from half to half is small: its angle is taken of the product.
    ((turn(last) * turn(first).conj()).arg() / blocks.width).abs()
}

/// Returns true if the weak line explains much more than its mirror image about the strong line.
fn is_one_sided(samples: &Samples, fit: &Fit, strong: usize, weak: usize) -> bool {
    let lines = fit.guesses();
    let Some((one, other)) = lines.get(strong).zip(lines.get(weak)) else { return false };
    let mirror = Line { omega: 2.0 * one.omega - other.omega, decay: other.decay };
    if mirror.omega < 2.0 * TAU {
        return true;
    }
    let with = |line: Option<Line>| {
        let others = lines.iter().enumerate().filter(|(number, _)| *number != weak).map(|(_, line)| *line);
        Fit::new(samples, &others.chain(line).collect::<Vec<Line>>()).map(|fit| fit.rest)
    };
    match (with(None), with(Some(mirror))) {
        (Some(without), Some(mirrored)) => without - mirrored < MIRRORED * (without - fit.rest),
        _ => false,
    }
}
