//! Verdict of a comparison, in a sentence or two.

use results::{ComparisonResult, MethodRow, Reached};

use super::parts::estimates;
use crate::format;
use crate::verdict::{Tone, Verdict, in_a_sentence};

/// Largest number of names in one list; the remaining ones are only counted.
const MOST_NAMES: usize = 4;

/// Returns the number of methods that are within the tolerance on every seed, and the number of all methods,
/// both among those that are compared with least squares.
pub(super) fn passed(result: &ComparisonResult) -> (usize, usize) {
    let held = || result.held_to_least_squares();
    (held().filter(|row| row.outcome.passes()).count(), held().count())
}

/// Returns the end of a sentence on the methods that estimate another quantity than least squares and on weak
/// baselines, to follow a statement about the other methods; empty if there are none.
#[must_use]
pub fn beside_least_squares(result: &ComparisonResult) -> String {
    let names: Vec<String> = result.of_their_own().map(|row| in_a_sentence(&row.title)).collect();
    let own = match names.len() {
        0 => String::new(),
        1 => format!("; {} estimates something else", listed(&names)),
        _ => format!("; {} estimate something else", listed(&names)),
    };
    let excused = result.excused().filter_map(|row| Some((row, row.outcome.estimate()?)));
    let excused = excused.map(|(row, found)| {
        format!(
            "; {}, a weak baseline with a fixed number of steps, is {} off, which does not count",
            in_a_sentence(&row.title),
            format::percent(found.worst_error_percent)
        )
    });
    std::iter::once(own).chain(excused).collect()
}

pub(super) fn verdict(result: &ComparisonResult) -> Verdict {
    let count = result.results.len();
    if count == 0 {
        return Verdict {
            tone: Tone::Bad,
            label: "No methods",
            sentence: "No method was fitted: there is nothing to compare.".to_owned(),
        };
    }
    let (passed, held) = passed(result);
    let tolerance = format::quantity(&format::exact(result.tolerance_percent), "%");
    let first = if held == 0 {
        "No method is held to least squares".to_owned()
    } else if passed == held {
        agreement(result, held, &tolerance)
    } else {
        let who = agree(passed, held);
        format!("{who} with certified least squares within {tolerance}{}", shortfalls(result))
    };
    let first = format!("{first}{}.", beside_least_squares(result));
    let oracle = &result.oracle;
    let found = format::with_uncertainty(oracle.zeta, oracle.zeta_std_error);
    let mut sentences = vec![format!("Certified least squares finds a damping ratio of {found}."), first];
    sentences.extend(unfinished(result));
    let was_interrupted = result.results.iter().any(|row| row.outcome.is_interrupted());
    let (tone, label) = if was_interrupted {
        sentences.push("The run was interrupted: an unfinished run is no result.".to_owned());
        (Tone::Caution, "Interrupted")
    } else if passed == held && result.pass {
        (Tone::Good, "All within tolerance")
    } else if passed == 0 && held > 0 {
        (Tone::Bad, "None within tolerance")
    } else {
        (Tone::Bad, "Not all within tolerance")
    };
    Verdict { tone, label, sentence: sentences.join(" ") }
}

/// Returns the sentence for a comparison in which every method passes.
fn agreement(result: &ComparisonResult, count: usize, tolerance: &str) -> String {
    let who = if count == 1 {
        "The one method agrees".to_owned()
    } else if count == 2 {
        "Both methods agree".to_owned()
    } else {
        format!("All {count} methods agree")
    };
    let largest = worst(result).map_or_else(String::new, |(row, error)| {
        if error == 0.0 {
            "; none differs from it in any digit".to_owned()
        } else {
            format!("; the largest difference is {} ({})", format::percent(error), in_a_sentence(&row.title))
        }
    });
    format!("{who} with certified least squares within {tolerance}{largest}")
}

fn agree(passed: usize, count: usize) -> String {
    match (passed, count) {
        (0, 1) => "The one method does not agree".to_owned(),
        (0, _) => format!("None of the {count} methods agrees"),
        (1, _) => format!("1 of {count} methods agrees"),
        _ => format!("{passed} of {count} methods agree"),
    }
}

/// Returns a sentence on the methods that do not pass: outside the tolerance, or without an estimate.
fn shortfalls(result: &ComparisonResult) -> String {
    let outside: Vec<String> = estimates(result)
        .filter(|(row, estimate)| !estimate.pass && !row.excused)
        .map(|(row, estimate)| {
            let title = in_a_sentence(&row.title);
            let error = estimate.worst_error_percent;
            if error.is_finite() {
                format!("{title} (by {})", format::percent(error))
            } else {
                format!("{title} (not comparable)")
            }
        })
        .collect();
    let silent: Vec<String> = result
        .results
        .iter()
        .filter(|row| row.outcome.estimate().is_none())
        .map(|row| in_a_sentence(&row.title))
        .collect();
    [("outside", outside), ("no estimate", silent)]
        .into_iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(what, names)| format!("; {what}: {}", listed(&names)))
        .collect()
}

/// Returns a sentence on methods within the tolerance that stopped before they converged.
fn unfinished(result: &ComparisonResult) -> Option<String> {
    let names: Vec<String> = estimates(result)
        .filter(|(_, estimate)| estimate.pass && estimate.reached != Reached::Converged)
        .map(|(row, _)| in_a_sentence(&row.title))
        .collect();
    (!names.is_empty()).then(|| format!("Within the tolerance, but stopped unconverged: {}.", listed(&names)))
}

