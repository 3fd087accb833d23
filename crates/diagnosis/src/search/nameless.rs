//! Torques without a name in the place of effects that have one.
//!
//! What no law of the vocabulary explains is soaked up by several effects at once, and each of these then seems to be
//! needed. A law that is none of them but explains the same in one piece shows that they are not. Such laws are fitted
//! wherever the best set of all has several members or one that not every mechanism has, beside the best sets of plain laws and in the place of
//! each class of the best of them: a torque along the position, and a damping and a stiffness of higher order, alone and together. The
//! first is also fitted beside the best set of each size that is made of plain laws and of what the measuring chain does.

use crate::data::segments::Data;
use crate::evidence::weights::{EVEN, Weighed, Weighing};
use crate::explain::position_torque::beside;
use crate::fit::fitted::{Fit, Point};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::model::candidate::Candidate;
use crate::search::archive::Archive;
use rayon::prelude::*;

/// Sets of plain laws that they are fitted beside.
const SETS: usize = 2;

/// Takes the best sets of plain laws with a torque without a name into an archive.
pub(crate) fn nameless(data: &Data, calibrated: &Fit, archive: &mut Archive, vocabulary: usize) {
    let weighing = Weighing::of(data, calibrated, archive, vocabulary);
    let weighed = weighing.weigh(archive);
    // Of a single law that every mechanism has nothing is asked: there is nothing that a law in one piece could spare.
    let is_plain = |best: &Fit| best.hypothesis.is_plain() && best.hypothesis.counted().count() < 2;
    if weighed.first().is_none_or(|best| is_plain(best.fit)) {
        return;
    }
    let plain: Vec<&Fit> =
        weighed.iter().map(|own| own.fit).filter(|fit| fit.hypothesis.is_plain()).take(SETS).collect();
    let bases = bases(&weighed, &plain);
    let simple = of_each_size(&weighed, &bases);
    let along = bases.par_iter().chain(&simple).map(|set| {
        let time = set.autocorrelation_time();
        beside(data, set, time, EVEN).ok().flatten()
    });
    let along: Vec<Option<Fit>> = along.collect();
    let [damping, stiffness] = Candidate::UNLISTED;
    let laws = [vec![damping], vec![stiffness], vec![damping, stiffness]];
    let asked: Vec<(&Fit, &[Candidate])> =
        bases.iter().flat_map(|set| laws.iter().map(|laws| (*set, laws.as_slice()))).collect();
    let unlisted: Vec<Option<Fit>> = asked.par_iter().map(|(set, laws)| with(data, set, laws)).collect();
    for fit in along.into_iter().chain(unlisted).flatten() {
        archive.admit(data, fit);
    }
}

/// The best set of each size that is made of plain laws and of what the measuring chain does, but for those that are `known`: what a
/// larger one explains beside it may be a torque along the position.
fn of_each_size<'b>(weighed: &[Weighed<'b>], known: &[&'b Fit]) -> Vec<&'b Fit> {
    let is_simple = |own: &Candidate| own.is_plain() || own.system().is_none();
    let size = |fit: &Fit| fit.hypothesis.counted().count();
    let mut best: Vec<&Fit> = Vec::new();
    for fit in weighed.iter().map(|own| own.fit).filter(|fit| fit.hypothesis.counted().all(is_simple)) {
        if !best.iter().any(|other| size(other) == size(fit)) {
            best.push(fit);
        }
    }
    best.retain(|fit| !known.iter().any(|other| other.hypothesis == fit.hypothesis));
    best
}

/// Some sets, and for each class of the first of these the best plain set without it.
fn bases<'b>(weighed: &[Weighed<'b>], plain: &[&'b Fit]) -> Vec<&'b Fit> {
    let mut bases = plain.to_vec();
    let all = || weighed.iter().map(|own| own.fit).filter(|fit| fit.hypothesis.is_plain());
    for member in plain.first().iter().flat_map(|best| &best.hypothesis.candidates) {
        let class = member.evidence_class();
        let without = all().find(|fit| fit.hypothesis.lacks(class));
        bases.extend(without.filter(|own| !bases.iter().any(|known| known.hypothesis == own.hypothesis)));
    }
    bases
}

/// A set with laws of higher order beside it, begun where the set ended.
fn with(data: &Data, set: &Fit, laws: &[Candidate]) -> Option<Fit> {
    if laws.iter().any(|law| set.hypothesis.knows(*law)) {
        return None;
    }
    let hypothesis = set.hypothesis.with(&[set.hypothesis.candidates.as_slice(), laws].concat());
    // Their parameters come last: they are behind every candidate.
    let mut globals = set.point.globals.clone();
    globals.extend(laws.iter().flat_map(|law| law.parameters(&data.facts)).map(|_| 0.0));
    let point = Point { globals, starts: set.point.starts.clone() };
    fit(data, &hypothesis, point, Moving::All, Stopping::SEARCH).ok()
}
