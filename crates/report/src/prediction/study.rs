//! Sentences on a prediction study, for the page and for Markdown.

use crate::format;
use crate::tables::{Fact, fact, whole};
use crate::verdict::{self, Origin, Tone, Verdict};
use results::{
    MethodScores, PredictionOutcome, PredictionResult, PredictionRow, ProblemOutcome, ProblemRow,
    ProblemStudy, SplitSummary,
};

/// Returns the facts about a problem: its law, or its file.
pub(super) fn facts(study: &ProblemStudy) -> Vec<Fact> {
    let mut facts = Vec::new();
    if let Some(law) = &study.law {
        facts.extend([
            fact("Law", law.equation.clone()),
            fact("Parameters", law.parameters.clone()),
            fact("Closed form", law.exactness.clone()),
            fact("Scatter", law.scatter.clone()),
            fact("λ of the viscous part", format::quantity(&format::significant(law.viscous_rate, 6), "1/s")),
            fact(
                "Projected slope of the noise-free ln A",
                format::quantity(&format::significant(law.projected_slope, 6), "1/s"),
            ),
            fact(
                "Draws",
                format!(
                    "{}; methods with random numbers of their own use the first {}. Errors and densities of \
                     all methods are over the first {1}; coverage and sign tests are over all draws of a \
                     method",
                    law.draws[0], law.draws[1]
                ),
            ),
        ]);
    }
    if let Some(data) = &study.data {
        facts.extend([
            fact("File", data.path.clone()),
            fact("Clock", format!("{}: {}", data.clock, data.clock_reason)),
        ]);
    }
    facts.extend([
        fact("Peaks", whole(study.peaks)),
        fact("From first to last", format::quantity(&format::significant(study.duration_s, 4), "s")),
    ]);
    facts
}

/// Returns sentences on the laws that methods discovered.
pub(super) fn laws(study: &ProblemStudy) -> Vec<String> {
    let law = |row: &PredictionRow| {
        let scores = scored(row)?;
        let equation = scores.equation.as_ref()?;
        let common = match &scores.commonest_form {
            Some((form, count)) if scores.draws > 1 => {
                format!(" on the first draw; {count} of {} draws give {form}", scores.draws)
            }
            Some((form, count)) if scores.draws == 1 && *count > 1 => {
                format!(" on the first fold; {count} folds give {form}")
            }
            _ => String::new(),
        };
        Some(format!("{}: {equation}{common}", row.title))
    };
    study.methods.iter().filter_map(law).collect()
}

pub(super) fn scored(row: &PredictionRow) -> Option<&MethodScores> {
    match &row.outcome {
        PredictionOutcome::Scored(scores) => Some(scores),
        PredictionOutcome::Failed { .. } => None,
    }
}

pub(super) fn held_out(splits: &SplitSummary) -> String {
    format!(
        "Inside: one of every {} blocks of {} successive peaks is held out, but never the first or the last \
         block; a record is fitted once for each such choice, and each draw of a simulation uses the next \
         choice in turn. Beyond: the last {} % of the peaks are held out.",
        splits.every,
        splits.block_peaks,
        format::fixed(100.0 * splits.last_share, 0)
    )
}

pub(super) fn studied(result: &PredictionResult) -> impl Iterator<Item = &ProblemRow> {
    result.problems.iter().filter(|row| matches!(row.outcome, ProblemOutcome::Studied(_)))
}

/// Returns the verdict of the page, which only counts; the conclusions from the numbers are in each problem's
/// own sentences.
pub(super) fn headline(result: &PredictionResult) -> Verdict {
    let of = |origin| studied(result).filter(|row| row.origin == origin).count();
    let (simulated, measured) = (of(results::Origin::Simulated), of(results::Origin::Measured));
    let all = studied(result).count();
    let other = all - simulated - measured;
    let mut kinds = vec![format!("{simulated} simulated"), format!("{measured} measured")];
    if other > 0 {
        kinds.push(format!("{other} of unstated origin"));
    }
    let absent = result.problems.len() - all;
    let (tone, label) = match (all, absent) {
        (0, _) => (Tone::Bad, "Nothing studied"),
        (_, 0) => (Tone::Good, "Every problem studied"),
        _ => (Tone::Caution, "Some records are absent"),
    };
    Verdict {
        tone,
        label,
        sentence: format!(
            "Methods were scored on held-out peaks of {all} problems ({}). Each section states what its numbers \
             support; agreement with least squares is no merit where the envelope is not exponential.",
            kinds.join(", ")
        ),
    }
}

pub(super) fn origin(result: &PredictionResult) -> Origin {
    let origins = studied(result).map(|row| row.origin);
    verdict::origin_of_all(origins, Some("Each section states the origin of its problem."))
}
