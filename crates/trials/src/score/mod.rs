//! Scoring of answers against opened truths, by pure functions.
//!
//! Correctness has one definition (`judgment`): the test of stated confidence, the counts in `cases.csv` and
//! the list of failures all use it. Classes are the scorer's own. Which effects it treats as alike does not follow from
//! which ones the diagnosis treats as alike, and a class to which an unlisted law belongs by its mechanism counts
//! neither for nor against an answer.

pub(crate) mod accuracy;
mod bars;
mod classes;
#[cfg(test)]
mod classes_tests;
mod closure;
mod gate;
mod isotonic;
mod judgment;
mod regret;
mod reliability;
#[cfg(test)]
pub(crate) mod sample;
mod statistics;
#[cfg(test)]
mod tests;
mod unknown;

pub use closure::true_closure;
pub use gate::{Gate, misses_the_gate};
pub use judgment::AnsweredCase;
pub use regret::with_the_truth;

pub(crate) use judgment::Judgment;
pub(crate) use statistics::proportion;

use crate::baseline::{Baseline, row};
use crate::hidden::Bank;
use judgment::{RIGHT_MEANS, Said};
use reliability::{Statements, is_own, mapped, of_confidence, of_effects, reliability};
use results::{
    FailureRow, LeftOutBank, ProbabilityMap, Reliability, TRIALS_SCHEMA, TrialCaseRow, TrialsResult,
    VerdictStatus,
};
use seed::Seed;

/// Trials whose cases were answered, with everything that the scores depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct Trials {
    /// Name of the trials.
    pub name: String,
    /// Root seed of every random draw.
    pub seed: u64,
    /// Banks that were not made, with reasons.
    pub left_out: Vec<LeftOutBank>,
    /// Values that the scores have to reach.
    pub gate: Gate,
    /// Elapsed wall time in seconds.
    pub seconds: f64,
}

/// Scores all cases, in the order in which they were made.
///
/// An answer is right if its status and its named set are right after nuisances are removed;
/// [`TrialsResult::right_means`] gives the full definition. Shares have 95 % intervals by Clopper and
/// Pearson, medians by order statistics, areas under the ROC curve by DeLong. The calibration of
/// probabilities is assessed in bins of equal count, with a bootstrap over cases. The bootstrap's draws
/// follow from [`Trials::seed`], so the same cases give the same numbers. Quantities that could not be
/// measured are NaN.
///
/// `baselines` hold one answer for each case, in the order of `cases`.
#[must_use]
pub fn score(trials: &Trials, cases: &[AnsweredCase], baselines: &[Baseline]) -> TrialsResult {
    let judged: Vec<Judgment<'_>> = cases.iter().map(Judgment::of).collect();
    let seed = Seed::new(trials.seed).child("scoring");
    let (reliability, map) = probabilities(&judged, &seed);
    let unknown = unknown::study(&judged);
    let named_right = judged.iter().filter(|judgment| judgment.right && judgment.said == Said::Effect);
    let answers = || judged.iter().filter_map(Judgment::answer);
    let ratio_to_floor = statistics::quantiles(
        named_right.filter_map(Judgment::answer).map(|answer| answer.gap.ratio_to_floor),
    );
    let seconds_per_case = statistics::quantiles(answers().map(|answer| answer.seconds));
    let closure = closure::study(&judged);
    let measured = bars::Measured {
        judged: &judged,
        reliability: &reliability,
        unknown: &unknown,
        ratio_to_floor: &ratio_to_floor,
        closure: &closure,
        seconds: &seconds_per_case,
    };
    TrialsResult {
        schema: TRIALS_SCHEMA.to_owned(),
        task: "trials".to_owned(),
        name: trials.name.clone(),
        seed: trials.seed,
        cases: cases.len() as u64,
        unanswered: cases.iter().filter(|case| case.answer.is_err()).count() as u64,
        left_out: trials.left_out.clone(),
        right_means: RIGHT_MEANS.to_owned(),
        bars: bars::bars(&measured),
        gate: trials.gate.rows(&judged, &reliability),
        inclusion: classes::study(&judged),
        banks: accuracy::banks(&judged),
        effects: accuracy::sizes(&judged, true),
        sizes: accuracy::sizes(&judged, false),
        confusion: accuracy::confusion(&judged),
        kinds: accuracy::kinds(&judged),
        map,
        unknown,
        ratio_to_floor,
        closure,
        seconds_per_case,
        nuisances: accuracy::nuisances(&judged),
        baselines: baselines.iter().map(|baseline| row(baseline, &judged)).collect(),
        failures: judged.iter().filter(|judgment| !judgment.right).map(failure).collect(),
        seconds: trials.seconds,
        reliability,
    }
}

