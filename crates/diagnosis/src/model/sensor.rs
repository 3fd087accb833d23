//! Map of the sensor from the motion to its readings.

/// Smooth effects of the measurement chain on a reading, in their physical order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Sensor {
    /// Time constant; it is no map of a single value: [`crate::model::lag`].
    pub(crate) lag: Option<f64>,
    pub(crate) nonlinearity: Option<(f64, f64)>,
    pub(crate) drift: Option<f64>,
    pub(crate) clock: Option<f64>,
    /// Half of its range, and the center of the range.
    pub(crate) saturation: Option<(f64, f64)>,
    /// Width by which readings lag behind in either direction: [`crate::model::encoder_hysteresis`]. It
    /// is not a map of a single value.
    pub(crate) reading: Option<f64>,
}

/// Observed value with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Observed {
    pub(crate) value: f64,
    /// Derivative by the observed quantity, as it is after the lag.
    pub(crate) slope: f64,
    /// Derivatives by the sensor's parameters, at the indices below.
    pub(crate) by_parameter: [f64; 7],
}

impl Observed {
    /// Indices in [`Self::by_parameter`]: a lag, a nonlinearity's amplitude and phase, a drift, a clock's
    /// change, half a range and its center.
    pub(crate) const BY_LAG: usize = 0;
    pub(crate) const BY_AMPLITUDE: usize = 1;
    pub(crate) const BY_PHASE: usize = 2;
    pub(crate) const BY_DRIFT: usize = 3;
    pub(crate) const BY_CLOCK: usize = 4;
    pub(crate) const BY_BOUND: usize = 5;
    pub(crate) const BY_CENTER: usize = 6;
}

impl Sensor {
    /// Returns the true time at which a sample stamped `stamp` was taken: stamp = t + ½·r′·t².
    pub(crate) fn true_time(&self, stamp: f64) -> f64 {
        // 2·s/(1 + √(1 + 2·r′·s)) is the root near s, without cancellation for small r′.
        self.clock.map_or(stamp, |change| 2.0 * stamp / (1.0 + (1.0 + 2.0 * change * stamp).max(0.0).sqrt()))
    }

    /// Computes the reading for an observed quantity `x` after the lag, with its derivative by the lag and its
    /// rate.
    pub(crate) fn observe(&self, [x, by_constant]: [f64; 2], rate: f64, time: f64, start: f64) -> Observed {
        let mut slope = 1.0;
        let mut by_parameter = [0.0; 7];
        let [by_lag, by_amplitude, by_phase, by_drift, by_clock, ..] = &mut by_parameter;
        let mut value = x;
        *by_lag = by_constant;
        // dt/dr′ at a given stamp, less that at the start, because the start state moves along.
        *by_clock = -0.5 * (time * time - start * start) * rate;
        if let Some((amplitude, phase)) = self.nonlinearity {
            let (sine, cosine) = libm::sincos(value + phase);
            value += amplitude * sine;
            slope = 1.0 + amplitude * cosine;
            *by_lag *= slope;
            *by_clock *= slope;
            *by_amplitude = sine;
            *by_phase = amplitude * cosine;
        }
        if let Some(drift) = self.drift {
            value += drift * time;
        }
        *by_drift = time;
        if let Some((bound, center)) = self.saturation
            && (value - center).abs() > bound
        {
            let side = (value - center).signum();
            value = center + bound * side;
            slope = 0.0;
            by_parameter = [0.0; 7];
            let [.., by_bound, by_center] = &mut by_parameter;
            (*by_bound, *by_center) = (side, 1.0);
        }
        Observed { value, slope, by_parameter }
    }
}

#[cfg(test)]
mod tests {
    use super::{Observed, Sensor};

    /// Derivatives of the sensor's map against central differences.
    #[test]
    fn a_sensors_derivatives_are_those_of_its_values() {
        let full = Sensor {
            lag: None,
            nonlinearity: Some((0.02, 0.4)),
            drift: Some(0.003),
            clock: Some(1e-3),
            saturation: Some((5.0, 0.1)),
            reading: None,
        };
        let (x, rate, time) = (0.3, -2.0, 7.0);
        let at = full.observe([x, 1.0], rate, time, 0.0);
        let h = 1e-6;
        let slope = |plus: f64, minus: f64| (plus - minus) / (2.0 * h);
        let by_x = slope(
            full.observe([x + h, 1.0], rate, time, 0.0).value,
            full.observe([x - h, 1.0], rate, time, 0.0).value,
        );
        assert!((by_x - at.slope).abs() < 1e-8);
        assert!((at.by_parameter[Observed::BY_LAG] - at.slope).abs() < 1e-12);
        let phase = |d: f64| {
            Sensor { nonlinearity: Some((0.02, 0.4 + d)), ..full }.observe([x, 1.0], rate, time, 0.0).value
        };
        assert!((slope(phase(h), phase(-h)) - at.by_parameter[2]).abs() < 1e-8);
        for side in [-1.0, 1.0] {
            let clipped = |bound: f64, center: f64| {
                Sensor { saturation: Some((bound, center)), ..full }.observe([side, 1.0], rate, time, 0.0)
            };
            let at = clipped(0.2, 0.05);
            let by_bound = slope(clipped(0.2 + h, 0.05).value, clipped(0.2 - h, 0.05).value);
            let by_center = slope(clipped(0.2, 0.05 + h).value, clipped(0.2, 0.05 - h).value);
            assert!((by_bound - at.by_parameter[Observed::BY_BOUND]).abs() < 1e-8);
            assert!((by_center - at.by_parameter[Observed::BY_CENTER]).abs() < 1e-8);
            assert_eq!(at.slope, 0.0);
        }
        let stamp = full.true_time(time);
        assert!((stamp + 0.5 * 1e-3 * stamp * stamp - time).abs() < 1e-12);
    }
}
