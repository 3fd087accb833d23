//! Linear oscillator by regression in weak form.
//!
//! The equation of motion is multiplied by a smooth window φ that vanishes, with its first derivatives, at
//! both ends. It is integrated by parts until only φ is differentiated (Shinbrot 1957; Messenger, Bortz
//! 2021):
//!
//!   ∫φ″·θ = 2ζω₀·∫φ′·θ − ω₀²·∫φ·θ + g·∫φ·u + b·∫φ, with b = ω₀²·θ_rest.
//!
//! Each window gives one equation that is linear in the coefficients. A velocity obeys the same equation with
//! u̇ in place of u, an acceleration with ü; these derivatives again move to φ.

use crate::observed::{input, order};
use crate::{Basis, Estimated, IdentifyError, LinearOscillator};
use dynamics::weak_form::test_function;
use nalgebra::{DMatrix, DVector};
use record::{Clock, Record};
use std::f64::consts::TAU;

/// Most samples that the search for the time scale uses; more would not improve it.
const MOST_SAMPLES: usize = 8192;
/// Number of frequencies tried for the time scale.
const FREQUENCIES: u32 = 400;
/// Fewest windows per fitted coefficient.
const WINDOWS_EACH: usize = 3;
/// Exponent n of the windows (1 − s²)ⁿ.
const EXPONENT: i32 = 4;
/// Smallest step between samples that counts as a gap, in usual steps.
const GAP: f64 = 4.0;

/// Fits damping, stiffness, input gain and rest position to all windows of a record.
///
/// An input may be kept between its samples or vary linearly. Half a sampling interval lies between the two, which
/// would be taken for damping; the one that leaves less is believed.
pub(crate) fn oscillator(record: &Record, clock: &Clock) -> Result<LinearOscillator, IdentifyError> {
    let linear = Samples::new(record, clock);
    let kept = linear.kept().map(|samples| samples.oscillator());
    match (linear.oscillator(), kept) {
        (Ok(linear), Some(Ok(kept))) => Ok(if kept.rest < linear.rest { kept } else { linear }.oscillator),
        (linear, _) => linear.map(|found| found.oscillator),
    }
}

/// Oscillator with the sum of the squared residuals of its windows.
struct Found {
    oscillator: LinearOscillator,
    rest: f64,
}

impl Samples<'_> {
    fn oscillator(&self) -> Result<Found, IdentifyError> {
        let width = self.period().min(self.duration() / 4.0);
        let rows = self.rows(width);
        let columns = if self.input.is_some() { 4 } else { 3 };
        let needed = WINDOWS_EACH * columns;
        if rows.len() < needed {
            return Err(IdentifyError::TooShort { windows: rows.len(), needed, width_s: width });
        }
        let with_spring = fit(&rows, columns, true)?;
        let [_, stiffness, ..] = with_spring.0;
        let restored = stiffness.value > 0.0 && stiffness.is_significant();
        let ([damping, stiffness, shift, gain], rest) =
            if restored { with_spring } else { fit(&rows, columns, false)? };
        let center = (restored && self.order == 0).then(|| shift.times(1.0 / stiffness.value));
        let oscillator = LinearOscillator {
            stiffness,
            damping,
            rest: center,
            input_gain: self.input.is_some().then_some(gain),
            basis: Basis::Windows(rows.len()),
        };
        Ok(Found { oscillator, rest })
    }
}

/// One window's equation: ∫φ″·θ, then ∫φ′·θ, −∫φ·θ, ∫φ and the integral of the input.
type Row = (f64, [f64; 4]);

/// Fits damping, stiffness, shift and gain by least squares, each with its standard error; 0 for those not
/// fitted. The second number is the sum of the squared residuals.
fn fit(rows: &[Row], columns: usize, spring: bool) -> Result<([Estimated; 4], f64), IdentifyError> {
    debug_assert!(columns <= 4, "{columns} columns of 4");
    let free: Vec<usize> = (0..columns).filter(|column| spring || *column != 1).collect();
    let entries =
        free.iter().flat_map(|&at| rows.iter().filter_map(move |(_, entries)| entries.get(at).copied()));
    let mut design = DMatrix::from_iterator(rows.len(), free.len(), entries);
    // Columns have norm 1, so that their units do not affect the inversion.
    let sizes: Vec<f64> = design.column_iter().map(|column| column.norm()).collect();
    if sizes.iter().any(|size| !size.is_finite() || *size <= 0.0) {
        return Err(IdentifyError::Undetermined);
    }
    for (mut column, size) in design.column_iter_mut().zip(&sizes) {
        column /= *size;
    }
    let target = DVector::from_iterator(rows.len(), rows.iter().map(|(target, _)| *target));
    let normal = design.tr_mul(&design);
    let inverse = normal.try_inverse().ok_or(IdentifyError::Undetermined)?;
    let solution = &inverse * design.tr_mul(&target);
    let freedom = (rows.len().saturating_sub(free.len())).max(1) as f64;
    let rest = (&target - &design * &solution).norm_squared();
    // Windows overlap by three quarters, so that four neighbors count for little more than one.
    let variance = 4.0 * rest / freedom;
    let mut found = [Estimated { value: 0.0, std_error: 0.0 }; 4];
    for (number, (column, size)) in free.iter().zip(&sizes).enumerate() {
        let value = solution.get(number).copied().unwrap_or(f64::NAN) / size;
        let std_error = (variance * inverse.get((number, number)).copied().unwrap_or(f64::NAN)).sqrt() / size;
        if !value.is_finite() || !std_error.is_finite() {
            return Err(IdentifyError::Undetermined);
        }
        if let Some(place) = found.get_mut(*column) {
            *place = Estimated { value, std_error };
        }
    }
    Ok((found, rest))
}

