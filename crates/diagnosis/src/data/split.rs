//! Short shooting intervals: pieces of segments, on which even a fit that begins far off finds its way.

#![allow(clippy::indexing_slicing, reason = "pieces are ranges of their segment")]

use crate::data::segments::{Data, Segment};
use std::f64::consts::TAU;

/// Number of periods of the shortest pieces, and the fewest samples in one.
const PERIODS: f64 = 1.5;
const FEWEST: usize = 16;

/// Factor from one length of the pieces to the next.
const RATIO: usize = 4;

impl Data {
    /// Returns how many times the shortest pieces of the longest segment are joined by [`RATIO`] until they are
    /// the segment.
    pub(crate) fn splits(&self) -> u32 {
        let most = self.segments.iter().map(|segment| self.pieces(segment)).max().unwrap_or(1);
        most.ilog(RATIO)
    }

    /// Splits every segment into pieces, each with its own start state: into the shortest ones, joined `times`
    /// times by four. Also returns the sample of its segment at which each piece begins, by segment.
    pub(crate) fn split(&self, times: u32) -> (Self, Vec<Vec<usize>>) {
        let mut segments = Vec::new();
        let mut begins = Vec::with_capacity(self.segments.len());
        for segment in &self.segments {
            let count = (self.pieces(segment) / RATIO.pow(times)).max(1);
            let begin: Vec<usize> = (0..count).map(|piece| piece * segment.times.len() / count).collect();
            let ends = begin.iter().skip(1).copied().chain([segment.times.len()]);
            for (from, to) in begin.iter().copied().zip(ends) {
                let (times, values) = (segment.times[from..to].to_vec(), segment.values[from..to].to_vec());
                let first = segment.first && from == 0;
                segments.push(Segment { first, times, values, parts: vec![0], ..segment.clone() });
            }
            begins.push(begin);
        }
        (Self { segments, ..self.clone() }, begins)
    }

    /// Returns the number of the shortest pieces of a segment: a power of [`RATIO`], so that longer pieces begin
    /// where shorter ones do.
    fn pieces(&self, segment: &Segment) -> usize {
        let periods = segment.span() * self.facts.frequency / TAU;
        let most = ((periods / PERIODS) as usize).min(segment.times.len() / FEWEST).max(1);
        RATIO.pow(most.ilog(RATIO))
    }
}

#[cfg(test)]
mod tests {
    use crate::sets::score::calibrated_swing;

    /// Longer pieces begin where shorter ones do, and the longest ones are the segments.
    #[test]
    fn pieces_hold_every_sample_and_are_nested() {
        let (data, _) = calibrated_swing();
        let data = data.joined(usize::MAX);
        let splits = data.splits();
        assert!(splits > 0);
        let (short, mut begins) = data.split(0);
        assert!(short.segments.len() > data.segments.len());
        assert_eq!(short.samples(), data.samples());
        assert_eq!(short.segments.iter().filter(|own| own.first).count(), 1);
        for times in 1..=splits {
            let (longer, next) = data.split(times);
            assert_eq!(longer.samples(), data.samples());
            assert!(next.iter().zip(&begins).all(|(new, old)| new.iter().all(|at| old.contains(at))));
            begins = next;
        }
        assert_eq!(begins, vec![vec![0]; data.segments.len()]);
    }
}
