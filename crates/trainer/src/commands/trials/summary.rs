//! Terminal output of trials, on one screen.

use crate::terminal::table::table;
use report::format::{fixed, interval, quantity, significant};
use results::{BarRow, Proportion, SizeRow, TrialsResult};
use std::path::Path;

/// Maximum number of effects listed as the worst.
const MOST_WORST: usize = 6;
/// Size from which an effect should be named; smaller effects may be missed legitimately.
const VISIBLE: f64 = 12.0;

/// Formats the result for the terminal.
pub(super) fn summary(result: &TrialsResult, folder: &Path) -> String {
    let path = folder.display();
    let mut parts = vec![
        format!(
            "{} cases, seed {}, in {:.1} s{}",
            result.cases,
            result.seed,
            result.seconds,
            if result.unanswered > 0 {
                format!(": {} WITHOUT AN ANSWER", result.unanswered)
            } else {
                String::new()
            },
        ),
        table(&["bar", "", "measured, 95 % interval", "cases", ""], result.bars.iter().map(bar).collect()),
        banks(result),
    ];
    parts.extend((!result.inclusion.is_empty()).then(|| classes(result)));
    parts.extend((!result.gate.is_empty()).then(|| {
        table(&["gate", "", "measured, 95 % interval", "cases", ""], result.gate.iter().map(bar).collect())
    }));
    parts.extend(worst(result));
    parts.extend(result.left_out.iter().map(|left| format!("not made: {}: {}", left.bank, left.reason)));
    if let Some(first) = result.failures.first() {
        parts.push(format!(
            "{} cases wrong or without an answer, each with its command in the report; the first:\n  {}",
            result.failures.len(),
            first.command
        ));
    }
    parts.push(format!(
        "report: {path}/report.html\nscores: {path}/result.json, cases.csv\nscore again: trainer trials --score {path}"
    ));
    parts.join("\n\n")
}

fn percent(share: f64) -> String {
    if share.is_finite() { quantity(&fixed(100.0 * share, 1), "%") } else { "–".to_owned() }
}

fn bar(row: &BarRow) -> Vec<String> {
    let is_share = row.unit == "%";
    let number = |value: f64| {
        if is_share { percent(value) } else { quantity(&significant(value, 3), &row.unit) }
    };
    let bar = match (row.at_least, row.at_most) {
        (Some(low), Some(high)) => format!("{} to {}", number(low), number(high)),
        (Some(low), None) => format!("≥ {}", number(low)),
        (None, Some(high)) => format!("≤ {}", number(high)),
        (None, None) => String::new(),
    };
    let measured = match (row.value.is_finite(), row.interval_95) {
        (false, _) => "–".to_owned(),
        (true, [low, high]) if is_share => {
            format!("{} [{}, {}]", number(row.value), fixed(100.0 * low, 1), fixed(100.0 * high, 1))
        }
        (true, ends) if ends[0].is_finite() => format!("{} {}", number(row.value), interval(ends)),
        (true, _) => number(row.value),
    };
    vec![row.metric.clone(), bar, measured, row.cases.to_string(), report::bar_state(row).to_owned()]
}

fn banks(result: &TrialsResult) -> String {
    let share = |of: &Proportion| {
        if of.of == 0 { String::new() } else { format!("{} ({}/{})", percent(of.share), of.count, of.of) }
    };
    let rows = result
        .banks
        .iter()
        .map(|bank| vec![bank.bank.clone(), share(&bank.right), share(&bank.top_1), share(&bank.class)])
        .collect();
    table(&["bank", "status and set right", "first name right", "its class right"], rows)
}

/// Formats the shares of acting effects that are named, by class, in cases with several effects; columns are
/// groups of cases.
fn classes(result: &TrialsResult) -> String {
    let groups = &result.inclusion;
    let heads: Vec<&str> =
        std::iter::once("by class").chain(groups.iter().map(|own| own.banks.as_str())).collect();
    let rows = report::class_rows(groups).into_iter().map(|(name, shares)| {
        let cell = |of: &Proportion| {
            if of.of == 0 {
                "–".to_owned()
            } else {
                format!("{} ({}/{})", percent(of.share), of.count, of.of)
            }
        };
        std::iter::once(name).chain(shares.iter().map(cell)).collect()
    });
    table(&heads, rows.collect())
}

/// Lists the effects that are least often named at sizes at which they should be, the worst first.
fn worst(result: &TrialsResult) -> Option<String> {
    let mut by_effect: Vec<(&str, u64, u64)> = Vec::new();
    let single = |row: &&SizeRow| row.bank == "single" && row.size >= VISIBLE;
    for row in result.effects.iter().filter(single) {
        match by_effect.iter_mut().find(|(effect, ..)| *effect == row.effect) {
            Some((_, right, of)) => (*right, *of) = (*right + row.top_1.count, *of + row.top_1.of),
            None => by_effect.push((&row.effect, row.top_1.count, row.top_1.of)),
        }
    }
    let share = |(_, right, of): &(&str, u64, u64)| *right as f64 / *of as f64;
    by_effect.retain(|row| row.1 < row.2);
    by_effect.sort_by(|a, b| share(a).total_cmp(&share(b)));
    let named: Vec<String> = by_effect
        .iter()
        .take(MOST_WORST)
        .map(|(effect, right, of)| format!("{effect} {right} of {of}"))
        .collect();
    (!named.is_empty())
        .then(|| format!("least often named first, at sizes of about 12 and more: {}", named.join(", ")))
}
