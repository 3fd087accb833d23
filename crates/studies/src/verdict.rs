//! Verdict on a problem: sentences on its scores that claim no more than the scores support.

use report::format;
use results::{HeldOutScore, PredictionOutcome, PredictionRow, ProblemStudy};

/// Maximum number of names in a list; the others are only counted.
const MOST_NAMES: usize = 6;

/// Lists, for interpolation and for extrapolation, the methods that predict better than the best exponential
/// by more than chance, those that predict worse, and those that cannot be distinguished from it. The last
/// stretch of a record is a single trial, which cannot be tested.
pub(crate) fn verdict(study: &ProblemStudy, significance: f64) -> Vec<String> {
    let waits = |row: &PredictionRow| row.outcome.is_not_begun();
    if !study.methods.is_empty() && study.methods.iter().all(waits) {
        return vec!["Interrupted before a method was fitted: nothing is compared.".to_owned()];
    }
    let mut sentences = vec![match study.comparisons {
        0 => "No method differs from the best exponential on any held-out peak.".to_owned(),
        count => format!(
            "Sign tests over {}, {count} comparisons adjusted by Holm's method, level {significance}.",
            if study.law.is_some() { "draws" } else { "blocks of peaks" }
        ),
    }];
    sentences.push(format!(
        "Between other peaks {}",
        tested(study, &study.exponential.interpolation, interpolation, significance)
    ));
    sentences.push(if study.law.is_some() {
        format!(
            "Beyond the last peak seen {}",
            tested(study, &study.exponential.extrapolation, extrapolation, significance)
        )
    } else {
        single_stretch(study)
    });
    sentences
}

fn interpolation(row: &PredictionRow) -> Option<&HeldOutScore> {
    match &row.outcome {
        PredictionOutcome::Scored(scores) => scores.interpolation.as_ref(),
        PredictionOutcome::Failed { .. } => None,
    }
}

fn extrapolation(row: &PredictionRow) -> Option<&HeldOutScore> {
    match &row.outcome {
        PredictionOutcome::Scored(scores) => scores.extrapolation.as_ref(),
        PredictionOutcome::Failed { .. } => None,
    }
}

fn tested(
    study: &ProblemStudy,
    exponential: &HeldOutScore,
    score: impl Fn(&PredictionRow) -> Option<&HeldOutScore>,
    significance: f64,
) -> String {
    let (mut better, mut worse, mut open) = (Vec::new(), Vec::new(), Vec::new());
    let (mut same, mut seen) = (0, 0);
    for row in &study.methods {
        let Some(found) = score(row) else { continue };
        let Some(pair) = &found.against_exponential else { continue };
        seen += 1;
        let name = format!(
            "{} (error {}; better in {}, worse in {} of {})",
            row.id,
            format::significant(found.rms_log_error, 2),
            pair.better,
            pair.worse,
            pair.better + pair.worse + pair.equal
        );
        if pair.better + pair.worse == 0 {
            same += 1;
        } else if pair.adjusted_p_value > significance || pair.adjusted_p_value.is_nan() {
            open.push(name);
        } else if pair.better > pair.worse {
            better.push(name);
        } else {
            worse.push(name);
        }
    }
    let reference = format::significant(exponential.rms_log_error, 2);
    if seen == 0 {
        return format!("no method predicts; the best exponential misses by {reference}.");
    }
    let parts = [
        Some(match better.len() {
            0 => format!(
                "no method is better than the best exponential (error {reference}) by more than chance"
            ),
            _ => format!(
                "better than the best exponential (error {reference}) by more than chance: {}",
                listed(&better)
            ),
        }),
        (!worse.is_empty()).then(|| format!("worse: {}", listed(&worse))),
        (!open.is_empty()).then(|| format!("not distinguishable from it: {}", listed(&open))),
        (same > 0).then(|| format!("the same line: {}", methods(same))),
    ];
    format!("{}.", parts.into_iter().flatten().collect::<Vec<_>>().join("; "))
}

/// Describes the errors on the last stretch of a record, and states that this is a single stretch.
fn single_stretch(study: &ProblemStudy) -> String {
    let reference = study.exponential.extrapolation.rms_log_error;
    let errors = || study.methods.iter().filter_map(|row| Some((row, extrapolation(row)?.rms_log_error)));
    if errors().next().is_none() {
        return format!(
            "Beyond the last peak seen no method predicts; the best exponential misses by {}.",
            format::significant(reference, 2)
        );
    }
    let below = errors().filter(|(_, error)| *error < reference * (1.0 - 1e-6)).count();
    let best = errors().next().map_or_else(String::new, |(row, error)| {
        format!("; the smallest is {} ({})", format::significant(error, 2), row.id)
    });
    format!(
        "Beyond the last peak seen the best exponential misses by {}, and {} {} by less{best}: one stretch \
         of one record is a single trial, which no test can distinguish from chance.",
        format::significant(reference, 2),
        methods(below),
        if below == 1 { "misses" } else { "miss" },
    )
}

fn methods(count: usize) -> String {
    match count {
        0 => "no methods".to_owned(),
        1 => "1 method".to_owned(),
        _ => format!("{count} methods"),
    }
}

fn listed(names: &[String]) -> String {
    let (shown, rest) = names.split_at(names.len().min(MOST_NAMES));
    match rest.len() {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}
