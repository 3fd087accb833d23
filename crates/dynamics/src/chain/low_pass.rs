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

/// Does the same as [`quintic`], given value and first derivative.
pub(super) fn cubic<S: Sampled>(
    time_constant: S,
    times_s: &[f64],
    end: impl Fn(usize) -> Option<[S; 2]>,
    first: S,
) -> Vec<S> {
    run(time_constant, times_s, end, first, |[p, v], [q, w], h| {
        let (v, w) = (v * h, w * h);
        let rise = q - p;
        [p, v, rise * 3.0 - v * 2.0 - w, -(rise * 2.0) + v + w]
    })
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
