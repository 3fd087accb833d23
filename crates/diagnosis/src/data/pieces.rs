//! Pieces of a record on the way to segments: cut into equal lengths, and wherever the input is unknown.

use crate::data::observations::Observations;

/// Consecutive samples of a record.
pub(crate) struct Piece {
    /// Index of the record's equal length that holds them.
    pub(crate) at: usize,
    /// Index of the stretch between gaps of the input that holds them.
    pub(crate) stretch: usize,
    pub(crate) times: Vec<f64>,
    pub(crate) values: Vec<f64>,
}

/// Cuts samples into `count` equal lengths and at each gap of the input. An input interpolated across a gap
/// would push the body there.
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
