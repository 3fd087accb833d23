//! Scores of predictions at held-out peaks.

use std::f64::consts::PI;

/// Half-width of a Gaussian 95 % interval in standard deviations.
const GAUSSIAN_95: f64 = 1.959_963_984_540_054;

/// A peak that was held out from a fit, and the fit's prediction for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOutPeak {
    /// Measured ln A of the peak.
    pub observed: f64,
    /// Predicted ln A: −∞ if the predicted motion has come to rest, NaN if there is no prediction.
    pub predicted: f64,
    /// Standard deviation of a measured ln A about the prediction; `None` if the method states none.
    pub std_error: Option<f64>,
}

impl HeldOutPeak {
    /// Returns `true` if the stated 95 % interval, predicted ± 1.96 standard deviations, holds the peak.
    /// `None` if no standard deviation is stated; `Some(false)` if the prediction is not finite.
    #[must_use]
    pub fn is_within_95(&self) -> Option<bool> {
        if !self.predicted.is_finite() {
            return Some(false);
        }
        self.std_error.map(|error| (self.observed - self.predicted).abs() <= GAUSSIAN_95 * error)
    }

    /// Returns the natural logarithm of the stated Gaussian density at the peak. `None` if no standard
    /// deviation is stated; −∞ if the prediction is not finite.
    #[must_use]
    pub fn log_density(&self) -> Option<f64> {
        if !self.predicted.is_finite() {
            return Some(f64::NEG_INFINITY);
        }
        self.std_error.map(|error| {
            let standardized = (self.observed - self.predicted) / error;
            -0.5 * (2.0 * PI).ln() - error.ln() - 0.5 * standardized * standardized
        })
    }
}

/// Returns the root mean square error of ln A. Infinite if a prediction is not finite, so that no failed
/// prediction is ignored; NaN for no peaks.
#[must_use]
pub fn rms_log_error(peaks: &[HeldOutPeak]) -> f64 {
    let square = |peak: &HeldOutPeak| {
        let error = peak.observed - peak.predicted;
        if error.is_finite() { error * error } else { f64::INFINITY }
    };
    (peaks.iter().map(square).sum::<f64>() / peaks.len() as f64).sqrt()
}

/// Returns the root mean square of the amplitudes' relative errors Â/A − 1, in percent. A prediction at rest
/// has an error of 100 %; a NaN prediction has an infinite error.
#[must_use]
pub fn relative_amplitude_error_percent(peaks: &[HeldOutPeak]) -> f64 {
    let square = |peak: &HeldOutPeak| {
        let error = (peak.predicted - peak.observed).exp_m1();
        if error.is_nan() { f64::INFINITY } else { error * error }
    };
    100.0 * (peaks.iter().map(square).sum::<f64>() / peaks.len() as f64).sqrt()
}

/// Returns the mean logarithm of the predictive density over the peaks. `None` for no peaks, or if a peak
/// with a finite prediction has no stated standard deviation.
#[must_use]
pub fn mean_log_density(peaks: &[HeldOutPeak]) -> Option<f64> {
    let densities: Option<Vec<f64>> = peaks.iter().map(HeldOutPeak::log_density).collect();
    densities.filter(|all| !all.is_empty()).map(|all| all.iter().sum::<f64>() / all.len() as f64)
}

/// Returns the number of stated 95 % intervals that hold their peak, and the number of peaks. `None` for no
/// peaks, or if a peak with a finite prediction has no stated standard deviation.
#[must_use]
pub fn held_within_95(peaks: &[HeldOutPeak]) -> Option<(usize, usize)> {
    let held: Option<Vec<bool>> = peaks.iter().map(HeldOutPeak::is_within_95).collect();
    held.filter(|all| !all.is_empty()).map(|all| (all.iter().filter(|held| **held).count(), all.len()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::{
        HeldOutPeak, held_within_95, mean_log_density, relative_amplitude_error_percent, rms_log_error,
    };

    fn peak(observed: f64, predicted: f64, std_error: Option<f64>) -> HeldOutPeak {
        HeldOutPeak { observed, predicted, std_error }
    }

    #[test]
    fn errors_by_hand() {
        let peaks = [peak(-1.0, -0.7, None), peak(-2.0, -2.4, None)];
        assert!((rms_log_error(&peaks) - 0.125_f64.sqrt()).abs() < 1e-15);
        let relative = ((0.3_f64.exp() - 1.0).powi(2) + ((-0.4_f64).exp() - 1.0).powi(2)) / 2.0;
        assert!((relative_amplitude_error_percent(&peaks) - 100.0 * relative.sqrt()).abs() < 1e-12);
        assert!(rms_log_error(&[]).is_nan());
    }

    #[test]
    fn what_has_come_to_rest_misses_the_whole_amplitude() {
        let rest = [peak(-1.0, f64::NEG_INFINITY, None)];
        assert!(rms_log_error(&rest).is_infinite());
        assert!((relative_amplitude_error_percent(&rest) - 100.0).abs() < 1e-12);
        assert_eq!(held_within_95(&[rest[0], peak(0.0, 0.0, Some(1.0))]), Some((1, 2)));
        assert_eq!(mean_log_density(&rest), Some(f64::NEG_INFINITY));
        for nowhere in [f64::NAN, f64::INFINITY] {
            let none = [peak(-1.0, nowhere, None), peak(-1.0, -1.0, None)];
            assert!(rms_log_error(&none).is_infinite());
            assert!(relative_amplitude_error_percent(&none).is_infinite());
        }
    }

    /// Values away from a mean of 0 and a standard deviation of 1, where products differ from quotients and
    /// sums from differences.
    #[test]
    fn a_gaussian_is_measured_from_its_mean_in_standard_deviations() {
        let peaks = [peak(3.0, 4.0, Some(0.5)), peak(3.0, 3.0, Some(0.5))];
        let (two_off, none_off) = (0.053_990_966_513_188_06_f64 / 0.5, 0.398_942_280_401_432_7_f64 / 0.5);
        let expected = f64::midpoint(two_off.ln(), none_off.ln());
        assert!((mean_log_density(&peaks).unwrap() - expected).abs() < 1e-14);
        let within = |predicted: f64| peak(3.0, predicted, Some(0.5)).is_within_95();
        assert_eq!(
            [within(3.97), within(2.03), within(3.99), within(2.01)],
            [true, true, false, false].map(Some)
        );
    }

    #[test]
    fn densities_and_intervals_of_a_gaussian() {
        // One standard deviation off: ln of 0.24197072451914337/0.5.
        let peaks = [peak(-1.0, -0.5, Some(0.5))];
        let expected = (0.241_970_724_519_143_37_f64 / 0.5).ln();
        assert!((mean_log_density(&peaks).unwrap() - expected).abs() < 1e-14);
        let peaks = [peak(0.0, 1.95, Some(1.0)), peak(0.0, 1.97, Some(1.0))];
        assert_eq!(held_within_95(&peaks), Some((1, 2)));
        let peaks = [peak(0.0, 0.0, Some(1.0)), peak(0.0, 0.0, None)];
        assert_eq!((held_within_95(&peaks), mean_log_density(&peaks)), (None, None));
    }
}
