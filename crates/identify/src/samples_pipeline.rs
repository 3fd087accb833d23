//! Envelope of a free decay by least squares on its samples.

use crate::modes::{Separated, separated};
use crate::observed::order;
use crate::{Basis, Estimated, LinearOscillator, weak};
use envelope::{Envelope, EnvelopeError, Extraction, RatioDefinition};
use nalgebra::{Matrix2, Vector2};
use record::{Clock, Record, median};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Pipeline that needs no peaks: a damped sinusoid is fitted to the samples of each short window.
///
/// The record is cut into windows of half a period, or of 1/λ where the decay is faster. In each of them
/// y(t) = c + e^(−λ(t−t_k))·(a_k·cos ω(t−t_k) + b_k·sin ω(t−t_k)) is fitted by linear least squares, with one rest
/// position c for all windows; the amplitude at the window's center t_k is √(a_k² + b_k²). The phases of
/// the windows correct ω and their amplitudes λ, and the windows are fitted again. So each amplitude comes from
/// its own samples alone, and the decay of the amplitudes need not be exponential. Other modes are
/// subtracted before ([`modes`](crate::modes)).
///
/// It serves records with few samples per period, few cycles, much noise, or several modes. Where peaks are
/// many and clear, the recommended pipeline assumes less.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SamplesPipeline {
    /// Length of a window, in periods; windows are shorter where the decay is faster.
    pub window_periods: f64,
    /// Smallest amplitude used, in its standard errors.
    pub floor_in_errors: f64,
}

impl SamplesPipeline {
    /// Settings in use if a configuration sets none.
    pub const DEFAULT: Self = Self { window_periods: 0.5, floor_in_errors: 8.0 };
}

/// Most rounds of fitting windows and correcting the frequency and the decay.
const ROUNDS: usize = 20;
/// Relative change of the frequency and the decay that ends the rounds.
const SETTLED: f64 = 1e-9;
/// Fewest windows that give a line and its error.
const FEWEST_WINDOWS: usize = 3;
/// Fewest samples of a window, of which two determine its amplitude and phase.
const FEWEST_SAMPLES: usize = 5;
/// Smallest part of a window that its samples span.
const LEAST_SPAN: f64 = 0.6;
/// Smallest angular frequency of a swing, in decay rates: a damping ratio of 0.96.
const LEAST_SWING: f64 = 0.3;
/// Samples per period that a regression over windows needs.
const MANY_PER_PERIOD: f64 = 12.0;
/// Longest window, in records.
const LONGEST: f64 = 0.15;
/// Largest decay rate of a mode, in angular frequencies.
const MOST_OF_A_MODE: f64 = 0.2;
/// Smallest amplitude in largest ones: no sensor's range is wider, and the rounds end at errors of this size.
const DYNAMIC_RANGE: f64 = 1e-6;
/// Residuals, in steps of rounded values, from which the errors of rounding are random, and the smallest amplitude
/// where they are not, in steps.
const DITHERED: f64 = 0.45;
const COARSE: f64 = 2.3;
/// Residuals of a window, in those of the others and as a part of its amplitude, above which it holds more than a
/// free swing.
const FOREIGN: (f64, f64) = (4.0, 0.15);

/// Frequency and decay of a swing, with its samples.
#[derive(Debug, Clone)]
struct Swing {
    /// Angular frequency of the damped swing, in rad/s.
    omega: f64,
    /// Decay rate of the amplitude, in 1/s.
    decay: f64,
    values: Vec<f64>,
    /// Step that the values are rounded to; 0 if they are not.
    quantum: f64,
}

/// Damped sinusoid fitted to the samples of a window.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    /// Time of the center, in seconds.
    pub(crate) time: f64,
    /// Amplitudes of the cosine and of the sine at the center.
    pub(crate) parts: (f64, f64),
    /// Variance of the amplitude for noise of variance 1.
    pub(crate) leverage: f64,
    /// Sum of the squared residuals.
    rest: f64,
    /// Number of samples.
    count: usize,
}