/// Columns of a record in the form that the windows need.
#[derive(Clone)]
struct Samples<'a> {
    times: &'a [f64],
    /// Observed values minus their mean; only the shift depends on the mean.
    values: Vec<f64>,
    mean: f64,
    /// Times and values of the input, including rows between the samples.
    input: Option<Vec<(f64, f64)>>,
    /// Number of time derivatives that the observed quantity already has.
    order: usize,
    /// Usual step between samples, in seconds.
    step: f64,
}

impl<'a> Samples<'a> {
    fn new(record: &'a Record, clock: &'a Clock) -> Self {
        let mean = record.values().iter().sum::<f64>() / record.len() as f64;
        Self {
            times: &clock.times_s,
            values: record.values().iter().map(|value| value - mean).collect(),
            mean,
            input: input(record, clock),
            order: order(record.quantity()),
            step: 1.0 / clock.sample_rate_hz,
        }
    }

    /// Returns the samples with an input that is kept from each of its samples to the next; `None` without an input.
    fn kept(&self) -> Option<Self> {
        let input = self.input.as_ref()?;
        let before = input.iter().take(1).chain(input);
        // The trapezoidal rule weighs a sample by half of both intervals beside it, which a kept input fills with two
        // values.
        let mean = |(now, before): (&(f64, f64), &(f64, f64))| (now.0, 0.5 * (now.1 + before.1));
        let input = input.iter().zip(before).map(mean).collect();
        Some(Self { input: Some(input), ..self.clone() })
    }

    fn duration(&self) -> f64 {
        match self.times {
            [first, .., last] => last - first,
            _ => 0.0,
        }
    }

    /// Returns the period of the strongest line in the spectrum of the values, in seconds, between eight
    /// samples and half the record.
    fn period(&self) -> f64 {
        let stride = self.times.len().div_ceil(MOST_SAMPLES).max(1);
        let (longest, shortest) = (self.duration() / 2.0, 8.0 * self.step * stride as f64);
        let period = |number: u32| {
            let share = f64::from(number) / f64::from(FREQUENCIES);
            longest * libm::pow(shortest / longest, share)
        };
        let power = |period: f64| {
            let rate = TAU / period;
            let picked = self.times.iter().zip(&self.values).step_by(stride);
            let (sine, cosine) = picked.fold((0.0, 0.0), |(sine, cosine), (time, value)| {
                let (s, c) = libm::sincos(rate * time);
                (sine + value * s, cosine + value * c)
            });
            sine * sine + cosine * cosine
        };
        let best = (0..=FREQUENCIES)
            .map(|number| (power(period(number)), number))
            .max_by(|(one, _), (other, _)| one.total_cmp(other));
        best.map_or(longest, |(_, number)| period(number))
    }

    /// Returns the equations of all windows of a width in seconds that contain no gap; each window starts a
    /// quarter of a width after the previous one.
    fn rows(&self, width: f64) -> Vec<Row> {
        let Some(&first) = self.times.first() else { return Vec::new() };
        let count = (4.0 * (self.duration() / width - 1.0)).floor().max(-1.0) as i64 + 1;
        (0..count).filter_map(|number| self.row(first + 0.25 * width * number as f64, width)).collect()
    }

    fn row(&self, start: f64, width: f64) -> Option<Row> {
        let from = self.times.partition_point(|time| *time < start);
        let to = self.times.partition_point(|time| *time <= start + width);
        let times = self.times.get(from..to)?;
        if times.len() < 8 || times.windows(2).any(|pair| matches!(pair, [a, b] if b - a > GAP * self.step)) {
            return None;
        }
        let (mut target, [mut damping, mut stiffness, mut shift, mut gain]) = (0.0, [0.0; 4]);
        let half = 0.5 * width;
        let derivatives = |time: f64| {
            let [phi, slope, curvature] = test_function((time - start) / half - 1.0, EXPONENT);
            [phi, slope / half, curvature / (half * half)]
        };
        for (at, (time, weight)) in trapezoids(times.iter().copied()).enumerate() {
            let [phi, slope, curvature] = derivatives(time).map(|value| weight * value);
            let value = self.values.get(from + at)?;
            target += curvature * value;
            damping += slope * value;
            stiffness -= phi * (value + self.mean);
            shift += phi;
        }
        if let Some(input) = &self.input {
            let from = input.partition_point(|(time, _)| *time < start);
            let to = input.partition_point(|(time, _)| *time <= start + width);
            let pushes = input.get(from..to)?;
            let sign = if self.order == 1 { -1.0 } else { 1.0 };
            for ((time, weight), (_, push)) in trapezoids(pushes.iter().map(|(time, _)| *time)).zip(pushes) {
                gain += sign * weight * derivatives(time).get(self.order)? * push;
            }
        }
        Some((target, [damping, stiffness, shift, gain]))
    }
}

/// Returns each time with its weight in the trapezoidal rule. The first and the last time miss one neighbor,
/// which does no harm: windows vanish at their ends.
fn trapezoids(times: impl Iterator<Item = f64> + Clone) -> impl Iterator<Item = (f64, f64)> {
    let before = std::iter::once(None).chain(times.clone().map(Some));
    let after = times.clone().skip(1).map(Some).chain([None]);
    let beside = before.zip(after);
    times
        .zip(beside)
        .map(|(time, (before, after))| (time, 0.5 * (after.unwrap_or(time) - before.unwrap_or(time))))
}
