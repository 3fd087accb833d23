//! Proposals: sets to fit with the points where their fits begin, derived from a fit by removing, adding or
//! replacing members.

#![allow(clippy::indexing_slicing, reason = "a law has at least one parameter")]

use crate::data::scales::Scales;
use crate::data::segments::Data;
use crate::fit::fitted::{Fit, Point, extended};
use crate::fit::levenberg_marquardt::{Moving, fit, squares};
use crate::fit::stopping::Stopping;
use crate::linear::dictionary::{Dictionary, Gain};
use crate::model::candidate::Candidate;
use crate::model::hypothesis::Hypothesis;
use crate::sets::archive::{Archive, gone};
use rayon::prelude::*;

/// Share of its linearized strength with which an effect begins a fit.
const FIRST_SIZE: f64 = 1e-3;

/// Squares at the start of a set, relative to those of its known fit, below which it is fitted again.
pub(crate) const CLOSER: f64 = 0.9;

/// Gain in log likelihood, in nats, above which a set begins closer for certain, even if most of the squares
/// are noise.
const SURELY: f64 = 10.0;

/// Set to fit, and the point where its fit begins.
#[derive(Debug, Clone)]
pub(crate) struct Proposal {
    pub(crate) hypothesis: Hypothesis,
    pub(crate) point: Point,
}

/// Merges a candidate into its generalization if a set has both: the general one takes over the special one's
/// size.
fn absorb(members: &mut Vec<(Candidate, Vec<f64>)>) {
    let special: Vec<(Candidate, Candidate)> =
        members.iter().filter_map(|(general, _)| Some((*general, general.generalizes()?))).collect();
    for (general, special) in special {
        let Some(place) = members.iter().position(|(candidate, _)| *candidate == special) else { continue };
        let (_, own) = members.remove(place);
        let target = members.iter_mut().find(|(candidate, _)| *candidate == general);
        if let (Some((_, values)), Some(size)) = (target, own.first())
            && let Some(first) = values.first_mut()
        {
            *first += size;
        }
    }
}

/// Creates a proposal from the result of a fit, without some candidates and with others added. If an added
/// candidate is a member already, its size is added to the member's.
pub(crate) fn proposal(
    data: &Data,
    base: &Fit,
    without: &[Candidate],
    added: &[(Candidate, Vec<f64>)],
) -> Proposal {
    let facts = &data.facts;
    let parts = base.hypothesis.parts(facts, &base.point.globals);
    let mut members: Vec<(Candidate, Vec<f64>)> = base
        .hypothesis
        .candidates
        .iter()
        .copied()
        .zip(parts.into_iter().map(<[f64]>::to_vec))
        .filter(|(candidate, _)| !without.contains(candidate))
        .collect();
    for (candidate, values) in added {
        match members.iter_mut().find(|(own, _)| own == candidate).map(|(_, own)| own.as_mut_slice()) {
            Some([first, ..]) => *first += values[0],
            _ => members.push((*candidate, values.clone())),
        }
    }
    absorb(&mut members);
    members.sort_by_key(|(candidate, _)| candidate.rank());
    let candidates: Vec<Candidate> = members.iter().map(|(candidate, _)| *candidate).collect();
    let hypothesis = base.hypothesis.with(&candidates);
    let calibrated = base.point.globals.iter().copied().take(base.hypothesis.calibrated.len());
    let globals = calibrated.chain(members.into_iter().flat_map(|(_, part)| part)).collect();
    let starts = base.point.starts.iter().map(|start| extended(start, &hypothesis)).collect();
    Proposal { hypothesis, point: Point { globals, starts } }
}

/// Returns the candidates of a gain, with parameters to begin a fit with.
pub(crate) fn additions(facts: &Scales, dictionary: &Dictionary, gain: &Gain) -> Vec<(Candidate, Vec<f64>)> {
    let mut coefficients = gain.coefficients.as_slice();
    gain.entries
        .iter()
        .filter_map(|&index| {
            let entry = dictionary.entries.get(index)?;
            let (own, rest) = coefficients.split_at_checked(entry.columns.len())?;
            coefficients = rest;
            let mut parameters = dictionary.parameters(index, own);
            // The coefficients assume that calibration and start states have moved along, which the fit has
            // still to do: sizes begin small and grow in its first steps, with everything else.
            for (value, parameter) in parameters.iter_mut().zip(entry.candidate.parameters(facts)) {
                let is_its_own_shape = parameter.strength && parameter.upper.is_finite();
                if !parameter.shape && !is_its_own_shape {
                    *value *= FIRST_SIZE;
                }
            }
            Some((entry.candidate, parameters))
        })
        .collect()
}

