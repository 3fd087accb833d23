//! Modes of a record that swings at several frequencies, and the sharpness of a resonance.

use super::interval::WithInterval;
use serde::{Deserialize, Serialize};

/// A mode of a free decay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ModeRow {
    /// Undamped natural frequency, in Hz.
    pub frequency_hz: WithInterval,
    /// Damping ratio.
    pub damping_ratio: WithInterval,
    /// Quality factor and half-power width; `None` if the mode has no resonance, and in results of versions that
    /// did not write them.
    #[serde(flatten)]
    pub resonance: Option<Resonance>,
    /// Share of the modes' power over the record, between 0 and 1.
    pub share: f64,
    /// `true` for a line that keeps its amplitude while others decay, as the hum of the mains does: no mode.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub steady: bool,
}

/// Sharpness of the resonance of a linear oscillator with viscous damping.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Resonance {
    /// Quality factor Q = 1/(2ζ): 2π times the stored energy over the energy lost in a cycle at resonance. Its
    /// upper end is not finite if ζ may be zero.
    pub quality_factor: WithInterval,
    /// Half-power width 2ζf in Hz, with the undamped natural frequency f: the width at 1/√2 of the peak. Exact for
    /// the response in velocity; for that in displacement within 1 % up to ζ = 0.1 and 5 % up to ζ = 0.2, and
    /// it has no lower half-power point above ζ = 0.38.
    pub half_power_width_hz: WithInterval,
}

/// Damping ratio from which the response in displacement has no peak, 1/√2.
const NO_PEAK: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl Resonance {
    /// Returns the sharpness for an undamped natural frequency in Hz and a damping ratio, whose errors are taken as
    /// independent; `None` unless 0 < ζ < 1/√2.
    ///
    /// Source: Ewins, Modal Testing, 2nd ed., Research Studies Press 2000, section 4.2.
    #[must_use]
    pub fn of(frequency_hz: WithInterval, damping_ratio: WithInterval) -> Option<Self> {
        let (frequency, ratio) = (frequency_hz.value, damping_ratio.value);
        if !(ratio > 0.0 && ratio < NO_PEAK && frequency > 0.0) {
            return None;
        }
        let quality = |ratio: f64| 0.5 / ratio;
        let [low, high] = damping_ratio.interval_95;
        let highest = if low > 0.0 || low.is_nan() { quality(low) } else { f64::INFINITY };
        let error =
            2.0 * libm::hypot(frequency * damping_ratio.std_error(), ratio * frequency_hz.std_error());
        Some(Self {
            quality_factor: WithInterval { value: quality(ratio), interval_95: [quality(high), highest] },
            half_power_width_hz: WithInterval::normal(2.0 * ratio * frequency, error),
        })
    }

    /// Returns the sharpness for the angular frequency of a damped swing in rad/s, taken as known, and its damping
    /// ratio, as [`Resonance::of`] does.
    #[must_use]
    pub fn of_swing(omega_rad_s: f64, damping_ratio: WithInterval) -> Option<Self> {
        let undamped = omega_rad_s / (1.0 - damping_ratio.value * damping_ratio.value).sqrt();
        Self::of(WithInterval::normal(undamped / std::f64::consts::TAU, 0.0), damping_ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::{ModeRow, Resonance, WithInterval};

    /// Returns the width at 1/√2 of the peak of the response in displacement, or of that in velocity, by search.
    fn width(ratio: f64, is_velocity: bool) -> f64 {
        let response = |r: f64| {
            let size = 1.0 / ((1.0 - r * r).powi(2) + (2.0 * ratio * r).powi(2)).sqrt();
            if is_velocity { r * size } else { size }
        };
        let steps = || (1..400_000).map(|step| f64::from(step) * 1e-5);
        let half = steps().map(response).fold(0.0, f64::max) / 2.0_f64.sqrt();
        steps().filter(|r| response(*r) >= half).count() as f64 * 1e-5
    }

    #[test]
    fn the_width_is_that_of_the_response_in_its_range() {
        let exact = |value: f64| WithInterval { value, interval_95: [value, value] };
        for (ratio, bound) in [(0.01, 0.002), (0.1, 0.0105), (0.2, 0.05)] {
            let found = Resonance::of(exact(1.0), exact(ratio)).unwrap();
            assert!((found.quality_factor.value * 2.0 * ratio - 1.0).abs() < 1e-12);
            let of_width = |is_velocity| found.half_power_width_hz.value / width(ratio, is_velocity) - 1.0;
            assert!(of_width(true).abs() < 2e-3, "{ratio}: {}", of_width(true));
            assert!(of_width(false).abs() < bound, "{ratio}: {}", of_width(false));
        }
        for none in [0.0, -0.01, 0.75, f64::NAN] {
            assert_eq!(Resonance::of(exact(1.0), exact(none)), None);
        }
    }

    #[test]
    fn a_ratio_that_may_be_zero_bounds_the_quality_factor_from_below_only() {
        let frequency = WithInterval::normal(2.0, 0.01);
        let found = Resonance::of(frequency, WithInterval::normal(0.01, 0.01)).unwrap();
        assert!(
            found.quality_factor.interval_95[0] > 10.0 && found.quality_factor.interval_95[1].is_infinite()
        );
        let found = Resonance::of(frequency, WithInterval::normal(0.01, 0.001)).unwrap();
        assert!((found.half_power_width_hz.std_error() - 2.0 * 2.0 * 0.001).abs() < 1e-5);
        assert!(found.quality_factor.interval_95[1] < 65.0);
    }

    #[test]
    fn a_mode_of_an_older_result_is_read() {
        let text = r#"{"frequency_hz":{"value":2,"interval_95":[1,3]},
            "damping_ratio":{"value":0.01,"interval_95":[0,0.02]},"share":0.5}"#;
        let mode: ModeRow = serde_json::from_str(text).unwrap();
        assert_eq!(mode.resonance, None);
        let resonance = Resonance::of(mode.frequency_hz, mode.damping_ratio);
        let text = serde_json::to_string(&ModeRow { resonance, ..mode }).unwrap();
        assert!(text.contains(r#""quality_factor":{"value":50.0,"interval_95":[25.0,null]}"#), "{text}");
        assert!(serde_json::from_str::<ModeRow>(&text).unwrap().resonance.is_some());
    }
}
