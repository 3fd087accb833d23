//! Spectrum of residuals: its strongest line and the noise beside a line.

use super::samples::Samples;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Most points of the grid.
const MOST_POINTS: usize = 1 << 18;
/// Half width of the band that the noise beside a line is taken from, in lines one over the record apart.
const BESIDE: f64 = 10.0;
/// Half width of the band that the background is taken from, in lines one over the record apart.
const AROUND: f64 = 40.0;
/// Smallest power of a line over that of the background; white noise reaches it once in many records.
const CLEAR: f64 = 12.0;

/// Power at each frequency, for an even grid over the start of a record.
pub(super) struct Spectrum {
    powers: Vec<f64>,
    /// Angular frequency per record duration from one power to the next.
    spacing: f64,
    points: usize,
}

impl Spectrum {
    /// Computes the spectrum of values at the samples' times, up to a share `span` of the record.
    pub(super) fn new(samples: &Samples, values: &[f64], span: f64) -> Self {
        let within = samples.times.partition_point(|time| *time <= span);
        let points = within.clamp(2, MOST_POINTS);
        let mut sums = vec![(0.0, 0.0); points];
        let rate = (points as f64 - 1.0) / span;
        for (time, value) in samples.times.iter().zip(values).take(within) {
            let at = (time * rate).round() as usize;
            if let Some((sum, count)) = sums.get_mut(at) {
                *sum += value;
                *count += 1.0;
            }
        }
        let mut previous = 0.0;
        // A cell without a sample repeats the one before: it is no worse a guess than the mean.
        let means = sums.into_iter().map(|(sum, count)| {
            previous = if count > 0.0 { sum / count } else { previous };
            Complex::new(previous, 0.0)
        });
        let mut padded: Vec<Complex<f64>> = means.collect();
        let length = (2 * points).next_power_of_two();
        padded.resize(length, Complex::new(0.0, 0.0));
        transform(&mut padded);
        let powers = padded.iter().take(length / 2).map(|value| value.norm_sqr()).collect();
        Self { powers, spacing: TAU * rate / length as f64, points }
    }

    /// Returns the angular frequency of the strongest line within a range and outside the excluded bands;
    /// `None` if noise may have made it.
    pub(super) fn peak(&self, range: (f64, f64), excluded: &[(f64, f64)]) -> Option<f64> {
        let allowed = |omega: f64| {
            omega >= range.0
                && omega <= range.1
                && excluded.iter().all(|(from, to)| omega < *from || omega > *to)
        };
        let lines =
            self.powers.iter().enumerate().map(|(number, power)| (number as f64 * self.spacing, *power));
        let allowed = lines.filter(|(omega, _)| allowed(*omega));
        let (omega, power) = allowed.max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (power > CLEAR * noise_power(&self.powers)).then_some(omega)
    }

    /// Returns the variance per sample of white noise as strong as most of the spectrum around a frequency,
    /// which single lines do not change, for a number of samples over the whole record.
    pub(super) fn background(&self, omega: f64, count: usize) -> f64 {
        let around = self.band(omega, (TAU * AROUND).min(0.5 * omega));
        noise_power(around) * count as f64 / (self.points as f64).powi(2)
    }

    fn band(&self, omega: f64, half: f64) -> &[f64] {
        let from = ((omega - half) / self.spacing).max(1.0) as usize;
        let to = ((omega + half) / self.spacing).max(1.0) as usize;
        let to = to.saturating_add(1).min(self.powers.len());
        self.powers.get(from..to).unwrap_or(&[])
    }

    /// Returns the variance per sample of white noise as strong as the residuals beside a frequency, for a
    /// number of samples over the whole record.
    pub(super) fn noise(&self, omega: f64, count: usize) -> f64 {
        let inside = self.band(omega, TAU * BESIDE);
        let mean = inside.iter().sum::<f64>() / inside.len().max(1) as f64;
        // The four fitted numbers of a line took the power of two of about twenty lines.
        let taken = 2.0 * BESIDE / (2.0 * BESIDE - 2.0);
        taken * mean * count as f64 / (self.points as f64).powi(2)
    }
}

/// Returns the mean power of noise from the median: noise has exponentially distributed powers.
fn noise_power(powers: &[f64]) -> f64 {
    let mut powers = powers.to_vec();
    let middle = powers.len() / 2;
    if middle >= powers.len() {
        return 0.0;
    }
    let (_, median, _) = powers.select_nth_unstable_by(middle, f64::total_cmp);
    *median / std::f64::consts::LN_2
}

/// Replaces values, whose number is a power of two, by their discrete Fourier transform (Cooley, Tukey 1965).
fn transform(values: &mut [Complex<f64>]) {
    let length = values.len();
    let bits = length.trailing_zeros();
    for at in 0..length {
        let to = if bits == 0 { 0 } else { at.reverse_bits() >> (usize::BITS - bits) };
        if at < to {
            values.swap(at, to);
        }
    }
    let mut half = 1;
    while half < length {
        let turn = |at: usize| Complex::from_polar(1.0, -TAU * at as f64 / (2 * half) as f64);
        let turns: Vec<Complex<f64>> = (0..half).map(turn).collect();
        for block in values.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for ((one, other), turn) in low.iter_mut().zip(high).zip(&turns) {
                let turned = *other * turn;
                *other = *one - turned;
                *one += turned;
            }
        }
        half *= 2;
    }
}
