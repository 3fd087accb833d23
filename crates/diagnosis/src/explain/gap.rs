//! Size of the gap and its closure, with intervals.

use crate::evidence::held_out::HeldOut;
use crate::noise::ratio::{Block, ratio_interval};
use crate::residual::floor::NoiseFloor;
use nalgebra::DVector;
use results::{GapSummary, WithInterval};

/// Held-out residuals of the three simulators, and of the free latent torque.
pub(crate) struct Stages<'a> {
    pub(crate) nominal: &'a HeldOut,
    pub(crate) recalibrated: &'a HeldOut,
    pub(crate) repaired: &'a HeldOut,
    pub(crate) ceiling: &'a [DVector<f64>],
}

/// Number of blocks of a segment: about one for each swing.
const BLOCKS: usize = 6;

/// Lowest closure that is stated: that of a simulator that doubles the squares of the gap. Worse ones get it
/// too.
const LOWEST_CLOSURE: f64 = -1.0;

/// Interval of the closure if the gap cannot be told from none.
const ANY_CLOSURE: [f64; 2] = [LOWEST_CLOSURE, 1.0];

/// Sums of squares by segment and block.
type Squares = Vec<Vec<f64>>;

fn by_block(squares: &[f64]) -> Vec<f64> {
    let size = squares.len().div_ceil(BLOCKS).max(1);
    squares.chunks(size).map(|block| block.iter().sum()).collect()
}

fn held_out(held: &HeldOut) -> Squares {
    let own = |e: &DVector<f64>| {
        let squares: Vec<f64> = e.iter().map(|e| e * e).collect();
        by_block(&squares)
    };
    held.residuals.iter().map(own).collect()
}

/// Returns the squares of the noise floor. Their sum is the floor over all samples, and they scatter as that
/// sum does. A sample at which the floor was not measured counts as the mean. The measured ones stand for
/// all: each deviation from the mean counts N/n times.
fn of_floor(squares: &[Vec<Option<f64>>], floor: &NoiseFloor) -> Squares {
    let mean = floor.value * floor.value;
    let samples = squares.iter().map(Vec::len).sum::<usize>();
    let worth = samples as f64 / floor.count.max(1) as f64;
    let own = |squares: &Vec<Option<f64>>| {
        let of = |square: &Option<f64>| square.map_or(mean, |square| mean + worth * (square - mean));
        let filled: Vec<f64> = squares.iter().map(of).collect();
        by_block(&filled)
    };
    squares.iter().map(own).collect()
}

fn mean_square(squares: &Squares, samples: f64) -> f64 {
    squares.iter().flatten().sum::<f64>() / samples
}

fn closure(after: f64, before: f64, noise: f64) -> f64 {
    let excess = before - noise;
    if excess > 0.0 { (1.0 - (after - noise) / excess).max(LOWEST_CLOSURE) } else { 0.0 }
}

/// Returns the interval of a ratio of sums of squares, computed from blocks.
fn interval(squares: [&Squares; 3], block: impl Fn([f64; 3]) -> Block) -> Option<[f64; 2]> {
    let [one, other, third] = squares;
    let runs: Vec<Vec<Block>> = one
        .iter()
        .zip(other)
        .zip(third)
        .map(|((a, b), c)| a.iter().zip(b).zip(c).map(|((a, b), c)| block([*a, *b, *c])).collect())
        .collect();
    ratio_interval(&runs)
}

/// Computes the gap. Its intervals compare the sums of squares of the simulators with those of the noise
/// floor, swing by swing ([`ratio_interval`]). If the gap cannot be told from none, the interval of its
/// closure extends from [`LOWEST_CLOSURE`] to 1.
pub(crate) fn gap(
    stages: &Stages<'_>,
    (floor, floors): (NoiseFloor, &[Vec<Option<f64>>]),
    last_third: [f64; 2],
    unit: &str,
) -> GapSummary {
    let [nominal, recalibrated, repaired] =
        [stages.nominal, stages.recalibrated, stages.repaired].map(held_out);
    let floors = of_floor(floors, &floor);
    let samples = stages.repaired.residuals.iter().map(DVector::len).sum::<usize>().max(1) as f64;
    let noise = floor.value * floor.value;
    let [r0, rc, rm] = [&nominal, &recalibrated, &repaired].map(|own| mean_square(own, samples));
    let closed = |before: &Squares, value: f64| {
        let left =
            interval([&repaired, before, &floors], |[after, before, noise]| [after - noise, before - noise]);
        let ends = |[low, high]: [f64; 2]| [1.0 - high, 1.0 - low].map(|end| end.max(LOWEST_CLOSURE));
        WithInterval { value, interval_95: left.map_or(ANY_CLOSURE, ends) }
    };
    let over = interval([&repaired, &floors, &floors], |[after, noise, _]| [after, noise]);
    let ratio = (rm / noise).sqrt();
    let freedom: f64 = stages.repaired.residuals.iter().map(|e| e.len() as f64).sum();
    let left: f64 = stages.ceiling.iter().map(DVector::norm_squared).sum();
    GapSummary {
        unit: unit.to_owned(),
        nominal: r0.sqrt(),
        recalibrated: rc.sqrt(),
        repaired: rm.sqrt(),
        // If a free torque predicts worse than none, none is the better choice.
        ceiling: (left / freedom.max(1.0)).min(rm).sqrt(),
        closure: closed(&nominal, closure(rm, r0, noise)),
        closure_of_recalibrated: closed(&recalibrated, closure(rm, rc, noise)),
        ratio_to_floor: ratio,
        ratio_to_floor_interval_95: over.map_or([0.0, ratio], |ends| ends.map(|end| end.max(0.0).sqrt())),
        noise_floor: floor.value,
        noise_floor_interval_95: floor.interval_95,
        last_third: last_third.map(f64::sqrt),
        held_out: "segments of about six periods (without a spring: three time constants); simulators are \
                   fitted to the even segments and scored on the odd ones, and vice versa; on the scored \
                   segments, only the initial states are fitted. With fewer than eight segments: blocks of \
                   at least three quarters of a period; a quarter of them is held out at a time, and nothing \
                   is fitted to these"
            .to_owned(),
    }
}

/// Returns the mean paired difference of squares by segment over its standard error; positive if `after` is
/// better.
pub(crate) fn paired(before: &[DVector<f64>], after: &[DVector<f64>]) -> f64 {
    let differences: Vec<f64> =
        before.iter().zip(after).map(|(b, a)| b.norm_squared() - a.norm_squared()).collect();
    let (mean, error) = crate::noise::statistics::mean_and_error(&differences);
    if error > 0.0 { mean / error } else { 0.0 }
}
