//! Noise of a joint's known torques, and the offset of its torque sensor in each recording.
//!
//! The torques that the model leaves unexplained move the joint's oscillator, as the diagnosis sees it. A few
//! columns that smooth laws, dry friction and an armature would leave are fitted to this motion, with an offset and a
//! start state for each recording. What remains is taken for the response to white noise in the drive: the errors of the torque
//! sensor, of the smoothed motion and of what the model idealizes. Its variance is S/(2ck) for noise of the two-sided
//! spectral density S.

use crate::tracking::Tracking;

/// Motion and unexplained torque of a joint at one sample.
pub(crate) struct Sample {
    pub(crate) time: f64,
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    /// Torque that the model leaves unexplained.
    pub(crate) unexplained: f64,
}

/// Speed, relative to the root mean square, below which dry friction's direction counts as changing.
const SLOW: f64 = 0.05;

/// Largest part of the independent numbers of a motion that its columns may take.
const MOST_TAKEN: f64 = 0.7;

/// Estimate for one joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive {
    /// Two-sided spectral density of the noise, in (N m)² s or N² s.
    pub(crate) density: f64,
    /// Constant torque in the drive, by recording, in N m or N.
    pub(crate) offsets: Vec<f64>,
    /// Share of the squares of dry friction's motion that the other columns do not imitate.
    pub(crate) friction_alone: f64,
}

/// Returns the motion of an oscillator at rest under torques at times, linear in between.
pub(crate) fn moved(tracking: &Tracking, times: &[f64], torques: &[f64], start: [f64; 2]) -> Vec<f64> {
    let Tracking { inertia, damping, stiffness } = *tracking;
    let [mut x, mut v] = start;
    let mut path = vec![x];
    let steps = times.iter().zip(times.iter().skip(1)).zip(torques.iter().zip(torques.iter().skip(1)));
    for ((from, to), (first, last)) in steps {
        let h = to - from;
        // The implicit midpoint rule, which is exact enough for a step far below the period.
        let rate = 0.5 * (first + last) - stiffness * (x + 0.5 * h * v) - damping * v;
        let change = h * rate / (inertia + 0.5 * h * damping + 0.25 * h * h * stiffness);
        x += h * (v + 0.5 * change);
        v += change;
        path.push(x);
    }
    path
}

/// Returns the columns of laws that a joint may lack, by sample.
fn laws(samples: &[Sample], speed: f64, turns: bool) -> Vec<Vec<f64>> {
    let column = |of: &dyn Fn(&Sample) -> f64| samples.iter().map(of).collect::<Vec<f64>>();
    let mut columns = vec![
        column(&|own| (own.velocity / (SLOW * speed)).tanh()),
        column(&|own| own.velocity),
        column(&|own| own.velocity * own.velocity.abs()),
        column(&|own| own.acceleration),
        column(&|own| own.position),
    ];
    if turns {
        columns.push(column(&|own| own.position.sin()));
        columns.push(column(&|own| own.position.cos()));
    }
    columns
}

/// Solves the normal equations of columns, scaled to unit length. A direction that the others hold already takes no
/// part. Returns the coefficients.
pub(crate) fn fitted(columns: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let dot = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
    let lengths: Vec<f64> = columns.iter().map(|own| dot(own, own).sqrt().max(f64::MIN_POSITIVE)).collect();
    let row = |(at, one): (usize, &Vec<f64>)| -> Vec<f64> {
        let own = lengths.get(at).copied().unwrap_or(1.0);
        let cells = columns.iter().zip(&lengths).enumerate();
        // A small ridge keeps columns apart that are alike.
        cells
            .map(|(other, (column, length))| {
                dot(one, column) / own / length + if other == at { 1e-9 } else { 0.0 }
            })
            .collect()
    };
    let matrix: Vec<Vec<f64>> = columns.iter().enumerate().map(row).collect();
    let right = columns.iter().zip(&lengths).map(|(own, length)| dot(own, right) / length).collect();
    let Ok(solution) = dynamics::tree::solved(&matrix, right) else { return vec![0.0; columns.len()] };
    solution.iter().zip(&lengths).map(|(own, length)| own / length).collect()
}

/// Returns the number of independent numbers in the motion of an oscillator: two for each second and hertz of its noise bandwidth,
/// k/(4c).
pub(crate) fn independent(tracking: &Tracking, seconds: f64) -> f64 {
    2.0 * seconds * tracking.stiffness / (4.0 * tracking.damping)
}

/// Returns the torque of dry friction of unit size in the direction of the motion.
pub(crate) fn directions(samples: &[Sample]) -> Vec<f64> {
    let speed = samples.iter().map(|own| own.velocity.powi(2)).sum::<f64>() / samples.len().max(1) as f64;
    let slow = (SLOW * speed.sqrt()).max(f64::MIN_POSITIVE);
    samples.iter().map(|own| (own.velocity / slow).tanh()).collect()
}

