//! Simulated oscillator and its peaks.

use crate::dual::Dual;
use std::ops::{Add, Mul, Sub};

/// Numbers of substeps in the rows of the extrapolation.
const SUBSTEPS: [u32; 8] = [2, 4, 6, 8, 10, 12, 14, 16];

/// Most corrections of a peak's time; three are enough if the motion is an oscillation.
const MOST_CORRECTIONS: usize = 20;

/// Law of damping.
pub(crate) trait Damping: Copy {
    /// Returns the deceleration at a velocity.
    fn deceleration(&self, velocity: Dual) -> Dual;

    /// Returns the law for a motion whose amplitudes are `factor` times as large as those that the returned
    /// law is used with.
    fn for_amplitudes(&self, factor: f64) -> Self;
}

/// Viscous damping: the deceleration 2λθ'.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Viscous {
    pub(crate) rate: Dual,
}

impl Damping for Viscous {
    fn deceleration(&self, velocity: Dual) -> Dual {
        self.rate * velocity * 2.0
    }

    fn for_amplitudes(&self, _factor: f64) -> Self {
        *self
    }
}

#[derive(Debug, Clone, Copy)]
struct State {
    position: Dual,
    velocity: Dual,
}

impl State {
    fn is_finite(self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}

impl Add for State {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { position: self.position + other.position, velocity: self.velocity + other.velocity }
    }
}

impl Sub for State {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { position: self.position - other.position, velocity: self.velocity - other.velocity }
    }
}

impl Mul<Dual> for State {
    type Output = Self;
    fn mul(self, factor: Dual) -> Self {
        Self { position: self.position * factor, velocity: self.velocity * factor }
    }
}

/// Peak of the simulated motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    pub(crate) time: Dual,
    /// Logarithm of the height, relative to that of the first peak.
    pub(crate) log_height: Dual,
}

/// Oscillator θ'' = −ω₀²θ − damping(θ').
#[derive(Debug, Clone, Copy)]
pub(crate) struct Oscillator<D> {
    /// Stiffness ω₀².
    pub(crate) stiffness: Dual,
    pub(crate) damping: D,
}

impl<D: Damping> Oscillator<D> {
    /// Returns the peaks of a motion that is released at height 1 at time 0 (the first peak), up to the first
    /// one at or after `duration`. `step` is the integration step. `None` if the motion is not finite or has
    /// no further peak.
    pub(crate) fn peaks(mut self, duration: f64, step: f64) -> Option<Vec<Peak>> {
        let first = Peak { time: Dual::constant(0.0), log_height: Dual::constant(0.0) };
        let mut peaks = vec![first];
        let mut last = first;
        let mut state = State { position: Dual::constant(1.0), velocity: Dual::constant(0.0) };
        // Logarithm of the factor that was removed from the state.
        let mut log_factor = 0.0;
        // An overdamped motion has no peaks; an oscillation with this step has one within a period.
        let most_steps = (20.0 * std::f64::consts::TAU / (step * self.stiffness.value.sqrt())).ceil();
        while last.time.value < duration {
            let (since, top) = self.next_peak(state, step, most_steps as usize)?;
            last = Peak { time: last.time + since, log_height: top.position.ln() };
            last.log_height.value += log_factor;
            if !last.time.is_finite() || !last.log_height.is_finite() {
                return None;
            }
            peaks.push(last);
            // A long record decays below the range of doubles: remove a power of two, which is exact.
            let exponent = top.position.value.log2().round();
            let factor = exponent.exp2();
            self.damping = self.damping.for_amplitudes(factor);
            log_factor += exponent * std::f64::consts::LN_2;
            state = top * Dual::constant(1.0 / factor);
        }
        Some(peaks)
    }

    fn derivative(&self, state: State) -> State {
        let pull = -(self.stiffness * state.position);
        State { position: state.velocity, velocity: pull - self.damping.deceleration(state.velocity) }
    }

    /// Returns the time to the next peak and the state there, from a state at a peak.
    fn next_peak(&self, start: State, step: f64, most_steps: usize) -> Option<(Dual, State)> {
        let mut state = start;
        let mut rising = false;
        for taken in 0..most_steps {
            let next = self.advance(state, Dual::constant(step));
            if !next.is_finite() {
                return None;
            }
            if rising && next.velocity.value <= 0.0 {
                let (within, top) = self.top(state, next, step);
                return Some((within + Dual::constant(step * taken as f64), top));
            }
            rising = next.velocity.value > 0.0;
            state = next;
        }
        None
    }

