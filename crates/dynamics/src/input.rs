//! Measured input.

#![allow(
    clippy::indexing_slicing,
    reason = "`Input::new` checks that there are samples, and a value for each time"
)]

use crate::error::DynamicsError;
use serde::{Deserialize, Serialize};

/// Behavior of an input between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hold {
    /// Keeps the last value, as a digital controller's output does.
    #[default]
    Zero,
    /// Changes linearly to the next value.
    Linear,
    /// Follows a smooth curve through its samples, as a sampled continuous signal does: cubic polynomials whose slopes
    /// are those of the polynomial through up to eight samples on either side. On even stamps these slopes approach
    /// those of the band-limited signal. The error of the value falls with the fourth power of the sampling interval.
    #[serde(rename = "band-limited")]
    BandLimited,
}

impl Hold {
    /// Every behavior.
    pub const ALL: [Self; 3] = [Self::Zero, Self::Linear, Self::BandLimited];

    /// Returns the name in configurations and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Linear => "linear",
            Self::BandLimited => "band-limited",
        }
    }

    /// Returns the behavior in words that follow "the input".
    #[must_use]
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Zero => "keeps its last sample",
            Self::Linear => "goes straight from sample to sample",
            Self::BandLimited => "follows a smooth curve through its samples",
        }
    }
}

/// Coefficients of 1, x, x² and x³.
pub(crate) type Cubic = [f64; 4];

/// Measured input: values at times, and the behavior in between. Before the first time it has the first
/// value, after the last time the last one.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    times: Vec<f64>,
    values: Vec<f64>,
    hold: Hold,
    /// Polynomials of the value and of its rate from each time to the next one, of the fraction of that time which
    /// has passed. Empty unless the input is thinned or band-limited.
    curves: Vec<[Cubic; 2]>,
}

/// Input on one piece: a polynomial of the seconds since `from`, which holds until `until`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub(crate) from: f64,
    pub(crate) until: f64,
    terms: Cubic,
    rate: Cubic,
}

/// Returns the coefficients of a polynomial about another point, `x` away.
fn about([a, b, c, d]: Cubic, x: f64) -> Cubic {
    [a + x * (b + x * (c + x * d)), b + x * (2.0 * c + x * 3.0 * d), c + x * 3.0 * d, d]
}

impl Piece {
    /// Returns the value at a time, and its first three Taylor coefficients there.
    pub(crate) fn expanded(&self, time: f64) -> Cubic {
        about(self.terms, time - self.from)
    }

    /// Returns the rate at a time, and its first three Taylor coefficients there.
    pub(crate) fn rate_expanded(&self, time: f64) -> Cubic {
        about(self.rate, time - self.from)
    }

    pub(crate) fn at(&self, time: f64) -> f64 {
        let [value, ..] = self.expanded(time);
        value
    }
}

/// Nodes in [−1, 1] and weights of the quadrature by Gauss and Legendre that is exact to degree seven.
///
/// # Reference
/// Abramowitz, Stegun, Handbook of Mathematical Functions, table 25.4.
const QUADRATURE: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
];

/// Number of samples to either side of one whose polynomial tells the slope there, on even stamps.
const BESIDE: usize = 8;

/// The same on uneven stamps and at the ends, where the polynomial through many samples oscillates.
const FEWEST_BESIDE: usize = 2;

/// Largest ratio of two intervals between stamps that count as even.
const EVEN: f64 = 1.5;

/// Returns the cubic polynomials from each sample to the next, and their rates.
fn smooth_curves(times: &[f64], values: &[f64]) -> Vec<[Cubic; 2]> {
    let samples: Vec<[f64; 3]> = times
        .iter()
        .zip(values)
        .enumerate()
        .map(|(at, (time, value))| [*time, *value, slope_at(times, values, at)])
        .collect();
    let curve = |([from, a, slope], [until, next, next_slope]): (&[f64; 3], &[f64; 3])| {
        let length = until - from;
        let (b, end) = (slope * length, next_slope * length);
        let (c, d) = (3.0 * (next - a) - 2.0 * b - end, 2.0 * (a - next) + b + end);
        [[*a, b, c, d], [b / length, 2.0 * c / length, 3.0 * d / length, 0.0]]
    };
    samples.iter().zip(samples.iter().skip(1)).map(curve).collect()
}

