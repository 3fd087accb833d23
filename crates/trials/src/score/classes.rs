//! Scores by effect and by class for cases with several effects: recall, precision, and calibration of
//! probabilities.

use super::judgment::{Judgment, Said};
use super::reliability::Statements;
use super::statistics::{proportion, quantiles};
use crate::effects::{EffectClass, REGISTRY, TrialEffect, class_of};
use crate::hidden::{Asked, Bank, HiddenEffect};
use results::{ClassScores, DiagnosisResult, InclusionRow, Proportion, RecallRow};

/// Endpoints of the ranges of sizes, × noise, with a stated recall; the last range has no upper end.
const FLOORS: [f64; 5] = [1.0, 4.0, 10.0, 30.0, f64::INFINITY];

/// Probability from which an answer counts as sure.
const SURE: f64 = 0.9;

/// Probability below which an answer does not list an effect.
const LISTED: f64 = 0.01;

/// Returns the probability of a class: the sum over its effects without nuisances, at most 1.
fn probability(answer: &DiagnosisResult, class: &str, nuisances: &[String]) -> f64 {
    let own = answer.effects.iter().filter(|row| class_of(&row.id) == class && !nuisances.contains(&row.id));
    own.map(|row| row.probability).sum::<f64>().min(1.0)
}

/// Returns `true` if an answer about a class counts neither for nor against, because a nuisance or a law
/// outside the vocabulary belongs to it.
fn is_open(judgment: &Judgment<'_>, class: &str) -> bool {
    let hidden = &judgment.case.hidden;
    hidden.nuisances.iter().any(|id| class_of(id) == class)
        || hidden.unlisted.iter().any(|law| law.class.as_deref() == Some(class))
        || hidden.allowed.iter().any(|allowed| allowed == class)
}

fn acts(judgment: &Judgment<'_>, class: &str) -> bool {
    judgment.case.hidden.effects.iter().any(|effect| class_of(&effect.id) == class)
}

/// Returns the effects that an answer names; none if its status is not `effect`.
fn named<'a>(judgment: &'a Judgment<'_>) -> &'a [&'a str] {
    if judgment.said == Said::Effect { &judgment.named } else { &[] }
}

fn names_class(judgment: &Judgment<'_>, class: &str) -> bool {
    named(judgment).iter().any(|id| class_of(id) == class)
}

/// Returns the listed probabilities of classes, each with `true` if the class acts.
pub(crate) fn statements<'a>(judged: impl Iterator<Item = &'a Judgment<'a>>) -> Statements {
    judged
        .filter_map(|judgment| {
            let answer = judgment.answer()?;
            let of = |class: &str| {
                (probability(answer, class, &judgment.case.hidden.nuisances), acts(judgment, class))
            };
            let told =
                EffectClass::ALL.iter().map(|class| class.id()).filter(|class| !is_open(judgment, class));
            Some(told.map(of).filter(|(stated, _)| *stated > LISTED).collect())
        })
        .collect()
}

/// Returns the groups of cases that are scored by class, each with its name.
pub(crate) fn groups<'a, 'b>(judged: &'b [Judgment<'a>]) -> Vec<(&'static str, Vec<&'b Judgment<'a>>)> {
    let of = |wanted: fn(&Judgment<'_>) -> bool| judged.iter().filter(|judgment| wanted(judgment)).collect();
    let groups: [(&str, Vec<&Judgment<'_>>); 4] = [
        ("composite", of(|judgment| judgment.bank() == Bank::Composite)),
        ("rigs, composite", of(|judgment| judgment.bank() == Bank::Rigs && is_composite(judgment))),
        (
            "rigs, one or two effects",
            of(|judgment| {
                judgment.bank() == Bank::Rigs && judgment.asked() == Asked::Effects && !is_composite(judgment)
            }),
        ),
        (
            "rigs, no effect",
            of(|judgment| judgment.bank() == Bank::Rigs && judgment.asked() != Asked::Effects),
        ),
    ];
    groups.into_iter().filter(|(_, own)| !own.is_empty()).collect()
}

/// Returns `true` if effects act together with laws outside the vocabulary.
pub(crate) fn is_composite(judgment: &Judgment<'_>) -> bool {
    let hidden = &judgment.case.hidden;
    !hidden.effects.is_empty() && !hidden.unlisted.is_empty()
}

/// Returns the leading effect of each case that has one.
fn leading<'a>(judged: &[&'a Judgment<'a>]) -> impl Iterator<Item = (&'a Judgment<'a>, &'a HiddenEffect)> {
    judged.iter().filter_map(|judgment| Some((*judgment, judgment.case.hidden.effects.first()?)))
}

/// Returns the share of cases in which the leading effect's class is named.
pub(crate) fn leading_named<'a>(judged: &[&'a Judgment<'a>]) -> Proportion {
    proportion(leading(judged).map(|(judgment, effect)| names_class(judgment, class_of(&effect.id))))
}

/// Returns the share of cases in which the leading effect's class gets a probability of 0.9 or more.
pub(crate) fn leading_sure<'a>(judged: &[&'a Judgment<'a>]) -> Proportion {
    proportion(leading(judged).map(|(judgment, effect)| stated(judgment, class_of(&effect.id)) >= SURE))
}

fn stated(judgment: &Judgment<'_>, class: &str) -> f64 {
    judgment.answer().map_or(0.0, |answer| probability(answer, class, &judgment.case.hidden.nuisances))
}

