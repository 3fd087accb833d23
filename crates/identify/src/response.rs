//! Linear oscillator whose simulated response is nearest to a record: least squares on the samples
//! (output-error method; Ljung, System Identification, 1999, chapter 4).
//!
//! ẍ = −c·ẋ − k·x + g·u(t) + b from x₀, v₀, integrated together with its derivatives with respect to the six
//! numbers. A regression over windows gives the first guess; it weighs the noise less well, since it differentiates.

mod jumps;

use crate::observed::{input, order};
use crate::scaled::{inverse, solve};
use crate::{Basis, Estimated, LinearOscillator};
use least_squares::{Descent, Method};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use record::{Clock, Record, noise_level};
use std::f64::consts::PI;

/// Number of the fitted numbers.
const COUNT: usize = 6;
/// Place of the input's gain among them.
const GAIN: usize = 2;

/// Position and velocity, or their derivatives.
type Pair = [f64; 2];

/// The fitted numbers.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    stiffness: f64,
    damping: f64,
    gain: f64,
    /// Acceleration at rest, or what a sensor of a velocity or an acceleration shows then.
    shift: f64,
    start: Pair,
}

impl Numbers {
    fn moved(self, step: &[f64; COUNT]) -> Self {
        let [stiffness, damping, gain, shift, position, velocity] = *step;
        let [x, v] = self.start;
        Self {
            stiffness: self.stiffness + stiffness,
            damping: self.damping + damping,
            gain: self.gain + gain,
            shift: self.shift + shift,
            start: [x + position, v + velocity],
        }
    }
}

/// Method of the fit.
const METHOD: Method =
    Method { first: 1e-6, max_steps: 40, tolerance: 1e-10, max_damping: 1e7, ..Method::TENFOLD };
/// Longest integration step, in radians of the natural frequency or of the damping.
const LONGEST: f64 = 0.15;
/// Most integration steps between two samples.
const MOST_STEPS: f64 = 200.0;
/// Residuals of a linear system's response, in units of the noise.
const LINEAR: f64 = 4.0;
/// Lowest guess of a natural frequency, in radians per record, and highest one, in radians per sampling interval.
const SLOWEST: f64 = 10.0;
const FASTEST: f64 = 1.0;
/// Number of guesses of the frequency, and those of the damping ratio.
const GRID: u32 = 16;
const DAMPINGS: [f64; 2] = [0.1, 0.5];
/// Largest part of a record's variance that a response may leave.
const UNEXPLAINED: f64 = 0.8;
/// Ratio of the mean squares that two fits leave, from which the part that the second leaves out is no part of the motion.
const BETTER: f64 = 2.0;
/// Variance of residuals, in that of the noise, from which they are more than noise.
const BEYOND: f64 = 1.3;
/// First guesses of the natural frequency of a record that does not swing, in radians per record, for a damping ratio
/// of 1.
const CREEPING: [f64; 4] = [3.0, 8.0, 20.0, 60.0];

/// Fits the response to an input, from a first guess and from the best of many others. `None` without a changing
/// input or a spring, or if it leaves far more than the noise where there is a guess.
pub(crate) fn driven(
    record: &Record,
    clock: &Clock,
    guess: Option<&LinearOscillator>,
) -> Option<LinearOscillator> {
    let pushes = input(record, clock)?;
    let guess = guess.map(|guess| [guess.stiffness.value, guess.damping.value.max(0.0)]);
    let (slowest, fastest) = (SLOWEST / clock.duration_s(), FASTEST * clock.sample_rate_hz);
    let noise = noise_of(record);
    let fits = [true, false].map(|kept| {
        let problem = Problem::new(record, clock, (&pushes, kept), 0, noise);
        let grid = (0..GRID).flat_map(|number| {
            let omega = slowest * libm::pow(fastest / slowest, f64::from(number) / f64::from(GRID - 1));
            DAMPINGS.map(|ratio| [omega * omega, 2.0 * ratio * omega])
        });
        let left = |start: &[f64; 2]| problem.best_of(*start).map_or(f64::INFINITY, |(_, sums)| sums.rest);
        let best = grid.min_by(|one, other| left(one).total_cmp(&left(other)));
        nearest(guess.into_iter().chain(best).filter_map(|start| problem.fitted(start)))
    });
    let found = nearest(fits.into_iter().flatten())?;
    let start = [found.1.stiffness.value, found.1.damping.value];
    let jumping = jumps::jumping(&pushes, 1.0 / clock.sample_rate_hz, |pushes, kept| {
        Problem::new(record, clock, (pushes, kept), 0, noise).fitted(start)
    });
    let (rest, found) = nearest(jumping.into_iter().chain([found]))?;
    // A response misses much more of a system that is not linear than a regression over short windows.
    let is_linear = rest < record.len() as f64 * (LINEAR * noise).powi(2);
    sprung(Some((rest, found)), record).filter(|_| is_linear || guess.is_none())
}