impl Window {
    pub(crate) fn amplitude(&self) -> f64 {
        libm::hypot(self.parts.0, self.parts.1)
    }

    fn scatter(&self) -> f64 {
        (self.rest / (self.count - 2) as f64).sqrt()
    }
}

impl SamplesPipeline {
    /// Extracts the envelope of a record under a clock. The run time is linear in the number of samples.
    ///
    /// # Errors
    /// [`EnvelopeError::NoSwing`] for a motion that returns to rest without swinging,
    /// [`EnvelopeError::TooFewPeaks`] for fewer than three windows above the noise.
    pub fn extract(&self, record: &Record, clock: &Clock) -> Result<Extraction, EnvelopeError> {
        let (swing, Found { windows, noise, offset }) = self.fitted(record, clock)?;
        let first = windows.first().map_or(f64::NAN, |window| window.time);
        let logarithms = windows.iter().map(|window| libm::log(window.amplitude())).collect();
        let errors = windows.iter().map(|window| noise * window.leverage.sqrt() / window.amplitude());
        Ok(Extraction {
            pipeline: "samples",
            because: None,
            envelope: Envelope::new(
                windows.iter().map(|window| window.time).collect(),
                logarithms,
                swing.omega,
            )?
            .with_log_std_errors(errors.collect())
            .with_ratio(RatioDefinition::LogarithmicDecrement),
            first_peak_s: first - clock.start_s(),
            period_s: TAU / swing.omega,
            offset,
            samples: record.len(),
        })
    }

    /// Returns the oscillator whose decay has the amplitudes and the phases of the windows.
    pub(crate) fn oscillator(
        &self,
        record: &Record,
        clock: &Clock,
    ) -> Result<LinearOscillator, EnvelopeError> {
        let (swing, Found { windows, noise, offset }) = self.fitted(record, clock)?;
        let [omega, decay] = swing.drifts(&windows, noise);
        let (omega, decay) =
            (Estimated { value: swing.omega, ..omega }, Estimated { value: swing.decay, ..decay });
        let weights: f64 = windows.iter().map(|window| window.count as f64).sum();
        Ok(LinearOscillator {
            stiffness: Estimated {
                value: omega.value.powi(2) + decay.value.powi(2),
                std_error: 2.0 * libm::hypot(omega.value * omega.std_error, decay.value * decay.std_error),
            },
            damping: decay.times(2.0),
            rest: (order(record.quantity()) == 0)
                .then(|| Estimated { value: offset, std_error: noise / weights.sqrt() }),
            input_gain: None,
            basis: Basis::Samples(windows.len()),
        })
    }

    /// Returns all windows of a period whose amplitude is clear, whether or not they belong to one free decay, with the
    /// noise of a sample.
    pub(crate) fn clear_windows(&self, record: &Record, clock: &Clock) -> Option<(Vec<Window>, f64)> {
        // A hand spoils the guess, but not the free decay from the largest amplitude on.
        let fitted = self.fitted(record, clock).map(|(swing, _)| swing);
        let swing = fitted.or_else(|_| Swing::guessed(record, clock)).ok()?;
        let (windows, _) = swing.windows(&clock.times_s, TAU / swing.omega);
        let noise = median(windows.iter().map(Window::scatter).collect())?;
        let is_clear =
            |window: &Window| window.amplitude() > self.floor_in_errors * noise * window.leverage.sqrt();
        let clear = windows.into_iter().filter(is_clear).collect();
        Some((swing.turned(clear), noise))
    }

