//! Baseline diagnosers for the same records, which the diagnosis has to beat.

mod weak_form;

pub use weak_form::{WEAK_FORM, WEAK_FORM_METHOD, weak_form};

use crate::hidden::{Asked, Bank};
use crate::score::{AnsweredCase, Judgment, accuracy, proportion};
use results::{BaselineRow, SizeRow};
use std::collections::BTreeMap;

/// Answers of a baseline diagnoser to every case.
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// Identifier.
    pub id: String,
    /// One-sentence description of the method.
    pub method: String,
    /// Named effect of each case, in the order of the cases; `None` if nothing is named.
    pub answers: Vec<Option<String>>,
}

/// Record as a baseline sees it: positions at the logged times.
#[derive(Debug, Clone, PartialEq)]
pub struct BaselineRecord {
    /// Times in seconds, nondecreasing.
    pub times_s: Vec<f64>,
    /// Positions in rad or m.
    pub values: Vec<f64>,
    /// Input; `None` for a free motion.
    pub input: Option<Vec<f64>>,
}

impl BaselineRecord {
    /// Returns `true` if every time has a value and, if there is an input, an input value.
    fn is_whole(&self) -> bool {
        let count = self.times_s.len();
        self.values.len() == count && self.input.as_ref().is_none_or(|input| input.len() == count)
    }
}

/// Baseline that always names the effect that is hidden in most cases of a single effect: the score of
/// knowing only the frequencies.
#[must_use]
pub fn most_common(cases: &[AnsweredCase]) -> Baseline {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let single = cases.iter().filter(|case| case.hidden.bank == Bank::Single);
    for effect in single.filter_map(|case| case.hidden.effects.first()) {
        *counts.entry(&effect.id).or_default() += 1;
    }
    let most = counts.into_iter().rev().max_by_key(|(_, count)| *count).map(|(id, _)| id.to_owned());
    Baseline {
        id: "most-common".to_owned(),
        method: "names the effect that most cases hide, whatever the record".to_owned(),
        answers: vec![most; cases.len()],
    }
}

/// Scores a baseline by the same rules as the diagnosis: nuisances that it names are removed first.
pub(crate) fn row(baseline: &Baseline, judged: &[Judgment<'_>]) -> BaselineRow {
    let named = || {
        judged.iter().zip(&baseline.answers).map(|(judgment, answer)| {
            let hidden = &judgment.case.hidden;
            (judgment, answer.as_ref().filter(|id| !hidden.nuisances.contains(id)))
        })
    };
    let is_right = |judgment: &Judgment<'_>, answer: Option<&String>| {
        answer.is_some_and(|id| judgment.case.hidden.effects.iter().any(|effect| &effect.id == id))
    };
    let single = || named().filter(|(judgment, _)| judgment.bank() == Bank::Single);
    let without = named().filter(|(judgment, _)| judgment.asked() == Asked::Nothing);
    let sizes = (0..accuracy::SIZES.len()).filter_map(|index| {
        let range = accuracy::range(index);
        let top_1 = proportion(
            single()
                .filter(|(judgment, _)| accuracy::within(judgment.size(), range))
                .map(|(judgment, answer)| is_right(judgment, answer)),
        );
        let size = accuracy::SIZES.get(index).copied()?;
        let nothing = proportion([]);
        (top_1.of > 0).then(|| SizeRow {
            bank: "single".to_owned(),
            effect: String::new(),
            size,
            range,
            top_1,
            class: top_1,
            both: nothing,
        })
    });
    BaselineRow {
        id: baseline.id.clone(),
        method: baseline.method.clone(),
        top_1: proportion(single().map(|(judgment, answer)| is_right(judgment, answer))),
        diagnosis: proportion(single().map(|(judgment, _)| judgment.top_1)),
        false_alarms: proportion(without.map(|(_, answer)| answer.is_some())),
        sizes: sizes.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::sample::{answered, case};

    #[test]
    fn the_most_common_effect_is_named_throughout() {
        let of = |bank, hidden: &[&str]| case(bank, hidden, answered("none", &[], 0.5));
        let cases = [
            of(Bank::Single, &["gravity"]),
            of(Bank::Single, &["backlash"]),
            of(Bank::Single, &["gravity"]),
            of(Bank::None, &[]),
        ];
        let baseline = most_common(&cases);
        assert_eq!(baseline.answers, vec![Some("gravity".to_owned()); 4]);
        let judged: Vec<Judgment<'_>> = cases.iter().map(Judgment::of).collect();
        let row = row(&baseline, &judged);
        assert_eq!((row.top_1.count, row.top_1.of, row.diagnosis.count), (2, 3, 0));
        assert_eq!((row.false_alarms.count, row.false_alarms.of), (1, 1));
    }
}