/// Returns `true` if some bar is missed by the whole interval.
#[must_use]
pub fn misses_a_bar(result: &TrialsResult) -> bool {
    result.bars.iter().any(|bar| bar.missed_beyond_chance)
}

/// Returns one row per case.
#[must_use]
pub fn case_rows(cases: &[AnsweredCase]) -> Vec<TrialCaseRow> {
    cases.iter().map(|case| case_row(&Judgment::of(case))).collect()
}

/// Returns the reliability studies, and the probability map. The map is fitted to every second case of the
/// own banks, from the first, and scored on the others.
fn probabilities(judged: &[Judgment<'_>], seed: &Seed) -> (Vec<Reliability>, ProbabilityMap) {
    let own = |even: Option<bool>| -> Statements {
        let places = judged.iter().filter(|judgment| is_own(judgment.bank())).enumerate();
        let chosen = places.filter(|(place, _)| even.is_none_or(|even| place.is_multiple_of(2) == even));
        of_confidence(chosen.map(|(_, judgment)| judgment))
    };
    let stressed = || judged.iter().filter(|judgment| judgment.bank() == Bank::Stressed);
    let elsewhere =
        || judged.iter().filter(|judgment| matches!(judgment.bank(), Bank::Measured | Bank::Engine));
    let all_own = || judged.iter().filter(|judgment| is_own(judgment.bank()));
    let map = isotonic::fit(&own(Some(true)).concat());
    let held_out = own(Some(false));
    let mut studies = vec![
        ("confidence", "own", own(None)),
        ("confidence", "stressed", of_confidence(stressed())),
        ("confidence", "measured and engine", of_confidence(elsewhere())),
        ("effects", "own", of_effects(all_own())),
        ("effects", "stressed", of_effects(stressed())),
    ];
    if !map.knots.is_empty() {
        studies.push(("confidence, mapped", "own, not fitted", mapped(&held_out, &map)));
        studies.push(("confidence, not mapped", "own, not fitted", held_out));
        studies.push(("confidence, mapped", "stressed", mapped(&of_confidence(stressed()), &map)));
    }
    for (banks, own) in classes::groups(judged) {
        studies.push(("confidence", banks, of_confidence(own.iter().copied())));
        studies.push(("effects", banks, of_effects(own.iter().copied())));
        studies.push(("classes", banks, classes::statements(own.iter().copied())));
    }
    let found = studies.iter().filter_map(|(subject, banks, statements)| {
        reliability(subject, banks, statements, &seed.child(subject).child(banks))
    });
    (found.collect(), map)
}

fn failure(judgment: &Judgment<'_>) -> FailureRow {
    FailureRow {
        id: judgment.case.id.clone(),
        bank: judgment.bank().name().to_owned(),
        hidden: judgment.hidden_name(),
        said: match &judgment.case.answer {
            Ok(_) => judgment.said_name(),
            Err(message) => format!("no answer: {message}"),
        },
        size: judgment.size(),
        same_class: judgment.class && !judgment.top_1,
        command: judgment.case.command.clone(),
    }
}

fn case_row(judgment: &Judgment<'_>) -> TrialCaseRow {
    let hidden = &judgment.case.hidden;
    let answer = judgment.answer();
    let foreign = hidden.foreign.iter().map(|foreign| foreign.detectability);
    let sizes = hidden.effects.iter().map(|effect| effect.detectability).chain(foreign);
    let sizes: Vec<String> = sizes.map(|size| format!("{size:.4}")).collect();
    let ids: Vec<&str> = hidden.effects.iter().map(|effect| effect.id.as_str()).collect();
    let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
    let closure = answer.map(|answer| answer.gap.closure);
    TrialCaseRow {
        id: judgment.case.id.clone(),
        bank: judgment.bank().name().to_owned(),
        hidden: judgment.foreign_law().filter(|_| ids.is_empty()).unwrap_or_else(|| ids.join("+")),
        size: sizes.join("+"),
        status: judgment.said.name().to_owned(),
        named: judgment.named.join("+"),
        confidence: finite(answer.map(|answer| answer.verdict.confidence)),
        unknown: judgment.probability(VerdictStatus::Unknown.name()),
        right: judgment.right,
        top_1: judgment.top_1,
        class: judgment.class,
        ratio_to_floor: finite(answer.map(|answer| answer.gap.ratio_to_floor)),
        closure: finite(closure.map(|closure| closure.value)),
        closure_low: finite(closure.map(|closure| closure.interval_95[0])),
        closure_high: finite(closure.map(|closure| closure.interval_95[1])),
        regret: finite(judgment.regret()),
        true_closure: finite(judgment.case.true_closure.as_ref().ok().copied()),
        seconds: finite(answer.map(|answer| answer.seconds)),
    }
}