/// Returns the noise of the observed column, of which rounding is a part.
fn noise_of(record: &Record) -> f64 {
    noise_level(record.values()).max(record.quantum())
}

/// Fits a motion that returns to rest in a few cycles or without a swing, from first guesses and from others. `None` if
/// nothing pulls it back.
pub(crate) fn returning<'a>(
    record: &Record,
    clock: &Clock,
    guesses: impl IntoIterator<Item = &'a LinearOscillator>,
) -> Option<LinearOscillator> {
    // Samples tell no frequency from its image beyond half their rate.
    let highest = PI * clock.sample_rate_hz;
    let creeping = CREEPING.map(|omega| omega / clock.duration_s()).map(|omega| [omega * omega, 2.0 * omega]);
    let guesses = guesses.into_iter().map(|guess| [guess.stiffness.value, guess.damping.value]);
    let starts: Vec<[f64; 2]> = guesses.chain(creeping).collect();
    let fit = |from: usize| {
        let problem = Problem::new(record, clock, (&[], false), from, noise_of(record));
        let fits = starts.iter().filter_map(|start| problem.fitted(*start));
        let found = nearest(fits.filter(|(_, found)| found.stiffness.value < highest * highest))?;
        Some((found.0 / problem.samples as f64, found))
    };
    let whole = fit(0);
    // The first samples after a release tell the faster of two decays: they are left out only if they are no part of it.
    let after = Some(record.samples_at_rest()).filter(|held| *held > 0).and_then(fit);
    let is_after = |square: f64| whole.as_ref().is_none_or(|(of_whole, _)| *of_whole > BETTER * square);
    let found = after.filter(|(square, _)| is_after(*square)).or(whole);
    sprung(found.map(|(_, found)| found), record)
}

/// Returns the fit with the smallest residuals.
fn nearest(fits: impl Iterator<Item = (f64, LinearOscillator)>) -> Option<(f64, LinearOscillator)> {
    fits.min_by(|(one, _), (other, _)| one.total_cmp(other))
}

/// Returns the oscillator of a fit if a spring pulls it back, and if it explains a part of the record that noise does not.
fn sprung(fit: Option<(f64, LinearOscillator)>, record: &Record) -> Option<LinearOscillator> {
    let (rest, found) = fit?;
    let values = record.values();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let total: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let is_seen = rest < UNEXPLAINED * total;
    (is_seen && found.stiffness.value > 0.0 && found.stiffness.is_significant()).then_some(found)
}

/// Time from which the input changes at a constant rate.
struct Knot {
    time: f64,
    push: f64,
    rate: f64,
    /// Sample at this time.
    value: Option<f64>,
}

/// Samples and input of a record.
struct Problem {
    knots: Vec<Knot>,
    samples: usize,
    is_driven: bool,
    /// Number of time derivatives that the observed quantity already has.
    order: usize,
    /// Noise of the samples.
    noise: f64,
    /// Time between samples, in seconds.
    interval: f64,
}

/// Sums of a simulation over the samples.
struct Sums {
    normal: SMatrix<f64, COUNT, COUNT>,
    slope: SVector<f64, COUNT>,
    /// Sum of the squared residuals.
    rest: f64,
    /// Sum of the products of neighboring residuals.
    next: f64,
}

/// Position and velocity, and their derivatives with respect to each of the numbers.
#[derive(Debug, Clone, Copy)]
struct State {
    own: Pair,
    by: [Pair; COUNT],
}

impl State {
    /// Returns the state after a step at given rates.
    fn plus(mut self, step: f64, rates: &Self) -> Self {
        let pairs = std::iter::once(&mut self.own).chain(&mut self.by);
        for (own, rate) in pairs.zip(std::iter::once(&rates.own).chain(&rates.by)) {
            for (value, rate) in own.iter_mut().zip(rate) {
                *value += step * rate;
            }
        }
        self
    }
}

