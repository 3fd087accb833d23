//! The probability that a system has a class of effects.
//!
//! What the likelihood of sets says supposes that the left-over is what it was taken for. How far that can be believed is
//! learned: a logistic function of what this record shows of the class,
//!
//! - the log evidence by replacement, and that of half swings where these show the class, each as sign(x)·ln(1 + |x|): the
//!   evidence of a class that has a thousand nats is no surer than that of one with two hundred;
//! - the logarithm of the held-out error without the class over that with it, and of the error with it over the noise: what
//!   an effect takes away is worth the more, the less is left of unknown cause;
//! - the part of the draws of segments in which the class comes back;
//! - whether the members of the class can sit where they like on a record.

use crate::answer::EffectClass;

/// Coefficients of the logistic function.
struct Learned {
    constant: f64,
    replacement: f64,
    half_swings: f64,
    error: f64,
    left_over: f64,
    stability: f64,
    flexible: f64,
}

const LEARNED: Learned = Learned {
    constant: -1.71,
    replacement: 0.1,
    half_swings: 0.2,
    error: 0.8,
    left_over: 0.0,
    stability: 1.4,
    flexible: -0.8,
};

fn compressed(x: f64) -> f64 {
    x.signum() * x.abs().ln_1p()
}

/// The probability of a class whose members are flexible or not, where the best set leaves so many times the noise.
pub(crate) fn probability(class: &EffectClass, is_flexible: bool, over_noise: f64) -> f64 {
    let ratio = class.error_without / class.error_with;
    let error = if ratio.is_finite() && ratio > 0.0 { ratio.ln() } else { 0.0 };
    let log_odds = LEARNED.constant
        + LEARNED.replacement * compressed(class.evidence.replacement)
        + LEARNED.half_swings * class.evidence.half_swings.map_or(0.0, compressed)
        + LEARNED.error * error
        + LEARNED.left_over * over_noise.max(1.0).ln()
        + LEARNED.stability * class.stability
        + LEARNED.flexible * f64::from(u8::from(is_flexible));
    1.0 / (1.0 + (-log_odds).exp())
}
