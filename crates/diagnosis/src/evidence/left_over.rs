//! Test for a left-over that no named effect explains.
//!
//! It examines the residual of the best named set in three ways, all relative to the noise around it:
//!
//! - the decrease by a smooth function of position, velocity, time and the input, as a torque or in the
//!   sensor, above the frequencies of slow drifts;
//! - the excess of the residual's spectrum, in a band about a harmonic of the swing or midway between two,
//!   over the neighboring bands. This needs no basis, and detects torques and sensor effects alike;
//! - a steady line at any frequency, over the louder of the two sides about it.
//!
//! Each compares two variances, which are both the noise's if nothing is left. The evidence is the log
//! likelihood ratio of two Gaussian variances against a common one. So noise of any color counts for nothing
//! if its spectrum is smooth over a few bands, and few samples give little evidence.

#![allow(clippy::indexing_slicing, reason = "there is a band for every half harmonic")]

use crate::data::segments::{Data, PERIODS, Segment};
use crate::evidence::discrepancy::basis;
use crate::fit::fitted::Fit;
use crate::linear::dictionary::{Acting, columns_of};
use crate::linear::projection::Projection;
use crate::linear::tangent::{Path, matrix};
use crate::noise::high_pass::high_pass;
use crate::noise::periodogram::below_images;
use crate::noise::statistics::{duration, mean};
use crate::residual::floor::without_rounding;
use crate::residual::spectrum::steady;
use dynamics::DynamicsError;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Left-over without a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unexplained {
    /// Log evidence that there is one, in nats.
    pub(crate) evidence: f64,
    /// Sum of squares of the residual beyond the noise.
    pub(crate) squares: f64,
}

/// Number of harmonics of the swing that are examined.
const HARMONICS: usize = 12;

/// Index of the band about the swing's own frequency; the first band lies about half of that.
const SWING: usize = 1;

/// Number of bins of a segment's spectrum on either side of a band's center that belong to it.
const BESIDE: i32 = 1;

/// Number of comparisons: every band, a free torque, a free sensor and the lines. The evidence is the largest
/// of all.
const LOOKS: f64 = 3.0 + 2.0 * HARMONICS as f64;

/// Places on either side of a line, in steps of half the resolution, between which the spectrum counts as the
/// noise about it. Closer ones hold a part of the line itself.
const SIDE: std::ops::Range<usize> = 5..25;

/// Number of independent squares in a band of three neighboring bins under a Hann window, whose amplitudes
/// have the correlations 2/3 and 1/6: 2·3²/(3 + 2·(2·(2/3)² + (1/6)²)).
const WORTH: f64 = 108.0 / 29.0;

/// Share of the largest eigenvalue below which a direction of the basis counts as dependent on the others.
const DEPENDENT: f64 = 1e-8;

/// Smallest share of a column's length that has to remain without its drifts; a column with less counts as a
/// drift itself.
const DRIFTS: f64 = 0.1;

/// Returns the log likelihood ratio of two variances against a common one: `first` is a mean of `count`
/// independent squares, `second` of `others`. 0 unless the first is the larger.
fn larger(first: f64, count: f64, second: f64, others: f64) -> f64 {
    if !(first > second && second > 0.0 && count > 0.0 && others > 0.0) {
        return 0.0;
    }
    let common = (count * first + others * second) / (count + others);
    0.5 * ((count + others) * libm::log(common) - count * libm::log(first) - others * libm::log(second))
}

/// Band of the spectrum: the sum of its periodogram, the number of bins, and the number of independent
/// squares.
#[derive(Debug, Clone, Copy, Default)]
struct Band {
    power: f64,
    bins: f64,
    worth: f64,
}

impl Band {
    fn mean(self) -> f64 {
        if self.bins > 0.0 { self.power / self.bins } else { 0.0 }
    }

    fn with(self, other: Self) -> Self {
        Self {
            power: self.power + other.power,
            bins: self.bins + other.bins,
            worth: self.worth + other.worth,
        }
    }
}

