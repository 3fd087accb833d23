//! Samples that arrive in bursts.

use super::step::{Extent, Samples, Step};
use crate::description::{Class, Description, Kind, Parameter, Range};
use crate::error::DynamicsError;
use crate::law::Values;
use crate::units::Quantity;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

const DESCRIPTION: Description = Description {
    id: "timestamp_batching",
    title: "Timestamp batching",
    kind: Kind::MeasuringChain,
    class: Class::Clock,
    equation: "stamp: the end of the burst that the sample arrives in",
    latex: r"t\mapsto\min\{b_k: b_k\ge t\},\quad b_{k+1}-b_k=T_b+\sigma_b n_k",
    parameters: &[
        Parameter {
            name: "interval",
            symbol: "T_b",
            quantity: Quantity::Time,
            range: Range::POSITIVE,
            meaning: "mean time between bursts",
            default: None,
        },
        Parameter {
            name: "scatter",
            symbol: "σ_b",
            quantity: Quantity::Time,
            range: Range::NON_NEGATIVE,
            meaning: "standard deviation of the time between two bursts",
            default: None,
        },
    ],
    tell_tale: "Repeated stamps, and a staircase in place of the motion.",
    confused_with: &["timestamp_jitter"],
    reference: "Olson, A passive solution to the sensor synchronization problem, IEEE/RSJ International Conference on Intelligent Robots and Systems 2010",
    driven_only: false,
    hidden_states: 0,
    smooth: false,
    example: &[0.06, 0.003],
};

/// Samples are collected and handed over in bursts; each carries the time of its burst.
#[derive(Debug, Clone, Copy)]
pub struct TimestampBatching;

/// Largest scatter, in intervals. At this scatter two bursts coincide four standard deviations below the
/// mean.
const LARGEST_SCATTER: f64 = 0.25;

impl Step for TimestampBatching {
    const DESCRIPTION: &'static Description = &DESCRIPTION;

    fn distort<R: Rng + ?Sized>(
        &[interval, scatter, ..]: &Values<f64>,
        samples: &mut Samples<f64>,
        generator: &mut R,
    ) {
        let Some(&first) = samples.stamps_s.first() else { return };
        // The logger was running before the record began: the first burst ends anywhere within an interval.
        let mut burst = first + interval * generator.random::<f64>();
        for stamp in &mut samples.stamps_s {
            while *stamp > burst {
                let error: f64 = generator.sample(StandardNormal);
                // Within four standard deviations, which keeps the bursts in order.
                burst += interval + scatter * error.clamp(-3.9, 3.9);
            }
            *stamp = burst;
        }
    }

    fn check(&[interval, scatter, ..]: &Values<f64>, extent: &Extent) -> Result<(), DynamicsError> {
        let refused = |parameter, value, relation, bound, reason| {
            Err(DynamicsError::Contradiction {
                effect: DESCRIPTION.id,
                parameter,
                value,
                relation,
                bound,
                reason,
            })
        };
        if interval < extent.sample_period_s {
            let reason = "the sample period: a shorter burst holds zero samples";
            return refused("interval", interval, "at least", extent.sample_period_s, reason);
        }
        if interval > extent.duration_s / 2.0 {
            let reason = "half the record: with fewer bursts no time passes in the file";
            return refused("interval", interval, "at most", extent.duration_s / 2.0, reason);
        }
        if scatter > LARGEST_SCATTER * interval {
            let reason = "a quarter of the interval: beyond it bursts overtake each other";
            return refused("scatter", scatter, "at most", LARGEST_SCATTER * interval, reason);
        }
        Ok(())
    }
}
