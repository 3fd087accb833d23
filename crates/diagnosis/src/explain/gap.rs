//! How far the gap shrinks, with intervals.

use crate::answer::{Gap, Interval};
use crate::evidence::held_out::HeldOut;
use crate::noise::floor::NoiseFloor;
use crate::noise::ratio::{Block, ratio_interval};
use nalgebra::DVector;

/// Held-out residuals of the three simulators, and of the free latent torque.
pub(crate) struct Stages<'a> {
    pub(crate) nominal: &'a HeldOut,
    pub(crate) recalibrated: &'a HeldOut,
    pub(crate) repaired: &'a HeldOut,
    pub(crate) ceiling: &'a [DVector<f64>],
}

/// Blocks of a segment: swings, of which it holds about six.
const BLOCKS: usize = 6;

/// A simulator that doubles the square of the gap, or worse: closures are stated down to here.
const LOWEST_CLOSURE: f64 = -1.0;

/// Ends of an interval of closures of a gap that is not told from none.
const ANY_CLOSURE: [f64; 2] = [LOWEST_CLOSURE, 1.0];

/// Squares by block of a segment, on the scale of a variance's sum: what the fitted start states have taken
/// is put back.
type Squares = Vec<Vec<f64>>;

fn by_block(squares: &[f64], scale: f64) -> Vec<f64> {
    let size = squares.len().div_ceil(BLOCKS).max(1);
    squares.chunks(size).map(|block| scale * block.iter().sum::<f64>()).collect()
}

fn held_out(held: &HeldOut) -> Squares {
    let own = |e: &DVector<f64>| {
        let squares: Vec<f64> = e.iter().map(|e| e * e).collect();
        by_block(&squares, e.len() as f64 / (e.len() as f64 - held.starts as f64).max(1.0))
    };
    held.residuals.iter().map(own).collect()
}

/// The noise floor's: their sum is what it comes to over all samples, and they scatter as that sum does. A
/// sample where the floor was not measured stands for the mean, and those where it was for all: each
/// deviation counts N/n times.
fn of_floor(squares: &[Vec<Option<f64>>], floor: &NoiseFloor) -> Squares {
    let mean = floor.value * floor.value;
    let samples = squares.iter().map(Vec::len).sum::<usize>();
    let worth = samples as f64 / floor.count.max(1) as f64;
    let own = |squares: &Vec<Option<f64>>| {
        let filled: Vec<f64> =
            // Where no difference was taken the mean stands.
            squares.iter().map(|square| mean + worth * square.map_or(0.0, |square| square - mean)).collect();
        by_block(&filled, 1.0)
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

/// Interval of a ratio of sums of squares, block by block.
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

/// The gap. Intervals hold the sums of squares of the simulators and of the noise floor against one another,
/// swing by swing ([`ratio_interval`]). Where the gap is not told from none its closure may be anything from
/// [`LOWEST_CLOSURE`] to 1.
pub(crate) fn gap(
    stages: &Stages<'_>,
    (floor, floors): (NoiseFloor, &[Vec<Option<f64>>]),
    last_third: [f64; 2],
    unit: &'static str,
) -> Gap {
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
        Interval { value, interval_95: left.map_or(ANY_CLOSURE, ends) }
    };
    let over = interval([&repaired, &floors, &floors], |[after, noise, _]| [after, noise]);
    let ratio = (rm / noise).sqrt();
    let freedom: f64 = stages
        .repaired
        .residuals
        .iter()
        .map(|e| (e.len() as f64 - stages.repaired.starts as f64).max(1.0))
        .sum();
    let left: f64 = stages.ceiling.iter().map(DVector::norm_squared).sum();
    Gap {
        unit,
        nominal: r0.sqrt(),
        recalibrated: rc.sqrt(),
        repaired: rm.sqrt(),
        // Where a free torque predicts worse than none, none is the better choice.
        ceiling: (left / freedom.max(1.0)).min(rm).sqrt(),
        closure: closed(&nominal, closure(rm, r0, noise)),
        closure_of_recalibrated: closed(&recalibrated, closure(rm, rc, noise)),
        ratio_to_floor: Interval {
            value: ratio,
            interval_95: over.map_or([0.0, ratio], |ends| ends.map(|end| end.max(0.0).sqrt())),
        },
        noise_floor: floor,
        last_third: last_third.map(f64::sqrt),
        held_out: "segments of about six periods (without a spring: three time constants), fitted to the even ones and \
                   scored on the odd ones and the other way round; on the scored segments only the start states are \
                   fitted. Fewer than eight segments: blocks of at least three quarters of a period, a quarter of \
                   them held out at a time, nothing fitted to these"
            .to_owned(),
    }
}

/// Mean paired difference of squares by segment over its standard error: by how many standard errors `after` is better.
pub(crate) fn paired(before: &[DVector<f64>], after: &[DVector<f64>]) -> f64 {
    let differences: Vec<f64> =
        before.iter().zip(after).map(|(b, a)| b.norm_squared() - a.norm_squared()).collect();
    let (mean, error) = crate::noise::statistics::mean_and_error(&differences);
    if error > 0.0 { mean / error } else { 0.0 }
}