/// Returns the number of samples on either side of one whose polynomial tells the slope there.
fn reach(times: &[f64], at: usize) -> usize {
    let reach = BESIDE.min(at).min(times.len().saturating_sub(at + 1));
    // The range lies within the times.
    let near = times.get(at - reach..=at + reach).unwrap_or_default();
    let intervals = near.iter().zip(near.iter().skip(1)).map(|(before, after)| after - before);
    let (least, most) = intervals.fold((f64::INFINITY, 0.0_f64), |(a, b), own| (a.min(own), b.max(own)));
    if reach > FEWEST_BESIDE && most <= EVEN * least { reach } else { FEWEST_BESIDE }
}

/// Returns the slope at a sample of the polynomial through it and the samples within [`reach`].
fn slope_at(times: &[f64], values: &[f64], at: usize) -> f64 {
    let reach = reach(times, at);
    let near = at.saturating_sub(reach)..(at + reach + 1).min(times.len());
    let own = || near.clone().filter_map(|index| Some((index, *times.get(index)?, *values.get(index)?)));
    let Some((_, here, value)) = own().find(|(index, ..)| *index == at) else { return 0.0 };
    let beside = || own().filter(|(index, ..)| *index != at);
    // Lagrange's formula: the slopes of all basis polynomials sum to zero.
    beside()
        .map(|(index, time, other)| {
            let rest = beside().filter(|(other, ..)| *other != index);
            let basis: f64 = rest.map(|(_, third, _)| (here - third) / (time - third)).product();
            basis * (other - value) / (time - here)
        })
        .sum()
}

impl Input {
    /// Creates an input from its samples; times in seconds, values in the unit that the nominal `input_gain`
    /// converts to a torque.
    ///
    /// # Errors
    /// Returns [`DynamicsError::BadInput`] unless there is at least one sample, as many values as times, all
    /// are finite, and the times strictly increase.
    pub fn new(times: Vec<f64>, values: Vec<f64>, hold: Hold) -> Result<Self, DynamicsError> {
        let input = Self::uncurved(times, values, hold)?;
        let is_smooth = hold == Hold::BandLimited;
        let curves = if is_smooth { smooth_curves(&input.times, &input.values) } else { Vec::new() };
        Ok(Self { curves, ..input })
    }

    /// Checks the samples of an input, as [`Self::new`] does, and leaves its curves out.
    fn uncurved(times: Vec<f64>, values: Vec<f64>, hold: Hold) -> Result<Self, DynamicsError> {
        let bad = |what, index, value, remedy| Err(DynamicsError::BadInput { what, index, value, remedy });
        if times.is_empty() || times.len() != values.len() {
            return bad(
                "number of values",
                values.len(),
                times.len() as f64,
                "give one value for each time, at least one",
            );
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return bad("value", index, value, "values must be finite");
        }
        if let Some((index, &time)) = times.iter().enumerate().find(|(_, time)| !time.is_finite()) {
            return bad("time", index, time, "times must be finite");
        }
        let pairs = times.iter().zip(times.iter().skip(1));
        if let Some((index, (_, &time))) = pairs.enumerate().find(|(_, (before, after))| after <= before) {
            return bad("time", index + 1, time, "times must strictly increase");
        }
        Ok(Self { times, values, hold, curves: Vec::new() })
    }

