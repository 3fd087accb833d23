//! The probability that a system has a class of effects.
//!
//! Where nothing is left beside the best set of effects, a law that no list has may still have been explained away by
//! those that one has. So the log evidence n by replacement is held against how often classes with such evidence were there: a
//! logistic function of ln(1 + n).
//!
//! Where something is left, the likelihood of sets takes it for what it is not: small laws that no list has, colored noise.
//! How far the evidence can be believed there is learned too: a logistic function of what this record shows of the class,
//!
//! - ln(1 + n) of the log evidence by replacement, and of that of half swings where these show the class: a thousand nats are
//!   hardly surer than two hundred where the model itself is in doubt. Evidence against a class says nothing more;
//! - the logarithm of the held-out error without the class over that with it;
//! - whether the class leads: none costs as much to go without. What stands in for something is small beside what is there, and
//!   of 127 leading classes of the training rigs the nine that were not there were all of rigs with nothing but an unlisted law;
//! - the part of the recalibrated simulator's error that the best set leaves, from a sixth on and in its logarithm, where half
//!   swings do not show the class. An explanation that leaves much may be a piece of a law that no list has, and then a second
//!   witness has to speak for it, or many nats: of 18 such leading classes of training rigs with less than 70 nats two were there,
//!   of 16 with more 14; where less is left, six of eleven with less than 70.
//!
//! The part of the draws of segments in which a class comes back, and how far the best set stays above the noise, add
//! nothing to these.
//!
//! The numbers are maximum-likelihood fits with a weak Gaussian prior to the classes of 210 rigs (`experiments/rigs/records.py`, 100
//! of the bank `train` with the seed 7 and 110 of the bank `score` with the seed 5), where nothing is left with as much weight
//! for 111 cases of the crate's own trials (`configs/trials-quick.toml`, seed 101). Rigs that lack nothing but an unlisted law count a
//! quarter: few real ones do. The class of an unlisted law is neither there nor not, and is left out. The rigs were made by an integrator
//! and a physics engine that share no code with the fits, and a bank with another seed scores the numbers
//! (`reports/trials/README.md`). What the part that is left costs was fitted by itself, the other numbers held, to the 1,033
//! classes of rigs of the banks `short` (seeds 71 to 77) and `train` (`--kind rough`, seed 41) where something is left, with the part
//! that answers state: of the repaired simulator, which is nearly that of the best set.

use crate::answer::ClassEvidence;

/// Coefficients of the logistic function.
struct Learned {
    constant: f64,
    replacement: f64,
    half_swings: f64,
    error: f64,
    leads: f64,
    remaining: f64,
}

/// Where something is left beside the best set, and where nothing is.
const LEARNED: Learned = Learned {
    constant: -2.07,
    replacement: 0.58,
    half_swings: 0.35,
    error: 0.38,
    leads: 0.86,
    remaining: -0.91,
};
const CLEAN: Learned =
    Learned { constant: -3.19, replacement: 1.24, half_swings: 0.0, error: 0.0, leads: 0.0, remaining: 0.0 };

/// Part of the recalibrated simulator's error from which on an explanation leaves much.
const MUCH: f64 = 1.0 / 6.0;

/// What a record shows of a class.
pub(crate) struct Shown<'e> {
    pub(crate) evidence: &'e ClassEvidence,
    /// Held-out error without the class over that with it.
    pub(crate) ratio: f64,
    /// Whether there is evidence for it, and for no other class more.
    pub(crate) leads: bool,
    /// Held-out error of the best set over that of the recalibrated simulator.
    pub(crate) remaining: f64,
}

/// ln of a ratio; 0 where it is no number.
fn log_ratio(ratio: f64) -> f64 {
    if ratio.is_finite() && ratio > 0.0 { ratio.ln() } else { 0.0 }
}

/// ln(1 + x) of evidence; 0 where it speaks against.
fn compressed(nats: f64) -> f64 {
    nats.max(0.0).ln_1p()
}

fn logistic(log_odds: f64) -> f64 {
    1.0 / (1.0 + (-log_odds).exp())
}