/// Proposes to replace each member by its generalization, at each of its shapes. The first parameters keep the
/// member's values, further strengths of the first one's unit begin at half of its size. The linearization cannot
/// distinguish these: at the special case the shape has no effect.
pub(crate) fn generalized(data: &Data, base: &Fit, candidates: &[Candidate]) -> Vec<Proposal> {
    let parts = base.hypothesis.parts(&data.facts, &base.point.globals);
    let mut proposals = Vec::new();
    for (&special, part) in base.hypothesis.candidates.iter().zip(parts) {
        let Some(size) = part.first() else { continue };
        for &general in candidates.iter().filter(|general| general.generalizes() == Some(special)) {
            for shape in general.shapes(&data.facts) {
                let parameters = general.parameters(&data.facts);
                let values = parameters.iter().zip(shape).enumerate();
                let values = values.map(|(place, (parameter, shape))| match part.get(place) {
                    Some(own) => *own,
                    _ if parameter.strength && general.quantity(place) == general.quantity(0) => 0.5 * size,
                    _ => shape,
                });
                proposals.push(proposal(data, base, &[special], &[(general, values.collect())]));
            }
        }
    }
    proposals
}

/// Proposes to refit a set from its end point, with the shape of one member replaced by each shape that it
/// may begin with.
pub(crate) fn reshaped(data: &Data, ended: &Fit) -> Vec<Proposal> {
    let parts = ended.hypothesis.parts(&data.facts, &ended.point.globals);
    let mut begun = Vec::new();
    let mut first = ended.hypothesis.calibrated.len();
    for (member, part) in ended.hypothesis.candidates.iter().zip(parts) {
        let parameters = member.parameters(&data.facts);
        let has_shape = parameters.iter().any(|parameter| parameter.shape);
        for shape in member.shapes(&data.facts).into_iter().filter(|_| has_shape) {
            let mut point = ended.point.clone();
            let places = point.globals.iter_mut().skip(first).zip(parameters.iter().zip(shape));
            for (place, (_, shape)) in places.filter(|(_, (parameter, _))| parameter.shape) {
                *place = shape;
            }
            begun.push(Proposal { hypothesis: ended.hypothesis.clone(), point });
        }
        first += part.len();
    }
    begun
}

/// Proposes to replace each member by the simpler effect that it tends to, with the member's first values. Friction
/// that begins at zero often ends at a point where it stops the motion half a swing too early or too late.
pub(crate) fn simplified(data: &Data, base: &Fit, candidates: &[Candidate]) -> Vec<Proposal> {
    let parts = base.hypothesis.parts(&data.facts, &base.point.globals);
    let members = base.hypothesis.candidates.iter().zip(parts);
    let simpler = members.filter_map(|(&member, part)| {
        let special = member.tends_to().filter(|special| candidates.contains(special))?;
        let own = part.get(..special.parameters(&data.facts).len())?;
        let added = (special, own.to_vec());
        Some(proposal(data, base, &[member], &[added]))
    });
    simpler.collect()
}

/// Proposes a set without those of its members that ended at strength zero, begun where the set ended; `None`
/// if there are none.
pub(crate) fn left_over(data: &Data, ended: &Fit) -> Option<Proposal> {
    let gone = gone(data, ended);
    (!gone.is_empty()).then(|| proposal(data, ended, &gone, &[]))
}

/// Returns `true` if a set begins closer to the data than its known fit ends: that fit ended in a local
/// minimum.
pub(crate) fn begins_closer(data: &Data, pool: &Archive, proposal: &Proposal) -> bool {
    pool.find(&proposal.hypothesis.candidates).is_some_and(|known| {
        let begin = squares(data, &proposal.hypothesis, &proposal.point);
        let time = known.autocorrelation_time();
        begin.is_ok_and(|begin| begin < CLOSER * known.squares || known.nats_behind(begin, time) > SURELY)
    })
}

/// Fits proposals in parallel. Each fit is sequential, and the fits come in the order of the proposals;
/// failed ones are left out.
pub(crate) fn fit_all(
    data: &Data,
    proposals: &[Proposal],
    effort: impl Fn(&Proposal) -> Stopping + Sync,
) -> Vec<Fit> {
    let fitted = |proposal: &Proposal| {
        fit(data, &proposal.hypothesis, proposal.point.clone(), Moving::All, effort(proposal)).ok()
    };
    let fits: Vec<Option<Fit>> = proposals.par_iter().map(fitted).collect();
    fits.into_iter().flatten().collect()
}

/// Fits proposals at whose points no fit of the archive has begun yet. A known set is of use only if it ends
/// closer.
pub(crate) fn fit_new(
    data: &Data,
    archive: &mut Archive,
    mut proposals: Vec<Proposal>,
    effort: impl Fn(&Proposal) -> Stopping + Sync,
) -> Vec<Fit> {
    proposals.retain(|own| archive.is_new(&own.hypothesis, &own.point, effort(own).steps));
    let known: &Archive = archive;
    fit_all(data, &proposals, |own| {
        let own_effort = effort(own);
        own_effort.below(own_effort.below.min(known.known_squares(&own.hypothesis)))
    })
}

/// Fits such proposals and admits the fits to the archive.
pub(crate) fn take_in(data: &Data, archive: &mut Archive, proposals: Vec<Proposal>, effort: Stopping) {
    for fit in fit_new(data, archive, proposals, |_| effort) {
        archive.admit(data, fit);
    }
}