    /// Returns the sample times in seconds, increasing; as many as [`Self::values`].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the sample values in the input's unit, before the nominal oscillator's gain.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the behavior between samples.
    #[must_use]
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// Returns the value at a time in seconds, in the input's unit.
    ///
    /// ```
    /// use dynamics::{Hold, Input};
    /// let input = Input::new(vec![0.0, 1.0], vec![2.0, 4.0], Hold::Linear)?;
    /// assert_eq!([-1.0, 0.5, 3.0].map(|time| input.at(time)), [2.0, 3.0, 4.0]);
    /// # Ok::<(), dynamics::DynamicsError>(())
    /// ```
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        self.piece(self.piece_index(time)).at(time)
    }

    /// Returns the coefficients of the polynomial that the input follows from a sample to the next one: of 1, x, x² and
    /// x³, where x is the time since the sample in seconds. After the last sample, the input is constant.
    ///
    /// ```
    /// use dynamics::{Hold, Input};
    /// let input = Input::new(vec![0.0, 0.5], vec![2.0, 4.0], Hold::Linear)?;
    /// assert_eq!(input.cubic(0), [2.0, 4.0, 0.0, 0.0]);
    /// # Ok::<(), dynamics::DynamicsError>(())
    /// ```
    #[must_use]
    pub fn cubic(&self, sample: usize) -> [f64; 4] {
        self.piece(sample + 1).terms
    }

    /// Returns the input at other times: as many, in seconds.
    ///
    /// # Errors
    /// Returns [`DynamicsError::BadInput`] for times that [`Self::new`] would refuse.
    pub fn with_times(&self, times: Vec<f64>) -> Result<Self, DynamicsError> {
        let followed = Self::uncurved(times, self.values.clone(), self.hold)?;
        Ok(Self { curves: self.curves.clone(), ..followed })
    }

    /// Returns the input multiplied by a factor.
    ///
    /// # Errors
    /// Returns [`DynamicsError::BadInput`] if a value is not finite any more.
    pub fn scaled(&self, factor: f64) -> Result<Self, DynamicsError> {
        let values = self.values.iter().map(|value| value * factor).collect();
        let curves = self.curves.iter().map(|curve| curve.map(|own| own.map(|term| term * factor))).collect();
        Ok(Self { curves, ..Self::uncurved(self.times.clone(), values, self.hold)? })
    }

    /// Returns the input with one cubic polynomial in place of every `count` samples. A `count` of 0 or 1
    /// changes nothing.
    ///
    /// Each polynomial is the one that lies closest to the input over its time (least squares). The remainder
    /// is orthogonal to cubic polynomials. So a system that is slow in comparison moves the same way to eighth
    /// order in the length of the pieces, and an integration by Taylor series takes a step from piece to piece
    /// in place of one from sample to sample.
    ///
    /// ```
    /// use dynamics::{Hold, Input};
    /// let times: Vec<f64> = (0..61).map(|at| 0.1 * f64::from(at)).collect();
    /// let input = Input::new(times.clone(), times.iter().map(|t| t.sin()).collect(), Hold::Linear)?;
    /// let thinned = input.thinned(10);
    /// assert_eq!(thinned.times().len(), 7);
    /// assert!(times.iter().all(|time| (thinned.at(*time) - time.sin()).abs() < 2e-3));
    /// # Ok::<(), dynamics::DynamicsError>(())
    /// ```
    #[must_use]
    pub fn thinned(&self, count: usize) -> Self {
        let last = self.times.len().saturating_sub(1);
        if count < 2 || last == 0 {
            return self.clone();
        }
        let kept: Vec<usize> = (0..last).step_by(count).chain([last]).collect();
        let value: fn(&Piece, f64) -> f64 = Piece::at;
        let rate: fn(&Piece, f64) -> f64 = |piece, time| {
            let [rate, ..] = piece.rate_expanded(time);
            rate
        };
        let curves = kept.iter().zip(kept.iter().skip(1));
        let curves = curves.map(|(&from, &until)| [value, rate].map(|of| self.closest(from, until, of)));
        let of = |list: &[f64]| kept.iter().filter_map(|&index| list.get(index).copied()).collect();
        Self { times: of(&self.times), values: of(&self.values), hold: self.hold, curves: curves.collect() }
    }

    /// Returns the polynomial that is closest to the input, or to its rate, from one sample to another, as a sum of the
    /// Legendre polynomials P₀ to P₃: their coefficients are the projections of what `of` returns.
    fn closest(&self, from: usize, until: usize, of: fn(&Piece, f64) -> f64) -> Cubic {
        let (begin, end) = (self.piece(from).until, self.piece(until).until);
        let mut projections = [0.0; 4];
        for index in from + 1..=until {
            let piece = self.piece(index);
            let half = 0.5 * (piece.until - piece.from);
            for (node, weight) in QUADRATURE {
                let time = piece.from + half * (1.0 + node);
                let x = (2.0 * time - begin - end) / (end - begin);
                let part = weight * half / (end - begin) * of(&piece, time);
                let legendre = [1.0, x, 1.5 * x * x - 0.5, (2.5 * x * x - 1.5) * x];
                for (sum, value) in projections.iter_mut().zip(legendre) {
                    *sum += part * value;
                }
            }
        }
        let [p0, p1, p2, p3] = projections;
        let (p1, p2, p3) = (3.0 * p1, 5.0 * p2, 7.0 * p3);
        // With x = 2s − 1, where s is the fraction of the time.
        [p0 - p1 + p2 - p3, 2.0 * p1 - 6.0 * p2 + 12.0 * p3, 6.0 * p2 - 30.0 * p3, 20.0 * p3]
    }

    /// Returns the piece that begins at sample `index − 1` and ends at sample `index`; 0 is the piece before
    /// the first.
    pub(crate) fn piece(&self, index: usize) -> Piece {
        debug_assert_eq!(self.times.len(), self.values.len(), "an input has a value for every time");
        let at = |list: &[f64], index: usize| list.get(index).copied();
        let until = at(&self.times, index).unwrap_or(f64::INFINITY);
        let before =
            index.checked_sub(1).and_then(|before| at(&self.times, before).zip(at(&self.values, before)));
        let Some((from, value)) = before else {
            return Piece { from: until, until, terms: [self.values[0], 0.0, 0.0, 0.0], rate: [0.0; 4] };
        };
        let length = until - from;
        let scaled = |[a, b, c, d]: Cubic| [a, b / length, c / length.powi(2), d / length.powi(3)];
        let (terms, rate) = match (self.curves.get(index - 1), self.hold, at(&self.values, index)) {
            (Some(&[value, rate]), ..) => (scaled(value), scaled(rate)),
            (None, Hold::Linear, Some(next)) => {
                let slope = (next - value) / length;
                ([value, slope, 0.0, 0.0], [slope, 0.0, 0.0, 0.0])
            }
            _ => ([value, 0.0, 0.0, 0.0], [self.step_rate(index - 1), 0.0, 0.0, 0.0]),
        };
        Piece { from, until, terms, rate }
    }

    /// Returns the step to a sample from the one before, over the time between the two: the rate that a digital
    /// controller computes of a held input. 0 at the first sample.
    fn step_rate(&self, index: usize) -> f64 {
        let Some(before) = index.checked_sub(1) else { return 0.0 };
        (self.values[index] - self.values[before]) / (self.times[index] - self.times[before])
    }

    /// Returns the rate at a time in seconds, in the input's unit per second.
    #[must_use]
    pub fn rate_at(&self, time: f64) -> f64 {
        let [rate, ..] = self.piece(self.piece_index(time)).rate_expanded(time);
        rate
    }

    /// Returns the index of the piece that holds just after a time.
    pub(crate) fn piece_index(&self, time: f64) -> usize {
        self.times.partition_point(|&knot| knot <= time)
    }
}

