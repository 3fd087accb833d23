//! Initial points for sets of plain laws from the weak form of the equation of motion.
//!
//! Fits of trajectories begin at the recalibrated simulator. That is a poor start if a missing law outweighs
//! the laws of the simulator: if a spring stiffens strongly under an input, the closest linear oscillator is
//! one that the input does not move. The weak form needs no trajectory. Multiplied by a bump φ and integrated
//! by parts over it, the equation of motion I·ẍ + c·ẋ + k·(x − x₀) = u + Σ bⱼ·τⱼ is linear in I, c, k, k·x₀
//! and bⱼ, with derivatives of φ in place of those of the record (Messenger and Bortz, "Weak SINDy for
//! partial differential equations", Journal of Computational Physics 443, 2021). Noise biases the solution,
//! so it is only a start for a fit.

use crate::data::scales::Scales;
use crate::data::segments::{Data, Segment};
use crate::fit::fitted::{Fit, Point, first_starts};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::model::candidates::Along;
use crate::model::hypothesis::{Calibrated, Hypothesis};
use crate::model::matrices::solve;
use crate::search::archive::Archive;
use crate::search::proposals::CLOSER;
use dynamics::weak_form::test_function;
use dynamics::{Coefficients, Input};
use nalgebra::DMatrix;
use record::Quantity;
use std::f64::consts::TAU;

/// Length of a bump in periods, and the number of bumps that begin within one length.
const PERIODS: f64 = 0.75;
const OVERLAP: f64 = 4.0;

/// Exponent n of a bump (1 − s²)ⁿ.
const EXPONENT: i32 = 4;

/// Fewest samples in a bump.
const FEWEST: usize = 8;

/// Fewest bumps for each unknown.
const ROWS: usize = 4;

/// Fits the plain sets that the weak form prefers, one of each size, if they begin closer to the data than
/// any fit of the archive ended.
pub(crate) fn from_weak_form(data: &Data, calibrated: &Fit, candidates: &[Candidate], archive: &mut Archive) {
    let laws: Vec<Candidate> = candidates.iter().copied().filter(|law| law.is_plain()).collect();
    let Some(equations) = Equations::of(data, calibrated, &laws) else { return };
    for size in 1..=laws.len() {
        let sets = (0_u32..1 << laws.len()).filter(|set| set.count_ones() as usize == size);
        let solved = sets.filter_map(|set| equations.solved(data, &calibrated.hypothesis, set));
        let Some(best) = solved.min_by(|a, b| a.squares.total_cmp(&b.squares)) else { continue };
        let ended = archive.fits.iter().map(|fit| fit.squares).fold(f64::INFINITY, f64::min);
        let starts = first_starts(data, &best.hypothesis);
        let point = Point { globals: best.globals, starts };
        let begun = fit(data, &best.hypothesis, point, Moving::Starts, Stopping::SEARCH);
        if let Ok(begun) = begun.as_ref()
            && begun.squares < CLOSER * ended
            && let Ok(set) = fit(data, &best.hypothesis, begun.point.clone(), Moving::All, Stopping::SEARCH)
        {
            archive.admit(data, set);
        }
    }
}

/// Linear equations of the weak form, one row for each bump.
struct Equations {
    /// ∫φ̈·x, −∫φ̇·x, ∫φ·x and −∫φ: the factors of inertia, damping, stiffness, and stiffness times rest
    /// angle.
    oscillator: Vec<[f64; 4]>,
    /// ∫φ·u, plus the integrals of the torques of known effects.
    torque: Vec<f64>,
    /// ∫φ·τ of every law's columns.
    laws: Vec<(Candidate, Vec<Vec<f64>>)>,
}

/// Set with coefficients, and the squares that the equations leave.
struct Solved {
    hypothesis: Hypothesis,
    globals: Vec<f64>,
    squares: f64,
}

