//! The probability that a system has a class of effects.
//!
//! The likelihood of sets supposes that the left-over is what it is taken for. How far it can be believed is learned: a
//! logistic function of what this record shows of the class,
//!
//! - the log evidence by replacement, and that of half swings where these show the class, as sign(x)·ln(1 + |x|): a
//!   thousand nats are hardly surer than two hundred where the model itself is in doubt. How much worse than without it the
//!   best set with a class is says nothing more;
//! - the logarithm of the held-out error without the class over that with it.
//!
//! The part of the draws of segments in which a class comes back, and how far the best set stays above the noise, add
//! nothing to these.
//!
//! The four numbers are a maximum-likelihood fit with a weak Gaussian prior to the classes of the 120 rigs with even
//! numbers of those that `experiments/rigs/records.py` makes with the seed 1: half of them lack two to six effects beside a
//! small unlisted law, others one, two or none. Rigs that lack nothing but an unlisted law count a quarter: few real ones do. The
//! class of an unlisted law is neither there nor not, and is left out. All were made by
//! an integrator and a physics engine that share no code with the fits, and banks with another seed, other ranges and other
//! laws score it (`reports/trials/README.md`).

use crate::answer::EffectClass;

/// Coefficients of the logistic function.
struct Learned {
    constant: f64,
    replacement: f64,
    half_swings: f64,
    error: f64,
}

const LEARNED: Learned = Learned { constant: -2.25, replacement: 0.69, half_swings: 0.23, error: 0.69 };

fn compressed(nats: f64) -> f64 {
    nats.signum() * nats.abs().ln_1p()
}

/// The probability of a class, from what speaks for it.
pub(crate) fn probability(class: &EffectClass) -> f64 {
    let ratio = class.error_without / class.error_with;
    let error = if ratio.is_finite() && ratio > 0.0 { ratio.ln() } else { 0.0 };
    let log_odds = LEARNED.constant
        + LEARNED.replacement * compressed(class.evidence.replacement.max(0.0))
        + LEARNED.half_swings * class.evidence.half_swings.map_or(0.0, compressed)
        + LEARNED.error * error;
    1.0 / (1.0 + (-log_odds).exp())
}

#[cfg(test)]
mod tests {
    use super::probability;
    use crate::answer::{ClassEvidence, EffectClass};

    fn class(replacement: f64, half_swings: Option<f64>, error_without: f64) -> EffectClass {
        EffectClass {
            id: "friction",
            probability: 0.0,
            gap_share: None,
            kinds: Vec::new(),
            kind_is_told: false,
            error_without,
            error_with: 1.0,
            stability: 1.0,
            evidence: ClassEvidence { replacement, half_swings },
        }
    }

    #[test]
    fn a_class_is_the_surer_the_more_speaks_for_it() {
        let of = |nats, swings, error| probability(&class(nats, swings, error));
        assert!(of(100.0, Some(10.0), 3.0) > of(10.0, Some(10.0), 3.0));
        assert!(of(10.0, Some(10.0), 3.0) > of(10.0, Some(-10.0), 3.0));
        assert!(of(10.0, None, 3.0) > of(10.0, None, 1.0));
    }

    /// A class that nothing asks for is improbable, and one that everything does is certain.
    #[test]
    fn its_ends() {
        assert!(probability(&class(-5.0, Some(-3.0), 0.95)) < 0.1);
        assert!(probability(&class(200.0, Some(60.0), 10.0)) > 0.95);
    }

    #[test]
    fn an_error_that_is_no_number_says_nothing() {
        let known = probability(&class(10.0, None, 1.0));
        assert_eq!(probability(&class(10.0, None, f64::NAN)), known);
        assert_eq!(probability(&class(10.0, None, 0.0)), known);
    }
}
