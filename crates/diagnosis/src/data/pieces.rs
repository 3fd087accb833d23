//! Samples of a record on their way to segments: cut by length, and where an input is not known.

use crate::data::observations::Observations;

/// Consecutive samples.
pub(crate) struct Piece {
    /// Which of the record's equal lengths they lie in.
    pub(crate) at: usize,
    /// Which of the stretches between gaps of the input they lie in.
    pub(crate) stretch: usize,
    pub(crate) times: Vec<f64>,
    pub(crate) values: Vec<f64>,
}

/// Cuts samples into so many equal lengths, and where the input has a gap: drawn through a gap, it would push the body there.
pub(crate) fn pieces(
    record: &Observations,
    (count, length): (usize, f64),
    samples: impl Iterator<Item = (f64, f64)>,
) -> Vec<Piece> {
    let driven = record.input.is_some();
    let gaps = record.after_gaps.iter().filter_map(|at| record.times_s.get(*at));
    let gaps: Vec<f64> = gaps.filter(|_| driven).copied().collect();
    let mut pieces: Vec<Piece> = Vec::new();
    for (time, value) in samples {
        let at = ((time / length) as usize).min(count - 1);
        let stretch = gaps.partition_point(|gap| *gap <= time);
        match pieces.last_mut().filter(|piece| (piece.at, piece.stretch) == (at, stretch)) {
            Some(piece) => {
                piece.times.push(time);
                piece.values.push(value);
            }
            None => pieces.push(Piece { at, stretch, times: vec![time], values: vec![value] }),
        }
    }
    pieces
}
