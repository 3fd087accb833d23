//! Envelope of a record: the result of a pipeline.

#![allow(clippy::indexing_slicing, reason = "`Envelope::new` refuses fewer than three peaks")]

use crate::error::EnvelopeError;

/// Fewest peaks that give a line and its error.
pub(crate) const FEWEST_PEAKS: usize = 3;

/// Decay of a record's peaks: the only data that an estimator of the decay rate receives.
///
/// Times start at the first peak. Invariants: at least three peaks, finite values, increasing times.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    times_s: Vec<f64>,
    log_amplitudes: Vec<f64>,
    omega_rad_s: f64,
    log_std_errors: Option<Vec<f64>>,
    ratio: RatioDefinition,
}

/// Definition of the damping ratio from a decay rate λ and the angular frequency ω of the damped swing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RatioDefinition {
    /// λ/ω: the paper's definition, for small damping; relatively too large by ζ²/2.
    #[default]
    SmallDamping,
    /// λ/√(λ² + ω²): the logarithmic decrement's definition, exact for viscous damping.
    LogarithmicDecrement,
}

impl Envelope {
    /// Creates an envelope from times in seconds, natural logarithms of amplitudes, and the angular frequency
    /// in rad/s. The times are shifted to start at zero.
    ///
    /// # Errors
    /// [`EnvelopeError::TooFewPeaks`] for fewer than three peaks. It is returned as well, with 0 peaks found,
    /// if a value is not finite, the times do not increase, the lengths differ, or the frequency is not above
    /// 0.
    pub fn new(times_s: Vec<f64>, log_amplitudes: Vec<f64>, omega_rad_s: f64) -> Result<Self, EnvelopeError> {
        let finite = times_s.iter().chain(&log_amplitudes).all(|number| number.is_finite());
        let increasing = times_s.iter().zip(times_s.iter().skip(1)).all(|(one, next)| one < next);
        let usable = finite
            && increasing
            && times_s.len() == log_amplitudes.len()
            && omega_rad_s.is_finite()
            && omega_rad_s > 0.0;
        let found = if usable { times_s.len() } else { 0 };
        if found < FEWEST_PEAKS {
            return Err(EnvelopeError::TooFewPeaks {
                pipeline: "given",
                found,
                needed: FEWEST_PEAKS,
                remedy: "Expected finite peaks at increasing times and a positive frequency.".to_owned(),
            });
        }
        let first = times_s[0];
        let times_s = times_s.into_iter().map(|time| time - first).collect();
        let ratio = RatioDefinition::default();
        Ok(Self { times_s, log_amplitudes, omega_rad_s, log_std_errors: None, ratio })
    }

    /// Returns this envelope with the standard error that the sensor's noise leaves in each ln A. The errors
    /// are dropped if their number differs from that of the peaks or one of them is not a finite number above
    /// 0.
    #[must_use]
    pub fn with_log_std_errors(self, errors: Vec<f64>) -> Self {
        let usable =
            errors.len() == self.len() && errors.iter().all(|error| error.is_finite() && *error > 0.0);
        Self { log_std_errors: usable.then_some(errors), ..self }
    }

    /// Returns this envelope with another definition of the damping ratio.
    #[must_use]
    pub fn with_ratio(self, ratio: RatioDefinition) -> Self {
        Self { ratio, ..self }
    }

    /// Returns the definition of the damping ratio.
    #[must_use]
    pub fn ratio(&self) -> RatioDefinition {
        self.ratio
    }

    /// Returns the number of peaks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Returns `true` if there are no peaks, which the invariants exclude.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.times_s.is_empty()
    }

    /// Returns the times of the peaks after the first one, in seconds, increasing.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Returns the time from the first peak to the last one, in seconds, above 0.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.times_s[self.times_s.len() - 1]
    }

    /// Returns the natural logarithms of the peaks' amplitudes, with the amplitude in the record's unit.
    #[must_use]
    pub fn log_amplitudes(&self) -> &[f64] {
        &self.log_amplitudes
    }

    /// Returns the angular frequency, 2π over the median period, in rad/s.
    #[must_use]
    pub fn omega_rad_s(&self) -> f64 {
        self.omega_rad_s
    }

    /// Returns the standard error of each ln A from the sensor's noise, one entry per peak, above 0; `None`
    /// if the pipeline does not know it. It grows as 1/A.
    #[must_use]
    pub fn log_std_errors(&self) -> Option<&[f64]> {
        self.log_std_errors.as_deref()
    }

    /// Returns the damping ratio for a decay rate in 1/s, by the envelope's [`RatioDefinition`].
    #[must_use]
    pub fn damping_ratio(&self, decay_rate: f64) -> f64 {
        match self.ratio {
            RatioDefinition::SmallDamping => decay_rate / self.omega_rad_s,
            RatioDefinition::LogarithmicDecrement => decay_rate / libm::hypot(decay_rate, self.omega_rad_s),
        }
    }

    /// Returns the standard error of the damping ratio for a decay rate and its standard error, both in 1/s.
    /// The frequency is taken as exact.
    #[must_use]
    pub fn damping_ratio_error(&self, decay_rate: f64, std_error: f64) -> f64 {
        match self.ratio {
            RatioDefinition::SmallDamping => std_error / self.omega_rad_s,
            RatioDefinition::LogarithmicDecrement => {
                std_error * self.omega_rad_s.powi(2) / libm::hypot(decay_rate, self.omega_rad_s).powi(3)
            }
        }
    }
}

/// Envelope, with other results of its extraction.
#[derive(Debug, Clone, PartialEq)]
pub struct Extraction {
    /// Name of the pipeline.
    pub pipeline: &'static str,
    /// Reason for this pipeline if the record decided it, as a clause.
    pub because: Option<String>,
    /// Envelope of the record.
    pub envelope: Envelope,
    /// Time of the first peak after the first sample, in seconds.
    pub first_peak_s: f64,
    /// Median period, in seconds.
    pub period_s: f64,
    /// Rest position that was removed, in the record's unit.
    pub offset: f64,
    /// Number of samples that the peaks were searched in.
    pub samples: usize,
}

/// Returns the differences between entries `lag` apart.
pub(crate) fn differences(values: &[f64], lag: usize) -> Vec<f64> {
    values.iter().zip(values.iter().skip(lag)).map(|(one, next)| next - one).collect()
}