    /// Fits windows of a free decay, longer ones where the noise hides the swing in short ones.
    fn fitted(&self, record: &Record, clock: &Clock) -> Result<(Swing, Found), EnvelopeError> {
        let guess = Swing::guessed(record, clock)?;
        let mut fitted = self.settled(guess.clone(), self.window_periods, clock);
        let mut periods = self.window_periods;
        while matches!(fitted, Err(EnvelopeError::TooFewPeaks { .. })) {
            periods *= 2.0;
            if periods * TAU / guess.omega > LONGEST * clock.duration_s() {
                break;
            }
            fitted = self.settled(guess.clone(), periods, clock).or(fitted);
        }
        fitted
    }

    /// Fits windows of a length in periods and corrects the swing by them until it settles.
    fn settled(
        &self,
        mut swing: Swing,
        periods: f64,
        clock: &Clock,
    ) -> Result<(Swing, Found), EnvelopeError> {
        for _ in 0..ROUNDS {
            let found = self.round(&swing, periods, clock)?;
            let before = (swing.omega, swing.decay);
            swing = swing.corrected(&found)?;
            if libm::hypot(swing.omega - before.0, swing.decay - before.1) < SETTLED * swing.omega {
                return Ok((swing, found));
            }
        }
        let found = self.round(&swing, periods, clock)?;
        Ok((swing, found))
    }

    /// Fits the windows of a swing and keeps those of its free decay.
    fn round(&self, swing: &Swing, periods: f64, clock: &Clock) -> Result<Found, EnvelopeError> {
        let enough = (FEWEST_SAMPLES + 1) as f64 / clock.sample_rate_hz;
        let length_s = (periods * TAU / swing.omega).min(1.0 / swing.decay.max(0.0)).max(enough);
        let (windows, offset) = swing.windows(&clock.times_s, length_s);
        let noise = median(windows.iter().map(Window::scatter).collect()).unwrap_or(0.0);
        let windows = self.free_decay(&windows, noise, swing.quantum);
        if windows.len() < FEWEST_WINDOWS {
            return Err(EnvelopeError::TooFewPeaks {
                pipeline: "samples",
                found: windows.len(),
                needed: FEWEST_WINDOWS,
                remedy: format!(
                    "A swing's amplitude in windows of {length_s:.3} s must stay above {} of its standard errors; give a \
                     longer record or one with less noise, or lower envelope.samples.floor_in_errors.",
                    self.floor_in_errors
                ),
            });
        }
        Ok(Found { windows, noise, offset })
    }

    /// Returns the windows from the largest amplitude on, up to the first two that the noise hides.
    fn free_decay(&self, windows: &[Window], noise: f64, quantum: f64) -> Vec<Window> {
        let (of_noise, of_amplitude) = FOREIGN;
        let own =
            |window: &&Window| window.scatter() <= (of_noise * noise).max(of_amplitude * window.amplitude());
        let own: Vec<Window> = windows.iter().filter(own).copied().collect();
        let largest = own
            .iter()
            .enumerate()
            .max_by(|(_, one), (_, other)| one.amplitude().total_cmp(&other.amplitude()));
        let start = largest.map_or(own.len(), |(at, _)| at);
        let top = own.get(start).map_or(f64::NAN, Window::amplitude);
        let is_clear = |window: &Window| {
            let hidden = self.floor_in_errors * noise * window.leverage.sqrt();
            // Noise below the step does not make an error of the rounding random.
            let rounded = if noise < DITHERED * quantum { COARSE * quantum } else { 0.0 };
            window.amplitude() > hidden.max(rounded).max(DYNAMIC_RANGE * top)
        };
        let Some(decay) = own.get(start..) else { return Vec::new() };
        let hidden = decay.windows(2).position(|pair| !pair.iter().any(is_clear));
        decay.iter().take(hidden.unwrap_or(decay.len())).filter(|window| is_clear(window)).copied().collect()
    }
}

/// Windows of a free decay, with the noise of a sample and the rest position.
#[derive(Debug)]
struct Found {
    windows: Vec<Window>,
    noise: f64,
    offset: f64,
}

