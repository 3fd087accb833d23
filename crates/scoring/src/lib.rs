//! How far an estimate is from the oracle, whether that passes, what follows from a damping ratio, how well
//! held-out peaks are predicted, and what chance alone would give.

mod agreement;
mod chance;
mod derived;
mod error;
mod prediction;

pub use agreement::{Agreement, agreement};
pub use chance::{binomial_interval, clustered_interval, holm, sign_test};
pub use derived::{
    critical_damping, cycles_to_one_over_e, damping_coefficient, half_life, quality_factor, stiffness,
    time_constant,
};
pub use error::{digits_of_agreement, error_percent, median, passes, worst};
pub use prediction::{
    HeldOutPeak, held_within_95, mean_log_density, relative_amplitude_error_percent, rms_log_error,
};