    /// Returns the time from `before` to where the velocity is zero, and the state there, by Newton's method
    /// on the integrated velocity, which is positive before the peak and negative after it.
    fn top(&self, before: State, after: State, step: f64) -> (Dual, State) {
        let share = before.velocity.value / (before.velocity.value - after.velocity.value);
        let mut time = Dual::constant(step * share);
        let mut state = self.advance(before, time);
        for _ in 0..MOST_CORRECTIONS {
            let correction = state.velocity / self.derivative(state).velocity;
            time = time - correction;
            time.value = time.value.clamp(0.0, step);
            state = self.advance(before, time);
            // The square of the correction before this one is below rounding; the derivative converges one
            // iteration later.
            if correction.value.abs() <= 1e-12 * step {
                break;
            }
        }
        (time, state)
    }

    /// Makes a step of order 16: the explicit midpoint rule with several numbers of substeps, extrapolated to
    /// infinitely many.
    ///
    /// Reference: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.9.
    fn advance(&self, state: State, step: Dual) -> State {
        let mut previous_row = [state; SUBSTEPS.len()];
        let mut best = state;
        for (row, &substeps) in SUBSTEPS.iter().enumerate() {
            let mut entry = self.midpoint(state, step, substeps);
            for (older, &coarser) in previous_row.iter_mut().zip(SUBSTEPS.iter().take(row).rev()) {
                let ratio = f64::from(substeps) / f64::from(coarser);
                let next = entry + (entry - *older) * Dual::constant(1.0 / (ratio * ratio - 1.0));
                *older = entry;
                entry = next;
            }
            if let Some(last) = previous_row.get_mut(row) {
                *last = entry;
            }
            best = entry;
        }
        best
    }

    /// Makes a step by the explicit midpoint rule, whose error has only even powers of the substep.
    fn midpoint(&self, state: State, step: Dual, substeps: u32) -> State {
        let substep = step * (1.0 / f64::from(substeps));
        let double = substep * 2.0;
        let mut before = state;
        let mut now = state + self.derivative(state) * substep;
        for _ in 1..substeps {
            let next = before + self.derivative(now) * double;
            before = now;
            now = next;
        }
        now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OMEGA: f64 = 21.8;

    fn viscous(rate: f64) -> Oscillator<Viscous> {
        let rate = Dual::variable(rate);
        Oscillator { stiffness: Dual::constant(OMEGA * OMEGA) + rate * rate, damping: Viscous { rate } }
    }

    fn step(per_period: f64) -> f64 {
        std::f64::consts::TAU / OMEGA / per_period
    }

    #[test]
    fn the_peaks_are_those_of_the_solved_equation() {
        // The solution has its peaks at 2πk/ω, with heights exp(−λt).
        for rate in [0.19, -0.4, 0.0, 9.0] {
            for (k, peak) in viscous(rate).peaks(20.0, step(8.0)).unwrap().iter().enumerate() {
                let time = std::f64::consts::TAU * k as f64 / OMEGA;
                assert!((peak.time.value - time).abs() < 1e-12, "{rate} {k} {peak:?}");
                assert!((peak.log_height.value + rate * time).abs() < 1e-12 * (1.0 + rate.abs() * time));
                assert!((peak.log_height.slope + time).abs() < 1e-11 * (1.0 + time), "{k} {peak:?}");
                assert!(peak.time.slope.abs() < 1e-12, "{k} {peak:?}");
            }
        }
    }

    #[test]
    fn a_step_is_of_order_sixteen() {
        let error = |per_period: f64| {
            let peaks = viscous(0.0).peaks(20.0, step(per_period)).unwrap();
            peaks.last().unwrap().log_height.value.abs()
        };
        let (coarse, fine) = (error(3.0), error(4.0));
        assert!(coarse > 1e-9 && (coarse / fine).ln() / (4.0_f64 / 3.0).ln() > 14.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn a_decay_beyond_the_range_of_doubles_is_followed() {
        let peaks = viscous(9.0).peaks(1000.0, step(8.0)).unwrap();
        let last = peaks.last().unwrap();
        assert!((last.log_height.value / last.time.value + 9.0).abs() < 1e-11);
    }

    #[test]
    fn another_law_of_damping_gives_its_own_envelope() {
        /// Quadratic drag β|θ'|θ'.
        #[derive(Clone, Copy)]
        struct Drag(f64);
        impl Damping for Drag {
            fn deceleration(&self, velocity: Dual) -> Dual {
                velocity * (self.0 * velocity.value.abs())
            }
            fn for_amplitudes(&self, factor: f64) -> Self {
                Self(self.0 * factor)
            }
        }
        let drag = 0.01;
        let oscillator = Oscillator { stiffness: Dual::constant(OMEGA * OMEGA), damping: Drag(drag) };
        let peaks = oscillator.peaks(40.0, step(16.0)).unwrap();
        // Averaging gives 1/A = 1 + 4βωt/(3π), to first order in β.
        let last = peaks.last().unwrap();
        let averaged = -(4.0 * drag * OMEGA * last.time.value / (3.0 * std::f64::consts::PI)).ln_1p();
        assert!((last.log_height.value - averaged).abs() < 0.01, "{last:?} {averaged}");
        assert!(last.log_height.value < -1.0);
    }
}
