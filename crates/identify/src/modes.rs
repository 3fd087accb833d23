//! Modes of a free decay: damped sinusoids that a record is the sum of.
//!
//! Lines are added one at a time. Each starts from the strongest line of the residuals or from the poles of a
//! Hankel matrix (Kung 1978; Hua, Sarkar 1990), and all are refined together by variable projection (Golub,
//! Pereyra 1973) on all samples at their times.

#![allow(clippy::indexing_slicing, reason = "numbers of lines are those of the fit")]

mod fit;
mod pair;
mod pencil;
mod samples;
mod spectrum;

use crate::observed::input;
use crate::oscillator::{Basis, Estimated, LinearOscillator};
use fit::{Fit, Fitted, Line};
use pencil::Blocks;
use record::{Clock, Record};
use samples::Samples;
use spectrum::Spectrum;
use std::f64::consts::TAU;

/// Most lines, with the harmonics of modes.
const MOST_LINES: usize = 6;
/// Most lines that are tried in vain.
const MOST_REFUSED: usize = 4;
/// Fewest periods of a mode in a record.
const FEWEST_PERIODS: f64 = 3.0;
/// Highest frequency, in samples per period.
const FEWEST_PER_PERIOD: f64 = 2.5;
/// Most samples that first guesses are compared on.
const MOST_PICKED: usize = 8192;
/// Smallest amplitude, in standard errors.
const CLEAR: f64 = 6.0;
/// Smallest share of the explained variance.
const LEAST_SHARE: f64 = 1e-4;
/// Smallest gain of the score by an added line.
const LEAST_GAIN: f64 = 10.0;
/// Relative distance from a multiple of a stronger line's frequency within which a line is a harmonic.
const HARMONIC: f64 = 0.01;
/// Multiples of a frequency that count as harmonics, each with the largest power of such a harmonic over that
/// of the fundamental: high harmonics of a swing are weak.
const MULTIPLES: [(f64, f64); 4] = [(2.0, 1.0), (3.0, 1.0), (4.0, 0.01), (5.0, 0.01)];
/// Decay of a line over a record, in e-foldings, up to which its amplitude is steady, and that of a swing from which it
/// decays; and the standard errors that these numbers are sure to.
const STEADY: f64 = 0.3;
const DECAYS: f64 = 1.0;
const SURE: f64 = 3.0;
/// Shares of a record, from its start, in which lines are searched: those that decay fast fill no more.
const SPANS: [f64; 3] = [1.0, 0.25, 0.0625];

/// Damped sinusoid of a free decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Undamped natural frequency √(ω² + λ²)/2π, in Hz, from the angular frequency ω and the decay λ of the
    /// damped sinusoid.
    pub frequency_hz: Estimated,
    /// Damping ratio λ/√(ω² + λ²), dimensionless.
    pub damping_ratio: Estimated,
    /// Amplitude at the start of the record, in the record's unit.
    pub amplitude: f64,
    /// Part of the modes' power over the record, between 0 and 1.
    pub share: f64,
    /// `true` if it keeps its amplitude while others decay: a line that something beside the system makes, such as the
    /// hum of the mains or a motor, and no mode.
    pub is_steady: bool,
}

impl Mode {
    /// Returns an oscillator with the frequency and the damping of this mode, one of `modes` of a record.
    #[must_use]
    pub fn oscillator(&self, of_record: LinearOscillator, modes: usize) -> LinearOscillator {
        let omega = self.frequency_hz.times(TAU);
        let std_error = 2.0 * omega.value * omega.std_error;
        let stiffness = Estimated { value: omega.value.powi(2), std_error };
        let damping = self.damping_ratio.times(2.0 * omega.value);
        LinearOscillator { stiffness, damping, basis: Basis::Modes(modes), ..of_record }
    }
}

/// Returns the modes of a free decay under a clock, the most powerful first, and after them the steady lines beside them.
///
/// The record is taken as a sum of damped sinusoids and a slow trend: poles of the Hankel matrix of the record
/// (Kung 1978; Hua, Sarkar 1990, equation 14), refined by variable projection (Golub, Pereyra 1973). A mode
/// has an amplitude of more than 6 standard errors, is no multiple of a stronger mode's frequency, and is told
/// from the changes that a nonlinear swing of one mode makes by itself. Standard errors are from the Jacobian
/// and the residuals' spectrum beside the mode, so that they hold for correlated residuals too. The result is
/// empty for a record with an input that changes, without motion, or without a clear mode. The run time is
/// nearly linear in the number of samples.
#[must_use]
pub fn modes(record: &Record, clock: &Clock) -> Vec<Mode> {
    if input(record, clock).is_some() {
        return Vec::new();
    }
    let reported = |samples: Samples| Some(samples.reported(&samples.fitted()?));
    Samples::new(record, clock).and_then(reported).into_iter().flatten().collect()
}

