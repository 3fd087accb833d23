//! Readings of a sensor that lags, along a motion.

use crate::noise::statistics::duration;
use dynamics::chain::LowPass;
use dynamics::scalar::Dual;

/// Shortest time constant, in intervals of the samples, with which the filter is computed; a shorter one shows in
/// no sample.
const SHORTEST: f64 = 1e-6;

/// Longest interval, in radians of the swing, that the filter runs over; beyond it there are samples missing.
const LONGEST: f64 = 1.2;

/// Low-pass filter of a sensor over a segment, T·ẏ + y = x.
///
/// The motion before a segment, or in the place of missing samples, is not known. The first reading is that of a
/// steady swing of angular frequency ω about any center: y = x − (T·ẋ − T²·ẍ)/(1 + (ωT)²), which the filter
/// forgets within T.
pub(crate) struct Lag<'t> {
    runs: Vec<Run<'t>>,
    constant: f64,
    frequency: f64,
}

/// Filter over samples of which none is missing: the index of the first, the times, and the filter.
struct Run<'t> {
    from: usize,
    times: &'t [f64],
    filter: LowPass<f64>,
}

/// Value, rate and curvature of a series at an index.
type Series<'a> = &'a dyn Fn(usize) -> Option<[f64; 3]>;

impl<'t> Lag<'t> {
    /// Prepares the filter of a time constant for the times of a segment. `frequency` is the swing's angular
    /// frequency.
    pub(crate) fn new(constant: f64, times: &'t [f64], frequency: f64) -> Self {
        let interval = duration(times) / times.len().max(2) as f64;
        let constant = constant.max(SHORTEST * interval).max(f64::MIN_POSITIVE);
        let is_near = |from: &f64, to: &f64| (to - from) * frequency < LONGEST;
        let mut from = 0;
        let runs = times.chunk_by(is_near).map(|times| {
            let run = Run { from, times, filter: LowPass::new(constant, times) };
            from += times.len();
            run
        });
        Self { runs: runs.collect(), constant, frequency }
    }

    /// Returns the first reading, and its derivative by the time constant.
    fn first(&self, [value, rate, curvature]: [f64; 3]) -> [f64; 2] {
        let (constant, square) = (self.constant, self.frequency * self.frequency);
        let rest = 1.0 + constant * constant * square;
        let change = constant * rate - constant * constant * curvature;
        let by_constant = rate - 2.0 * constant * curvature - change * 2.0 * constant * square / rest;
        [value - change / rest, -by_constant / rest]
    }

    /// Returns the readings of a series, or a derivative of the readings from that of the series.
    pub(crate) fn of(&self, series: Series<'_>) -> Vec<f64> {
        let over = |run: &Run<'_>| {
            let [first, _] = self.first(series(run.from)?);
            let at = |index| series(run.from + index).map(|[value, rate, _]| [value, rate]);
            Some(run.filter.of(at, first))
        };
        self.runs.iter().filter_map(over).flatten().collect()
    }

    /// Returns the derivatives of the readings by the time constant.
    pub(crate) fn by_constant(&self, series: Series<'_>) -> Vec<f64> {
        let over = |run: &Run<'_>| {
            let [value, by_constant] = self.first(series(run.from)?);
            let first = Dual { value, partials: [by_constant] };
            let dual = |[value, rate, _]: [f64; 3]| [Dual::from(value), Dual::from(rate)];
            let filter = LowPass::new(Dual::variable(self.constant, 0), run.times);
            Some(filter.of(|index| series(run.from + index).map(dual), first))
        };
        let runs = self.runs.iter().filter_map(over).flatten();
        runs.map(|own| own.partials.into_iter().sum()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Lag;

    /// A swing about a center; its lagged reading is a swing of smaller amplitude and later phase.
    #[test]
    fn a_steady_swing_is_read_late_and_small_from_the_first_sample_on() {
        let (frequency, constant) = (7.0, 0.05);
        let times: Vec<f64> = (0..200).filter(|at| at % 70 < 50).map(|at| 0.01 * f64::from(at)).collect();
        let swing = |at: usize| {
            let (sine, cosine) = (frequency * times.get(at)?).sin_cos();
            Some([0.3 + cosine, -frequency * sine, -frequency * frequency * cosine])
        };
        let reading = |constant: f64, time: f64| {
            let lag: f64 = frequency * constant;
            let (sine, cosine) = (frequency * time).sin_cos();
            0.3 + (cosine + lag * sine) / (1.0 + lag * lag)
        };
        let lag = Lag::new(constant, &times, frequency);
        let h = 1e-6;
        for ((time, found), slope) in times.iter().zip(lag.of(&swing)).zip(lag.by_constant(&swing)) {
            assert!((found - reading(constant, *time)).abs() < 1e-6, "{time}");
            let by_difference = (reading(constant + h, *time) - reading(constant - h, *time)) / (2.0 * h);
            assert!((slope - by_difference).abs() < 1e-4, "{time}: {slope} {by_difference}");
        }
        let none = Lag::new(0.0, &times, frequency);
        for (at, (found, slope)) in none.of(&swing).into_iter().zip(none.by_constant(&swing)).enumerate() {
            let [value, rate, _] = swing(at).unwrap();
            assert!((found - value).abs() < 1e-7 && (slope + rate).abs() < 1e-5, "{at}");
        }
    }
}