impl Problem {
    /// Takes the samples from a number on; `kept` is `true` if an input stays between its samples.
    fn new(
        record: &Record,
        clock: &Clock,
        (pushes, kept): (&[(f64, f64)], bool),
        from: usize,
        noise: f64,
    ) -> Self {
        let samples: Vec<(f64, f64)> =
            clock.times_s.iter().copied().zip(record.values().iter().copied()).skip(from).collect();
        let at: Vec<(f64, f64)> = if pushes.is_empty() {
            samples.iter().map(|(time, _)| (*time, 0.0)).collect()
        } else {
            pushes.to_vec()
        };
        let mut rest = samples.iter().peekable();
        let mut knots: Vec<Knot> = Vec::with_capacity(at.len());
        for (index, &(time, push)) in at.iter().enumerate() {
            let next = at.get(index + 1).filter(|next| !kept && next.0 > time);
            let rate = next.map_or(0.0, |next| (next.1 - push) / (next.0 - time));
            let value = rest.next_if(|sample| sample.0 <= time).map(|sample| sample.1);
            knots.push(Knot { time, push, rate, value });
        }
        Self {
            knots,
            samples: samples.len(),
            is_driven: !pushes.is_empty(),
            order: order(record.quantity()),
            noise,
            interval: 1.0 / clock.sample_rate_hz,
        }
    }

    /// Fits all numbers from a stiffness and a damping; returns the sum of the squared residuals, and the oscillator.
    fn fitted(&self, start: [f64; 2]) -> Option<(f64, LinearOscillator)> {
        let mut best = self.best_of(start)?;
        let mut descent = Descent::new(METHOD);
        while let Ok(damping) = descent.next_damping() {
            let next = self.step(&best.1, damping).map(|step| best.0.moved(&step));
            let next = next.and_then(|next| Some((next, self.sums(&next)?)));
            descent.advance(&mut best, next, |(_, sums)| sums.rest);
        }
        let (numbers, sums) = best;
        Some((sums.rest, self.oscillator(&numbers, &sums)?))
    }

    /// Returns the best numbers for a stiffness and a damping: the motion is linear in the others, and a system at rest
    /// tells nothing of the two.
    fn best_of(&self, [stiffness, damping]: [f64; 2]) -> Option<(Numbers, Sums)> {
        let at_rest = Numbers { stiffness, damping, gain: 0.0, shift: 0.0, start: [0.0; 2] };
        let numbers = at_rest.moved(&self.step(&self.sums(&at_rest)?, 0.0)?);
        Some((numbers, self.sums(&numbers)?))
    }

    /// Returns the numbers that the record determines.
    fn free(&self) -> Vec<usize> {
        (0..COUNT).filter(|number| *number != GAIN || self.is_driven).collect()
    }

    /// Returns the step of the method of Levenberg and Marquardt in all numbers that the motion depends on.
    fn step(&self, sums: &Sums, lambda: f64) -> Option<[f64; COUNT]> {
        let mut free = self.free();
        free.retain(|at| sums.normal.get((*at, *at)).is_some_and(|size| *size > 0.0));
        let mut normal = self.normal(sums, &free)?;
        for at in 0..free.len() {
            *normal.get_mut((at, at))? *= 1.0 + lambda;
        }
        let slope =
            DVector::from_iterator(free.len(), free.iter().filter_map(|at| sums.slope.get(*at).copied()));
        let solution = solve(&normal, &slope)?;
        let mut step = [0.0; COUNT];
        for (at, value) in free.iter().zip(solution.iter()) {
            *step.get_mut(*at)? = *value;
        }
        Some(step)
    }

    fn normal(&self, sums: &Sums, free: &[usize]) -> Option<DMatrix<f64>> {
        let entries =
            free.iter().flat_map(|row| free.iter().map(|column| sums.normal.get((*row, *column)).copied()));
        let entries = entries.collect::<Option<Vec<f64>>>()?;
        Some(DMatrix::from_row_slice(free.len(), free.len(), &entries))
    }

    fn oscillator(&self, numbers: &Numbers, sums: &Sums) -> Option<LinearOscillator> {
        let free = self.free();
        let freedom = self.samples.checked_sub(free.len()).filter(|freedom| *freedom > 0)? as f64;
        let inverse = inverse(&self.normal(sums, &free)?)?;
        // Residuals of which neighbors are alike tell less: those of a first-order autoregression.
        let alike = (sums.next / sums.rest).clamp(0.0, 0.999);
        let own = sums.rest / freedom;
        let variance = (own * (1.0 + alike) / (1.0 - alike)).max(self.resonant(numbers, own));
        let std_error = |number: usize| {
            let at = free.iter().position(|free| *free == number)?;
            Some((variance * inverse.get((at, at))?).sqrt())
        };
        let estimated = |value: f64, number: usize| Some(Estimated { value, std_error: std_error(number)? });
        let (stiffness, damping) = (estimated(numbers.stiffness, 0)?, estimated(numbers.damping, 1)?);
        let shift = estimated(numbers.shift, 3).filter(|_| self.order == 0);
        let usable = stiffness.value.is_finite() && stiffness.value > 0.0 && damping.std_error.is_finite();
        usable.then_some(LinearOscillator {
            stiffness,
            damping,
            rest: shift.map(|shift| shift.times(1.0 / stiffness.value)),
            input_gain: estimated(numbers.gain, GAIN),
            basis: Basis::Response(self.samples),
        })
    }