/// Strongest mode of a free decay, alone.
pub(crate) struct Separated {
    /// Angular frequency of the damped swing, in rad/s.
    pub(crate) omega: f64,
    /// Decay rate of the amplitude, in 1/s.
    pub(crate) decay: f64,
    /// Values of the record minus a slow trend and all other modes.
    pub(crate) values: Vec<f64>,
}

/// Returns the strongest mode of a free decay; `None` without a clear mode.
pub(crate) fn separated(record: &Record, clock: &Clock) -> Option<Separated> {
    let samples = Samples::new(record, clock)?;
    let fit = samples.fitted()?;
    let is_steady = samples.steady(&fit);
    let lines = fit.lines.iter().enumerate().filter(|(number, _)| !is_steady[*number]);
    let (number, strongest) = lines.max_by(|(_, one), (_, other)| one.energy.total_cmp(&other.energy))?;
    let values = fit.residuals(&samples, &[number]).into_iter().map(|value| samples.size * value);
    let Line { omega, decay } = strongest.line;
    Some(Separated {
        omega: omega / samples.duration_s,
        decay: decay / samples.duration_s,
        values: values.collect(),
    })
}

impl Samples {
    /// Returns every so many samples, few enough to compare first guesses quickly.
    fn picked(&self) -> Self {
        let stride = self.times.len().div_ceil(MOST_PICKED).max(1);
        let picked = |column: &[f64]| column.iter().step_by(stride).copied().collect();
        Self { times: picked(&self.times), values: picked(&self.values), ..*self }
    }

    /// Fits all lines that a record shows.
    fn fitted(&self) -> Option<Fit> {
        let mut best = Fit::new(self, &[])?;
        let (mut excluded, mut refused) = (Vec::new(), 0);
        while best.lines.len() < MOST_LINES && refused < MOST_REFUSED {
            let Some((fit, fitted)) = self.extended(&best, &excluded) else { break };
            match self.refusal(&best, &fit, &fitted) {
                None => best = fit,
                Some(band) => {
                    excluded.push(band);
                    refused += 1;
                }
            }
        }
        Fit::refined(self, &best.guesses())
    }

    /// Returns the best fit with one more line than a given one, with the samples that it is a fit of.
    fn extended(&self, best: &Fit, excluded: &[(f64, f64)]) -> Option<(Fit, Self)> {
        let residuals = best.residuals(self, &[]);
        let range = (TAU * FEWEST_PERIODS, TAU * self.times.len() as f64 / FEWEST_PER_PERIOD);
        let known = best.guesses();
        let mut added: Vec<Line> = Vec::new();
        for span in SPANS {
            let Some(omega) = Spectrum::new(self, &residuals, span).peak((range.0 / span, range.1), excluded)
            else {
                continue;
            };
            added.extend([0.5, 2.0, 8.0].map(|decay| Line { omega, decay: decay / span }.bounded()));
            added.extend(Blocks::new(self, &residuals, omega, span).lines(1));
        }
        let mut starts: Vec<Vec<Line>> =
            added.iter().map(|line| known.iter().copied().chain([*line]).collect()).collect();
        for (number, line) in known.iter().enumerate() {
            let values = best.residuals(self, &[number]);
            for span in SPANS {
                let pair = Blocks::new(self, &values, line.omega, span).lines(2);
                let others = known.iter().enumerate().filter(|(other, _)| *other != number);
                starts.push(others.map(|(_, line)| *line).chain(pair).collect());
            }
        }
        let allowed = |line: &Line| {
            let known = known.iter().any(|known| (known.omega - line.omega).abs() < TAU * 0.5);
            let outside = excluded.iter().all(|(from, to)| line.omega < *from || line.omega > *to);
            line.omega >= range.0 && line.omega <= range.1 && (known || outside)
        };
        starts.retain(|lines| lines.len() == known.len() + 1 && lines.iter().all(allowed));
        let highest = starts.iter().flatten().map(|line| line.omega).fold(range.0, f64::max);
        let samples = self.thinned(highest);
        let few = samples.picked();
        let mut ranked: Vec<Fit> = starts.iter().filter_map(|lines| Fit::new(&few, lines)).collect();
        ranked.sort_by(|one, other| one.rest.total_cmp(&other.rest));
        let refined = ranked.iter().take(3).filter_map(|fit| Fit::refined(&few, &fit.guesses()));
        let usable = refined.filter(|fit| fit.guesses().iter().all(allowed));
        let fit = usable.min_by(|one, other| one.rest.total_cmp(&other.rest))?;
        let fit = Fit::refined(&samples, &fit.guesses())?;
        fit.guesses().iter().all(allowed).then_some((fit, samples))
    }

