//! Test functions and the integrals against them.

use crate::sloped::Sloped;
use crate::whitening::{Row, Whitening};
use nalgebra::{DMatrix, DVector};
use sparse::{Column, Law, Scaled};

/// Nodes and weights of Gauss-Legendre quadrature on 0..1, exact up to degree 9.
///
/// Reference: Abramowitz, Stegun, Handbook of Mathematical Functions (1964), table 25.4, moved to 0..1.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_45),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Share of each residual's variance that is added as independent, so that the covariance can always be
/// inverted.
///
/// Reference: Bortz, Messenger, Dukic, Bulletin of Mathematical Biology 85 (2023) 110, section 2.2.
const IDENTITY_SHARE: f64 = 1e-10;

/// Smallest share of its variance that the functions before it must leave for a test function to be kept.
const INDEPENDENT: f64 = 1e-6;

/// Function of time that vanishes at the peaks `first` and `last` and outside of them: φ(s) = (1 − u²)^p,
/// with u from −1 at `first` to 1 at `last`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TestFunction {
    first: usize,
    last: usize,
    middle: f64,
    half_width: f64,
    exponent: i32,
    /// Factor that scales the measured side's row to length 1.
    scale: f64,
    /// −∫φ′y ds as weights of y at the peaks, with y linear between them.
    measured: Row,
    /// ∫φθ ds as weights of θ at the peaks, with θ linear between them.
    weights: Row,
}

impl TestFunction {
    fn new(first: usize, last: usize, exponent: i32, times: &[f64]) -> Option<Self> {
        let (from, to) = (*times.get(first)?, *times.get(last)?);
        let mut function = Self {
            first,
            last,
            middle: (from + to) / 2.0,
            half_width: (to - from) / 2.0,
            exponent,
            scale: 1.0,
            measured: Row::zeros(first, last - first + 1),
            weights: Row::zeros(first, last - first + 1),
        };
        for (at, (one, next)) in times.iter().zip(times.iter().skip(1)).enumerate().take(last).skip(first) {
            let step = next - one;
            for (node, weight) in GAUSS {
                let (value, _) = function.at(one + node * step);
                // By parts, −∫φ′y = ∫φy′, and y′ is constant between two peaks.
                function.measured.add(at, -weight * value);
                function.measured.add(at + 1, weight * value);
                function.weights.add(at, weight * value * step * (1.0 - node));
                function.weights.add(at + 1, weight * value * step * node);
            }
        }
        let length = function.measured.dot(&function.measured).sqrt();
        (length.is_finite() && length > 0.0).then(|| {
            function.scale = 1.0 / length;
            function.measured.scale(function.scale);
            function.weights.scale(function.scale);
            function
        })
    }

    /// Returns φ and φ′ at a scaled time.
    fn at(&self, time: f64) -> (f64, f64) {
        let u = (time - self.middle) / self.half_width;
        let base = 1.0 - u * u;
        let lower = base.powi(self.exponent - 1);
        let derivative = -2.0 * u * f64::from(self.exponent) * lower / self.half_width;
        (lower * base * self.scale, derivative * self.scale)
    }
}

/// Returns the first peaks of the test functions of a width: half a width apart, with the last function
/// ending with the record.
fn positions(steps: usize, width: usize) -> impl Iterator<Item = usize> {
    let last = steps.saturating_sub(width);
    (0..last).step_by((width / 2).max(1)).chain([last])
}

/// Linearly independent test functions of a record.
///
/// The narrowest are two steps between peaks wide if `most` allows all of that width; otherwise they are so
/// wide that their number is at most half of `most`. Then the width doubles up to the whole record, until
/// `most` functions are kept. The narrow ones come first because they are the least alike: a set that starts
/// with the wide ones has combinations that nearly vanish at every peak but not between the peaks, and the
/// whitening amplifies these.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TestFunctions {
    functions: Vec<TestFunction>,
    /// Whitening of the measured side, whose scatter is its rows times the scatter of the peaks.
    pub(crate) whitening: Whitening,
}