/// Returns the sum of the squares that columns with coefficients leave.
pub(crate) fn squares_left(columns: &[Vec<f64>], coefficients: &[f64], mut target: Vec<f64>) -> f64 {
    for (column, coefficient) in columns.iter().zip(coefficients) {
        for (left, own) in target.iter_mut().zip(column) {
            *left -= coefficient * own;
        }
    }
    target.iter().map(|own| own * own).sum()
}

/// Estimates noise and offsets of the drive of a joint from its recordings. `turns` is `true` for a joint whose
/// coordinate is an angle.
pub(crate) fn drive_noise(tracking: &Tracking, recordings: &[Vec<Sample>], turns: bool) -> Drive {
    let all = || recordings.iter().flatten();
    let count = all().count();
    let speed = (all().map(|own| own.velocity.powi(2)).sum::<f64>() / count.max(1) as f64).sqrt();
    let speed = speed.max(f64::MIN_POSITIVE);
    let omega = (tracking.stiffness / tracking.inertia).sqrt();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut offsets: Vec<Vec<f64>> = Vec::new();
    let mut target = Vec::new();
    let mut seconds = 0.0;
    for (at, samples) in recordings.iter().enumerate() {
        let times: Vec<f64> = samples.iter().map(|own| own.time).collect();
        seconds += times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
        let laws = laws(samples, speed, turns);
        if columns.is_empty() {
            columns = vec![Vec::new(); laws.len()];
        }
        for (column, law) in columns.iter_mut().zip(&laws) {
            column.extend(moved(tracking, &times, law, [0.0; 2]));
        }
        let unexplained: Vec<f64> = samples.iter().map(|own| own.unexplained).collect();
        target.extend(moved(tracking, &times, &unexplained, [0.0; 2]));
        let none = vec![0.0; times.len()];
        for (torque, start) in
            [(vec![1.0; times.len()], [0.0; 2]), (none.clone(), [1.0, 0.0]), (none, [0.0, omega])]
        {
            let own = moved(tracking, &times, &torque, start);
            let before: usize = recordings.iter().take(at).map(Vec::len).sum();
            let mut column = vec![0.0; before];
            column.extend(own);
            column.resize(count, 0.0);
            offsets.push(column);
        }
    }
    let laws = columns.len();
    columns.extend(offsets);
    let found = fitted(&columns, &target);
    let left = squares_left(&columns, &found, target);
    let variance = left / count.max(1) as f64;
    let friction_alone = columns.split_first().map_or(0.0, |(friction, others)| {
        let all: f64 = friction.iter().map(|own| own * own).sum();
        squares_left(others, &fitted(others, friction), friction.clone()) / all.max(f64::MIN_POSITIVE)
    });
    let numbers = independent(tracking, seconds);
    let taken = (columns.len() as f64 / numbers.max(f64::MIN_POSITIVE)).min(MOST_TAKEN);
    Drive {
        density: 2.0 * tracking.damping * tracking.stiffness * variance / (1.0 - taken),
        offsets: found.iter().skip(laws).step_by(3).copied().collect(),
        friction_alone,
    }
}

#[cfg(test)]
mod tests {
    use super::{Sample, drive_noise};
    use crate::tracking::Tracking;

    /// White noise of 0.02 N m at 500 samples a second has the density 0.02²/500. Friction, an armature and an offset
    /// of the sensor do not change what is found.
    #[test]
    fn noise_and_offset_are_found_beside_friction() {
        let tracking = Tracking { inertia: 0.05, damping: 0.7, stiffness: 5.0 };
        let mut state = 3_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
        };
        let mut recording = |offset: f64| -> Vec<Sample> {
            let sample = |at: u32| {
                let time = f64::from(at) * 2e-3;
                let (position, velocity, acceleration) = (
                    (8.0 * time).sin() + (3.0 * time).cos(),
                    8.0 * (8.0 * time).cos() - 3.0 * (3.0 * time).sin(),
                    -64.0 * (8.0 * time).sin() - 9.0 * (3.0 * time).cos(),
                );
                let noise = 0.02 * 12.0_f64.sqrt() * uniform();
                let unexplained = offset + 0.1 * velocity.signum() + 0.002 * acceleration + noise;
                Sample { time, position, velocity, acceleration, unexplained }
            };
            (0..10_000).map(sample).collect()
        };
        let found = drive_noise(&tracking, &[recording(0.05), recording(-0.03)], true);
        let expected = 0.02 * 0.02 / 500.0;
        assert!((found.density / expected).log2().abs() < 1.0, "{} {expected}", found.density);
        for (found, truth) in found.offsets.iter().zip([0.05, -0.03]) {
            assert!((found - truth).abs() < 5e-3, "{found} {truth}");
        }
    }
}
