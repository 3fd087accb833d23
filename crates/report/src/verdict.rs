//! Verdict of a run in one sentence, and the kind of its record.

use results::{EstimationResult, Reached};

use crate::format;

/// Color of a statement. The words carry the meaning; the color repeats it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tone {
    Good,
    Caution,
    Bad,
}

impl Tone {
    /// Returns the class in the style sheet.
    pub(crate) fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Caution => "caution",
            Self::Bad => "bad",
        }
    }
}

/// Verdict of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Verdict {
    pub(crate) tone: Tone,
    /// Label of two or three words.
    pub(crate) label: &'static str,
    pub(crate) sentence: String,
}

/// Coefficient of determination below which agreement with least squares says little about the damping.
const LINE: f64 = 0.9;

pub(crate) fn verdict(result: &EstimationResult) -> Verdict {
    let who = in_a_sentence(&result.estimator_title);
    let zeta =
        format::with_uncertainty(result.estimate.zeta, result.estimate.zeta_std_error.unwrap_or(f64::NAN));
    let comparison = comparison(result);
    let steps = format::count(result.steps);
    match result.estimate.reached {
        Reached::Converged => {
            converged(result, &format!("The {who} finds a damping ratio of {zeta}; it {comparison}."))
        }
        Reached::BudgetSpent => Verdict {
            tone: if result.pass { Tone::Caution } else { Tone::Bad },
            label: if result.pass { "Within tolerance, not converged" } else { "Not converged" },
            sentence: format!(
                "The {who} used up its budget of steps ({steps} taken) before it converged. The \
                 damping ratio it had reached, {zeta}, {comparison}."
            ),
        },
        Reached::Stalled => Verdict {
            tone: if result.pass { Tone::Caution } else { Tone::Bad },
            label: if result.pass { "Within tolerance, not converged" } else { "Not converged" },
            sentence: format!(
                "The {who} stalled after {steps} steps: no step improved the fit any more, and its own \
                 convergence condition was not met. The damping ratio it had reached, {zeta}, {comparison}."
            ),
        },
        Reached::Interrupted => Verdict {
            tone: Tone::Caution,
            label: "Interrupted",
            sentence: format!(
                "The run was interrupted after {steps} steps, before the {who} had finished. The \
                 damping ratio it had reached, {zeta}, {comparison}. An unfinished run is no result."
            ),
        },
        Reached::Diverged => Verdict {
            tone: Tone::Bad,
            label: "Diverged",
            sentence: format!(
                "The {who} found no damping ratio: its training diverged after {steps} steps. The \
                 value it stopped at, {zeta}, {comparison}."
            ),
        },
    }
}

/// Returns the verdict of an estimate that converged, from the sentence on its value.
fn converged(result: &EstimationResult, sentence: &str) -> Verdict {
    let r_squared = result.oracle.r_squared;
    let (tone, label) = match (result.pass, r_squared < LINE) {
        (true, false) => (Tone::Good, "Within tolerance"),
        (true, true) => (Tone::Caution, "Within tolerance, no clear decay"),
        (false, _) => (Tone::Bad, "Outside tolerance"),
    };
    let poor = if r_squared < LINE {
        format!(
            " But least squares itself explains little of the envelope (R² {}): one damping ratio hardly describes this \
             record.",
            format::fixed(r_squared, 2)
        )
    } else {
        String::new()
    };
    Verdict { tone, label, sentence: format!("{sentence}{poor}") }
}

/// Returns the next steps after an estimation, by the state in which it ended.
pub(crate) fn next(result: &EstimationResult) -> Vec<String> {
    let path = &result.data.path;
    let mut steps = match result.estimate.reached {
        Reached::Interrupted => {
            vec!["Resume it: the same call with --out and this folder, and --resume.".to_owned()]
        }
        Reached::BudgetSpent => {
            vec![
                "Raise fit.max_steps, or leave it out: the budget of steps ended before the fit converged."
                    .to_owned(),
            ]
        }
        Reached::Diverged | Reached::Stalled => vec![
            "Run it with another seed (seed=1), or with another method (trainer list estimators).".to_owned(),
        ],
        Reached::Converged => Vec::new(),
    };
    if result.pass {
        steps.push(format!(
            "See whether the decay is exponential at all: “trainer init {path} --out LINEAR” writes the linear oscillator \
             nearest to the record into a new folder, and prints the call that diagnoses what it lacks."
        ));
        steps.push(format!(
            "Compare other methods on the same envelope: “trainer configs/compare.toml data.path={path}”, in the folder of \
             the project's sources."
        ));
    }
    steps
}