/// Returns the periodogram of a piece under a Hann window at an angular frequency. Its mean over white noise
/// is the variance.
fn periodogram(times: &[f64], values: &[f64], frequency: f64) -> f64 {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return 0.0 };
    let length = (last - first).max(f64::MIN_POSITIVE);
    let (mut real, mut imaginary, mut weight) = (0.0, 0.0, 0.0);
    for (time, value) in times.iter().zip(values) {
        let window = 0.5 - 0.5 * libm::cos(TAU * (time - first) / length);
        let (sine, cosine) = libm::sincos(frequency * (time - first));
        real += window * value * cosine;
        imaginary += window * value * sine;
        weight += window * window;
    }
    if weight > 0.0 { (real * real + imaginary * imaginary) / weight } else { 0.0 }
}

/// Returns stretches of the residual, with their times, that are long enough to resolve a harmonic from its
/// neighbors: the unjoined segments or, if these are too short, the records.
fn stretches(data: &Data, residuals: &[DVector<f64>]) -> Vec<(Vec<f64>, Vec<f64>)> {
    let is_long = |times: &[f64]| duration(times) * data.facts.frequency >= 0.8 * TAU * PERIODS;
    let mut cut = Vec::new();
    let mut records: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for (segment, residual) in data.segments.iter().zip(residuals) {
        for part in segment.part_ranges() {
            let Some(times) = segment.times.get(part.clone()) else { continue };
            let Some(values) = residual.as_slice().get(part) else { continue };
            cut.push((times.to_vec(), values.to_vec()));
            if segment.record >= records.len() {
                records.resize_with(segment.record + 1, Default::default);
            }
            if let Some((own_times, own_values)) = records.get_mut(segment.record) {
                own_times.extend_from_slice(times);
                own_values.extend_from_slice(values);
            }
        }
    }
    // A shorter stretch has no bins between the harmonics.
    cut.retain(|(times, _)| is_long(times));
    if cut.is_empty() {
        records.retain(|(times, _)| is_long(times));
        return records;
    }
    cut
}

/// Returns the variance of the white noise if that of the drive is known beside it, and 0 otherwise.
fn known_noise(data: &Data) -> f64 {
    if data.facts.drive_noise > 0.0 { data.facts.noise * data.facts.noise } else { 0.0 }
}

/// Returns the variance of the noise at an angular frequency over that of its white part: 1 if the drive is exact.
fn over_white(data: &Data, omega: f64) -> f64 {
    let white = (data.facts.noise * data.facts.noise).max(f64::MIN_POSITIVE);
    1.0 + data.facts.moved_by_drive(omega) / data.interval() / white
}

/// Returns the bands about every half harmonic, from half the swing's frequency up, summed over the
/// stretches.
fn bands(data: &Data, residuals: &[DVector<f64>]) -> Vec<Band> {
    let mut bands = vec![Band::default(); 2 * HARMONICS];
    let highest = below_images(data.interval());
    for (times, values) in stretches(data, residuals) {
        let bin = TAU / duration(&times);
        for (at, band) in bands.iter_mut().enumerate() {
            let middle = 0.5 * (at + 1) as f64 * data.facts.frequency;
            if middle + bin > highest {
                continue;
            }
            for beside in -BESIDE..=BESIDE {
                let omega = middle + f64::from(beside) * bin;
                band.power += periodogram(&times, &values, omega) / over_white(data, omega);
                band.bins += 1.0;
            }
            band.worth += WORTH;
        }
    }
    bands
}

/// Returns the excess of the spectrum, and the noise about the swing's own frequency: its variance and the
/// number of squares that it is estimated from. No neighbor counts as quieter than `least`, the variance of known
/// noise.
fn outstanding(bands: &[Band], least: f64) -> (Unexplained, Band) {
    let mut evidence: f64 = 0.0;
    let mut squares = 0.0;
    // Start states absorb noise in the swing's own band, so no other band is compared with it.
    let lower = |index: usize| bands[if index == SWING + 1 { SWING - 1 } else { index - 1 }];
    let upper = |index: usize| bands.get(if index + 1 == SWING { SWING + 1 } else { index + 1 });
    // The lowest band is skipped since it has no neighbor below: red noise would stand out there as much as a
    // slow torque.
    for (index, band) in bands.iter().enumerate().skip(1) {
        let below = lower(index);
        let beside = upper(index).map_or(below, |above| below.with(*above));
        let own = larger(band.mean(), band.worth, beside.mean().max(least), beside.worth);
        evidence = evidence.max(own);
        if own > 0.0 {
            squares += 2.0 * (band.power - band.bins * beside.mean().max(least));
        }
    }
    let evidence = (evidence - libm::log(LOOKS)).max(0.0);
    (Unexplained { evidence, squares: squares.max(0.0) }, bands[SWING - 1].with(bands[SWING + 1]))
}

