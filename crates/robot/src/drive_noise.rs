//! Noise of a joint's known torques, the gain of its torque sensor, and the sensor's offset in each recording.
//!
//! The torques that the model leaves unexplained move the joint's oscillator, as the diagnosis sees it. A few
//! columns that smooth laws, dry friction and an armature would leave are fitted to this motion, with an offset and a
//! start state for each recording. What remains is taken for the response to white noise in the drive: the errors of the torque
//! sensor, of the smoothed motion and of what the model idealizes. Its variance is S/(2ck) for noise of the two-sided
//! spectral density S.
//!
//! A sensor that reads every torque too large by the same part, as one with a wrong torque constant does, leaves a multiple of the
//! torque itself. The model's masses tell it: along a joint that carries nothing but a constant inertia, other columns
//! imitate the torque's, and the gain stays 1.

use crate::tracking::Tracking;

/// Motion and unexplained torque of a joint at one sample.
pub(crate) struct Sample {
    pub(crate) time: f64,
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    /// Torque that the model leaves unexplained.
    pub(crate) unexplained: f64,
    /// Torque of the drive as recorded.
    pub(crate) torque: f64,
}

/// Speed, relative to the root mean square, below which dry friction's direction counts as changing.
const SLOW: f64 = 0.05;

/// Largest part of the independent numbers of a motion that its columns may take.
const MOST_TAKEN: f64 = 0.7;

/// Square of the standard errors by which a gain has to differ from 1.
const SIGNIFICANT: f64 = 9.0;

/// Squares that the torque's motion must have beside the other columns, relative to the noise's: noise in the torque itself pulls a
/// gain toward 0, and by no more than a fiftieth then.
const ALONE: f64 = 50.0;

/// Gain of a torque sensor: the torque is so many times what it reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Torque over reading.
    pub value: f64,
    /// Standard error.
    pub std_error: f64,
}

/// Estimate for one joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive {
    /// Two-sided spectral density of the noise, in (N m)² s or N² s.
    pub(crate) density: f64,
    /// Constant torque in the drive, by recording, in N m or N.
    pub(crate) offsets: Vec<f64>,
    /// Share of the squares of dry friction's motion that the other columns do not imitate.
    pub(crate) friction_alone: f64,
    /// Gain of the torque sensor; `None` if these recordings do not tell it from 1.
    pub(crate) gain: Option<Gain>,
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

/// Columns of motion in all recordings that noise is estimated beside, and the motion that they are fitted to.
struct Columns {
    /// Laws, then for each recording an offset and the two parts of its start state.
    columns: Vec<Vec<f64>>,
    /// Number of the laws.
    laws: usize,
    /// Motion under the recorded torques.
    torque: Vec<f64>,
    target: Vec<f64>,
    seconds: f64,
}

impl Columns {
    fn of(tracking: &Tracking, recordings: &[Vec<Sample>], turns: bool) -> Self {
        let all = || recordings.iter().flatten();
        let count = all().count();
        let speed = (all().map(|own| own.velocity.powi(2)).sum::<f64>() / count.max(1) as f64).sqrt();
        let speed = speed.max(f64::MIN_POSITIVE);
        let omega = (tracking.stiffness / tracking.inertia).sqrt();
        let (mut columns, mut offsets): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        let (mut torque, mut target, mut seconds) = (Vec::new(), Vec::new(), 0.0);
        for samples in recordings {
            let before = target.len();
            let times: Vec<f64> = samples.iter().map(|own| own.time).collect();
            seconds += times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
            let laws = laws(samples, speed, turns);
            columns.resize(laws.len(), Vec::new());
            for (column, law) in columns.iter_mut().zip(&laws) {
                column.extend(moved(tracking, &times, law, [0.0; 2]));
            }
            let under = |of: fn(&Sample) -> f64| {
                moved(tracking, &times, &samples.iter().map(of).collect::<Vec<f64>>(), [0.0; 2])
            };
            torque.extend(under(|own| own.torque));
            target.extend(under(|own| own.unexplained));
            for (torque, start) in [(1.0, [0.0; 2]), (0.0, [1.0, 0.0]), (0.0, [0.0, omega])] {
                let mut column = vec![0.0; before];
                column.extend(moved(tracking, &times, &vec![torque; times.len()], start));
                column.resize(count, 0.0);
                offsets.push(column);
            }
        }
        let laws = columns.len();
        columns.extend(offsets);
        Self { columns, laws, torque, target, seconds }
    }

    /// Returns the coefficients of all columns and the squares that they leave.
    fn fit(&self) -> (Vec<f64>, f64) {
        let found = fitted(&self.columns, &self.target);
        let left = squares_left(&self.columns, &found, self.target.clone());
        (found, left)
    }

