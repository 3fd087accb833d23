//! First-order low-pass filter over a motion that is known at samples with its derivatives.
//!
//! On an interval of length h the input is the polynomial Σ cₖuᵏ of u ∈ [0, 1] that matches values and
//! derivatives at both ends. With a = h/T the output at its end is y(0)·e^(−a) + Σ cₖMₖ, where Mₖ = ∫₀¹
//! a·e^(−a(1−u))·uᵏ du.

use super::step::Sampled;

/// Value of a up to which the moments are summed as a series of positive terms. Above it they are computed by
/// their recurrence, which multiplies errors by k/a in each of five steps.
const SERIES_UP_TO: f64 = 6.0;

/// Maximum number of terms of the series: 6⁴⁸/48! is 2e-24.
const SERIES_TERMS: usize = 48;

/// Computes Mₖ for k = 0..N.
fn moments<S: Sampled, const N: usize>(a: S) -> [S; N] {
    let zero = S::from(0.0);
    let decay = (-a).exp();
    let mut moments = [zero; N];
    if a.plain() <= SERIES_UP_TO {
        // Mₖ = a·e^(−a)·Σⱼ aʲ/(j!·(k + 1 + j)).
        let mut term = a * decay;
        for j in 0..SERIES_TERMS {
            for (k, moment) in moments.iter_mut().enumerate() {
                *moment = *moment + term * (1.0 / (k + 1 + j) as f64);
            }
            term = term * a * (1.0 / (j + 1) as f64);
            if term.plain().abs() < f64::EPSILON * 1e-3 * a.plain() {
                break;
            }
        }
    } else {
        // By parts: Mₖ = 1 − (k/a)·Mₖ₋₁.
        let mut before = zero;
        for (k, moment) in moments.iter_mut().enumerate() {
            *moment = if k == 0 { -decay + 1.0 } else { -(before / a * k as f64) + 1.0 };
            before = *moment;
        }
    }
    moments
}

/// Runs the low-pass filter over the intervals. `polynomial` returns the coefficients of an interval from its
/// two ends and its length.
fn run<S: Sampled, const ENDS: usize, const N: usize>(
    time_constant: S,
    times_s: &[f64],
    end: impl Fn(usize) -> Option<[S; ENDS]>,
    first: S,
    polynomial: impl Fn([S; ENDS], [S; ENDS], f64) -> [S; N],
) -> Vec<S> {
    let mut output = Vec::with_capacity(times_s.len());
    output.extend((!times_s.is_empty()).then_some(first));
    let mut now = first;
    for (at, (&from, &to)) in times_s.iter().zip(times_s.iter().skip(1)).enumerate() {
        let (Some(left), Some(right)) = (end(at), end(at + 1)) else { break };
        let length = to - from;
        let a = S::from(length) / time_constant;
        let moments: [S; N] = moments(a);
        now = now * (-a).exp();
        for (coefficient, moment) in polynomial(left, right, length).into_iter().zip(moments) {
            now = now + coefficient * moment;
        }
        output.push(now);
    }
    output
}

/// Returns the filtered signal at each time, given its value, first and second derivative there. Starts at
/// `first`.
pub(super) fn quintic<S: Sampled>(
    time_constant: S,
    times_s: &[f64],
    end: impl Fn(usize) -> Option<[S; 3]>,
    first: S,
) -> Vec<S> {
    run(time_constant, times_s, end, first, |[p, v, a], [q, w, b], h| {
        let (v, w, a, b) = (v * h, w * h, a * (h * h), b * (h * h));
        let rise = q - p;
        [
            p,
            v,
            a * 0.5,
            rise * 10.0 - v * 6.0 - w * 4.0 - a * 1.5 + b * 0.5,
            -(rise * 15.0) + v * 8.0 + w * 7.0 + a * 1.5 - b,
            rise * 6.0 - v * 3.0 - w * 3.0 - a * 0.5 + b * 0.5,
        ]
    })
}

/// First-order low-pass filter T·ẏ + y = x over samples of a signal and its rate, prepared for their times.
///
/// It is exact for the cubic through the values and rates at both ends of each interval, whose error at angular
/// frequency ω and sample period Δ is at most (ωΔ)⁴/384 of the amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass<S> {
    steps: Vec<Interval<S>>,
}

/// Effect of the filter over an interval: its own decay, and the weights of value and rate at the beginning, and
/// of value and rate at the end.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Interval<S> {
    decay: S,
    weights: [S; 4],
}

impl<S: Sampled> LowPass<S> {
    /// Prepares the filter of a time constant, in seconds and above 0, for increasing times in seconds.
    #[must_use]
    pub fn new(time_constant: S, times_s: &[f64]) -> Self {
        let steps = times_s.iter().zip(times_s.iter().skip(1)).map(|(from, to)| {
            let length = to - from;
            let a = S::from(length) / time_constant;
            let [m0, m1, m2, m3] = moments(a);
            let end = m2 * 3.0 - m3 * 2.0;
            let weights = [m0 - end, (m1 - m2 * 2.0 + m3) * length, end, (m3 - m2) * length];
            Interval { decay: (-a).exp(), weights }
        });
        Self { steps: steps.collect() }
    }

    /// Returns the filtered signal at each time, given `first` there at the first one. `at` returns the signal's
    /// value and rate at the time of an index; the output ends where it returns `None`.
    #[must_use]
    pub fn of(&self, at: impl Fn(usize) -> Option<[S; 2]>, first: S) -> Vec<S> {
        let Some(mut before) = at(0) else { return Vec::new() };
        let mut output = vec![first];
        let mut now = first;
        for (index, Interval { decay, weights }) in self.steps.iter().enumerate() {
            let Some(after) = at(index + 1) else { break };
            let ends = before.into_iter().chain(after);
            now = weights.iter().zip(ends).fold(now * *decay, |sum, (weight, end)| sum + *weight * end);
            output.push(now);
            before = after;
        }
        output
    }
}

#[cfg(test)]
mod tests {
    use super::moments;

    /// Against composite Simpson's rule, on both sides of the value at which the method changes.
    #[test]
    fn moments_are_the_integrals() {
        for a in [1e-6, 0.01, 0.7, 5.999, 6.001, 40.0, 900.0] {
            let found: [f64; 6] = moments(a);
            for (k, found) in found.iter().enumerate() {
                let panels = 200_000;
                let h = 1.0 / panels as f64;
                let f = |u: f64| a * (-a * (1.0 - u)).exp() * u.powi(k as i32);
                let sum: f64 = (0..panels)
                    .map(|i| {
                        let u = i as f64 * h;
                        h / 6.0 * (f(u) + 4.0 * f(u + h / 2.0) + f(u + h))
                    })
                    .sum();
                assert!((found - sum).abs() < 1e-12 * sum.max(1e-300) + 1e-13, "{k}, {a}: {found} {sum}");
            }
        }
    }
}
