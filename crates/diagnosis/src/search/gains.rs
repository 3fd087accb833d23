//! First-order gains of candidates, and tests of which of them are worth a fit.

use crate::data::segments::Data;
use crate::fit::fitted::Fit;
use crate::linear::dictionary::{Dictionary, Entry, Gain};
use crate::model::candidate::Candidate;
use crate::residual::spectrum::DECAYS;
use crate::sets::proposals::{Proposal, additions, proposal};

/// Returns the largest gain of each group of sets of entries, largest first.
pub(crate) fn best_of_each<K: PartialEq>(
    dictionary: &Dictionary,
    sets: impl Iterator<Item = (K, Vec<usize>)>,
) -> Vec<Gain> {
    let mut best: Vec<(K, Gain)> = Vec::new();
    for (group, entries) in sets {
        let Some(gain) = dictionary.gain(&entries) else { continue };
        match best.iter_mut().find(|(known, _)| *known == group) {
            Some((_, known)) if gain.squares > known.squares => *known = gain,
            Some(_) => {}
            None => best.push((group, gain)),
        }
    }
    let mut gains: Vec<Gain> = best.into_iter().map(|(_, gain)| gain).collect();
    gains.sort_by(|a, b| b.squares.total_cmp(&a.squares));
    gains
}

/// Returns the gains of single candidates, with the best shape of each.
pub(crate) fn singles(dictionary: &Dictionary) -> Vec<Gain> {
    let entries = dictionary.entries.iter().enumerate();
    best_of_each(dictionary, entries.map(|(index, entry)| (entry.candidate, vec![index])))
}

/// Returns the joint gains of two candidates, with the best shapes of each pair.
pub(crate) fn pairs(dictionary: &Dictionary) -> Vec<Gain> {
    let entries = || dictionary.entries.iter().enumerate();
    let beside = |(first, one): (usize, &Entry)| {
        let one = one.candidate;
        let others = entries().skip(first + 1).filter(move |(_, other)| other.candidate != one);
        others.map(move |(second, other)| ((one, other.candidate), vec![first, second]))
    };
    best_of_each(dictionary, entries().flat_map(beside))
}

/// Autocorrelation time, in samples, up to which a residual counts as white: it then hides nothing more.
pub(crate) const WHITE: f64 = 1.5;

/// Share of the threshold that the linearized gain has to reach at a white residual.
const PROMISE: f64 = 0.5;

/// Proposes every candidate alone, at its best shape.
pub(crate) fn alone(data: &Data, calibrated: &Fit, dictionary: &Dictionary) -> Vec<Proposal> {
    let linear = singles(dictionary);
    let linear = linear.iter().map(|gain| additions(&data.facts, dictionary, gain));
    let further = dictionary.further.iter().map(|(candidate, start, _)| vec![(*candidate, start.clone())]);
    linear.chain(further).map(|added| proposal(data, calibrated, &[], &added)).collect()
}

/// Returns `true` if a linearized gain is worth a fit. If the residual still has structure, any gain is: a
/// second cause may show only once the first is in the set. The best of many frequencies has a gain even in
/// white noise: for a sine and a cosine, the logarithm of the number of frequencies `looked` at.
pub(crate) fn promising(base: &Fit, time: f64, gain: f64, threshold: f64, looked: f64) -> bool {
    time > WHITE || stands_out(base, time, gain, threshold, looked)
}

/// Returns `true` if a linearized gain would count by itself, however much structure is left beside it.
pub(crate) fn stands_out(base: &Fit, time: f64, gain: f64, threshold: f64, looked: f64) -> bool {
    base.nats_behind(base.squares - gain, time) > PROMISE * threshold + libm::log(looked)
}

/// Returns `true` if the gain of a candidate without columns stands out. Such a candidate adds start states
/// to every segment, and a line in the spectrum of many short segments has to outweigh their price.
pub(crate) fn stands_alone(
    base: &Fit,
    time: f64,
    (candidate, gain): (Candidate, f64),
    threshold: f64,
    looked: f64,
) -> bool {
    let starts = (candidate.free_hidden().len() * base.point.starts.len()) as f64;
    let price = starts * libm::log((base.samples() as f64 / time).max(2.0));
    stands_out(base, time, gain, threshold.max(price), looked * DECAYS.len() as f64)
}