    /// Returns the band of frequencies to leave out if one of the lines of a fit is no mode.
    fn refusal(&self, before: &Fit, fit: &Fit, samples: &Self) -> Option<(f64, f64)> {
        let noise = Spectrum::new(self, &fit.residuals(self, &[]), 1.0);
        let power: f64 = fit.lines.iter().map(|line| line.energy).sum();
        let around = |line: &Fitted, width: f64| (line.line.omega - width, line.line.omega + width);
        let weakest = fit.lines.iter().min_by(|one, other| one.energy.total_cmp(&other.energy))?;
        let narrow = TAU.max(0.5 * weakest.line.decay);
        let level = |line: &Fitted| noise.background(line.line.omega, fit.count);
        // Bayesian information criterion for four more numbers and noise of a known level.
        let gain = Fit::new(samples, &before.guesses())?.rest - fit.rest;
        let price = 4.0 * libm::log(fit.count as f64) + LEAST_GAIN;
        if gain < price * level(weakest) {
            return Some(around(weakest, narrow));
        }
        let unclear = |line: &&Fitted| {
            line.amplitude() < CLEAR * (line.variances[2] * level(line)).sqrt()
                || line.energy < LEAST_SHARE * power
        };
        if let Some(line) = fit.lines.iter().find(unclear) {
            return Some(around(line, narrow));
        }
        let mut order: Vec<usize> = (0..fit.lines.len()).collect();
        let energy = |number: &usize| fit.lines[*number].energy;
        order.sort_by(|one, other| energy(other).total_cmp(&energy(one)));
        for (place, &weak) in order.iter().enumerate() {
            let stronger = order.iter().take(place);
            let alike = stronger.copied().find(|strong| !pair::are_two(samples, fit, *strong, weak));
            if let Some((strong, weak)) =
                alike.and_then(|strong| fit.lines.get(strong).zip(fit.lines.get(weak)))
            {
                let distance = 1.5 * (strong.line.omega - weak.line.omega).abs();
                return Some(around(strong, distance.max(narrow)));
            }
        }
        None
    }

    /// Returns, for each line of a fit, whether it keeps its amplitude over the record while others decay.
    fn steady(&self, fit: &Fit) -> Vec<bool> {
        let noise = Spectrum::new(self, &fit.residuals(self, &[]), 1.0);
        let decay = |line: &Fitted| {
            let level = noise.noise(line.line.omega, fit.count);
            (line.line.decay, SURE * (line.variances[1] * level).sqrt())
        };
        let decays = fit.lines.iter().map(decay).any(|(decay, error)| decay - error > DECAYS);
        let is_steady =
            |(decay, error): (f64, f64)| decays && decay.abs() <= error && decay.abs() + error < STEADY;
        fit.lines.iter().map(decay).map(is_steady).collect()
    }

    fn reported(&self, fit: &Fit) -> Vec<Mode> {
        let steady = self.steady(fit);
        let noise = Spectrum::new(self, &fit.residuals(self, &[]), 1.0);
        let is_harmonic = |line: &Fitted| {
            let of = |other: &Fitted| {
                let (ratio, power) = (line.line.omega / other.line.omega, line.energy / other.energy);
                MULTIPLES.iter().any(|(times, most)| (ratio / times - 1.0).abs() < HARMONIC && power < *most)
            };
            fit.lines.iter().any(of)
        };
        let mut lines: Vec<(bool, &Fitted)> = steady.into_iter().zip(&fit.lines).collect();
        // The harmonics of a swing decay with it.
        lines.retain(|(is_steady, line)| *is_steady || !is_harmonic(line));
        lines.sort_by(|one, other| one.0.cmp(&other.0).then(other.1.energy.total_cmp(&one.1.energy)));
        let power: f64 = lines.iter().map(|(_, line)| line.energy).sum();
        let mode = |(is_steady, line): &(bool, &Fitted)| {
            let Line { omega, decay } = line.line;
            let natural = libm::hypot(omega, decay);
            let level = noise.noise(omega, fit.count);
            let [omega_error, decay_error, _] = line.variances.map(|variance| (variance * level).sqrt());
            let rate = natural / TAU / self.duration_s;
            Mode {
                frequency_hz: Estimated {
                    value: rate,
                    std_error: rate * libm::hypot(omega * omega_error, decay * decay_error) / natural.powi(2),
                },
                damping_ratio: Estimated {
                    value: decay / natural,
                    std_error: libm::hypot(omega * omega * decay_error, omega * decay * omega_error)
                        / natural.powi(3),
                },
                amplitude: line.amplitude() * self.size,
                share: line.energy / power,
                is_steady: *is_steady,
            }
        };
        let is_finite = |mode: &Mode| {
            let errors = mode.frequency_hz.std_error + mode.damping_ratio.std_error;
            (mode.frequency_hz.value + errors + mode.share + mode.amplitude).is_finite()
        };
        lines.iter().map(mode).filter(is_finite).collect()
    }
}

#[cfg(test)]
mod tests;
