//! The measuring chain: from the motion to what a file says of it.
//!
//! One effect, one file. The order is that of the hardware, whatever order the effects are given in:
//!
//! 1. the sensor samples the motion at true times, and observes position, velocity or acceleration;
//! 2. it lags (`sensor_lag`), is eccentric (`sensor_nonlinearity`), its zero wanders (`sensor_drift`);
//! 3. white noise is added;
//! 4. its range ends (`sensor_saturation`), its reading has a step (`sensor_quantization`);
//! 5. readings go wrong (`outliers`) or get lost (`dropouts`) on their way;
//! 6. what arrives is stamped: by a clock of its own rate (`clock_drift`), at scattered moments
//!    (`timestamp_jitter`), burst by burst (`timestamp_batching`).
//!
//! Steps that are differentiable in their parameters are written over any [`Sampled`] number, so that a fit gets
//! exact derivatives from the same lines ([`transform`]). The others work on doubles and draw from a
//! generator of their own.

mod clock_drift;
mod dropouts;
mod low_pass;
mod measuring;
mod outliers;
mod sensor_drift;
mod sensor_lag;
mod sensor_nonlinearity;
mod sensor_quantization;
mod sensor_saturation;
mod step;
#[cfg(test)]
mod tests;
mod timestamp_batching;
mod timestamp_jitter;

pub use crate::units::Observed;
pub use clock_drift::ClockDrift;
pub use dropouts::Dropouts;
pub use measuring::{Chain, transform};
pub use outliers::Outliers;
pub use sensor_drift::SensorDrift;
pub use sensor_lag::SensorLag;
pub use sensor_nonlinearity::SensorNonlinearity;
pub use sensor_quantization::SensorQuantization;
pub use sensor_saturation::SensorSaturation;
pub use step::{Extent, Sampled, SampledMotion, Samples, Step};
pub use timestamp_batching::TimestampBatching;
pub use timestamp_jitter::TimestampJitter;
