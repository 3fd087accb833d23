//! Measurement chain: from the motion to the samples of a file.
//!
//! One effect, one file. The order is that of the hardware, whatever order the effects are given in:
//!
//! 1. the sensor samples the motion at true times, and observes position, velocity or acceleration;
//! 2. it lags (`sensor_lag`), is eccentric (`sensor_nonlinearity`), and its zero drifts (`sensor_drift`);
//! 3. white noise is added;
//! 4. its range is limited (`sensor_saturation`), its reading has a step (`sensor_quantization`);
//! 5. readings go wrong (`outliers`) or get lost (`dropouts`) in transport;
//! 6. the remaining samples are stamped: by a clock of its own rate (`clock_drift`), at scattered moments
//!    (`timestamp_jitter`), burst by burst (`timestamp_batching`).
//!
//! Steps that are differentiable in their parameters are written over any [`Sampled`] number, so that a fit
//! gets exact derivatives from the same code ([`transform`]). The others work on doubles and draw from a
//! generator of their own.
//!
//! # Example
//! A shaft that turns at 0.1 rad/s, observed by an encoder with steps of a thousandth of a radian:
//!
//! ```
//! use dynamics::chain::{Chain, Observed, SampledMotion};
//! use dynamics::{Active, Coordinate};
//! use seed::Seed;
//!
//! let times: Vec<f64> = (0..200).map(|sample| f64::from(sample) / 100.0).collect();
//! let position: Vec<f64> = times.iter().map(|time| 0.1 * time).collect();
//! let (velocity, acceleration) = (vec![0.1; 200], vec![0.0; 200]);
//! let motion = SampledMotion {
//!     times_s: &times,
//!     position: &position,
//!     velocity: &velocity,
//!     acceleration: &acceleration,
//! };
//! let encoder = Active::named("sensor_quantization", &[("step", 1e-3)])?;
//! let chain = Chain::new(Observed::Position, 0.0, vec![encoder])?;
//!
//! let seed = Seed::new(1);
//! let samples = chain.observe(&motion, Coordinate::Angle, |step| seed.child(step).generator())?;
//! for (read, true_position) in samples.values.iter().zip(&position) {
//!     assert!((read - true_position).abs() < 0.5001e-3);
//!     assert!((read / 1e-3 - (read / 1e-3).round()).abs() < 1e-9, "on the lattice: {read}");
//! }
//! # Ok::<(), dynamics::DynamicsError>(())
//! ```

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
pub use low_pass::LowPass;
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
