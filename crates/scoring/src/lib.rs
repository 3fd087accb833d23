//! Scores of estimates: error against the oracle, tolerance, agreement, quantities derived from a damping
//! ratio, prediction of held-out peaks, and statistics of chance.
//!
//! # Example
//!
//! ```
//! use scoring::{agreement, error_percent, half_life, passes, quality_factor};
//!
//! // A damping ratio of 0.00874 by least squares, and another method's.
//! assert!(passes(error_percent(0.008_741, 0.008_74), 0.1));
//! assert!((quality_factor(0.008_74) - 57.2).abs() < 0.1);
//! assert!((half_life(0.192) - 3.61).abs() < 0.01);
//!
//! // Decay rates of three records of one oscillator in 1/s, each with its standard error.
//! let found = agreement(&[(0.190, 0.004), (0.194, 0.004), (0.188, 0.008)]).unwrap();
//! assert_eq!(found.degrees, 2);
//! assert!(found.p_value > 0.5, "{found:?}");
//! ```

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
