//! Peaks with a least distance and a least prominence, as defined by `scipy.signal.find_peaks`.

/// Returns the indices of the local maxima: samples above both neighbors. For a flat top it is the middle
/// sample (the left one of two). The first and the last sample never count.
#[must_use]
pub fn local_maxima(values: &[f64]) -> Vec<usize> {
    let mut maxima = Vec::new();
    // Start of the flat stretch that rose from below, if there is one.
    let mut rise: Option<usize> = None;
    for (index, (one, next)) in values.iter().zip(values.iter().skip(1)).enumerate() {
        if next > one {
            rise = Some(index + 1);
        } else if next < one {
            maxima.extend(rise.take().map(|start| usize::midpoint(start, index)));
        }
    }
    maxima
}

/// Returns the prominence of each given peak: its height above the higher of the two lowest points that lie
/// between it and the next strictly higher sample to the left and to the right (or the record's end).
///
/// The run time is linear in the number of samples; the textbook's walk is quadratic on a decaying record.
#[must_use]
pub fn prominences(values: &[f64], peaks: &[usize]) -> Vec<f64> {
    let left = lowest_since_higher(values.iter().copied());
    let mut right = lowest_since_higher(values.iter().rev().copied());
    right.reverse();
    peaks
        .iter()
        .filter_map(|&peak| Some(values.get(peak)? - left.get(peak)?.max(*right.get(peak)?)))
        .collect()
}

/// Returns for each sample the lowest value since the last strictly higher one.
fn lowest_since_higher(values: impl Iterator<Item = f64>) -> Vec<f64> {
    // Samples that are still in view, each with the lowest value behind it; their heights strictly decrease.
    let mut view: Vec<(f64, f64)> = Vec::new();
    values
        .map(|value| {
            let mut lowest = value;
            while let Some((_, behind)) = view.pop_if(|(height, _)| *height <= value) {
                lowest = lowest.min(behind);
            }
            view.push((value, lowest));
            lowest
        })
        .collect()
}

/// Returns the indices of the peaks: local maxima, thinned to be at least `distance` samples apart with the
/// higher one kept; then those whose prominence is at least `prominence`.
///
/// The order of the two conditions matters and is scipy's: a peak that is thinned out does not come back if
/// the peak that displaced it is not prominent enough.
#[must_use]
pub fn find_peaks(values: &[f64], distance: usize, prominence: f64) -> Vec<usize> {
    let peaks = keep_distant(values, local_maxima(values), distance);
    let prominences = prominences(values, &peaks);
    peaks
        .into_iter()
        .zip(prominences)
        .filter(|(_, found)| *found >= prominence)
        .map(|(peak, _)| peak)
        .collect()
}

fn keep_distant(values: &[f64], peaks: Vec<usize>, distance: usize) -> Vec<usize> {
    let height = |peak: usize| values.get(peak).copied().unwrap_or(f64::NEG_INFINITY);
    let mut order: Vec<usize> = (0..peaks.len()).collect();
    // Highest first; of equal heights the later one first.
    order.sort_by(|&a, &b| {
        let (a_peak, b_peak) = (peaks.get(a).copied(), peaks.get(b).copied());
        let heights = a_peak.map(height).partial_cmp(&b_peak.map(height));
        heights.unwrap_or(std::cmp::Ordering::Equal).then(a.cmp(&b)).reverse()
    });
    let mut kept = vec![true; peaks.len()];
    for position in order {
        let (Some(&peak), Some(true)) = (peaks.get(position), kept.get(position).copied()) else {
            continue;
        };
        let near = |other: &usize| peak.abs_diff(*other) < distance;
        let (before, after) = peaks.split_at(position);
        let lower = before.iter().rev().take_while(|other| near(other)).count();
        let upper = after.iter().skip(1).take_while(|other| near(other)).count();
        for (index, keep) in kept.iter_mut().enumerate().skip(position - lower).take(lower + 1 + upper) {
            *keep = index == position;
        }
    }
    peaks.into_iter().zip(kept).filter(|(_, keep)| *keep).map(|(peak, _)| peak).collect()
}

#[cfg(test)]
mod tests {
    use super::{find_peaks, local_maxima, prominences};

    #[test]
    fn flat_tops_count_once_and_ends_do_not_count() {
        assert_eq!(local_maxima(&[3.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 4.0, 4.0, 0.0, 5.0]), [3, 7]);
        assert_eq!(local_maxima(&[1.0, 1.0, 1.0]), [] as [usize; 0]);
        assert_eq!(local_maxima(&[0.0, 1.0, 1.0]), [] as [usize; 0]);
    }

    /// Prominence by its definition, with a literal walk.
    fn prominence_by_walking(values: &[f64], peak: usize) -> f64 {
        let top = values[peak];
        let lowest =
            |walk: &mut dyn Iterator<Item = f64>| walk.take_while(|&value| value <= top).fold(top, f64::min);
        let left = lowest(&mut values[..peak].iter().rev().copied());
        let right = lowest(&mut values[peak..].iter().copied());
        top - left.max(right)
    }

    #[test]
    fn the_linear_prominences_are_those_of_the_walk() {
        let values: Vec<f64> = (0..3000)
            .map(|i| ((i as f64 * 0.7).sin() + (i as f64 * 0.031).sin() * 2.0) * 40.0)
            .map(|value| value.round() / 40.0)
            .collect();
        let peaks = local_maxima(&values);
        assert!(peaks.len() > 300);
        for (&peak, found) in peaks.iter().zip(prominences(&values, &peaks)) {
            assert_eq!(found, prominence_by_walking(&values, peak), "peak {peak}");
        }
    }

    #[test]
    fn the_higher_of_two_near_peaks_stays() {
        let values = [0.0, 2.0, 1.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert_eq!(find_peaks(&values, 3, 0.5), [3, 7]);
        assert_eq!(find_peaks(&values, 1, 0.5), [1, 3, 7]);
        assert_eq!(find_peaks(&values, 1, 2.0), [3]);
    }
}