impl TestFunctions {
    /// Creates test functions over scaled times.
    pub(crate) fn over(scaled: &Scaled, most: usize, exponent: i32) -> Self {
        let steps = scaled.peaks() - 1;
        // A constant added to ln A changes no integral, so that there is one direction fewer than peaks.
        let most = most.min(steps);
        let mut functions: Vec<TestFunction> = Vec::new();
        let mut whitening = Whitening::default();
        let mut width = 2;
        // If not all fit, only half of them are used, to leave room for the wider ones.
        if positions(steps, width).count() > most {
            while positions(steps, width).count() > most / 2 && width < steps {
                width *= 2;
            }
            width = width.min(steps);
        }
        while functions.len() < most && width <= steps {
            for first in positions(steps, width) {
                let Some(function) = TestFunction::new(first, first + width, exponent, &scaled.times) else {
                    continue;
                };
                let products: Vec<f64> =
                    functions.iter().map(|kept| kept.measured.dot(&function.measured)).collect();
                if functions.len() < most && whitening.extend(&products, 1.0, INDEPENDENT) {
                    functions.push(function);
                }
            }
            width = if width < steps { (2 * width).min(steps) } else { steps + 1 };
        }
        Self { functions, whitening }
    }

    /// Returns the number of test functions.
    pub(crate) fn len(&self) -> usize {
        self.functions.len()
    }

