//! Accuracy by bank, effect and size, and confusion tables.

#![allow(clippy::indexing_slicing, reason = "sizes are counted by their own list")]

use super::judgment::{BANKS, Judgment, KINDS, Said};
use super::statistics::proportion;
use crate::hidden::{Asked, Bank};
use results::{BankRow, Confusion, NuisanceRow, Proportion, SizeRow};
use std::collections::{BTreeMap, BTreeSet};

/// Representative sizes in noise units; each one's range extends to the geometric mean with its neighbors.
pub(crate) const SIZES: [f64; 9] = [3.0, 6.0, 12.0, 25.0, 50.0, 100.0, 200.0, 400.0, 800.0];

/// Returns the range of sizes that the size with an index represents.
pub(crate) fn range(index: usize) -> [f64; 2] {
    // The first range includes all smaller sizes, the last one all larger ones.
    let middle = |below: usize| (SIZES[below] * SIZES[below + 1]).sqrt();
    let low = if index == 0 { 0.0 } else { middle(index - 1) };
    [low, if index + 1 < SIZES.len() { middle(index) } else { f64::INFINITY }]
}

/// Returns `true` if a size lies in a range.
pub(crate) fn within(size: f64, [low, high]: [f64; 2]) -> bool {
    size >= low && size < high
}