/// Returns the words after "it": the distance from the oracle, and its relation to the stated tolerance.
fn comparison(result: &EstimationResult) -> String {
    const ORACLE: &str = "closed-form least squares";
    let tolerance = format::quantity(&format::exact(result.tolerance_percent), "%");
    if !result.error_percent.is_finite() {
        return format!("cannot be compared with {ORACLE}");
    }
    let distance = if result.error_percent == 0.0 {
        format!("equals that of {ORACLE} to the last digit")
    } else {
        format!("differs from {ORACLE} by {}", format::percent(result.error_percent))
    };
    if result.error_percent > result.tolerance_percent {
        return format!("{distance}, so it does not solve least squares to the stated {tolerance}");
    }
    let seeds = result.seeds.len();
    let worst = format::percent(result.worst_error_percent);
    if !result.pass && seeds > 1 {
        format!(
            "{distance}, which solves least squares to the stated {tolerance}, but the worst of its {seeds} seeds \
             differs by {worst}, and every seed has to be within"
        )
    } else if seeds > 1 {
        format!(
            "{distance}, which solves least squares to the stated {tolerance} (the worst of its {seeds} seeds by {worst})"
        )
    } else {
        format!("{distance}, which solves least squares to the stated {tolerance}")
    }
}

/// Returns a title as inside a sentence: its first letter in lower case, unless its first word is a name or
/// contains another capital.
#[must_use]
pub fn in_a_sentence(title: &str) -> String {
    const NAMES: [&str; 6] = ["Bayesian", "Coulomb", "Gaussian", "Levenberg", "Newton", "Stribeck"];
    let is_end = |letter: char| !letter.is_alphabetic();
    let word = title.split(is_end).next().unwrap_or_default();
    let mut rest = title.chars();
    match rest.next() {
        Some(first)
            if !NAMES.contains(&word)
                && word.chars().count() > 1
                && word.chars().skip(1).all(char::is_lowercase) =>
        {
            first.to_lowercase().chain(rest).collect()
        }
        _ => title.to_owned(),
    }
}

/// Origin of a record: measured, simulated or not stated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Origin {
    /// Class in the style sheet.
    pub(crate) class: &'static str,
    /// Label of two or three words.
    pub(crate) label: &'static str,
    /// Meaning of the origin for the numbers.
    pub(crate) note: &'static str,
}

/// Returns the common origin of several records. If the origins differ and `apart` is given, the result says
/// so, with `apart` as its note; without `apart`, the origin then counts as unstated.
pub(crate) fn origin_of_all(
    stated: impl Iterator<Item = results::Origin>,
    apart: Option<&'static str>,
) -> Origin {
    let stated: Vec<results::Origin> = stated.collect();
    let differ = stated.iter().any(|other| Some(other) != stated.first());
    match apart {
        Some(note) if differ => Origin { class: "mixed", label: "Records of different origins", note },
        _ => origin(results::Origin::shared(stated)),
    }
}

/// Returns the words for the origin of a record; they always distinguish simulated from measured records.
pub(crate) fn kind(stated: results::Origin) -> &'static str {
    match stated {
        results::Origin::Unstated => "origin not stated",
        stated => stated.name(),
    }
}

