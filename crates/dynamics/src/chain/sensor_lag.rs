//! Sensor that follows with a lag.

use super::low_pass::{self, LowPass};
use super::step::{Extent, Sampled, SampledMotion, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Observed;
use crate::units::Quantity;

const DESCRIPTION: Description = Description {
    id: "sensor_lag",
    title: "Sensor lag",
    kind: Kind::MeasuringChain,
    class: Class::Sensor,
    equation: "T y′ + y = x, y settled at the start",
    latex: r"T\,\dot y+y=x",
    parameters: &[Parameter {
        name: "time_constant",
        symbol: "T",
        quantity: Quantity::Time,
        range: Range::POSITIVE,
        meaning: "time constant of the first-order low-pass",
        default: None,
    }],
    tell_tale: "Amplitude and phase errors grow with frequency; in a decay of one frequency they show only at the start or with harmonics.",
    confused_with: &["input_delay"],
    reference: "Doebelin, Measurement Systems, 5th ed., McGraw-Hill 2004, section 3.3",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.01],
};

/// First-order low-pass filter: T·ẏ + y = x, settled at the first sample's value.
///
/// It is exact for the polynomial through the motion's values and derivatives at both ends of each interval.
/// For a position this is a quintic, whose error at angular frequency ω and sample period Δ is at most
/// (ωΔ)⁶/46080 of the amplitude; for a velocity it is a cubic, with (ωΔ)⁴/384. A lagged acceleration is the
/// derivative of the lagged velocity: the lag commutes with d/dt.
#[derive(Debug, Clone, Copy)]
pub struct SensorLag;

impl Step for SensorLag {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const DIFFERENTIABLE: bool = true;

    fn transform<S: Sampled>(
        &[time_constant, ..]: &Values<S>,
        motion: &SampledMotion<'_, S>,
        observed: Observed,
        samples: &mut Samples<S>,
    ) {
        samples.values = match observed {
            Observed::Position => {
                let end = |at: usize| {
                    Some([
                        *motion.position.get(at)?,
                        *motion.velocity.get(at)?,
                        *motion.acceleration.get(at)?,
                    ])
                };
                let first = motion.position.first().copied().unwrap_or(S::from(0.0));
                low_pass::quintic(time_constant, motion.times_s, end, first)
            }
            Observed::Velocity => {
                let first = motion.velocity.first().copied().unwrap_or(S::from(0.0));
                lagged_velocity(time_constant, motion, first)
            }
            Observed::Acceleration => {
                let zero = S::from(0.0);
                let velocity = motion.velocity.first().copied().unwrap_or(zero);
                let acceleration = motion.acceleration.first().copied().unwrap_or(zero);
                let lagged = lagged_velocity(time_constant, motion, velocity - time_constant * acceleration);
                motion
                    .velocity
                    .iter()
                    .zip(lagged)
                    .map(|(&now, lagged)| (now - lagged) / time_constant)
                    .collect()
            }
        };
    }

    fn check(&[time_constant, ..]: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        if time_constant <= extent.duration_s {
            return Ok(());
        }
        Err(DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter: "time_constant",
            value: time_constant,
            relation: "at most",
            bound: extent.duration_s,
            reason: "the length of the record in seconds: a slower sensor never follows",
        })
    }
}

fn lagged_velocity<S: Sampled>(time_constant: S, motion: &SampledMotion<'_, S>, first: S) -> Vec<S> {
    let end = |at: usize| Some([*motion.velocity.get(at)?, *motion.acceleration.get(at)?]);
    LowPass::new(time_constant, motion.times_s).of(end, first)
}

#[cfg(test)]
mod tests {
    use super::SensorLag;
    use crate::chain::{Observed, Sampled, SampledMotion, Samples, Step};
    use crate::scalar::{Dual, Scalar};

    const OMEGA: f64 = 21.75;

    /// The lagged observation of cos ωt, sampled unevenly over 4 s, and its exact value: the settled response
    /// plus the decaying rest of the start.
    fn lagged<S: Sampled>(time_constant: S, observed: Observed) -> (Vec<S>, Vec<f64>) {
        let times: Vec<f64> = (0..1040).map(|i| i as f64 / 260.0 + 1e-3 * (i as f64).sin()).collect();
        let series = |f: &dyn Fn(f64) -> f64| -> Vec<S> { times.iter().map(|&t| S::from(f(t))).collect() };
        let position = series(&|t| (OMEGA * t).cos());
        let velocity = series(&|t| -OMEGA * (OMEGA * t).sin());
        let acceleration = series(&|t| -OMEGA * OMEGA * (OMEGA * t).cos());
        let motion = SampledMotion {
            times_s: &times,
            position: &position,
            velocity: &velocity,
            acceleration: &acceleration,
        };
        let mut samples = Samples { indices: vec![], times_s: vec![], values: vec![], stamps_s: vec![] };
        SensorLag::transform(&[time_constant; 4], &motion, observed, &mut samples);

        let (t, lag) = (time_constant.plain(), OMEGA * time_constant.plain());
        let order = match observed {
            Observed::Position => 0,
            Observed::Velocity => 1,
            Observed::Acceleration => 2,
        };
        let derivative = |at: f64| {
            let phase = OMEGA * at + order as f64 * std::f64::consts::FRAC_PI_2;
            OMEGA.powi(order) * (phase.cos() + lag * phase.sin()) / (1.0 + lag * lag)
        };
        let first = match observed {
            Observed::Position => position[0],
            Observed::Velocity => velocity[0],
            Observed::Acceleration => acceleration[0],
        };
        let start = first.plain() - derivative(times[0]);
        let exact = times.iter().map(|&at| derivative(at) + start * (-(at - times[0]) / t).exp()).collect();
        (samples.values, exact)
    }

    #[test]
    fn it_is_the_exact_response_to_a_cosine() {
        // Interpolation errors of quintic and cubic at ωΔ = 0.13 (the largest step), over the amplitude.
        let cases = [(Observed::Position, 2e-10), (Observed::Velocity, 1e-6), (Observed::Acceleration, 2e-5)];
        for (observed, tolerance) in cases {
            for time_constant in [1e-5, 1e-3, 4e-3, 0.05, 2.0] {
                let (found, exact) = lagged(time_constant, observed);
                let size = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                for (found, exact) in found.iter().zip(&exact) {
                    let error = (found - exact).abs() / size;
                    assert!(error < tolerance, "{observed:?}, T = {time_constant}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn its_derivative_is_that_of_the_values() {
        for time_constant in [1e-3, 0.05] {
            let (found, _) = lagged(Dual::<1>::variable(time_constant, 0), Observed::Position);
            let h = 1e-4 * time_constant;
            let (above, _) = lagged(time_constant + h, Observed::Position);
            let (below, _) = lagged(time_constant - h, Observed::Position);
            for ((found, above), below) in found.iter().zip(&above).zip(&below) {
                let difference = (above - below) / (2.0 * h);
                assert!((found.partials[0] - difference).abs() < 1e-5 * OMEGA, "{found:?} {difference}");
            }
        }
    }

    #[test]
    fn the_exponential_is_that_of_the_scalar() {
        assert_eq!(Dual::<1>::variable(0.0, 0).exp().partials, [1.0]);
    }
}
