//! Thinning of lines.

/// Returns at most about `most` points of a line: the first, the last, and of every stretch between them the
/// lowest and the highest, so that no peak is lost.
pub(crate) fn thin(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most.max(4) {
        return points.to_vec();
    }
    let stretch = (points.len() * 2).div_ceil(most.max(4));
    let mut kept = Vec::with_capacity(most + 4);
    kept.extend(points.first());
    for chunk in points.chunks(stretch) {
        let by_height = |a: &(usize, &(f64, f64)), b: &(usize, &(f64, f64))| a.1.1.total_cmp(&b.1.1);
        let low = chunk.iter().enumerate().min_by(by_height);
        let high = chunk.iter().enumerate().max_by(by_height);
        if let (Some((low_at, low)), Some((high_at, high))) = (low, high) {
            let (first, second) = if low_at <= high_at { (low, high) } else { (high, low) };
            kept.push(*first);
            kept.push(*second);
        }
    }
    kept.extend(points.last());
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::thin;

    #[test]
    fn a_short_line_is_left_alone() {
        let points = [(0.0, 1.0), (1.0, 2.0)];
        assert_eq!(thin(&points, 100), points);
    }

    #[test]
    fn peaks_and_ends_survive() {
        let mut points: Vec<_> = (0..10_000).map(|i| (f64::from(i), 0.5)).collect();
        points[4_321].1 = 9.0;
        points[7_654].1 = -9.0;
        let kept = thin(&points, 500);
        assert!(kept.len() <= 504, "{}", kept.len());
        assert_eq!(kept.first(), points.first());
        assert_eq!(kept.last(), points.last());
        assert!(kept.contains(&points[4_321]) && kept.contains(&points[7_654]));
        assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
