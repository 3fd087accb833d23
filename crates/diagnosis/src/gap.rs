//! How far the gap shrinks, with intervals.

use crate::answer::{Gap, Interval};
use crate::held_out::HeldOut;
use crate::noise::NoiseFloor;
use crate::statistics::quantile;
use nalgebra::DVector;
use rand::RngExt;
use seed::Seed;

/// Draws of the bootstrap.
const DRAWS: usize = 1000;

/// Held-out residuals of the three simulators, and of the free latent torque.
pub(crate) struct Stages<'a> {
    pub(crate) nominal: &'a HeldOut,
    pub(crate) recalibrated: &'a HeldOut,
    pub(crate) repaired: &'a HeldOut,
    pub(crate) ceiling: &'a [DVector<f64>],
}

/// Sums by segment: squares and degrees of freedom.
fn sums(held: &HeldOut) -> Vec<(f64, f64)> {
    let freedom = |e: &DVector<f64>| (e.len() as f64 - held.starts as f64).max(1.0);
    held.residuals.iter().map(|e| (e.norm_squared(), freedom(e))).collect()
}

fn mean_square(sums: &[(f64, f64)], chosen: &[usize]) -> f64 {
    let picked = || chosen.iter().filter_map(|index| sums.get(*index));
    picked().map(|s| s.0).sum::<f64>() / picked().map(|s| s.1).sum::<f64>().max(1.0)
}

fn closure(after: f64, before: f64, noise: f64) -> f64 {
    let excess = before - noise;
    if excess > 0.0 { 1.0 - (after - noise) / excess } else { 0.0 }
}

/// The gap. Intervals by a paired bootstrap over segments: the same segments are drawn for all simulators and for the noise
/// floor, whose squares and count come by segment.
pub(crate) fn gap(
    stages: &Stages<'_>,
    (floor, floors): (NoiseFloor, &[(f64, f64)]),
    last_third: [f64; 2],
    unit: &'static str,
    seed: &Seed,
) -> Gap {
    let [nominal, recalibrated, repaired] = [stages.nominal, stages.recalibrated, stages.repaired].map(sums);
    let all: Vec<usize> = (0..nominal.len()).collect();
    let noise = floor.value * floor.value;
    let mut generator = seed.child("segments").generator();
    let (mut closures, mut further, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..DRAWS {
        let drawn: Vec<usize> = all.iter().map(|_| generator.random_range(0..all.len().max(1))).collect();
        let after = mean_square(&repaired, &drawn);
        // The floor is an estimate too, from the same segments.
        let noise = mean_square(floors, &drawn);
        closures.push(closure(after, mean_square(&nominal, &drawn), noise));
        further.push(closure(after, mean_square(&recalibrated, &drawn), noise));
        ratios.push((after / noise).sqrt());
    }
    let interval = |value: f64, draws: &[f64]| Interval {
        value,
        interval_95: [quantile(draws, 0.025), quantile(draws, 0.975)],
    };
    let at = |sums: &[(f64, f64)]| mean_square(sums, &all);
    let (r0, rc, rm) = (at(&nominal), at(&recalibrated), at(&repaired));
    let freedom: f64 = repaired.iter().map(|s| s.1).sum();
    let left: f64 = stages.ceiling.iter().map(DVector::norm_squared).sum();
    Gap {
        unit,
        nominal: r0.sqrt(),
        recalibrated: rc.sqrt(),
        repaired: rm.sqrt(),
        ceiling: (left / freedom.max(1.0)).sqrt(),
        closure: interval(closure(rm, r0, noise), &closures),
        closure_of_recalibrated: interval(closure(rm, rc, noise), &further),
        ratio_to_floor: interval((rm / noise).sqrt(), &ratios),
        noise_floor: floor,
        last_third: last_third.map(f64::sqrt),
        held_out: "segments of about six periods (without a spring: three time constants), fitted to the even ones and \
                   scored on the odd ones and the other way round; on the scored segments only the start states are \
                   fitted"
            .to_owned(),
    }
}

/// Mean paired difference of squares by segment over its standard error: by how many standard errors `after` is better.
pub(crate) fn paired(before: &[DVector<f64>], after: &[DVector<f64>]) -> f64 {
    let differences: Vec<f64> =
        before.iter().zip(after).map(|(b, a)| b.norm_squared() - a.norm_squared()).collect();
    let (mean, error) = crate::statistics::mean_and_error(&differences);
    if error > 0.0 { mean / error } else { 0.0 }
}