#[cfg(test)]
mod tests {
    use super::{Hold, Input};

    /// A cubic polynomial stays one; with zero-order hold it is the one through the middles of its steps.
    #[test]
    fn few_pieces_of_a_polynomial_lie_on_it() {
        let times: Vec<f64> = (0..101).map(|at| 0.01 * f64::from(at)).collect();
        let of = |t: f64| 1.0 - t + 2.0 * t * t - 3.0 * t * t * t;
        for (hold, ahead, most) in [(Hold::Linear, 0.0, 2e-4), (Hold::Zero, 0.005, 5e-3)] {
            let input = Input::new(times.clone(), times.iter().map(|t| of(*t)).collect(), hold).unwrap();
            let thinned = input.thinned(40);
            assert_eq!(thinned.times(), [0.0, 0.4, 0.8, 1.0]);
            for time in times.iter().take(100) {
                let error = thinned.at(*time) - of(time - ahead);
                assert!(error.abs() < most, "{hold:?} {time} {error}");
            }
            let moved = thinned.with_times(vec![1.0, 1.8, 2.6, 3.0]).unwrap().scaled(-2.0).unwrap();
            assert!((moved.at(1.5) + 2.0 * thinned.at(0.25)).abs() < 1e-14);
        }
    }

    /// Halving the sampling interval divides the error of a band-limited sine by sixteen, and that of its rate by eight.
    #[test]
    fn a_band_limited_input_follows_a_sampled_sine() {
        let worst = |interval: f64| {
            let times: Vec<f64> = (0..(4.0 / interval) as usize).map(|at| interval * at as f64).collect();
            let values = times.iter().map(|t| (3.0 * t).sin()).collect();
            let input = Input::new(times, values, Hold::BandLimited).unwrap();
            let within = (0..1000).map(|at| 1.0 + 0.002 * f64::from(at));
            let errors = within.map(|t| {
                [(input.at(t) - (3.0 * t).sin()).abs(), (input.rate_at(t) - 3.0 * (3.0 * t).cos()).abs()]
            });
            errors.fold([0.0; 2], |[a, b]: [f64; 2], [c, d]| [a.max(c), b.max(d)])
        };
        let ([value, rate], [finer_value, finer_rate]) = (worst(0.1), worst(0.05));
        assert!((12.0..20.0).contains(&(value / finer_value)), "{value} {finer_value}");
        assert!((6.0..20.0).contains(&(rate / finer_rate)), "{rate} {finer_rate}");
        assert!(finer_value < 5e-6 && finer_rate < 1e-3, "{finer_value} {finer_rate}");
    }

