//! Least squares of damped sinusoids plus a trend, with the linear coefficients projected out.
//!
//! Time runs from 0 to 1 over a record. The trend is a parabola: a constant, and a drift that is no mode.
//! Variable projection (Golub, Pereyra 1973, in the form of Kaufman 1975): each step solves for the linear
//! coefficients first and then for the frequencies and decays together with them.

use super::samples::Samples;
use crate::scaled::{inverse, solve};
use least_squares::{Descent, Method};
use nalgebra::{DMatrix, DVector};

/// Number of columns of the trend.
const TREND: usize = 3;
/// Number of columns of each line: the cosine and the sine, and both times the time.
const EACH: usize = 4;
/// Method of a refinement.
const METHOD: Method = Method { max_steps: 25, ..Method::TENFOLD };
/// Smallest relative change by a step, accepted or not, that is followed by another one.
const CHANGE: f64 = 1e-9;
/// Largest damping ratio of a line, as decay over angular frequency.
const MOST_DAMPING: f64 = 0.6;
/// Fastest growth of a line over a record, in e-foldings.
const MOST_GROWTH: f64 = 2.0;

/// Damped sinusoid: angular frequency and decay per record duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) omega: f64,
    pub(super) decay: f64,
}

impl Line {
    /// Returns the line with its decay within bounds.
    pub(super) fn bounded(self) -> Self {
        let most = (MOST_DAMPING * self.omega).max(0.0);
        Self { omega: self.omega, decay: self.decay.clamp(-MOST_GROWTH, most) }
    }

    fn parts(self, time: f64) -> (f64, f64) {
        let (sine, cosine) = libm::sincos(self.omega * time);
        let size = libm::exp(-self.decay * time);
        (size * cosine, size * sine)
    }
}

/// Line with its amplitudes and its variances for noise of variance 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fitted {
    pub(super) line: Line,
    /// Amplitudes of the cosine and of the sine at the record's start.
    parts: (f64, f64),
    /// Sum of the squares of the line over the fitted samples.
    pub(super) energy: f64,
    /// Variances of angular frequency, decay and amplitude.
    pub(super) variances: [f64; 3],
}

impl Fitted {
    pub(super) fn amplitude(&self) -> f64 {
        libm::hypot(self.parts.0, self.parts.1)
    }

    pub(super) fn at(&self, time: f64) -> f64 {
        let (cosine, sine) = self.line.parts(time);
        self.parts.0 * cosine + self.parts.1 * sine
    }
}

/// Fit of lines and of the trend.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fit {
    pub(super) lines: Vec<Fitted>,
    trend: [f64; TREND],
    /// Sum of the squared residuals.
    pub(super) rest: f64,
    /// Number of fitted samples.
    pub(super) count: usize,
    /// Normal matrix of the linear coefficients, then of angular frequency and decay of each line.
    normal: DMatrix<f64>,
    /// Products of those columns with the residuals.
    slope: DVector<f64>,
}

impl Fit {
    /// Fits amplitudes and trend to samples, for given lines; `None` if they cannot be told apart.
    pub(super) fn new(samples: &Samples, lines: &[Line]) -> Option<Self> {
        let gram = gram(samples, lines);
        let last = gram.nrows().checked_sub(1)?;
        let linear: Vec<usize> = (0..TREND)
            .chain((0..lines.len()).flat_map(|line| [0, 1].map(|part| TREND + EACH * line + part)))
            .collect();
        let design = DMatrix::from_fn(last, linear.len(), |row, column| {
            // A column beyond the last one does not exist.
            f64::from(u8::from(linear.get(column) == Some(&row)))
        });
        let inner = gram.view((0, 0), (last, last)).into_owned();
        let target = gram.view((0, last), (last, 1)).column(0).into_owned();
        let normal = design.tr_mul(&inner.tr_mul(&design));
        let solution = solve(&normal, &design.tr_mul(&target))?;
        let whole = &design * &solution;
        let power = gram.get((last, last)).copied()?;
        // Sums of products lose the last digits of the residuals.
        let rest = (power - whole.dot(&target)).max(1e-14 * power);
        let part = |at: usize| whole.get(at).copied();
        let mut full = DMatrix::zeros(last, TREND + EACH * lines.len());
        full.view_mut((0, 0), (last, linear.len())).copy_from(&design);
        let mut fitted = Vec::new();
        for (number, line) in lines.iter().enumerate() {
            let at = TREND + EACH * number;
            let (cosine, sine) = (part(at)?, part(at + 1)?);
            let to = linear.len() + 2 * number;
            *full.get_mut((at + 2, to))? = sine;
            *full.get_mut((at + 3, to))? = -cosine;
            *full.get_mut((at + 2, to + 1))? = -cosine;
            *full.get_mut((at + 3, to + 1))? = -sine;
            let block = inner.view((at, at), (2, 2));
            let parts = nalgebra::Vector2::new(cosine, sine);
            let energy = parts.dot(&(block * parts));
            fitted.push(Fitted { line: *line, parts: (cosine, sine), energy, variances: [f64::INFINITY; 3] });
        }
        let normal = full.tr_mul(&inner.tr_mul(&full));
        let slope = full.tr_mul(&(target - inner * &whole));
        let trend = [part(0)?, part(1)?, part(2)?];
        let count = samples.times.len();
        rest.is_finite().then_some(Self { lines: fitted, trend, rest, count, normal, slope })
    }