    /// Returns −∫φ′x ds of the measured peaks, one entry per function.
    pub(crate) fn measured(&self, values: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.len(), self.functions.iter().map(|function| function.measured.of(values)))
    }

    /// Returns ∫φ·1 and ∫φθ ds of the columns at the measured peaks, one row per function.
    pub(crate) fn terms_at_peaks(&self, columns: &[Column], scaled: &Scaled) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.len(), 1 + columns.len());
        let values = columns.iter().map(|column| {
            let at = scaled.logs.iter().zip(&scaled.times);
            at.map(|(&log, &time)| column.value(log, time)).collect::<Vec<f64>>()
        });
        let all = std::iter::once(vec![1.0; scaled.peaks()]).chain(values);
        for (mut entries, values) in matrix.column_iter_mut().zip(all) {
            for (entry, function) in entries.iter_mut().zip(&self.functions) {
                *entry = function.weights.of(&values);
            }
        }
        matrix
    }

    /// Returns both sides along a law's trajectory, which is also known between the peaks. The left side is
    /// −∫φ′x ds: the trajectory's own integral is exact, and only the residuals at the peaks are taken as
    /// linear between them. The right side is the terms' integrals.
    pub(crate) fn along(
        &self,
        law: &Sloped,
        columns: &[Column],
        scaled: &Scaled,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let curve = Curve::of(law, columns, scaled);
        let differences = scaled.residuals(&law.law.trajectory);
        let mut target = self.measured(&differences);
        let mut matrix = DMatrix::zeros(self.len(), 1 + columns.len());
        for (at, function) in self.functions.iter().enumerate() {
            let mut own = 0.0;
            let mut sums = vec![0.0; 1 + columns.len()];
            for node in curve.between(function.first, function.last) {
                let (value, derivative) = function.at(node.time);
                own -= node.weight * derivative * node.log;
                for (sum, term) in sums.iter_mut().zip(std::iter::once(&1.0).chain(&node.terms)) {
                    *sum += node.weight * value * term;
                }
            }
            if let Some(entry) = target.get_mut(at) {
                *entry += own;
            }
            for (entry, sum) in matrix.row_mut(at).iter_mut().zip(sums) {
                *entry = sum;
            }
        }
        (target, matrix)
    }

    /// Returns the whitening of b − Gc for terms at the measured peaks: the scatter enters both sides, with
    /// −φ′ and with φ·∂(law)/∂x.
    ///
    /// Reference: Bortz, Messenger, Dukic, Bulletin of Mathematical Biology 85 (2023) 110, section 2.2.
    pub(crate) fn whitening_at_peaks(&self, law: &Law, scaled: &Scaled) -> Option<Whitening> {
        let gradients: Vec<f64> = scaled.logs.iter().map(|&log| law.gradient(log)).collect();
        let rows: Vec<Row> = self
            .functions
            .iter()
            .map(|function| function.measured.minus_weighted(&function.weights, &gradients))
            .collect();
        let mut whitening = Whitening::default();
        for (at, row) in rows.iter().enumerate() {
            let products: Vec<f64> = rows.iter().take(at).map(|other| other.dot(row)).collect();
            if !whitening.extend(&products, row.dot(row) * (1.0 + IDENTITY_SHARE), 0.0) {
                return None;
            }
        }
        Some(whitening)
    }

    /// Returns the instruments Z of the weighted regression along a law's trajectory, which requires Zᵀr = 0
    /// of the residuals r at the peaks. A column of ones belongs to the initial value; the others are MᵀC⁻¹G
    /// with the measured side's rows M, their covariance C = MMᵀ and the terms' integrals G. Peaks by
    /// parameters.
    pub(crate) fn instruments(&self, law: &Law, scaled: &Scaled) -> DMatrix<f64> {
        let columns: Vec<Column> = law.terms.iter().map(|(column, _)| *column).collect();
        let slopes =
            law.trajectory.iter().zip(&scaled.times).map(|(&log, &time)| law.rate(log, time)).collect();
        let (_, integrals) = self.along(&Sloped { law: law.clone(), slopes }, &columns, scaled);
        let weights = self.whitening.unapply_all(&self.whitening.apply_all(&integrals));
        let mut instruments = DMatrix::zeros(scaled.peaks(), law.parameters());
        instruments.column_mut(0).fill(1.0);
        for (mut column, weights) in instruments.column_iter_mut().skip(1).zip(weights.column_iter()) {
            let mut sum = vec![0.0; scaled.peaks()];
            for (function, weight) in self.functions.iter().zip(weights.iter()) {
                function.measured.add_to(*weight, &mut sum);
            }
            column.iter_mut().zip(sum).for_each(|(entry, sum)| *entry = sum);
        }
        instruments
    }

    /// Returns the information on a constant law's rate, dx/ds: the squared length of its whitened column,
    /// per variance of the scatter.
    pub(crate) fn information(&self, scaled: &Scaled) -> f64 {
        self.whitening.apply(&self.measured(&scaled.times)).norm_squared()
    }
}

/// Trajectory at the quadrature's nodes.
struct Curve {
    nodes: Vec<Node>,
}

struct Node {
    time: f64,
    /// Weight of the node in an integral over s.
    weight: f64,
    log: f64,
    terms: Vec<f64>,
}

impl Curve {
    /// Interpolates by a cubic between the peaks, with the trajectory's slopes there.
    fn of(law: &Sloped, columns: &[Column], scaled: &Scaled) -> Self {
        let peaks = || scaled.times.iter().zip(&law.law.trajectory).zip(&law.slopes);
        let nodes =
            peaks().zip(peaks().skip(1)).flat_map(|(((from, one), rise), ((to, next), next_rise))| {
                let step = to - from;
                GAUSS.map(|(u, weight)| {
                    let (down, time) = (1.0 - u, from + u * step);
                    // Hermite's cubic.
                    let log = down * down * ((1.0 + 2.0 * u) * one + u * step * rise)
                        + u * u * ((1.0 + 2.0 * down) * next - down * step * next_rise);
                    let terms = columns.iter().map(|column| column.value(log, time)).collect();
                    Node { time, weight: weight * step, log, terms }
                })
            });
        Self { nodes: nodes.collect() }
    }