impl Equations {
    /// Returns the equations of a data set; `None` if the sensor does not show the position, if there are no
    /// laws, or if there are too few samples.
    fn of(data: &Data, calibrated: &Fit, laws: &[Candidate]) -> Option<Self> {
        if data.quantity != Quantity::Position || laws.is_empty() {
            return None;
        }
        let hypothesis = &calibrated.hypothesis;
        let mut all = Self {
            oscillator: Vec::new(),
            torque: Vec::new(),
            laws: laws.iter().map(|law| (*law, Vec::new())).collect(),
        };
        let nominal = hypothesis.nominal.coefficients();
        let units = |law: &Candidate| {
            let shape = law.shapes(&data.facts).into_iter().next();
            shape.map_or_else(Vec::new, |shape| law.unit_values(&shape, &data.facts))
        };
        let known =
            hypothesis.known.iter().map(|own| (own.candidate, vec![own.candidate.values(&own.stated)]));
        let known: Vec<(Candidate, Vec<Vec<f64>>)> = known.collect();
        for segment in &data.segments {
            let seen = Seen::of(data, segment, nominal.input_gain);
            let columns =
                |law: Candidate, values: &[Vec<f64>]| seen.columns(law, values, &data.facts, &nominal);
            let own: Vec<Vec<Vec<f64>>> = laws.iter().map(|law| columns(*law, &units(law))).collect();
            let stated: Vec<Vec<f64>> =
                known.iter().flat_map(|(law, values)| columns(*law, values)).collect();
            let ones = vec![1.0; segment.times.len()];
            for bump in bumps(&segment.times, PERIODS * TAU / data.facts.frequency) {
                let integral = |values: &[f64]| {
                    let [integral, ..] = bump.integrals(values);
                    integral
                };
                let [position, slope, bend] = bump.integrals(&segment.values);
                all.oscillator.push([bend, -slope, position, -integral(&ones)]);
                let acting = std::iter::once(&seen.input).chain(&stated);
                all.torque.push(acting.map(|torque| integral(torque)).sum());
                for ((_, rows), columns) in all.laws.iter_mut().zip(&own) {
                    rows.push(columns.iter().map(|column| integral(column)).collect());
                }
            }
        }
        (!all.torque.is_empty()).then_some(all)
    }

    /// Solves the equations for a set by least squares; the bits of `set` are its members. `None` if a
    /// coefficient that cannot be negative is.
    fn solved(&self, data: &Data, hypothesis: &Hypothesis, set: u32) -> Option<Solved> {
        let members = self.laws.iter().enumerate().filter(|(place, _)| set >> place & 1 == 1);
        let members: Vec<&(Candidate, Vec<Vec<f64>>)> = members.map(|(_, law)| law).collect();
        let (oscillator, sizes, squares) = self.regressed(hypothesis, &members)?;
        let of_oscillator = |(which, stated): (&Calibrated, f64)| match which.free() {
            Some(_) => which.of(&oscillator),
            None => stated,
        };
        let calibrated = hypothesis.calibrated.iter().zip(hypothesis.nominal_point());
        let mut globals: Vec<f64> = calibrated.map(of_oscillator).collect();
        let mut sizes = sizes.as_slice();
        for (law, _) in &members {
            let shape = law.shapes(&data.facts).into_iter().next()?;
            let (own, rest) = sizes.split_at_checked(law.unit_values(&shape, &data.facts).len())?;
            sizes = rest;
            if law.is_non_negative() && own.iter().any(|size| *size < 0.0) {
                return None;
            }
            globals.extend(law.linear_parameters(&shape, own));
        }
        let set: Vec<Candidate> = members.iter().map(|(law, _)| *law).collect();
        Some(Solved { hypothesis: hypothesis.with(&set), globals, squares })
    }