    /// Refines lines from a first guess by the method of Levenberg and Marquardt.
    pub(super) fn refined(samples: &Samples, lines: &[Line]) -> Option<Self> {
        let mut best = Self::new(samples, lines)?;
        let mut descent = Descent::new(METHOD);
        while let Ok(damping) = descent.next_damping() {
            let next = best.step(damping).and_then(|lines| Self::new(samples, &lines));
            let before = best.rest;
            let change = next.as_ref().map(|next| (before - next.rest).abs() / before);
            descent.advance(&mut best, next, |fit| fit.rest);
            if change.is_some_and(|change| change < CHANGE) {
                break;
            }
        }
        best.with_variances()
    }

    fn step(&self, damping: f64) -> Option<Vec<Line>> {
        let mut normal = self.normal.clone();
        let from = TREND + 2 * self.lines.len();
        for at in from..normal.nrows() {
            *normal.get_mut((at, at))? *= 1.0 + damping;
        }
        let step = solve(&normal, &self.slope)?;
        let moved = self.lines.iter().enumerate().map(|(number, fitted)| {
            let line = fitted.line;
            let (omega, decay) = (step.get(from + 2 * number)?, step.get(from + 2 * number + 1)?);
            let most = 2.0 + 0.5 * line.decay.abs();
            let moved = Line {
                omega: line.omega + omega.clamp(-most, most),
                decay: line.decay + decay.clamp(-most, most),
            };
            (moved.omega > 0.0).then_some(moved.bounded())
        });
        moved.collect()
    }

    fn with_variances(mut self) -> Option<Self> {
        let inverse = inverse(&self.normal)?;
        let entry = |row: usize, column: usize| inverse.get((row, column)).copied();
        let from = TREND + 2 * self.lines.len();
        for (number, fitted) in self.lines.iter_mut().enumerate() {
            let (cosine, sine) = (TREND + 2 * number, TREND + 2 * number + 1);
            let size = fitted.amplitude();
            let (c, s) = (fitted.parts.0 / size, fitted.parts.1 / size);
            let amplitude = c * c * entry(cosine, cosine)?
                + 2.0 * c * s * entry(cosine, sine)?
                + s * s * entry(sine, sine)?;
            let omega = entry(from + 2 * number, from + 2 * number)?;
            let decay = entry(from + 2 * number + 1, from + 2 * number + 1)?;
            fitted.variances = [omega, decay, amplitude];
            if fitted.variances.iter().any(|variance| !variance.is_finite() || *variance < 0.0) {
                return None;
            }
        }
        Some(self)
    }

    /// Returns the lines without their amplitudes.
    pub(super) fn guesses(&self) -> Vec<Line> {
        self.lines.iter().map(|fitted| fitted.line).collect()
    }

    /// Returns samples minus trend and lines, except the lines of the given numbers.
    pub(super) fn residuals(&self, samples: &Samples, except: &[usize]) -> Vec<f64> {
        let removed: Vec<&Fitted> = self
            .lines
            .iter()
            .enumerate()
            .filter(|(number, _)| !except.contains(number))
            .map(|(_, line)| line)
            .collect();
        let value = |(time, value): (&f64, &f64)| {
            let trend: f64 = self.trend.iter().zip(trend(*time)).map(|(size, column)| size * column).sum();
            value - trend - removed.iter().map(|line| line.at(*time)).sum::<f64>()
        };
        samples.times.iter().zip(&samples.values).map(value).collect()
    }
}

/// Returns the columns of the trend: Legendre's polynomials.
fn trend(time: f64) -> [f64; TREND] {
    let x = 2.0 * time - 1.0;
    [1.0, x, 1.5 * x * x - 0.5]
}

/// Returns the products of all columns with each other; the last column is the values.
fn gram(samples: &Samples, lines: &[Line]) -> DMatrix<f64> {
    let width = TREND + EACH * lines.len() + 1;
    let mut sums = vec![0.0; width * width];
    let mut row = Vec::with_capacity(width);
    for (&time, &value) in samples.times.iter().zip(&samples.values) {
        row.clear();
        row.extend(trend(time));
        for line in lines {
            let (cosine, sine) = line.parts(time);
            row.extend([cosine, sine, time * cosine, time * sine]);
        }
        row.push(value);
        for (number, (sums, &one)) in sums.chunks_exact_mut(width).zip(&row).enumerate() {
            for (sum, other) in sums.iter_mut().zip(&row).take(number + 1) {
                *sum += one * other;
            }
        }
    }
    let lower = DMatrix::from_row_slice(width, width, &sums);
    let mut gram = &lower + lower.transpose();
    for (mut column, at) in gram.column_iter_mut().zip(0..width) {
        if let Some(entry) = column.get_mut(at) {
            *entry *= 0.5;
        }
    }
    gram
}
