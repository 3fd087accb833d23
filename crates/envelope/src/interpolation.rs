//! Linear interpolation on an even grid.

/// Returns values at the times `0, step, 2·step, …` below the last of `times`, by linear interpolation.
///
/// Times must start at 0 and not decrease. Where a time repeats, the value jumps: a grid point at the
/// repeated time gets the last of its values, as in `numpy.interp`.
#[must_use]
pub fn resample(times: &[f64], values: &[f64], step: f64) -> Vec<f64> {
    let Some(&last) = times.last() else {
        return Vec::new();
    };
    // Number of points of numpy.arange(0, last, step).
    let count = (last / step).ceil().max(0.0) as usize;
    let mut segments = times
        .iter()
        .zip(values)
        .zip(times.iter().zip(values).skip(1))
        .map(|((&start, &from), (&end, &to))| (start, from, end, to))
        .peekable();
    (0..count)
        .filter_map(|index| {
            let time = index as f64 * step;
            while segments.next_if(|&(_, _, end, _)| end <= time).is_some() {}
            let &(start, from, end, to) = segments.peek()?;
            Some((to - from) / (end - start) * (time - start) + from)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::resample;

    #[test]
    fn a_repeated_time_takes_its_last_value() {
        let grid = resample(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 7.0], 0.5);
        assert_eq!(grid, [0.0, 0.5, 5.0, 6.0]);
    }
}
