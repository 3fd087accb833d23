//! How far an estimate is from the oracle, whether that passes, and what follows from a damping ratio.

mod derived;
mod error;

pub use derived::{
    critical_damping, cycles_to_one_over_e, damping_coefficient, half_life, quality_factor, stiffness,
    time_constant,
};
pub use error::{digits_of_agreement, error_percent, median, passes, worst};