    /// Returns the squares of a column that `others` do not imitate.
    fn alone(column: &[f64], others: &[Vec<f64>]) -> f64 {
        squares_left(others, &fitted(others, column), column.to_vec())
    }

    /// Returns the part of the independent numbers that the columns take, at most [`MOST_TAKEN`].
    fn taken(&self, numbers: f64) -> f64 {
        (self.columns.len() as f64 / numbers.max(f64::MIN_POSITIVE)).min(MOST_TAKEN)
    }

    /// Returns the gain of the torque sensor if it is not 1, from the recorded torques as one column more.
    fn gain(&self, numbers: f64) -> Option<Gain> {
        let mut columns = self.columns.clone();
        columns.push(self.torque.clone());
        let found = fitted(&columns, &self.target);
        let left = squares_left(&columns, &found, self.target.clone());
        let alone = Self::alone(&self.torque, &self.columns);
        let freedom = numbers * (1.0 - self.taken(numbers)) - 1.0;
        let excess = *found.last()?;
        let std_error = (left / freedom.max(1.0) / alone).sqrt();
        let is_told = excess.powi(2) > SIGNIFICANT * std_error.powi(2) && alone > ALONE * left;
        (is_told && excess > -1.0).then_some(Gain { value: 1.0 + excess, std_error })
    }
}

/// Estimates noise, gain and offsets of the drive of a joint from its recordings. `turns` is `true` for a joint whose
/// coordinate is an angle.
pub(crate) fn drive_noise(tracking: &Tracking, recordings: &[Vec<Sample>], turns: bool) -> Drive {
    let mut own = Columns::of(tracking, recordings, turns);
    let numbers = independent(tracking, own.seconds);
    let gain = own.gain(numbers);
    if let Some(gain) = gain {
        for (target, torque) in own.target.iter_mut().zip(&own.torque) {
            *target -= (gain.value - 1.0) * torque;
        }
    }
    let (found, left) = own.fit();
    let variance = left / own.target.len().max(1) as f64;
    let friction_alone = own.columns.split_first().map_or(0.0, |(friction, others)| {
        let all: f64 = friction.iter().map(|own| own * own).sum();
        Columns::alone(friction, others) / all.max(f64::MIN_POSITIVE)
    });
    Drive {
        density: 2.0 * tracking.damping * tracking.stiffness * variance / (1.0 - own.taken(numbers)),
        offsets: found.iter().skip(own.laws).step_by(3).copied().collect(),
        friction_alone,
        gain,
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
                let torque = (8.0 * f64::from(at) * 2e-3).sin();
                let time = f64::from(at) * 2e-3;
                let (position, velocity, acceleration) = (
                    (8.0 * time).sin() + (3.0 * time).cos(),
                    8.0 * (8.0 * time).cos() - 3.0 * (3.0 * time).sin(),
                    -64.0 * (8.0 * time).sin() - 9.0 * (3.0 * time).cos(),
                );
                let noise = 0.02 * 12.0_f64.sqrt() * uniform();
                let unexplained = offset + 0.1 * velocity.signum() + 0.002 * acceleration + noise;
                Sample { time, position, velocity, acceleration, unexplained, torque }
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

    /// Samples of a motion of two frequencies under a torque whose sensor reads a tenth too much. `other` is the frequency of
    /// a part of the torque that moves other joints.
    fn read_too_much(other: f64) -> Vec<Sample> {
        let sample = |at: u32| {
            let time = f64::from(at) * 2e-3;
            let torque = 0.5 * (8.0 * time).sin() + (other * time).sin();
            // A residue of the torque's own kind, too small and too fast to matter.
            let noise = 2e-3 * (at.wrapping_mul(2_654_435_761) % 1000) as f64 / 1000.0;
            Sample {
                time,
                position: (8.0 * time).sin(),
                velocity: 8.0 * (8.0 * time).cos(),
                acceleration: -64.0 * (8.0 * time).sin(),
                unexplained: -0.1 * torque + noise,
                torque,
            }
        };
        (0..10_000).map(sample).collect()
    }

    #[test]
    fn a_torque_sensor_that_reads_too_much_is_told_where_the_model_needs_the_torque_elsewhere() {
        let tracking = Tracking { inertia: 0.05, damping: 0.7, stiffness: 5.0 };
        let gain = drive_noise(&tracking, &[read_too_much(3.0)], true).gain;
        assert!(gain.is_some_and(|gain| (gain.value - 0.9).abs() < 5e-3), "{gain:?}");
        // Along one sine, an armature imitates the whole torque.
        let gain = drive_noise(&tracking, &[read_too_much(8.0)], true).gain;
        assert!(gain.is_none(), "{gain:?}");
    }
}
