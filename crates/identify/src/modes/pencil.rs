//! Poles of one or two damped sinusoids near a frequency.
//!
//! The values are turned back by the frequency and averaged over whole periods of it, which removes the
//! constant and the mirror line and leaves few complex numbers, however long a record is. Their Hankel matrix
//! has the rank of the number of lines; the shift of its signal space by one row has the lines' poles as
//! eigenvalues (Kung 1978; Hua, Sarkar 1990, equation 14).

#![allow(
    clippy::indexing_slicing,
    reason = "rows and columns of the Hankel matrix add up to the number of amplitudes"
)]

use super::fit::Line;
use super::samples::Samples;
use nalgebra::{Complex, DMatrix, Matrix2, SVD};
use std::f64::consts::TAU;

/// Most blocks of a record.
const MOST_BLOCKS: f64 = 100.0;

/// Complex amplitudes of values about a frequency, averaged over whole periods.
pub(super) struct Blocks {
    pub(super) amplitudes: Vec<Complex<f64>>,
    /// Duration of a block, in record durations.
    pub(super) width: f64,
    omega: f64,
}

impl Blocks {
    /// Averages the values over the first share `span` of a record.
    pub(super) fn new(samples: &Samples, values: &[f64], omega: f64, span: f64) -> Self {
        let cycles = omega * span / TAU;
        let periods = (cycles / MOST_BLOCKS).ceil().max(1.0);
        let width = periods * TAU / omega;
        let count = (span / width).floor().clamp(0.0, MOST_BLOCKS) as usize;
        let mut sums = vec![(Complex::new(0.0, 0.0), 0.0); count];
        for (time, value) in samples.times.iter().zip(values) {
            if let Some((sum, count)) = sums.get_mut((time / width) as usize) {
                *sum += Complex::from_polar(2.0 * value, -omega * time);
                *count += 1.0;
            }
        }
        let mut previous = Complex::new(0.0, 0.0);
        // A block without a sample repeats the one before: a swing changes little from block to block.
        let means = sums.into_iter().map(|(sum, count)| {
            previous = if count > 0.0 { sum / count } else { previous };
            previous
        });
        Self { amplitudes: means.collect(), width, omega }
    }

    /// Returns the lines that one (`order` 1) or two (`order` 2) poles describe best.
    pub(super) fn lines(&self, order: usize) -> Vec<Line> {
        // Too few blocks have no poles: other first guesses remain.
        let poles = poles(&self.amplitudes, order);
        let line = |pole: &Complex<f64>| {
            let (size, angle) = (libm::hypot(pole.re, pole.im), libm::atan2(pole.im, pole.re));
            Line { omega: self.omega + angle / self.width, decay: -libm::log(size) / self.width }
        };
        let lines = poles.iter().flatten().filter(|pole| pole.norm() > 0.0).map(line);
        lines.filter(|line| line.omega > 0.0 && line.decay.is_finite()).map(Line::bounded).collect()
    }
}

fn poles(amplitudes: &[Complex<f64>], order: usize) -> Option<Vec<Complex<f64>>> {
    let rows = amplitudes.len() / 2;
    let columns = (amplitudes.len() + 1).checked_sub(rows)?;
    if rows < order + 2 {
        return None;
    }
    let hankel = DMatrix::from_fn(rows, columns, |row, column| amplitudes[row + column]);
    let left = SVD::try_new(hankel, true, false, 1e-12, 1000)?.u?;
    let space = left.columns(0, order);
    let upper = space.rows(0, rows - 1);
    let lower = space.rows(1, rows - 1);
    let (square, shifted) = (upper.ad_mul(&upper), upper.ad_mul(&lower));
    if order == 1 {
        return Some(vec![shifted.get((0, 0))? / square.get((0, 0))?]);
    }
    let square: Matrix2<Complex<f64>> = square.fixed_view::<2, 2>(0, 0).into_owned();
    let shifted: Matrix2<Complex<f64>> = shifted.fixed_view::<2, 2>(0, 0).into_owned();
    let shift = square.try_inverse()? * shifted;
    let (half, product) = (shift.trace() * 0.5, shift.determinant());
    let square = half * half - product;
    let (size, angle) = (libm::hypot(square.re, square.im).sqrt(), 0.5 * libm::atan2(square.im, square.re));
    let root = Complex::new(size * libm::cos(angle), size * libm::sin(angle));
    Some(vec![half + root, half - root])
}