/// Returns the accuracy by bank; banks without cases are left out.
pub(crate) fn banks(judged: &[Judgment<'_>]) -> Vec<BankRow> {
    BANKS
        .into_iter()
        .filter_map(|bank| {
            let own = || judged.iter().filter(move |judgment| judgment.bank() == bank);
            own().next()?;
            let share = |of: fn(&Judgment<'_>) -> bool| proportion(own().map(of));
            let pairs = || own().filter(|judgment| judgment.case.hidden.effects.len() > 1);
            let plain = || own().filter(|judgment| judgment.asked() == Asked::Nothing);
            Some(BankRow {
                bank: bank.name().to_owned(),
                right: share(|judgment| judgment.right),
                top_1: share(|judgment| judgment.top_1),
                class: share(|judgment| judgment.class),
                both: proportion(pairs().map(|judgment| judgment.both)),
                either: proportion(pairs().map(|judgment| judgment.either)),
                false_alarms: proportion(plain().map(Judgment::alarms)),
            })
        })
        .collect()
}

/// Returns the accuracy by bank, first hidden effect and size, or by bank and size if `by_effect` is `false`.
pub(crate) fn sizes(judged: &[Judgment<'_>], by_effect: bool) -> Vec<SizeRow> {
    let mut groups: BTreeMap<(Bank, &str, usize), Vec<&Judgment<'_>>> = BTreeMap::new();
    for judgment in judged {
        let hidden = &judgment.case.hidden;
        let foreign = hidden.foreign.as_ref().and_then(|foreign| foreign.law.split(':').next());
        let size = judgment.size();
        let Some(index) = (0..SIZES.len()).find(|index| within(size, range(*index))) else { continue };
        let effect = match (by_effect, hidden.effects.first()) {
            (false, _) => "",
            (true, Some(first)) => first.id.as_str(),
            (true, None) => foreign.unwrap_or(""),
        };
        groups.entry((judgment.bank(), effect, index)).or_default().push(judgment);
    }
    groups
        .into_iter()
        .map(|((bank, effect, index), own)| SizeRow {
            bank: bank.name().to_owned(),
            effect: effect.to_owned(),
            size: SIZES.get(index).copied().unwrap_or(f64::NAN),
            range: range(index),
            top_1: proportion(own.iter().map(|judgment| judgment.top_1)),
            class: proportion(own.iter().map(|judgment| judgment.class)),
            both: match bank {
                Bank::Pair => proportion(own.iter().map(|judgment| judgment.both)),
                _ => proportion([]),
            },
        })
        .collect()
}

fn table(rows: Vec<String>, columns: Vec<String>, pairs: &[(String, String)]) -> Confusion {
    let counts = rows
        .iter()
        .map(|row| {
            let count = |column: &String| {
                pairs.iter().filter(|(hidden, said)| hidden == row && said == column).count() as u64
            };
            columns.iter().map(count).collect()
        })
        .collect();
    Confusion { hidden: rows, said: columns, counts }
}

/// Tabulates hidden effects against first names, over cases with at most one effect.
pub(crate) fn confusion(judged: &[Judgment<'_>]) -> Confusion {
    let said = |judgment: &Judgment<'_>| match (judgment.said, judgment.named.first()) {
        (Said::Effect, Some(first)) => (*first).to_owned(),
        (said, _) => said.name().to_owned(),
    };
    let hidden = |judgment: &Judgment<'_>| match judgment.bank() {
        Bank::LeftOut => "not considered".to_owned(),
        _ if judgment.asked() == Asked::Unknown => "foreign".to_owned(),
        bank if judgment.asked() == Asked::Nothing => bank.name().to_owned(),
        _ => judgment.case.hidden.effects.first().map_or_else(String::new, |effect| effect.id.clone()),
    };
    let pairs: Vec<(String, String)> = judged
        .iter()
        .filter(|judgment| judgment.case.hidden.effects.len() < 2)
        .map(|judgment| (hidden(judgment), said(judgment)))
        .collect();
    let order = |names: BTreeSet<&String>| -> Vec<String> {
        let known = dynamics::REGISTRY.iter().map(|effect| effect.id());
        let others = ["none", "calibration", "not considered", "foreign", "unknown", "no answer"];
        known.chain(others).filter(|id| names.iter().any(|name| name == id)).map(str::to_owned).collect()
    };
    let rows = order(pairs.iter().map(|(hidden, _)| hidden).collect());
    let columns = order(pairs.iter().map(|(_, said)| said).collect());
    table(rows, columns, &pairs)
}

/// Tabulates hidden kinds against kinds of answers.
pub(crate) fn kinds(judged: &[Judgment<'_>]) -> Confusion {
    let pairs: Vec<(String, String)> = judged
        .iter()
        .map(|judgment| (judgment.hidden_kind().to_owned(), judgment.said_kind().to_owned()))
        .collect();
    let order = |of: fn(&(String, String)) -> &String| -> Vec<String> {
        let names: BTreeSet<&String> = pairs.iter().map(of).collect();
        KINDS.into_iter().filter(|kind| names.iter().any(|name| name == kind)).map(str::to_owned).collect()
    };
    table(order(|pair| &pair.0), order(|pair| &pair.1), &pairs)
}

/// Returns the share of right kinds of verdict among cases with effects in a range of sizes and cases without
/// an effect.
pub(crate) fn kind_right(judged: &[Judgment<'_>], sizes: [f64; 2]) -> Proportion {
    let counted = judged.iter().filter(|judgment| {
        judgment.asked() != Asked::Unknown
            && (judgment.asked() == Asked::Nothing || within(judgment.size(), sizes))
    });
    proportion(counted.map(Judgment::kind_is_right))
}

/// Returns how often each nuisance was named.
pub(crate) fn nuisances(judged: &[Judgment<'_>]) -> Vec<NuisanceRow> {
    let ids: BTreeSet<&String> = judged.iter().flat_map(|judgment| &judgment.case.hidden.nuisances).collect();
    let row = |id: &String| {
        let having = judged.iter().filter(|judgment| judgment.case.hidden.nuisances.contains(id));
        let answers = having.filter_map(Judgment::answer);
        NuisanceRow {
            id: id.clone(),
            named: proportion(answers.map(|answer| answer.verdict.effects.contains(id))),
        }
    };
    ids.into_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::sample::{answered, case};

    #[test]
    fn ranges_touch_and_hold_what_they_are_named_for() {
        for (index, size) in SIZES.iter().enumerate() {
            assert!(within(*size, range(index)));
            if index > 0 {
                assert_eq!(range(index - 1)[1], range(index)[0]);
            }
        }
        assert!(within(0.0, range(0)) && within(1e9, range(SIZES.len() - 1)));
    }

    #[test]
    fn counts_fall_where_they_belong() {
        let cases = [
            case(Bank::Single, &["gravity"], answered("effect", &["gravity"], 0.9)),
            case(Bank::Single, &["gravity"], answered("effect", &["cubic_stiffness"], 0.9)),
            case(Bank::None, &[], answered("none", &[], 0.9)),
            case(Bank::None, &[], answered("effect", &["backlash"], 0.9)),
            case(Bank::Foreign, &[], Err("no".to_owned())),
        ];
        let judged: Vec<Judgment<'_>> = cases.iter().map(Judgment::of).collect();
        let found = confusion(&judged);
        assert_eq!(found.hidden, ["gravity", "none", "foreign"]);
        assert_eq!(found.said, ["cubic_stiffness", "gravity", "backlash", "none", "no answer"]);
        assert_eq!(found.counts, [[1, 1, 0, 0, 0], [0, 0, 1, 1, 0], [0, 0, 0, 0, 1]]);
        let banks = banks(&judged);
        assert_eq!((banks[0].false_alarms.count, banks[0].false_alarms.of), (1, 2));
        assert_eq!((banks[1].top_1.count, banks[1].top_1.of), (1, 2));
        let sizes = sizes(&judged, true);
        assert_eq!((sizes.len(), sizes[0].size, sizes[0].top_1.of), (2, 25.0, 2));
        assert_eq!((sizes[1].effect.as_str(), sizes[1].top_1.count), ("a law of its own", 0));
        assert_eq!(kinds(&judged).hidden, ["none", "structure", "unknown"]);
    }
}
