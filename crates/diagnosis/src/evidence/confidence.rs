//! How sure a verdict is, by how often such verdicts were right.
//!
//! The probabilities of sets come from a likelihood of Gaussian noise and a vocabulary that is taken to be
//! complete. Records keep to neither: where the cause has no name, two or three effects together often stand
//! in for it, and are sure of themselves. How often that happens only trials can say. So the stated
//! confidence is a logistic function of a set's own log odds and of whether anything is left beside it, by
//! status and by how many fitted effects it names, learned from a bank of withheld-effect trials:
//!
//! 522 cases of `trainer trials configs/trials-quick.toml` with the seeds 202 and 303, at sizes of 12, 25, 50
//! and 100 and in two to three times the numbers; 704 with the seeds 404 and 405 once the search had changed;
//! 513 with the seed 19 at all six sizes and 2,403 with the seed 23, those of an even number among the own
//! banks of `reports/trials/README.md`. The lines of each are the next one's prior, with a standard deviation
//! of 1 and, in the slopes, of 1/4. Probabilities of single effects are the second's. What is small is often
//! missed: that nothing is missing is the less sure the more small effects there are, and these banks have as
//! many of 3 and 6 noise units as of 50 and 100. Confidence is scored on the odd numbers, which taught
//! nothing.

use crate::answer::Status;

/// Log odds of being right: at even odds of the set, and by a unit of its own log odds.
struct Line {
    at_even: f64,
    by_odds: f64,
}

const NOTHING_MISSING: Line = Line { at_even: -2.08, by_odds: 0.86 };
const UNKNOWN: Line = Line { at_even: 0.45, by_odds: 0.2 };
/// Of three effects or more. The banks hide two at most, so that they cannot show three to be right (of 90
/// such answers none was): the step from one to two, as the first banks had it, is taken once more.
const OF_MANY: Line = Line { at_even: -2.54, by_odds: 0.31 };
/// By the number of fitted effects that are named, the last for more; none are fitted where stamps and values
/// show what is missing.
const EFFECTS: [Line; 4] = [
    Line { at_even: -1.15, by_odds: 0.8 },
    Line { at_even: -0.3, by_odds: 0.58 },
    Line { at_even: -0.83, by_odds: 0.47 },
    OF_MANY,
];

/// Of an effect by itself: of one or two that are named, of one that is not named, of one of many.
const NAMED: Line = Line { at_even: -0.28, by_odds: 0.51 };
const NOT_NAMED: Line = Line { at_even: -0.41, by_odds: 0.84 };
const ONE_OF_MANY: Line = Line { at_even: -2.02, by_odds: 0.36 };

/// Of an effect that stamps or values show by themselves: all 385 of the later training banks were there. One
/// more that is, and one that is not.
pub(crate) const SHOWN: f64 = 386.0 / 387.0;

/// Log odds beyond which the bank has nothing more to say.
const MOST_ODDS: f64 = 4.0;

/// Log odds of named effects being right where something is left beside them for certain: of all together, and of one.
const LEFT_OVER: f64 = -4.81;
const LEFT_BESIDE_ONE: f64 = -3.01;

/// How often so many fitted effects stood in, without leaving anything, for something without a name; the
/// last for more.
const STAND_IN: [f64; 4] = [0.035, 0.058, 0.095, 0.1];

/// The probability that named effects, so many fitted ones among them, stand in for something without a name though
/// nothing is left that shows it.
pub(crate) fn stand_in(fitted: usize) -> f64 {
    let [.., last] = STAND_IN;
    STAND_IN.get(fitted).copied().unwrap_or(last)
}

impl Line {
    /// The probability that goes with that of a set, and with log odds for what is left beside it.
    fn at(&self, probability: f64, left_over: f64) -> f64 {
        // A sum of probabilities may round to more than 1.
        let probability = probability.clamp(0.0, 1.0);
        let odds = (probability / (1.0 - probability)).ln().clamp(-MOST_ODDS, MOST_ODDS);
        1.0 / (1.0 + (-(self.at_even + self.by_odds * odds + left_over)).exp())
    }
}

/// The probability that a verdict is right, status and effects together, from that of its set and from the
/// probability that anything is left beside it.
pub(crate) fn confidence(status: Status, fitted: usize, probability: f64, left_over: f64) -> f64 {
    let [.., last] = &EFFECTS;
    match status {
        Status::None | Status::Calibration => NOTHING_MISSING.at(probability, 0.0),
        Status::Unknown => UNKNOWN.at(probability, 0.0),
        Status::Effect => EFFECTS.get(fitted).unwrap_or(last).at(probability, LEFT_OVER * left_over),
    }
}

/// The probability that an effect acts, from that of all sets with it: one of so many that are named, or none
/// of them. Where many are named, what could stand in one's place is one of many too.
pub(crate) fn of_effect(fitted: usize, is_named: bool, probability: f64, left_over: f64) -> f64 {
    let line = match (fitted, is_named) {
        (..=2, true) => NAMED,
        (..=2, false) => NOT_NAMED,
        _ => ONE_OF_MANY,
    };
    line.at(probability, LEFT_BESIDE_ONE * left_over)
}

#[cfg(test)]
mod tests {
    use super::{MOST_ODDS, confidence, of_effect};
    use crate::answer::Status;

    /// Surer sets are surer verdicts, and more effects less sure ones.
    #[test]
    fn confidence_grows_with_the_sets_and_falls_with_their_size() {
        for status in [Status::None, Status::Unknown, Status::Effect] {
            let values = [0.0, 0.02, 0.3, 0.6, 0.9, 1.0].map(|p| confidence(status, 1, p, 0.0));
            assert!(values.is_sorted(), "{status:?} {values:?}");
            assert!(values.iter().all(|p| (0.0..=1.0).contains(p)));
        }
        let by_size = [1, 2, 3, 5].map(|fitted| confidence(Status::Effect, fitted, 0.9, 0.0));
        assert!(by_size.is_sorted_by(|a, b| a >= b), "{by_size:?}");
        let rounded = 1.0 + f64::EPSILON;
        assert_eq!(confidence(Status::Effect, 1, rounded, 0.0), confidence(Status::Effect, 1, 1.0, 0.0));
        let most = 1.0 / (1.0 + (-MOST_ODDS).exp());
        assert_eq!(confidence(Status::Effect, 2, most, 0.0), confidence(Status::Effect, 2, 1.0, 0.0));
        assert!(confidence(Status::Effect, 1, 0.9, 1.0) < confidence(Status::Effect, 1, 0.9, 0.0));
    }

    /// Named effects rank above what could stand in their place, and less sure ones below.
    #[test]
    fn an_effects_probability_follows_that_of_its_sets() {
        for (fitted, is_named) in [(1, true), (1, false), (3, true), (3, false)] {
            let of = |probability, left_over| of_effect(fitted, is_named, probability, left_over);
            let values = [0.0, 0.02, 0.3, 0.6, 0.9, 1.0].map(|p| of(p, 0.0));
            assert!(values.is_sorted() && values.iter().all(|p| (0.0..=1.0).contains(p)), "{values:?}");
            assert!(of(0.9, 1.0) < of(0.9, 0.0));
            assert!(of_effect(fitted, true, 0.6, 0.0) > of_effect(fitted, false, 0.4, 0.0));
        }
    }
}