    /// At three samples per period, the slopes of five samples are off by a third.
    #[test]
    fn a_band_limited_input_follows_a_sine_of_few_samples() {
        let rate = std::f64::consts::TAU / 3.0;
        let of = |at: usize| (rate * at as f64 + 0.4).sin();
        let input = |stamp: fn(usize) -> f64| {
            let times = (0..60).map(stamp).collect();
            Input::new(times, (0..60).map(of).collect(), Hold::BandLimited).unwrap()
        };
        let slope = rate * (rate * 30.0 + 0.4).cos();
        let [_, even, ..] = input(|at| at as f64).cubic(30);
        assert!((even / slope - 1.0).abs() < 0.05, "{even} {slope}");
        // A gap beside the sample, where a polynomial through many samples would oscillate.
        let [_, beside_a_gap, ..] = input(|at| at as f64 + if at > 31 { 9.0 } else { 0.0 }).cubic(30);
        assert!((beside_a_gap / slope - 1.0).abs() < 1.0, "{beside_a_gap} {slope}");
    }

    /// A held input changes by its steps, which a digital controller divides by the time between them.
    #[test]
    fn the_rate_of_a_held_input_is_that_of_its_last_step() {
        let input = Input::new(vec![0.0, 0.5, 1.0], vec![1.0, 3.0, 2.0], Hold::Zero).unwrap();
        assert_eq!([0.2, 0.7, 1.4].map(|time| input.rate_at(time)), [0.0, 4.0, -2.0]);
    }

    /// The first coefficients are those of the polynomial moved to the time.
    #[test]
    fn an_expansion_is_the_same_polynomial() {
        let times: Vec<f64> = (0..9).map(f64::from).collect();
        let input = Input::new(times.clone(), times.iter().map(|t| t.sin()).collect(), Hold::Linear).unwrap();
        let piece = input.thinned(8).piece(1);
        let [a, b, c, d] = piece.expanded(2.0);
        let expected = piece.at(5.0);
        assert!((a + 3.0 * (b + 3.0 * (c + 3.0 * d)) - expected).abs() < 1e-12);
    }

    /// The response of a slow system to a sine is its product with smooth bumps. It differs by the eighth
    /// power of the pieces' length: about 256 times as much at twice the length.
    #[test]
    fn a_slow_system_feels_the_same() {
        let times: Vec<f64> = (0..4001).map(|at| 1e-3 * f64::from(at)).collect();
        let sine: Vec<f64> = times.iter().map(|t| (40.0 * t).sin()).collect();
        // In the middle of each hundredth of a sample: at its jumps a held input has no value.
        let middles: Vec<f64> = (0..200_000).map(|at| 1.0 + 1e-5 * (f64::from(at) + 0.5)).collect();
        let felt = |input: &Input| -> f64 {
            let of = |time: f64| input.at(time) * (-(time - 2.0).powi(2) / 0.02).exp() * (40.0 * time).sin();
            middles.iter().map(|time| of(*time)).sum::<f64>()
        };
        for hold in [Hold::Linear, Hold::Zero] {
            let input = Input::new(times.clone(), sine.clone(), hold).unwrap();
            let error = |count: usize| (felt(&input.thinned(count)) / felt(&input) - 1.0).abs();
            let (near, far) = (error(30), error(60));
            assert!(near < 1e-5 && (100.0..400.0).contains(&(far / near)), "{hold:?} {near} {far}");
        }
    }
}