/// Returns the excess of the steady line that stands out most in a spectrum, if it has noise on both sides.
/// The louder side counts: the spectrum of red noise falls toward higher frequencies.
fn standing(gains: &[f64]) -> Unexplained {
    let side = |range: std::ops::Range<usize>| gains.get(range).map(|own| 0.5 * mean(own));
    // Two neighboring places of the grid depend on each other, and each gain is a sum of two squares.
    let worth = SIDE.len() as f64;
    let of = |(at, gain): (usize, &f64)| {
        let below = side(at.checked_sub(SIDE.end)?..at.checked_sub(SIDE.start)?)?;
        let noise = below.max(side(at + SIDE.start + 1..at + SIDE.end + 1)?);
        let evidence = larger(0.5 * gain, 2.0, noise, worth);
        Some(Unexplained { evidence, squares: (gain - 2.0 * noise).max(0.0) })
    };
    let found = gains.iter().enumerate().filter_map(of);
    let nothing = Unexplained { evidence: 0.0, squares: 0.0 };
    let best = found.fold(nothing, |best, own| if own.evidence > best.evidence { own } else { best });
    let frequencies = (0.5 * gains.len() as f64).max(1.0);
    Unexplained { evidence: (best.evidence - libm::log(frequencies) - libm::log(LOOKS)).max(0.0), ..best }
}

/// Returns the lowest angular frequency of a sustained motion: the swing's or, in driven data, that with
/// which the records cross their mean, if it is lower.
fn slowest(data: &Data) -> f64 {
    let crossings = |segment: &Segment| {
        let center = mean(&segment.values);
        let sides = || segment.values.iter().map(|value| *value > center);
        sides().zip(sides().skip(1)).filter(|(one, next)| one != next).count()
    };
    let count = data.segments.iter().map(crossings).sum::<usize>() as f64;
    let span: f64 = data.segments.iter().map(Segment::span).sum();
    if !data.driven() || count == 0.0 {
        return data.facts.frequency;
    }
    data.facts.frequency.min(PI * count / span)
}

/// Removes from samples of all segments everything slower than any motion. Red noise would otherwise pass for
/// a slow torque, or for the center that an asymmetric spring shifts, and no neighboring band shows how large
/// it is.
fn without_drifts(data: &Data, period: f64, values: &mut [f64]) {
    let mut rest = values;
    for segment in &data.segments {
        for times in segment.part_ranges().filter_map(|part| segment.times.get(part)) {
            let Some((own, others)) = std::mem::take(&mut rest).split_at_mut_checked(times.len()) else {
                return;
            };
            high_pass(times, own, period);
            rest = others;
        }
    }
}

/// Returns the decrease of a residual's sum of squares by a fit of columns, without drifts, and the number of
/// independent directions of the columns. `filter` removes the drifts from a column too.
fn taken(
    residual: &DVector<f64>,
    projection: &Projection,
    columns: &[Vec<f64>],
    filter: impl Fn(&mut [f64]),
) -> (f64, f64) {
    let mut columns = matrix(projection.rows(), columns);
    let raw: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    projection.apply(&mut columns);
    for (mut column, raw) in columns.column_iter_mut().zip(raw) {
        let fitted = column.norm();
        filter(column.as_mut_slice());
        let length = column.norm();
        if fitted > 1e-6 * raw && length > DRIFTS * fitted { column /= length } else { column.fill(0.0) }
    }
    let scores = columns.tr_mul(residual);
    let eigen = DMatrix::symmetric_eigen(columns.tr_mul(&columns));
    let largest = eigen.eigenvalues.max();
    let (mut squares, mut count) = (0.0, 0.0);
    for index in 0..eigen.eigenvalues.len() {
        let value = eigen.eigenvalues[index];
        if value > DEPENDENT * largest && value > 0.0 {
            let along: f64 =
                (0..scores.len()).map(|row| eigen.eigenvectors[(row, index)] * scores[row]).sum();
            squares += along * along / value;
            count += 1.0;
        }
    }
    (squares, count)
}