    /// Returns the oscillator's coefficients, the laws' sizes, and the squares that they leave. Coefficients
    /// that are not calibrated keep their stated values.
    fn regressed(
        &self,
        hypothesis: &Hypothesis,
        laws: &[&(Candidate, Vec<Vec<f64>>)],
    ) -> Option<(Coefficients<f64>, Vec<f64>, f64)> {
        let stated = hypothesis.nominal.coefficients();
        let mut terms =
            [stated.inertia, stated.damping, stated.stiffness, stated.stiffness * stated.rest_angle];
        let free: Vec<bool> =
            Calibrated::PLAIN.iter().map(|own| hypothesis.calibrated.contains(own)).collect();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut right = Vec::new();
        for (row, (oscillator, torque)) in self.oscillator.iter().zip(&self.torque).enumerate() {
            let both = || oscillator.iter().zip(terms).zip(&free);
            let held = both().filter(|(_, free)| !**free).map(|((term, value), _)| term * value);
            right.push(torque - held.sum::<f64>());
            let own = both().filter(|(_, free)| **free).map(|((term, _), _)| *term);
            let laws = laws.iter().filter_map(|(_, law)| law.get(row)).flatten().map(|term| -term);
            rows.push(own.chain(laws).collect());
        }
        let (solution, squares) = least_squares(&rows, &right)?;
        let mut found = solution.into_iter();
        for (term, _) in terms.iter_mut().zip(&free).filter(|(_, free)| **free) {
            *term = found.next()?;
        }
        let [inertia, damping, stiffness, moment] = terms;
        let is_spring = stated.stiffness > 0.0;
        if inertia <= 0.0 || (is_spring && stiffness <= 0.0) {
            return None;
        }
        let rest_angle = if is_spring { moment / stiffness } else { stated.rest_angle };
        let found_oscillator =
            Coefficients { inertia, damping: damping.max(0.0), stiffness, rest_angle, ..stated };
        Some((found_oscillator, found.collect(), squares))
    }
}

/// Returns the least-squares solution of an overdetermined system, and the squares that it leaves.
fn least_squares(rows: &[Vec<f64>], right: &[f64]) -> Option<(Vec<f64>, f64)> {
    let count = rows.first()?.len();
    if rows.len() < ROWS * count {
        return None;
    }
    let design = DMatrix::from_fn(rows.len(), count, |row, column| {
        // Every row has the same number of terms.
        rows.get(row).and_then(|row| row.get(column)).copied().unwrap_or(0.0)
    });
    let right = DMatrix::from_column_slice(right.len(), 1, right);
    let solution = solve(&design.tr_mul(&design), &design.tr_mul(&right))?;
    let squares = (right - &design * &solution).norm_squared();
    let solution = solution.as_slice().to_vec();
    solution.iter().all(|value| value.is_finite()).then_some((solution, squares))
}

/// Segment with the velocity and the input torque at its samples.
struct Seen<'s> {
    segment: &'s Segment,
    velocity: Vec<f64>,
    /// Torque of the input.
    input: Vec<f64>,
    command: Option<&'s Input>,
}

impl<'s> Seen<'s> {
    fn of(data: &'s Data, segment: &'s Segment, gain: f64) -> Self {
        let command = data.inputs.get(segment.record).and_then(Option::as_ref);
        // Without an input there is no torque.
        let input = segment.times.iter().map(|time| command.map_or(0.0, |input| gain * input.at(*time)));
        Self { segment, velocity: slopes(&segment.times, &segment.values), input: input.collect(), command }
    }

    /// Returns the torques of an effect at the samples, one series for each of the values.
    fn columns(
        &self,
        law: Candidate,
        values: &[Vec<f64>],
        facts: &Scales,
        nominal: &Coefficients<f64>,
    ) -> Vec<Vec<f64>> {
        let along = Along {
            times: &self.segment.times,
            position: &self.segment.values,
            velocity: &self.velocity,
            observed: &self.segment.values,
            rate: &self.velocity,
            input: &self.input,
            command: self.command,
            first: self.segment.first,
            facts,
            nominal,
            respond: &|torque: &[f64]| torque.to_vec(),
        };
        law.system()
            .map_or_else(Vec::new, |effect| values.iter().map(|own| along.response_to(effect, own)).collect())
    }
}

