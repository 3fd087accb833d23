//! Sensor with a step.

use super::step::{Extent, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Quantity;
use rand::Rng;

const DESCRIPTION: Description = Description {
    id: "sensor_quantization",
    title: "Sensor quantization",
    kind: Kind::MeasuringChain,
    class: Class::Sensor,
    equation: "q round(y/q) with y moved by x to within h of it: y = min(max(y, x - h), x + h)",
    latex: r"q\,\operatorname{round}(y/q),\quad y\leftarrow\min(\max(y,x-h),x+h)",
    parameters: &[
        Parameter {
            name: "step",
            symbol: "q",
            quantity: Quantity::Observed,
            range: Range::POSITIVE,
            meaning: "distance between neighboring readings",
            default: None,
        },
        Parameter {
            name: "hysteresis",
            symbol: "h",
            quantity: Quantity::Observed,
            range: Range::NON_NEGATIVE,
            meaning: "lag of a reading behind the motion, in either direction",
            default: Some(0.0),
        },
    ],
    tell_tale: "Few distinct values; the residual stays within half a step, and is uniform there while the motion is large. With hysteresis it is shifted against the direction of motion: odd harmonics that do not decay with the swing.",
    confused_with: &["coulomb_friction"],
    reference: "Widrow, Kollár, Quantization Noise, Cambridge 2008, chapter 3",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.05],
};

/// Readings rounded to whole multiples of a step.
///
/// With a hysteresis h, a reading follows only once the motion is ahead of it by h. Magnetic encoders do so
/// to keep their last step from flickering; an encoder that counts lines at different places in the two
/// directions has a hysteresis of half a step. The first reading is at the position of the motion.
#[derive(Debug, Clone, Copy)]
pub struct SensorQuantization;

impl Step for SensorQuantization {
    const DESCRIPTION: &'static Description = &DESCRIPTION;

    fn distort<R: Rng + ?Sized>(
        &[step, hysteresis, ..]: &Values<f64>,
        samples: &mut Samples<f64>,
        _: &mut R,
    ) {
        let Some(&(mut held)) = samples.values.first() else { return };
        for value in &mut samples.values {
            held = held.max(*value - hysteresis).min(*value + hysteresis);
            *value = held;
        }
        round(step, &mut samples.values);
    }

    fn check(&[step, hysteresis, ..]: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        let span = extent.largest - extent.smallest;
        let contradiction = |parameter, value, bound, reason| DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter,
            value,
            relation: "at most",
            bound,
            reason,
        };
        if step > span {
            let reason = "the span of the signal: a coarser sensor does not see the motion";
            return Err(contradiction("step", step, span, reason));
        }
        if hysteresis > 0.5 * span {
            let reason = "half the span of the signal: beyond it no reading changes";
            return Err(contradiction("hysteresis", hysteresis, 0.5 * span, reason));
        }
        Ok(())
    }
}

/// Rounds values to the lattice of a step.
pub(super) fn round(step: f64, values: &mut [f64]) {
    for value in values {
        *value = step * (*value / step).round();
    }
}

#[cfg(test)]
mod tests {
    use super::SensorQuantization;
    use crate::chain::{Samples, Step};
    use rand::SeedableRng;
    use rand::rngs::SmallRng;

    fn read(values: &[f64], step: f64, hysteresis: f64) -> Vec<f64> {
        let list = || vec![0.0; values.len()];
        let mut samples =
            Samples { indices: vec![], times_s: list(), values: values.to_vec(), stamps_s: list() };
        let generator = &mut SmallRng::seed_from_u64(0);
        SensorQuantization::distort(&[step, hysteresis, 0.0, 0.0], &mut samples, generator);
        samples.values
    }

    #[test]
    fn a_reading_follows_once_it_is_left_behind() {
        let way = [0.0, 0.4, 1.0, 2.0, 1.6, 1.0, 0.4, 1.0];
        assert_eq!(read(&way, 1e-9, 0.5), [0.0, 0.0, 0.5, 1.5, 1.5, 1.5, 0.9, 0.9]);
    }

    /// Steps of 1, half a step of hysteresis: the line passed last, in either direction.
    #[test]
    fn with_half_a_step_it_is_the_last_line_passed() {
        let up: Vec<f64> = (0..=50).map(|i| 0.1 * f64::from(i) + 0.05).collect();
        let down: Vec<f64> = up.iter().rev().copied().collect();
        let way: Vec<f64> = up.iter().chain(&down).copied().collect();
        let found = read(&way, 1.0, 0.5);
        for (at, (value, reading)) in way.iter().zip(&found).enumerate().skip(10) {
            // After the reversal the last line stays the same for a while.
            let last = if at <= 50 { value.floor() } else { value.ceil().min(5.0) };
            assert_eq!(*reading, last, "{at}: {value}");
        }
    }
}
