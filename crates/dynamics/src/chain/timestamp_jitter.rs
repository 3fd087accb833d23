//! Stamps that scatter.

use super::step::{Extent, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Quantity;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

const DESCRIPTION: Description = Description {
    id: "timestamp_jitter",
    title: "Timestamp jitter",
    kind: Kind::MeasuringChain,
    class: Class::Clock,
    equation: "stamp t + σ n, n standard normal",
    latex: r"t+\sigma_t\,n,\quad n\sim\mathcal N(0,1)",
    parameters: &[Parameter {
        name: "deviation",
        symbol: "σ_t",
        quantity: Quantity::Time,
        range: Range::NON_NEGATIVE,
        meaning: "standard deviation of a stamp's error",
        default: None,
    }],
    tell_tale: "A white residual whose size is proportional to the velocity.",
    confused_with: &["timestamp_batching"],
    reference: "Souders, Flach, Hagwood, Yang, IEEE Transactions on Instrumentation and Measurement 39 (1990) 80",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.001],
};

/// Independent normal errors of the stamps. Stamps that would change places are sorted: a logger writes one
/// after the other.
#[derive(Debug, Clone, Copy)]
pub struct TimestampJitter;

/// Largest deviation in sample periods. Beyond it stamps change places so often (at half a period in one pair
/// of thirteen) that their errors are no longer independent.
const LARGEST: f64 = 0.5;

impl Step for TimestampJitter {
    const DESCRIPTION: &'static Description = &DESCRIPTION;

    fn distort<R: Rng + ?Sized>(
        &[deviation, ..]: &Values<f64>,
        samples: &mut Samples<f64>,
        generator: &mut R,
    ) {
        for stamp in &mut samples.stamps_s {
            *stamp += deviation * generator.sample::<f64, _>(StandardNormal);
        }
        samples.stamps_s.sort_by(f64::total_cmp);
    }

    fn check(&[deviation, ..]: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        let bound = LARGEST * extent.sample_period_s;
        if deviation <= bound {
            return Ok(());
        }
        Err(DynamicsError::Contradiction {
            effect: DESCRIPTION.id,
            parameter: "deviation",
            value: deviation,
            relation: "at most",
            bound,
            reason: "half the sample period: beyond it neighbors change places",
        })
    }
}