pub(crate) fn origin(stated: results::Origin) -> Origin {
    match stated {
        results::Origin::Measured => {
            Origin { class: "measured", label: "Measured record", note: "Recorded from an oscillator." }
        }
        results::Origin::Simulated => Origin {
            class: "simulated",
            label: "Simulated record",
            note: "Computed, not measured: nothing here is evidence about a real oscillator.",
        },
        results::Origin::Unstated => Origin {
            class: "unstated",
            label: "Origin not stated",
            note: "If it was measured, say so: data.origin = \"measured\" in the configuration, or --origin measured \
                   for trainer diagnose.",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Sample;

    fn sentence(change: impl FnOnce(&mut EstimationResult)) -> (&'static str, String) {
        let mut result = Sample::new().result;
        result.seeds.truncate(1);
        change(&mut result);
        let verdict = verdict(&result);
        (verdict.label, verdict.sentence.replace('\u{a0}', " "))
    }

    #[test]
    fn what_comes_next_follows_from_how_it_ended() {
        let mut result = Sample::new().result;
        result.pass = true;
        result.estimate.reached = Reached::Converged;
        assert!(next(&result)[0].contains("trainer init "), "{:?}", next(&result));
        result.pass = false;
        result.estimate.reached = Reached::BudgetSpent;
        assert_eq!(next(&result).len(), 1);
        assert!(next(&result)[0].contains("fit.max_steps"));
        result.estimate.reached = Reached::Interrupted;
        assert!(next(&result)[0].contains("--resume"));
    }

    #[test]
    fn a_pass() {
        assert_eq!(
            sentence(|_| ()),
            (
                "Within tolerance",
                "The physics-informed neural network finds a damping ratio of 0.00875 ± 0.00021; \
                 it differs from closed-form least squares by 3.1 × 10⁻⁷ %, which solves least squares to the stated \
                 0.1 %."
                    .to_owned()
            )
        );
    }

    #[test]
    fn a_miss() {
        let (label, text) = sentence(|r| {
            r.estimator_title = "PINN".into();
            r.error_percent = 2.345;
            r.pass = false;
        });
        assert_eq!(label, "Outside tolerance");
        assert!(text.starts_with("The PINN finds"), "{text}");
        assert!(
            text.ends_with("by 2.3 %, so it does not solve least squares to the stated 0.1 %."),
            "{text}"
        );
    }

    /// Regression: agreement on a line through nothing was shown in green.
    #[test]
    fn agreement_on_a_poor_line_is_no_success() {
        let mut result = Sample::new().result;
        assert_eq!(verdict(&result).tone, Tone::Good);
        result.oracle.r_squared = 0.2;
        assert_eq!(verdict(&result).tone, Tone::Caution);
        assert!(verdict(&result).sentence.contains("R² 0.20"), "{}", verdict(&result).sentence);
    }

    #[test]
    fn one_bad_seed() {
        let mut result = Sample::new().result;
        result.pass = false;
        result.worst_error_percent = 0.25;
        let text = verdict(&result).sentence.replace('\u{a0}', " ");
        assert!(text.contains("but the worst of its 5 seeds differs by 0.25 %"), "{text}");
    }

    #[test]
    fn what_did_not_finish_is_no_result() {
        let (label, text) = sentence(|r| r.estimate.reached = Reached::Interrupted);
        assert_eq!(label, "Interrupted");
        assert!(text.ends_with("An unfinished run is no result."), "{text}");
        let (label, text) = sentence(|r| {
            r.estimate.reached = Reached::Diverged;
            r.estimate.zeta = f64::NAN;
            r.error_percent = f64::NAN;
        });
        assert_eq!(label, "Diverged");
        assert!(text.contains("not finite, cannot be compared"), "{text}");
        let (label, text) = sentence(|r| r.estimate.reached = Reached::BudgetSpent);
        assert_eq!(label, "Within tolerance, not converged");
        assert!(text.contains("before it converged"), "{text}");
        let (label, text) = sentence(|r| r.estimate.reached = Reached::Stalled);
        assert_eq!(label, "Within tolerance, not converged");
        assert!(text.contains("stalled"), "{text}");
        let (label, _) = sentence(|r| {
            r.estimate.reached = Reached::Stalled;
            r.pass = false;
        });
        assert_eq!(label, "Not converged");
    }

    #[test]
    fn names_keep_their_capitals_inside_a_sentence() {
        for (title, expected) in [
            ("Gradient descent", "gradient descent"),
            ("NumPy polyfit", "NumPy polyfit"),
            ("L-BFGS-B", "L-BFGS-B"),
            ("QR decomposition", "QR decomposition"),
            ("Bayesian regression", "Bayesian regression"),
            ("", ""),
        ] {
            assert_eq!(in_a_sentence(title), expected);
        }
    }
    #[test]
    fn every_origin_has_its_own_look() {
        assert_eq!(origin(results::Origin::Measured).class, "measured");
        assert_eq!(origin(results::Origin::Simulated).class, "simulated");
        assert_eq!(origin(results::Origin::Unstated).class, "unstated");
        assert!(origin(results::Origin::Unstated).note.contains("data.origin = \"measured\""));
    }
}
