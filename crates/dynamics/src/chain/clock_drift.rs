//! Clock that runs at a wrong or changing rate.

use super::step::{Extent, Sampled, SampledMotion, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Observed;
use crate::units::Quantity;

/// Largest relative excess of a clock's rate, at the start and at the end.
const FASTEST: f64 = 1.0;

const DESCRIPTION: Description = Description {
    id: "clock_drift",
    title: "Clock drift",
    kind: Kind::MeasuringChain,
    class: Class::Clock,
    equation: "stamp t + r (t - t₀) + ½ r′ (t - t₀)²",
    latex: r"t+r\,(t-t_0)+\tfrac12\dot r\,(t-t_0)^2",
    parameters: &[
        Parameter {
            name: "rate",
            symbol: "r",
            quantity: Quantity::Ratio,
            range: Range { minimum: -0.5, maximum: FASTEST, closed: true },
            meaning: "relative rate error of the clock at the start; above 0 it runs fast",
            default: None,
        },
        Parameter {
            name: "change",
            symbol: "r′",
            quantity: Quantity::Rate,
            range: Range::ANY,
            meaning: "change of that rate per second",
            default: None,
        },
    ],
    tell_tale: "A phase error that grows with time, in proportion to the frequency.",
    confused_with: &["stiffness_drift"],
    reference: "Riley, Handbook of Frequency Stability Analysis, NIST SP 1065 (2008), section 2",
    driven_only: false,
    hidden_states: 0,
    smooth: true,
    example: &[0.002, 0.0002],
};

/// Clock of a recorder: at true time t, counted from the first sample, it shows t + r·t + ½·r′·t².
#[derive(Debug, Clone, Copy)]
pub struct ClockDrift;

impl Step for ClockDrift {
    const DESCRIPTION: &'static Description = &DESCRIPTION;
    const DIFFERENTIABLE: bool = true;

    fn transform<S: Sampled>(
        &[rate, change, ..]: &Values<S>,
        motion: &SampledMotion<'_, S>,
        _: Observed,
        samples: &mut Samples<S>,
    ) {
        let Some(&start) = motion.times_s.first() else { return };
        for (stamp, time) in samples.stamps_s.iter_mut().zip(&samples.times_s) {
            let since = time - start;
            *stamp = *stamp + rate * since + change * (0.5 * since * since);
        }
    }

    fn check(&[rate, change, ..]: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        let slowest = -(1.0 + rate) / extent.duration_s;
        let fastest = (FASTEST - rate) / extent.duration_s;
        let refused = |relation, bound, reason| {
            Err(DynamicsError::Contradiction {
                effect: DESCRIPTION.id,
                parameter: "change",
                value: change,
                relation,
                bound,
                reason,
            })
        };
        if change <= slowest {
            return refused("above", slowest, "below it the clock runs backward before the record ends");
        }
        if change > fastest {
            return refused("at most", fastest, "above it the clock gains more than a second in a second");
        }
        Ok(())
    }
}