    /// Returns the nodes between two peaks.
    fn between(&self, first: usize, last: usize) -> impl Iterator<Item = &Node> {
        self.nodes.iter().take(last * GAUSS.len()).skip(first * GAUSS.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use envelope::Envelope;
    use sparse::Term;

    /// Creates an envelope with uneven times.
    fn scaled(peaks: usize, log: impl Fn(f64) -> f64) -> Scaled {
        let times: Vec<f64> = (0..peaks).map(|i| i as f64 + 0.2 * (i as f64 * 1.7).sin()).collect();
        let logs = times.iter().map(|&time| log(time)).collect();
        Scaled::of(&Envelope::new(times, logs, 6.0).unwrap()).unwrap()
    }

    #[test]
    fn integrals_of_a_test_function_are_those_of_the_formula() {
        let scaled = scaled(9, |time| -time);
        for (exponent, area) in [(1, 4.0 / 3.0), (2, 16.0 / 15.0), (3, 32.0 / 35.0)] {
            let function = TestFunction::new(2, 7, exponent, &scaled.times).unwrap();
            let area = area * function.half_width * function.scale;
            // The integral ∫(1 − u²)^p du over −1..1 for p = 1, 2, 3.
            assert!((function.weights.of(&[1.0; 9]) / area - 1.0).abs() < 1e-13);
            // −∫φ′·1 = 0 and −∫φ′s = ∫φ.
            assert!(function.measured.of(&[1.0; 9]).abs() < 1e-14);
            assert!((function.measured.of(&scaled.times) / area - 1.0).abs() < 1e-13);
            assert!((function.measured.dot(&function.measured) - 1.0).abs() < 1e-13);
            let (time, step) = (function.middle + 0.3 * function.half_width, 1e-6);
            let difference = (function.at(time + step).0 - function.at(time - step).0) / (2.0 * step);
            assert!((function.at(time).1 / difference - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn there_are_as_many_as_steps_between_peaks_where_they_fit() {
        let found = [(3, 200), (4, 200), (40, 200), (69, 200), (300, 200), (69, 10)].map(|(peaks, most)| {
            let functions = TestFunctions::over(&scaled(peaks, |time| -time), most, 2);
            (functions.len(), functions.functions.iter().map(|function| function.last).max().unwrap())
        });
        assert_eq!(found, [(1, 2), (3, 3), (39, 39), (68, 68), (145, 299), (7, 68)]);
    }

    #[test]
    fn a_slope_loses_little_where_not_all_fit() {
        for (peaks, most, share) in
            [(69, 200, 1.0 - 1e-12), (300, 200, 0.98), (3000, 200, 0.97), (69, 5, 0.85)]
        {
            let scaled = scaled(peaks, |time| -time);
            let functions = TestFunctions::over(&scaled, most, 2);
            let found = functions.information(&scaled) / scaled.squared_times();
            assert!(found > share, "{peaks} {most}: {found}");
        }
    }

    #[test]
    fn along_an_exact_trajectory_both_sides_agree() {
        // dx/ds = 2s is solved by s² + x(0), which the cubic between the peaks represents exactly.
        let scaled = scaled(20, |time| -(time * time));
        let column = Column::over(Term::Time, &scaled).unwrap();
        let factor = 2.0 / column.derivative(0.0, 0.0);
        let constant = -factor * column.value(0.0, 0.0);
        let trajectory: Vec<f64> = scaled.times.iter().map(|s| s * s).collect();
        let slopes = scaled.times.iter().map(|s| 2.0 * s).collect();
        let law = Sloped::new(constant, vec![(column, factor)], trajectory.clone(), slopes, &scaled);
        let functions = TestFunctions::over(&scaled, 200, 2);
        // Peaks that lie on the trajectory add nothing to its own integral.
        let on_it = Scaled { logs: trajectory, ..scaled };
        let (target, matrix) = functions.along(&law, &[column], &on_it);
        let difference = target - matrix * DVector::from_vec(vec![constant, factor]);
        assert!(difference.amax() < 1e-14, "{difference}");
    }
}