    /// Returns the variance of a sample at the resonance if residuals of a variance `own` are, beyond the noise, an answer of
    /// the system to pushes that the input does not hold, such as its own noise: white pushes make the variance s² and the
    /// density 2 s² / (ζω₀) at ω₀, that of white noise with the variance s² / (ζω₀ Δt) for samples Δt apart.
    ///
    /// Source: Lin, Probabilistic Theory of Structural Dynamics, McGraw-Hill 1967, section 5.1.
    fn resonant(&self, numbers: &Numbers, own: f64) -> f64 {
        let noise = self.noise * self.noise;
        let memory = 2.0 / (numbers.damping.abs() * self.interval);
        if !self.is_driven || own < BEYOND * noise {
            return own;
        }
        noise + (own - noise) * memory.clamp(1.0, self.samples as f64)
    }

    /// Simulates the record; `None` if the motion runs away.
    fn sums(&self, numbers: &Numbers) -> Option<Sums> {
        let fastest = numbers.stiffness.abs().sqrt().max(numbers.damping.abs());
        let mut sums = Sums { normal: SMatrix::zeros(), slope: SVector::zeros(), rest: 0.0, next: 0.0 };
        let none = [0.0; 2];
        let mut state = State { own: numbers.start, by: [none, none, none, none, [1.0, 0.0], [0.0, 1.0]] };
        let mut before: Option<f64> = None;
        for (knot, next) in self.knots.iter().zip(self.knots.iter().skip(1).map(Some).chain([None])) {
            if let Some(value) = knot.value {
                let (seen, row) = self.seen(numbers, &state, knot.push);
                let residual = value - seen;
                sums.normal += row * row.transpose();
                sums.slope += row * residual;
                sums.rest += residual * residual;
                if let Some(before) = before.replace(residual) {
                    sums.next += residual * before;
                }
            }
            let Some(next) = next else { break };
            let steps = ((next.time - knot.time) * fastest / LONGEST).ceil().clamp(1.0, MOST_STEPS);
            let step = (next.time - knot.time) / steps;
            for number in 0..steps as usize {
                let push = knot.push + knot.rate * step * number as f64;
                state = self.advanced(numbers, &state, push, knot.rate, step);
            }
        }
        sums.rest.is_finite().then_some(sums)
    }

    /// Returns what the sensor sees, and its derivatives with respect to the numbers.
    fn seen(&self, numbers: &Numbers, state: &State, push: f64) -> (f64, SVector<f64, COUNT>) {
        let rates = self.rates(numbers, state, push);
        let of = |[position, velocity]: Pair, [_, acceleration]: Pair| match self.order {
            0 => position,
            1 => velocity,
            _ => acceleration,
        };
        let by = state.by.iter().zip(&rates.by).map(|(own, rate)| of(*own, *rate));
        let mut row = SVector::from_iterator(by);
        let seen = of(state.own, rates.own);
        if self.order == 0 {
            return (seen, row);
        }
        // A sensor of the velocity or of the acceleration sees no rest position, but has one of its own.
        if let Some(by_shift) = row.get_mut(3) {
            *by_shift = 1.0;
        }
        (seen + numbers.shift, row)
    }

    /// Returns the derivatives of the state by time.
    fn rates(&self, numbers: &Numbers, state: &State, push: f64) -> State {
        let Numbers { stiffness, damping, gain, shift, .. } = *numbers;
        let rate = |[x, v]: Pair, pushed: f64| [v, pushed - damping * v - stiffness * x];
        let acts = if self.order == 0 { 1.0 } else { 0.0 };
        let ([x, v], [by_stiffness, by_damping, by_gain, by_shift, by_position, by_velocity]) =
            (state.own, state.by);
        State {
            own: rate(state.own, gain * push + acts * shift),
            by: [
                rate(by_stiffness, -x),
                rate(by_damping, -v),
                rate(by_gain, push),
                rate(by_shift, acts),
                rate(by_position, 0.0),
                rate(by_velocity, 0.0),
            ],
        }
    }

