//! Neighboring segments joined into one, and what a fit needs to go from one to the other.

use crate::data::segments::{Data, Segment};
use nalgebra::DVector;

impl Data {
    /// Joins neighboring segments of each record, up to `by` segments into one.
    pub(crate) fn joined(&self, by: usize) -> Self {
        let mut segments: Vec<Segment> = Vec::new();
        let mut members = 0;
        for segment in &self.segments {
            match segments.last_mut() {
                Some(last)
                    if (last.record, last.stretch) == (segment.record, segment.stretch) && members < by =>
                {
                    last.parts.extend(segment.parts.iter().map(|part| part + last.times.len()));
                    last.times.extend(&segment.times);
                    last.values.extend(&segment.values);
                    last.still &= segment.still;
                    members += 1;
                }
                _ => {
                    segments.push(segment.clone());
                    members = 1;
                }
            }
        }
        Self { segments, ..self.clone() }
    }

    /// Returns, for each segment, the index of the unjoined segment that it begins with.
    pub(crate) fn firsts(&self) -> Vec<usize> {
        let counts = self.segments.iter().map(|segment| segment.parts.len());
        counts.scan(0, |at, count| Some(std::mem::replace(at, *at + count))).collect()
    }

    /// Keeps the parts that `keep` accepts by the index of their unjoined segment, plus the first sample of
    /// every kept segment, because its start state applies there. Segments without an accepted part are left
    /// out. Also returns the indices of the kept segments.
    pub(crate) fn masked(&self, keep: &dyn Fn(usize) -> bool) -> (Self, Vec<usize>) {
        let mut segments = Vec::new();
        let mut numbers = Vec::new();
        for (number, (segment, first)) in self.segments.iter().zip(self.firsts()).enumerate() {
            if (0..segment.parts.len()).any(|part| keep(first + part)) {
                segments.push(segment.keeping(|sample| keep(first + segment.part_of(sample))));
                numbers.push(number);
            }
        }
        (Self { segments, ..self.clone() }, numbers)
    }

    /// Keeps the samples that `keep` accepts by the indices of segment and sample, plus the first sample of
    /// every segment, because its start state applies there.
    pub(crate) fn keeping(&self, keep: impl Fn(usize, usize) -> bool) -> Self {
        let of = |(number, own): (usize, &Segment)| own.keeping(|sample| keep(number, sample));
        Self { segments: self.segments.iter().enumerate().map(of).collect(), ..self.clone() }
    }

    /// Splits residuals on this shooting interval into those of the unjoined segments.
    pub(crate) fn by_part(&self, residuals: &[DVector<f64>]) -> Vec<DVector<f64>> {
        let mut all = Vec::new();
        for (segment, residual) in self.segments.iter().zip(residuals) {
            all.extend(segment.part_ranges().map(|part| residual.rows(part.start, part.len()).clone_owned()));
        }
        all
    }

    /// Returns `true` if any segment was joined from several.
    pub(crate) fn is_joined(&self) -> bool {
        self.segments.iter().any(|segment| segment.parts.len() > 1)
    }
}

impl Segment {
    /// Keeps the samples that `keep` accepts, and always the first one.
    fn keeping(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.times.len()).filter(|&sample| sample == 0 || keep(sample)).collect();
        let pick = |values: &[f64]| kept.iter().filter_map(|&at| values.get(at).copied()).collect();
        Self { times: pick(&self.times), values: pick(&self.values), parts: vec![0], ..self.clone() }
    }

    fn part_of(&self, sample: usize) -> usize {
        self.parts.partition_point(|&from| from <= sample).saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use crate::Observations;
    use crate::data::segments::{Data, cut};
    use dynamics::Nominal;
    use nalgebra::DVector;
    use record::{Clock, ClockChoice, Quantity, Record};

    /// 20 s of a swing at 3.5 Hz, 100 samples a second.
    fn data() -> Data {
        let times: Vec<f64> = (0..2000).map(|at| f64::from(at) * 0.01).collect();
        let swing = |t: &f64| 0.6 * (-0.1 * t).exp() * (21.9 * t).cos();
        let values = times.iter().map(swing).collect();
        let record = Record::new(times, values, None, Quantity::Position, "rad").unwrap();
        let observed = Observations::new(&record, &Clock::new(&record, ClockChoice::Host).unwrap());
        let nominal = Nominal::new(1.0, 0.2, 480.0, 0.0).unwrap();
        cut(std::slice::from_ref(&observed), &[vec![true; 2000]], &(&nominal).into()).unwrap()
    }

    #[test]
    fn joined_segments_are_the_record_and_come_apart_again() {
        let data = data();
        let count = data.segments.len();
        assert!(count > 8, "{count}");
        let whole = data.joined(count);
        assert_eq!(whole.segments.len(), 1);
        assert_eq!(whole.samples(), data.samples());
        let segment = &whole.segments[0];
        assert_eq!(segment.parts.len(), count);
        let parts = whole.by_part(&[DVector::from_vec(segment.values.clone())]);
        for (part, original) in parts.iter().zip(&data.segments) {
            assert_eq!(part.as_slice(), original.values.as_slice());
        }
        let pairs = data.joined(2);
        assert_eq!(pairs.segments.len(), count.div_ceil(2));
        assert_eq!(pairs.firsts(), (0..count).step_by(2).collect::<Vec<_>>());
    }

    #[test]
    fn a_mask_leaves_the_parts_named_and_the_first_sample() {
        let data = data();
        let whole = data.joined(data.segments.len());
        let (odd, numbers) = whole.masked(&|part| part % 2 == 1);
        assert_eq!(numbers, [0]);
        let expected: usize = data.segments.iter().skip(1).step_by(2).map(|s| s.times.len()).sum();
        assert_eq!(odd.samples(), expected + 1);
        assert_eq!(odd.segments[0].times[0], data.segments[0].times[0]);
        assert_eq!(odd.segments[0].times[1], data.segments[1].times[0]);
        let (none, numbers) = data.masked(&|_| false);
        assert!(none.segments.is_empty() && numbers.is_empty());
    }
}