impl Swing {
    /// Takes the nearest linear oscillator, or the strongest mode of a record that swings for long enough to show
    /// modes.
    fn guessed(record: &Record, clock: &Clock) -> Result<Self, EnvelopeError> {
        let quantum = record.quantum();
        let nearest = weak::oscillator(record, clock).map(|found| {
            let decay = found.damping.times(0.5);
            ((found.stiffness.value - decay.value * decay.value).max(0.0).sqrt(), decay)
        });
        // A swing that hardly oscillates looks like a trend beside several modes. The regression needs many samples of
        // each period to say so.
        let is_strong = nearest.as_ref().is_ok_and(|(omega, decay)| {
            decay.value - 3.0 * decay.std_error > MOST_OF_A_MODE * omega
                && TAU * clock.sample_rate_hz > MANY_PER_PERIOD * omega
        });
        let mode = if is_strong { None } else { separated(record, clock) };
        if let Some(Separated { omega, decay, values }) = mode {
            return Ok(Self { omega, decay, values, quantum });
        }
        let (omega, decay) = nearest.map_err(|error| EnvelopeError::TooFewPeaks {
            pipeline: "samples",
            found: 0,
            needed: FEWEST_WINDOWS,
            remedy: error.to_string(),
        })?;
        Self { omega, decay: decay.value, values: record.values().to_vec(), quantum }.checked()
    }

    /// Refuses a motion that hardly swings.
    fn checked(self) -> Result<Self, EnvelopeError> {
        let swings = self.omega > LEAST_SWING * self.decay.abs() && self.omega.is_finite();
        if swings && self.decay.is_finite() { Ok(self) } else { Err(EnvelopeError::NoSwing) }
    }

    /// Corrects the frequency by the drift of the windows' phases, and the decay by that of their amplitudes.
    fn corrected(self, found: &Found) -> Result<Self, EnvelopeError> {
        let [omega, decay] = self.drifts(&found.windows, found.noise);
        Self { omega: self.omega - omega.value, decay: decay.value, ..self }.checked()
    }

    /// Returns windows whose phases are those of the swing's own phase at the same time.
    fn turned(&self, windows: Vec<Window>) -> Vec<Window> {
        let turn = |window: Window| {
            let (sine, cosine) = libm::sincos(self.omega * window.time);
            let (x, y) = window.parts;
            Window { parts: (x * cosine - y * sine, x * sine + y * cosine), ..window }
        };
        windows.into_iter().map(turn).collect()
    }

    /// Returns the drifts of the windows' phases from those of the swing and of the logarithms of their amplitudes
    /// downward, in 1/s.
    fn drifts(&self, windows: &[Window], noise: f64) -> [Estimated; 2] {
        let mut turned = 0.0;
        let mut before: Option<f64> = None;
        let phases = windows.iter().map(|window| {
            let (cosine, sine) = window.parts;
            let phase = libm::atan2(sine, cosine) + self.omega * window.time;
            let step = phase - before.replace(phase).unwrap_or(phase);
            turned += step - TAU * (step / TAU).round();
            turned
        });
        let phases: Vec<f64> = phases.collect();
        let logarithms: Vec<f64> = windows.iter().map(|window| -libm::log(window.amplitude())).collect();
        [slope(windows, &phases, noise), slope(windows, &logarithms, noise)]
    }

    /// Fits all windows of a length in seconds; returns them with the rest position.
    fn windows(&self, times: &[f64], length_s: f64) -> (Vec<Window>, f64) {
        let mut sums = (0.0, 0.0);
        let mut fits = Vec::new();
        let mut from = 0;
        while let Some((&start, later)) = times.get(from..).and_then(<[f64]>::split_first) {
            let to = from + 1 + later.partition_point(|time| time - start < length_s);
            let (Some(own), Some(values)) = (times.get(from..to), self.values.get(from..to)) else { break };
            let spanned = own.last().map_or(f64::NAN, |last| last - start);
            if own.len() >= FEWEST_SAMPLES && spanned >= LEAST_SPAN * length_s {
                let center = 0.5 * (start + start + spanned);
                if let Some(sum) = Sums::new(self, own, values, center) {
                    let (top, bottom) = sum.offset();
                    sums = (sums.0 + top, sums.1 + bottom);
                    fits.push(sum);
                }
            }
            from = to;
        }
        let offset = if sums.1 > 0.0 { sums.0 / sums.1 } else { 0.0 };
        (fits.iter().map(|sum| sum.window(offset)).collect(), offset)
    }
}