    /// Takes a step by the classical method of Runge and Kutta.
    fn advanced(&self, numbers: &Numbers, state: &State, push: f64, rate: f64, step: f64) -> State {
        let middle = push + 0.5 * rate * step;
        let one = self.rates(numbers, state, push);
        let two = self.rates(numbers, &state.plus(0.5 * step, &one), middle);
        let three = self.rates(numbers, &state.plus(0.5 * step, &two), middle);
        let four = self.rates(numbers, &state.plus(step, &three), push + rate * step);
        let weights = [(&one, 1.0), (&two, 2.0), (&three, 2.0), (&four, 1.0)];
        weights.iter().fold(*state, |state, (rates, weight)| state.plus(step / 6.0 * weight, rates))
    }
}

#[cfg(test)]
mod tests {
    use crate::identify;
    use rand_distr::{Distribution, Normal};
    use record::{Clock, ClockChoice, Quantity, Record};
    use seed::Seed;

    /// Return from 1 of a system of natural frequency 1 Hz, with a rest position of 0.3.
    fn returning(zeta: f64, noise: f64, seed: u64) -> Record {
        let omega = std::f64::consts::TAU;
        let root = omega * (zeta * zeta - 1.0).sqrt();
        let normal = Normal::new(0.0, noise).unwrap();
        let mut draws = Seed::new(seed).child("noise").generator();
        let times: Vec<f64> = (0..600).map(|at| 0.01 * f64::from(at)).collect();
        let motion = |time: f64| {
            (-zeta * omega * time).exp() * ((root * time).cosh() + zeta * omega / root * (root * time).sinh())
        };
        let values = times.iter().map(|time| 0.3 + motion(*time) + normal.sample(&mut draws)).collect();
        Record::new(times, values, None, Quantity::Position, "rad").unwrap()
    }

    #[test]
    fn noise_is_no_response() {
        for seed in 0..5 {
            let normal = Normal::new(0.0, 1.0).unwrap();
            let mut draws = Seed::new(seed).child("noise").generator();
            let times: Vec<f64> = (0..3000).map(|at| 0.01 * f64::from(at)).collect();
            let values = times.iter().map(|_| normal.sample(&mut draws)).collect();
            let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
            let found = identify(&record, &Clock::new(&record, ClockChoice::Auto).unwrap()).unwrap();
            let frequency = found.natural_frequency_hz();
            assert!(frequency.is_none_or(|own| own.std_error > 0.03 * own.value), "{seed}: {found:?}");
        }
    }

    /// Regression: the rest before a step was fitted as motion, and its few turning points told the frequency to 1 %.
    #[test]
    fn a_step_after_a_rest_is_fitted_from_its_beginning() {
        let (normal, mut draws) = (Normal::new(0.0, 5e-3).unwrap(), Seed::new(4).child("noise").generator());
        let (zeta, omega) = (0.27, std::f64::consts::TAU);
        let root = omega * (1.0_f64 - zeta * zeta).sqrt();
        let step = |time: f64| {
            let decay = (-zeta * omega * time).exp();
            1.0 - decay * ((root * time).cos() + zeta * omega / root * (root * time).sin())
        };
        let times: Vec<f64> = (0..400).map(|at| 0.01 * f64::from(at)).collect();
        let motion = |time: f64| if time < 0.7 { 0.0 } else { step(time - 0.7) };
        let values = times.iter().map(|time| motion(*time) + normal.sample(&mut draws)).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        let found = identify(&record, &Clock::new(&record, ClockChoice::Auto).unwrap()).unwrap();
        let (frequency, ratio) = (found.natural_frequency_hz().unwrap(), found.damping_ratio().unwrap());
        assert!((frequency.value - 1.0).abs() < 3e-3, "{frequency:?}");
        assert!((ratio.value - zeta).abs() < 4.0 * ratio.std_error, "{ratio:?}");
    }

    #[test]
    fn a_return_without_a_swing_has_a_damping_ratio() {
        for (zeta, seed) in [(1.001, 1), (1.3, 2), (2.0, 3)] {
            let record = returning(zeta, 2e-3, seed);
            let found = identify(&record, &Clock::new(&record, ClockChoice::Auto).unwrap()).unwrap();
            let ratio = found.damping_ratio().unwrap();
            assert!((ratio.value / zeta - 1.0).abs() < 0.1, "{zeta}: {ratio:?}");
            assert!((found.rest.unwrap().value - 0.3).abs() < 1e-3);
        }
    }
}