/// Returns the method with the largest error over its seeds; the first one if several are equal.
fn worst(result: &ComparisonResult) -> Option<(&MethodRow, f64)> {
    let mut found: Option<(&MethodRow, f64)> = None;
    for (row, estimate) in
        result.held_to_least_squares().filter_map(|row| Some((row, row.outcome.estimate()?)))
    {
        let error = estimate.worst_error_percent;
        if error.is_finite() && found.is_none_or(|(_, largest)| error > largest) {
            found = Some((row, error));
        }
    }
    found
}

/// Joins names; the last few are only counted.
pub(super) fn listed(names: &[String]) -> String {
    let shown = names.get(..names.len().min(MOST_NAMES)).unwrap_or_default().join(", ");
    match names.len().saturating_sub(MOST_NAMES) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::sample;
    use results::{Estimand, MethodOutcome};

    fn of(result: &ComparisonResult) -> (Tone, &'static str, String) {
        let verdict = verdict(result);
        let text = verdict.sentence.replace('\u{a0}', " ");
        let found = "Certified least squares finds a damping ratio of 0.00875 ± 0.00021. ";
        (verdict.tone, verdict.label, text.strip_prefix(found).unwrap_or(&text).to_owned())
    }

    #[test]
    fn the_damping_ratio_comes_first() {
        let sentence = verdict(&sample::passing()).sentence;
        assert!(
            sentence.starts_with("Certified least squares finds a damping ratio of 0.00875"),
            "{sentence}"
        );
    }

    #[test]
    fn all_agree() {
        let (tone, label, text) = of(&sample::passing());
        assert_eq!((tone, label), (Tone::Good, "All within tolerance"));
        assert_eq!(
            text,
            "All 21 methods agree with certified least squares within 0.1 %; the largest difference is \
             0.046 % (gradient descent). Within the tolerance, but stopped unconverged: gradient descent, \
             differential evolution."
        );
    }

    #[test]
    fn who_fails_is_named() {
        let mut result = sample::result();
        let (tone, label, text) = of(&result);
        assert_eq!((tone, label), (Tone::Bad, "Not all within tolerance"));
        assert!(
            text.starts_with(
                "20 of 21 methods agree with certified least squares within 0.1 %; no estimate: symbolic \
                 regression."
            ),
            "{text}"
        );
        let MethodOutcome::Estimate(estimate) = &mut result.results[14].outcome else { panic!() };
        estimate.pass = false;
        estimate.worst_error_percent = 0.254;
        let (_, _, text) = of(&result);
        assert!(
            text.contains("19 of 21 methods agree")
                && text.contains("; outside: long short-term memory network (by 0.25 %); no estimate:"),
            "{text}"
        );
    }

    #[test]
    fn few_methods_and_none() {
        let mut result = sample::passing();
        result.results.truncate(2);
        assert!(of(&result).2.starts_with("Both methods agree"), "{}", of(&result).2);
        result.results.truncate(1);
        assert!(of(&result).2.ends_with("; none differs from it in any digit."), "{}", of(&result).2);
        result.results.clear();
        assert_eq!(of(&result).0, Tone::Bad);
        let mut failing = sample::result();
        failing.results.retain(|row| row.outcome.estimate().is_none());
        let (_, label, text) = of(&failing);
        assert_eq!(label, "None within tolerance");
        assert!(text.starts_with("The one method does not agree"), "{text}");
    }

    #[test]
    fn an_unfinished_run_is_no_result() {
        let mut result = sample::result();
        result.results[20].outcome = MethodOutcome::Failed { reason: results::Failure::NotBegun };
        let (tone, label, text) = of(&result);
        assert_eq!((tone, label), (Tone::Caution, "Interrupted"));
        assert!(text.ends_with("an unfinished run is no result."), "{text}");
    }

    #[test]
    fn a_pass_that_the_run_does_not_state_is_none() {
        let mut result = sample::passing();
        result.pass = false;
        assert_eq!(of(&result).0, Tone::Bad);
    }

    /// The distance of a method that estimates another quantity counts neither as a shortfall nor as
    /// agreement.
    #[test]
    fn methods_of_their_own_estimand_are_not_counted() {
        let mut result = sample::passing();
        result.results[3].estimand = Estimand::Own;
        let title = in_a_sentence(&result.results[3].title);
        let (tone, _, text) = of(&result);
        assert_eq!(tone, Tone::Good);
        assert!(text.starts_with("All 20 methods agree"), "{text}");
        assert!(text.contains(&format!("; {title} estimates something else.")), "{text}");
        assert_eq!(passed(&result), (20, 20));
    }

    #[test]
    fn a_weak_baseline_that_used_up_its_steps_does_not_count() {
        let mut result = sample::passing();
        let row = result.results.iter_mut().find(|row| row.id == "gradient-descent").unwrap();
        let MethodOutcome::Estimate(found) = &mut row.outcome else { panic!() };
        (row.excused, found.pass, found.worst_error_percent) = (true, false, 4.9);
        let (tone, _, text) = of(&result);
        assert_eq!((tone, passed(&result)), (Tone::Good, (20, 20)));
        assert!(
            text.contains("; gradient descent, a weak baseline with a fixed number of steps, is 4.9 % off,"),
            "{text}"
        );
        assert!(!text.contains("outside"), "{text}");
    }

    #[test]
    fn long_lists_are_counted() {
        let names: Vec<String> = ["a", "b", "c", "d", "e", "f"].map(str::to_owned).into();
        assert_eq!(listed(&names), "a, b, c, d and 2 more");
        assert_eq!(listed(&names[..2]), "a, b");
    }
}