#[cfg(test)]
mod tests {
    use super::{Proposal, begins_closer, generalized, left_over, proposal, simplified};
    use crate::data::segments::Data;
    use crate::fit::fitted::{Fit, Point};
    use crate::fit::levenberg_marquardt::{Moving, fit, squares};
    use crate::fit::stopping::Stopping;
    use crate::model::candidate::Candidate;
    use crate::model::candidates::bouc_wen::BoucWen;
    use crate::model::candidates::coulomb_friction::CoulombFriction;
    use crate::model::candidates::hysteresis::Hysteresis;
    use crate::model::candidates::quadratic_drag::QuadraticDrag;
    use crate::sets::archive::Archive;
    use crate::sets::score::calibrated_swing;
    const COULOMB: Candidate = Candidate::new(&CoulombFriction);
    const DRAG: Candidate = Candidate::new(&QuadraticDrag);
    const HYSTERESIS: Candidate = Candidate::new(&Hysteresis);
    const BOUC_WEN: Candidate = Candidate::new(&BoucWen);

    /// A decaying swing, and the simulator calibrated to it with members at given parameters.
    fn swing(members: &[(Candidate, &[f64])]) -> (Data, Fit) {
        let (data, calibrated) = calibrated_swing();
        let added: Vec<(Candidate, Vec<f64>)> =
            members.iter().map(|(candidate, values)| (*candidate, values.to_vec())).collect();
        let set = proposal(&data, &calibrated, &[], &added);
        let stay = Stopping { steps: 0, ..Stopping::FINAL };
        let found = fit(&data, &set.hypothesis, set.point, Moving::All, stay).unwrap();
        (data, found)
    }

    /// Returns the members' parameters at a point, without the calibrated coefficients.
    fn members(begin: &Fit, set: &Point) -> Vec<f64> {
        set.globals.iter().copied().skip(begin.hypothesis.calibrated.len()).collect()
    }

    #[test]
    fn hysteresis_hands_its_torque_to_the_friction_that_it_tends_to() {
        let (data, alone) = swing(&[(DRAG, &[0.01]), (HYSTERESIS, &[0.7, 0.02])]);
        let [set] = simplified(&data, &alone, Candidate::ALL).try_into().unwrap();
        assert_eq!(set.hypothesis.candidates, [COULOMB, DRAG]);
        assert_eq!(members(&alone, &set.point), [0.7, 0.01]);
        assert!(
            simplified(&data, &alone, &[DRAG, HYSTERESIS]).is_empty(),
            "that is left out of the question"
        );
        let (data, bent) = swing(&[(BOUC_WEN, &[0.7, 0.02, 0.3, 1.5])]);
        let [set] = simplified(&data, &bent, Candidate::ALL).try_into().unwrap();
        assert_eq!(set.hypothesis.candidates, [HYSTERESIS]);
        assert_eq!(members(&bent, &set.point), [0.7, 0.02]);
        let back = generalized(&data, &alone, &[BOUC_WEN]);
        assert!(back.iter().all(|set| set.hypothesis.candidates == [DRAG, BOUC_WEN]));
        assert!(back.iter().all(|set| members(&alone, &set.point)[..3] == [0.01, 0.7, 0.02]));
        let (data, beside) = swing(&[(COULOMB, &[0.5]), (HYSTERESIS, &[0.7, 0.02])]);
        let [set] = simplified(&data, &beside, Candidate::ALL).try_into().unwrap();
        assert_eq!(set.hypothesis.candidates, [COULOMB]);
        assert_eq!(members(&beside, &set.point), [1.2]);
    }

    #[test]
    fn no_fit_begins_twice_at_one_point() {
        let (data, alone) = swing(&[(DRAG, &[0.01])]);
        let mut archive = Archive::default();
        let mut is_new = |own: &Proposal, steps| archive.is_new(&own.hypothesis, &own.point, steps);
        let begun = proposal(&data, &alone, &[], &[]);
        assert!(is_new(&begun, 40) && !is_new(&begun, 40));
        assert!(is_new(&begun, 60), "one of more steps ends elsewhere");
        assert!(is_new(&proposal(&data, &alone, &[], &[(DRAG, vec![1e-9])]), 40), "it begins elsewhere");
    }

    #[test]
    fn what_is_left_of_a_set_begins_where_it_ended() {
        let (data, full) = swing(&[(COULOMB, &[0.5]), (DRAG, &[0.01])]);
        assert!(left_over(&data, &full).is_none());
        let (data, ended) = swing(&[(COULOMB, &[0.5]), (DRAG, &[0.0])]);
        let left = left_over(&data, &ended).unwrap();
        assert_eq!(left.hypothesis.candidates, [COULOMB]);
        let begin = squares(&data, &left.hypothesis, &left.point).unwrap();
        assert!((begin / ended.squares - 1.0).abs() < 1e-9, "{begin} {}", ended.squares);
        let known = |squares: f64| {
            let known = Fit { hypothesis: left.hypothesis.clone(), squares, ..ended.clone() };
            Archive::from(vec![known], Vec::new())
        };
        assert!(begins_closer(&data, &known(1.2 * begin), &left));
        assert!(!begins_closer(&data, &known(begin), &left));
        assert!(!begins_closer(&data, &Archive::default(), &left), "nothing is known of it");
    }
}