/// Sums over the samples of a window, from which amplitudes follow once the rest position is known.
struct Sums {
    time: f64,
    /// Inverse of the normal matrix of cosine and sine.
    inverse: Matrix2<f64>,
    /// Products of cosine and sine with 1.
    ones: Vector2<f64>,
    /// Products of cosine and sine with the values.
    products: Vector2<f64>,
    count: usize,
    sum: f64,
    squares: f64,
}

impl Sums {
    /// `None` if the samples do not tell cosine and sine apart.
    fn new(swing: &Swing, times: &[f64], values: &[f64], center: f64) -> Option<Self> {
        let (mut normal, mut ones, mut products) = (Matrix2::zeros(), Vector2::zeros(), Vector2::zeros());
        let (mut sum, mut squares) = (0.0, 0.0);
        for (&time, &value) in times.iter().zip(values) {
            let (sine, cosine) = libm::sincos(swing.omega * (time - center));
            let row = Vector2::new(cosine, sine) * libm::exp(-swing.decay * (time - center));
            normal += row * row.transpose();
            ones += row;
            products += row * value;
            sum += value;
            squares += value * value;
        }
        let inverse = normal.try_inverse()?;
        Some(Self { time: center, inverse, ones, products, count: times.len(), sum, squares })
    }

    /// Returns this window's part of the numerator and of the denominator of the rest position.
    fn offset(&self) -> (f64, f64) {
        let share = self.ones.transpose() * self.inverse;
        (self.sum - (share * self.products).x, self.count as f64 - (share * self.ones).x)
    }

    fn window(&self, offset: f64) -> Window {
        let products = self.products - self.ones * offset;
        let parts = self.inverse * products;
        let squares = self.squares - 2.0 * offset * self.sum + offset * offset * self.count as f64;
        let direction = parts.normalize();
        Window {
            time: self.time,
            parts: (parts.x, parts.y),
            leverage: (direction.transpose() * self.inverse * direction).x,
            // Rounding can make the difference of two nearly equal sums negative.
            rest: (squares - parts.dot(&products)).max(0.0),
            count: self.count,
        }
    }
}

/// Returns the slope of values of windows over time, with the weights that noise gives to phases and to logarithms
/// of amplitudes. Its standard error is that of the noise, or of the scatter about the line if that is larger.
fn slope(windows: &[Window], values: &[f64], noise: f64) -> Estimated {
    let weighted = || {
        windows
            .iter()
            .zip(values)
            .map(|(window, value)| (window.amplitude().powi(2) / window.leverage, window.time, *value))
    };
    let total: f64 = weighted().map(|(weight, ..)| weight).sum();
    let time = weighted().map(|(weight, time, _)| weight * time).sum::<f64>() / total;
    let mean = weighted().map(|(weight, _, value)| weight * value).sum::<f64>() / total;
    let squares: f64 = weighted().map(|(weight, at, _)| weight * (at - time).powi(2)).sum();
    let value =
        weighted().map(|(weight, at, value)| weight * (at - time) * (value - mean)).sum::<f64>() / squares;
    let rest: f64 =
        weighted().map(|(weight, at, own)| weight * (own - mean - value * (at - time)).powi(2)).sum();
    let freedom = windows.len().saturating_sub(2).max(1) as f64;
    Estimated { value, std_error: (noise.powi(2).max(rest / freedom) / squares).sqrt() }
}

#[cfg(test)]
#[path = "samples_pipeline_tests.rs"]
mod tests;