/// Returns the share of hidden effects in a range of sizes whose class is named.
pub(crate) fn recall(judged: &[&Judgment<'_>], [low, high]: [f64; 2]) -> Proportion {
    let within = |effect: &&HiddenEffect| effect.floors.is_some_and(|floors| floors >= low && floors < high);
    proportion(judged.iter().flat_map(|judgment| {
        let own = judgment.case.hidden.effects.iter().filter(within);
        own.map(|effect| names_class(judgment, class_of(&effect.id)))
    }))
}

/// Returns the share of names whose class acts.
pub(crate) fn precision(judged: &[&Judgment<'_>]) -> Proportion {
    proportion(judged.iter().flat_map(|judgment| {
        let is_so = |id: &&str| acts(judgment, class_of(id)) || is_open(judgment, class_of(id));
        named(judgment).iter().map(is_so).collect::<Vec<_>>()
    }))
}

/// Returns the share of right answers (`unknown`, or a class that the truth allows) among cases of a law
/// outside the vocabulary.
pub(crate) fn unknown<'a>(judged: impl Iterator<Item = &'a Judgment<'a>>) -> Proportion {
    let foreign = judged.filter(|judgment| judgment.case.hidden.foreign.is_some());
    proportion(foreign.map(|judgment| judgment.right))
}

/// Returns the share of answers that name something or say `unknown`, among cases in which nothing is
/// missing.
pub(crate) fn false_alarms<'a>(judged: impl Iterator<Item = &'a Judgment<'a>>) -> Proportion {
    proportion(judged.filter(|judgment| judgment.asked() == Asked::Nothing).map(Judgment::alarms))
}

/// Returns the share of the gap attributed to classes that act, relative to the total attributed share;
/// `None` if nothing is attributed.
fn attributed(judgment: &Judgment<'_>) -> Option<f64> {
    let share = |id: &str| {
        let rows = &judgment.answer()?.effects;
        let found = rows.iter().find(|row| row.id == id)?.gap_share?;
        found.value.is_finite().then_some(found.value.max(0.0))
    };
    let shares: Vec<(&str, f64)> = named(judgment).iter().filter_map(|id| Some((*id, share(id)?))).collect();
    let all: f64 = shares.iter().map(|(_, share)| share).sum();
    let right =
        shares.iter().filter(|(id, _)| acts(judgment, class_of(id)) || is_open(judgment, class_of(id)));
    (all > 0.0).then(|| right.map(|(_, share)| share).sum::<f64>() / all)
}

/// Returns recall, precision and mean probabilities of an effect or a class over cases; `None` if it neither
/// acts nor is named.
fn inclusion(id: &str, judged: &[&Judgment<'_>], is_class: bool) -> Option<InclusionRow> {
    let key = |own: &str| if is_class { class_of(own) == id } else { own == id };
    let class = class_of(id);
    let acts = |judgment: &Judgment<'_>| judgment.case.hidden.effects.iter().any(|effect| key(&effect.id));
    let is_named = |judgment: &Judgment<'_>| named(judgment).iter().any(|own| key(own));
    let stated = |judgment: &Judgment<'_>| {
        if is_class { stated(judgment, id) } else { judgment.probability(id).unwrap_or(0.0) }
    };
    let counted: Vec<&Judgment<'_>> =
        judged.iter().copied().filter(|judgment| acts(judgment) || !is_open(judgment, class)).collect();
    let mean = |wanted: bool| {
        let own: Vec<f64> = counted
            .iter()
            .filter(|judgment| acts(judgment) == wanted)
            .map(|judgment| stated(judgment))
            .collect();
        own.iter().sum::<f64>() / own.len() as f64
    };
    let hidden =
        proportion(counted.iter().filter(|judgment| acts(judgment)).map(|judgment| is_named(judgment)));
    let right =
        proportion(counted.iter().filter(|judgment| is_named(judgment)).map(|judgment| acts(judgment)));
    (hidden.of + right.of > 0).then(|| InclusionRow {
        id: id.to_owned(),
        recall: hidden,
        precision: right,
        stated_where_it_acts: mean(true),
        stated_where_it_does_not: mean(false),
    })
}

/// Returns the scores of every group.
pub(crate) fn study(judged: &[Judgment<'_>]) -> Vec<ClassScores> {
    groups(judged).into_iter().map(|(banks, own)| scores(banks, &own)).collect()
}

fn scores(banks: &str, own: &[&Judgment<'_>]) -> ClassScores {
    let ranges = FLOORS.iter().zip(FLOORS.iter().skip(1)).map(|(low, high)| [*low, *high]);
    let same_classes = |judgment: &&Judgment<'_>| {
        let named = named(judgment);
        let every = judgment.case.hidden.effects.iter();
        every.clone().all(|effect| names_class(judgment, class_of(&effect.id)))
            && named.iter().all(|id| acts(judgment, class_of(id)) || is_open(judgment, class_of(id)))
    };
    let with_effects = || own.iter().filter(|judgment| judgment.asked() == Asked::Effects);
    let of_class = |class| REGISTRY.iter().filter(move |effect| effect.class == class);
    let ids = EffectClass::ALL.into_iter().flat_map(of_class).map(TrialEffect::id);
    ClassScores {
        banks: banks.to_owned(),
        cases: own.len() as u64,
        leading_named: leading_named(own),
        leading_sure: leading_sure(own),
        set: proportion(with_effects().map(same_classes)),
        recall: ranges.map(|floors| RecallRow { floors, named: recall(own, floors) }).collect(),
        precision: precision(own),
        attributed: quantiles(own.iter().filter_map(|judgment| attributed(judgment))),
        unknown: unknown(own.iter().copied()),
        false_alarms: false_alarms(own.iter().copied()),
        classes: EffectClass::ALL.iter().filter_map(|class| inclusion(class.id(), own, true)).collect(),
        effects: ids.filter_map(|id| inclusion(id, own, false)).collect(),
    }
}
