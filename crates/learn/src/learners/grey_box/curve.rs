//! Increasing curve through points, as what a sensor shows against what it measures.

/// Returns the increasing curve through the points (x, y) at a place: cubic from point to point, with slopes that keep it
/// from turning back, and straight beyond the ends. Both lists increase and are equally long; NaN with fewer than two
/// points.
///
/// Fritsch, Butland, SIAM Journal on Scientific and Statistical Computing 5 (1984) 300 (slopes by harmonic means).
pub(super) fn increasing(x: &[f64], y: &[f64], place: f64) -> f64 {
    let spans = || x.iter().zip(x.iter().skip(1)).zip(y.iter().zip(y.iter().skip(1)));
    let pieces: Vec<Piece> = spans()
        .map(|((from, to), (low, high))| Piece {
            from: *from,
            low: *low,
            length: to - from,
            rise: high - low,
        })
        .collect();
    let at = x.partition_point(|own| *own <= place).saturating_sub(1).min(pieces.len().saturating_sub(1));
    let Some(piece) = pieces.get(at) else { return f64::NAN };
    let before = at.checked_sub(1).and_then(|at| pieces.get(at));
    let after = pieces.get(at + 1);
    let first = slope(before, Some(piece));
    let last = slope(Some(piece), after);
    let run = place - piece.from;
    if run < 0.0 {
        return piece.low + first * run;
    }
    if run > piece.length {
        return piece.low + piece.rise + last * (run - piece.length);
    }
    let part = run / piece.length;
    let (square, cube) = (part * part, part * part * part);
    let slopes = first * (cube - 2.0 * square + part) + last * (cube - square);
    piece.low + piece.rise * (3.0 * square - 2.0 * cube) + piece.length * slopes
}

/// Stretch of the curve between two points.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from: f64,
    low: f64,
    length: f64,
    rise: f64,
}

/// Returns the slope at the point between two pieces: that of the only one at an end, a weighted harmonic mean elsewhere.
fn slope(before: Option<&Piece>, after: Option<&Piece>) -> f64 {
    match (before, after) {
        (Some(before), Some(after)) => {
            let share = (before.length + 2.0 * after.length) / (3.0 * (before.length + after.length));
            let (low, high) = (before.rise / before.length, after.rise / after.length);
            low * high / (share * high + (1.0 - share) * low)
        }
        (Some(only), None) | (None, Some(only)) => only.rise / only.length,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::increasing;

    const X: [f64; 4] = [0.0, 1.0, 1.2, 3.0];
    const Y: [f64; 4] = [2.0, 2.1, 4.0, 5.0];

    #[test]
    fn passes_through_its_points_and_never_turns_back() {
        for (x, y) in X.iter().zip(Y) {
            assert!((increasing(&X, &Y, *x) - y).abs() < 1e-12);
        }
        let values: Vec<f64> = (-100..400).map(|at| increasing(&X, &Y, f64::from(at) / 100.0)).collect();
        assert!(values.iter().zip(values.iter().skip(1)).all(|(low, high)| high > low));
    }

    #[test]
    fn a_line_stays_a_line_beyond_its_points_as_well() {
        for place in [-2.0, 0.3, 1.1, 2.0, 7.0] {
            assert!((increasing(&X, &X.map(|x| 3.0 * x - 1.0), place) - (3.0 * place - 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_single_point_is_no_curve() {
        assert!(increasing(&[1.0], &[1.0], 1.0).is_nan());
    }
}