/// Returns the slopes at the samples, from those before and after. The slope at an end is that of its
/// neighbor.
fn slopes(times: &[f64], values: &[f64]) -> Vec<f64> {
    let inner = times.iter().zip(times.iter().skip(2)).zip(values.iter().zip(values.iter().skip(2)));
    let inner: Vec<f64> = inner.map(|((from, to), (low, high))| (high - low) / (to - from)).collect();
    let ends = [inner.first().copied(), inner.last().copied()];
    // Fewer than three samples determine no slope.
    let [first, last] = ends.map(|end| end.unwrap_or(0.0));
    std::iter::once(first).chain(inner).chain([last]).take(times.len()).collect()
}

/// Weights of the samples in the integrals of a function times φ, φ̇ and φ̈, with φ = (1 − s²)ⁿ for |s| < 1.
struct Bump {
    first: usize,
    weights: Vec<[f64; 3]>,
}

impl Bump {
    /// Creates a bump with a half width about a center, by the trapezoidal rule; `None` if it covers too few
    /// samples.
    fn about(center: f64, half: f64, times: &[f64]) -> Option<Self> {
        let first = times.partition_point(|time| *time <= center - half);
        let end = times.partition_point(|time| *time < center + half);
        if end < first + FEWEST {
            return None;
        }
        let weight = |at: usize| {
            let time = *times.get(at)?;
            // φ is 0 at the ends of a segment.
            let before = at.checked_sub(1).and_then(|before| times.get(before)).unwrap_or(&time);
            let width = 0.5 * (times.get(at + 1).unwrap_or(&time) - before);
            let [phi, slope, bend] = test_function((time - center) / half, EXPONENT);
            Some([phi, slope / half, bend / (half * half)].map(|phi| phi * width))
        };
        Some(Self { first, weights: (first..end).filter_map(weight).collect() })
    }

    /// Returns the integrals of a series times φ, φ̇ and φ̈.
    fn integrals(&self, values: &[f64]) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (weights, value) in self.weights.iter().zip(values.iter().skip(self.first)) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += weight * value;
            }
        }
        sums
    }
}

/// Returns bumps of a length over a segment, [`OVERLAP`] of which begin within one length.
fn bumps(times: &[f64], length: f64) -> Vec<Bump> {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return Vec::new() };
    let count = ((last - first - length) / length * OVERLAP).floor();
    if count < 0.0 {
        return Vec::new();
    }
    let center = |number: usize| first + length * (0.5 + number as f64 / OVERLAP);
    (0..=count as usize).filter_map(|number| Bump::about(center(number), 0.5 * length, times)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Bump, slopes};

    /// ∫(1 − s²)⁴ ds = 256/315. Integrated by parts, φ̈ gives the second derivative of a parabola, φ̇ minus
    /// the slope of a line.
    #[test]
    fn bumps_differentiate_what_they_are_integrated_with() {
        let times: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        let bump = Bump::about(1.0, 0.8, &times).unwrap();
        let area = 0.8 * 256.0 / 315.0;
        let of = |f: fn(f64) -> f64| times.iter().map(|t| f(*t)).collect::<Vec<f64>>();
        let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-6, "{found} {wanted}");
        let [whole, ..] = bump.integrals(&of(|_| 1.0));
        near(whole, area);
        let [_, slope, _] = bump.integrals(&of(|t| 3.0 * t));
        near(slope, -3.0 * area);
        let [.., bend] = bump.integrals(&of(|t| 3.0 * t * t));
        near(bend, 6.0 * area);
    }

    #[test]
    fn slopes_of_a_line_are_its_slope() {
        for slope in slopes(&[0.0, 0.1, 0.3, 0.35], &[1.0, 1.2, 1.6, 1.7]) {
            assert!((slope - 2.0).abs() < 1e-12, "{slope}");
        }
        assert_eq!(slopes(&[0.0, 1.0], &[0.0, 1.0]), [0.0, 0.0]);
    }
}