impl Learned {
    fn probability(&self, &Shown { evidence, ratio, leads, remaining }: &Shown<'_>) -> f64 {
        let is_witnessed = evidence.half_swings.is_some_and(|nats| nats > 0.0);
        let remaining = if is_witnessed { 0.0 } else { log_ratio(remaining / MUCH).max(0.0) };
        logistic(
            self.constant
                + self.replacement * compressed(evidence.replacement)
                // Half swings that show nothing speak neither for nor against.
                + self.half_swings * evidence.half_swings.map_or(0.0, compressed)
                + self.error * log_ratio(ratio)
                + self.remaining * remaining
                + if leads { self.leads } else { 0.0 },
        )
    }
}

/// The probability of a class, from what speaks for it; `left_over` is the probability that something is left beside the best set
/// of effects.
pub(crate) fn probability(shown: &Shown<'_>, left_over: f64) -> f64 {
    let of = |learned: &Learned| learned.probability(shown);
    left_over * of(&LEARNED) + (1.0 - left_over) * of(&CLEAN)
}

#[cfg(test)]
mod tests {
    use super::{Shown, probability};
    use crate::answer::ClassEvidence;

    fn of_class(replacement: f64, half_swings: Option<f64>, ratio: f64, left_over: f64) -> f64 {
        let evidence = ClassEvidence { replacement, half_swings };
        probability(&Shown { evidence: &evidence, ratio, leads: false, remaining: 0.1 }, left_over)
    }

    const DOUBTED: f64 = 1.0;

    #[test]
    fn a_class_is_the_surer_the_more_speaks_for_it() {
        let of = |nats, swings, error| of_class(nats, swings, error, DOUBTED);
        assert!(of(100.0, Some(10.0), 3.0) > of(10.0, Some(10.0), 3.0));
        assert!(of(10.0, Some(10.0), 3.0) > of(10.0, Some(1.0), 3.0));
        assert!(of(10.0, None, 3.0) > of(10.0, None, 1.0));
    }

    #[test]
    fn a_class_that_leads_is_the_surer() {
        let evidence = ClassEvidence { replacement: 30.0, half_swings: None };
        let of =
            |leads| probability(&Shown { evidence: &evidence, ratio: 2.0, leads, remaining: 0.1 }, DOUBTED);
        assert!(of(true) > of(false) + 0.1);
    }

    /// Where most of the error is left a class needs a witness, or much evidence.
    #[test]
    fn an_explanation_that_leaves_much_needs_a_witness() {
        let of = |replacement, half_swings, remaining| {
            let evidence = ClassEvidence { replacement, half_swings };
            probability(&Shown { evidence: &evidence, ratio: 1.5, leads: true, remaining }, DOUBTED)
        };
        assert!(of(30.0, None, 0.1) > 0.6 && of(30.0, None, 0.5) < 0.5);
        assert_eq!(of(30.0, Some(5.0), 0.1), of(30.0, Some(5.0), 0.5));
        assert!(of(1000.0, None, 0.3) > 0.8);
        assert_eq!(of(30.0, None, f64::NAN), of(30.0, None, 0.1));
    }

    /// A class that nothing asks for is improbable, and one that everything does is certain.
    #[test]
    fn its_ends() {
        assert!(of_class(-5.0, Some(-3.0), 0.95, DOUBTED) < 0.15);
        assert!(of_class(200.0, Some(60.0), 10.0, DOUBTED) > 0.95);
    }

    /// Where nothing is left evidence says more than where something is, and a few nats are no name.
    #[test]
    fn where_nothing_is_left_evidence_says_more() {
        assert!(of_class(5.0, None, 1.01, 0.0) < 0.5);
        assert!(of_class(15.0, None, 1.01, 0.0) > 0.5);
        assert!(of_class(100.0, None, 1.01, 0.0) > 0.9);
        assert!(of_class(100.0, None, 1.01, DOUBTED) < 0.9);
    }

    #[test]
    fn an_error_that_is_no_number_says_nothing() {
        let known = of_class(10.0, None, 1.0, DOUBTED);
        assert_eq!(of_class(10.0, None, f64::NAN, DOUBTED), known);
        assert_eq!(of_class(10.0, None, 0.0, DOUBTED), known);
    }
}