/// Returns the left-over of a fit.
///
/// # Errors
/// Any [`DynamicsError`] of the simulation.
pub(crate) fn unexplained(data: &Data, fit: &Fit) -> Result<Unexplained, DynamicsError> {
    let residuals = without_rounding(data, &fit.residuals);
    let (spectrum, around) = outstanding(&bands(data, &residuals), known_noise(data));
    // If the spectrum has no bands beside the swing's, the whole residual counts as noise.
    let whole =
        Band { power: fit.squares, bins: fit.freedom(), worth: fit.freedom() / fit.autocorrelation_time() };
    let noise = if around.worth > 0.0 { around } else { whole };
    if data.facts.drive_noise > 0.0 {
        // Noise of the drive is red: a smooth torque would always take a part of it.
        return Ok(spectrum);
    }
    let projection = Projection::at(data, fit)?;
    let paths = Path::of(data, fit)?;
    let free = basis(data, data.facts.rest(&fit.point.globals, &fit.hypothesis));
    let period = TAU / slowest(data);
    let filter = |values: &mut [f64]| without_drifts(data, period, values);
    let mut residual: Vec<f64> = residuals.iter().flat_map(|own| own.iter().copied()).collect();
    filter(&mut residual);
    let residual = DVector::from_vec(residual);
    let residuals: Vec<&[f64]> = residuals.iter().map(DVector::as_slice).collect();
    let line = standing(&steady(data, &residuals).gains);
    let mut found = if line.evidence > spectrum.evidence { line } else { spectrum };
    for acting in [Acting::Torque, Acting::Sensor] {
        let columns = columns_of(&paths, data.quantity, &free, acting);
        let (squares, directions) = taken(&residual, &projection, &columns, filter);
        let mean = squares / directions.max(1.0);
        let evidence = (larger(mean, directions, noise.mean(), noise.worth) - libm::log(LOOKS)).max(0.0);
        if evidence > found.evidence {
            let squares = (squares - directions * noise.mean()).max(0.0);
            found = Unexplained { evidence, squares };
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::{Band, HARMONICS, SWING, WORTH, larger, outstanding, periodogram, standing};
    use crate::answer::Status;
    use crate::fixtures::record;
    use crate::noise::periodogram::add;
    use crate::{Observations, Settings, diagnose};
    use dynamics::chain::{Chain, Observed};
    use dynamics::{Active, Nominal, System};
    use rand_distr::{Distribution, StandardNormal};
    use record::{Clock, ClockChoice, Quantity, Record};

    #[test]
    fn equal_variances_say_nothing_and_unequal_ones_much() {
        assert_eq!(larger(1.0, 50.0, 1.0, 90.0), 0.0);
        assert_eq!(larger(0.5, 50.0, 1.0, 90.0), 0.0);
        // Calculated by hand: ½(140·ln((50·4 + 90)/140) − 50·ln 4).
        let expected = 0.5 * (140.0 * (290.0_f64 / 140.0).ln() - 50.0 * 4.0_f64.ln());
        assert!((larger(4.0, 50.0, 1.0, 90.0) - expected).abs() < 1e-12);
    }

    /// In many segments, each with a fitted start state, the swing's band is too quiet by a third.
    #[test]
    fn a_quiet_swing_makes_no_neighbor_loud() {
        let band = |power: f64| Band { power: 1500.0 * power, bins: 1500.0, worth: 1867.0 };
        let mut spectrum = vec![band(1.0); 2 * HARMONICS];
        spectrum[SWING] = band(0.65);
        assert_eq!(outstanding(&spectrum, 0.0).0.evidence, 0.0);
        // An excess at the swing's own frequency is still detected there.
        spectrum[SWING] = band(1.3);
        assert!(outstanding(&spectrum, 0.0).0.evidence > 5.0);
    }

    #[test]
    fn a_bands_squares_scatter_as_stated() {
        let mut generator = seed::Seed::new(3).child("noise").generator();
        let times: Vec<f64> = (0..400).map(f64::from).collect();
        let bin = std::f64::consts::TAU / 399.0;
        let means: Vec<f64> = (0..2000)
            .map(|_| {
                let noise: Vec<f64> = times.iter().map(|_| StandardNormal.sample(&mut generator)).collect();
                [19.0, 20.0, 21.0].iter().map(|k| periodogram(&times, &noise, k * bin)).sum::<f64>() / 3.0
            })
            .collect();
        let mean = crate::noise::statistics::mean(&means);
        let variance =
            crate::noise::statistics::mean(&means.iter().map(|m| (m - mean).powi(2)).collect::<Vec<_>>());
        assert!((mean - 1.0).abs() < 0.05, "{mean}");
        // The mean of n squares of unit Gaussians has the variance 2/n.
        assert!((2.0 / variance / WORTH - 1.0).abs() < 0.15, "{}", 2.0 / variance);
    }

    /// A sine of half the noise stands out at any frequency; white and red noise without one do not, nor
    /// does a slow drift.
    #[test]
    fn a_line_stands_out_and_no_noise_does() {
        let mut generator = seed::Seed::new(5).child("noise").generator();
        let evidence = |of: &mut dyn FnMut(f64) -> f64| {
            let points: Vec<(f64, f64)> = (0..2000).map(f64::from).map(|time| (time, of(time))).collect();
            let step = 0.5 * std::f64::consts::TAU / 2000.0;
            let mut gains = vec![0.0; 1500];
            add(&points, 2000.0, 3.0 * step, step, &mut gains);
            standing(&gains).evidence
        };
        let mut noise = || -> f64 { StandardNormal.sample(&mut generator) };
        for line in [0.1, 0.337, 2.0] {
            assert!(evidence(&mut |time| noise() + 0.5 * (line * time).sin()) > 5.0, "{line}");
        }
        for _ in 0..20 {
            let mut red = 0.0;
            assert_eq!(evidence(&mut |_| noise()), 0.0);
            assert_eq!(evidence(&mut |time| noise() + 2e-3 * time), 0.0);
            let mut walk = |_: f64| {
                red = 0.98 * red + noise();
                red
            };
            assert!(evidence(&mut walk) < 1.0);
        }
    }

    /// A swing that spans ten steps of its sensor: the errors of rounding follow the motion, and are no noise.
    #[test]
    fn rounding_to_a_few_steps_leaves_nothing_unknown() {
        let nominal = Nominal::new(1.0, 0.1, 120.0, 0.0).unwrap();
        let coarse = Active::new("sensor_quantization", &[0.16]).unwrap();
        let chain = Chain::new(Observed::Position, 3e-3, vec![coarse]).unwrap();
        let record = record(&System::new(nominal, Vec::new()).unwrap(), 0.8, 3000, &chain, 3);
        let observed = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
        let answer = diagnose(&[observed], &nominal, &Settings::default(), &|| 0.0).unwrap();
        assert_eq!(
            (answer.verdict.status, answer.verdict.effects),
            (Status::Effect, vec!["sensor_quantization"])
        );
    }

    /// The velocity that a counter of 1024 steps a turn gives by differences: its noise is blue, and an error below
    /// what its neighbors' differences show is no law's.
    #[test]
    fn a_differenced_counter_leaves_nothing_unknown() {
        let nominal = Nominal::new(1.0, 0.3, 57.0, 0.0).unwrap();
        let times: Vec<f64> = (0..3000).map(|at| f64::from(at) / 100.0).collect();
        let position = |time: f64| 0.8 * (-0.15 * time).exp() * ((57.0_f64 - 0.0225).sqrt() * time).cos();
        let step = std::f64::consts::TAU / 1024.0;
        let counts: Vec<f64> = times.iter().map(|time| (position(*time) / step).round()).collect();
        let velocity = counts.windows(2).map(|w| (w[1] - w[0]) * step * 100.0);
        let times = times.iter().skip(1).copied().collect();
        let record = Record::new(times, velocity.collect(), None, Quantity::Velocity, "rad/s").unwrap();
        let observed = Observations::new(&record, &Clock::new(&record, ClockChoice::Auto).unwrap());
        let answer = diagnose(&[observed], &nominal, &Settings::default(), &|| 0.0).unwrap();
        assert_eq!(
            (answer.verdict.status, answer.verdict.effects),
            (Status::Effect, vec!["sensor_quantization"])
        );
    }
}
