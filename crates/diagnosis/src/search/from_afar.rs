//! Fits of sets that the weak form proposes.
//!
//! The values of a proposed set are far enough from those of its fit that over six periods its motion would
//! lose count of the swings. So a fit begins on pieces of one or two periods, whose start states are those of
//! the smoothed motion, and goes on to pieces four times as long until they are the shooting interval.

use crate::data::segments::{Data, Segment};
use crate::fit::fitted::{Fit, Point, extended};
use crate::fit::levenberg_marquardt::{Moving, fit};
use crate::fit::stopping::Stopping;
use crate::search::asked::Asked;
use crate::search::weak_form::Begun;
use crate::sets::archive::{Archive, gone};
use crate::sets::proposals::proposal;
use crate::sets::score::score;
use rayon::prelude::*;

/// Number of sets that go on from the shortest pieces.
const MOST: usize = 5;

/// Fits the sets that the weak form prefers, and admits the fits to the archive.
pub(crate) fn from_afar(asked: &Asked<'_>, archive: &mut Archive) {
    let &Asked { data, proposed, .. } = asked;
    let (short, begins) = data.split(0);
    let begun = |set: &Begun| {
        let state = |segment: &Segment| proposed.state(segment.record, *segment.times.first()?);
        let starts =
            short.segments.iter().map(|own| extended(&state(own).unwrap_or(own.guess), &set.hypothesis));
        let point = Point { globals: set.globals.clone(), starts: starts.collect() };
        fit(&short, &set.hypothesis, point, Moving::All, Stopping::SEARCH).ok()
    };
    let first: Vec<Option<Fit>> = proposed.sets.par_iter().map(begun).collect();
    let mut first: Vec<Fit> = first.into_iter().flatten().collect();
    let time =
        first.iter().min_by(|a, b| a.squares.total_cmp(&b.squares)).map_or(1.0, Fit::autocorrelation_time);
    first.sort_by(|a, b| score(b, time).total_cmp(&score(a, time)));
    first.truncate(MOST);
    let longer: Vec<Option<Fit>> =
        first.into_par_iter().map(|set| lengthened(data, begins.clone(), set)).collect();
    for set in longer.into_iter().flatten() {
        archive.admit(data, set);
    }
}

/// Continues a fit on pieces that begin at the given samples of each segment to longer and longer ones, up to
/// the segments themselves. A member that loses its strength on the way is left out.
fn lengthened(data: &Data, mut begins: Vec<Vec<usize>>, mut set: Fit) -> Option<Fit> {
    for times in 1..=data.splits() {
        let (longer, next) = data.split(times);
        let places = begins.iter().zip(&next).flat_map(|(old, new)| old.iter().map(|at| new.contains(at)));
        let starts = set.point.starts.iter().zip(places).filter(|(_, stays)| *stays);
        let point = Point {
            globals: set.point.globals.clone(),
            starts: starts.map(|(start, _)| start.clone()).collect(),
        };
        let ended = fit(&longer, &set.hypothesis, point, Moving::All, Stopping::SEARCH).ok()?;
        let lost = gone(&longer, &ended);
        set = if lost.is_empty() {
            ended
        } else {
            let left = proposal(&longer, &ended, &lost, &[]);
            fit(&longer, &left.hypothesis, left.point, Moving::All, Stopping::SEARCH).ok()?
        };
        begins = next;
    }
    Some(set)
}
