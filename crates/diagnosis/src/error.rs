//! What keeps a record from being diagnosed.

use dynamics::DynamicsError;
use thiserror::Error;

/// A record that cannot be diagnosed, with what was found and what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DiagnosisError {
    /// Nothing to diagnose.
    #[error("there is no record; give at least one")]
    NoRecord,
    /// Too few samples.
    #[error(
        "record {record} has {found} samples; a diagnosis needs at least {needed}. Record longer, or faster"
    )]
    TooFewSamples {
        /// Which record, from 1.
        record: usize,
        /// Samples found.
        found: usize,
        /// Samples needed.
        needed: usize,
    },
    /// Too few cycles of a free decay.
    #[error(
        "record {record} shows {found:.1} cycles of about {period_s:.4} s; a diagnosis needs at least {needed}. \
         Record longer, or release from farther out"
    )]
    TooFewCycles {
        /// Which record, from 1.
        record: usize,
        /// Cycles found.
        found: f64,
        /// Cycles needed.
        needed: f64,
        /// The nominal period in seconds.
        period_s: f64,
    },
    /// Values that do not change, or by no more than the sensor resolves.
    #[error(
        "record {record} does not move: {}. Check the column, or release from farther out",
        still(*.span, *.resolution, .unit)
    )]
    NoMotion {
        /// Which record, from 1.
        record: usize,
        /// Largest minus smallest value.
        span: f64,
        /// What the sensor resolves; 0 where unknown.
        resolution: f64,
        /// Unit of the values.
        unit: &'static str,
    },
    /// A drive without a spring, or any driven system, without its input.
    #[error(
        "record {record} has no input column, but the nominal system has no spring: without its input nothing \
         moves it. Name the input's column"
    )]
    MissingInput {
        /// Which record, from 1.
        record: usize,
    },
    /// The record swings at another frequency than the nominal simulator.
    #[error(
        "record {record} swings with a period of {measured_s:.4} s, the nominal simulator with {nominal_s:.4} s, \
         {ratio:.1} times off: this is not the same system, or the units are wrong. Check the unit of time, the \
         nominal inertia and stiffness{}", known_factor(*ratio)
    )]
    AnotherPeriod {
        /// Which record, from 1.
        record: usize,
        /// The nominal period in seconds.
        nominal_s: f64,
        /// The measured period in seconds.
        measured_s: f64,
        /// The larger over the smaller.
        ratio: f64,
    },
    /// Angles too large to be radians.
    #[error(
        "record {record} swings out to {largest:.1} rad, {turns:.1} full turns, about a spring: these look like \
         degrees. Set unit = \"deg\""
    )]
    LooksLikeDegrees {
        /// Which record, from 1.
        record: usize,
        /// Largest distance from the middle, in the unit taken to be radians.
        largest: f64,
        /// The same in turns.
        turns: f64,
    },
    /// Records of one system that observe different quantities.
    #[error(
        "record {record} observes another quantity, or in another unit, than record 1; diagnose them apart"
    )]
    MixedQuantities {
        /// Which record, from 1.
        record: usize,
    },
    /// The caller asked to stop.
    #[error("interrupted after the stage `{stage}`; nothing was answered")]
    Interrupted {
        /// The last stage that was done.
        stage: &'static str,
    },
    /// The nominal simulator cannot be fitted to the record at all.
    #[error("the nominal simulator cannot be fitted to the record: {reason}")]
    NotFitted {
        /// What went wrong.
        reason: String,
    },
    /// The dynamics refuse.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
}

/// The mistake that a factor between two periods is known for. Periods of one system differ by a few percent at most, so a
/// tenth to either side leaves room for that.
fn known_factor(ratio: f64) -> &'static str {
    let near = |factor: f64| (ratio / factor - 1.0).abs() < 0.1;
    match () {
        () if near(std::f64::consts::TAU) => {
            ". The factor is near 2 pi: is a frequency stated in Hz that is in rad/s, or the other way round?"
        }
        () if near(1e3) => ". The factor is near 1000: are the stamps in ms? Set --time-unit ms",
        () if near(1e6) => ". The factor is near a million: are the stamps in us? Set --time-unit us",
        () if near(1e3_f64.sqrt()) => {
            ". Its square is near 1000: is the inertia or the stiffness stated with g, mm or mN in place of kg, m or N?"
        }
        () if near(9.806_65_f64.sqrt()) => {
            ". Its square is near 9.81: is the inertia or the stiffness stated with kgf in place of N?"
        }
        () if near(1f64.to_degrees().sqrt()) => {
            ". Its square is near 57.3: is the stiffness stated per degree in place of per radian?"
        }
        () => "",
    }
}

/// How little the values of a record move.
fn still(span: f64, resolution: f64, unit: &str) -> String {
    if span == 0.0 {
        return "all its values are the same".to_owned();
    }
    let span = format!("its values span {span:.1e} {unit}");
    if resolution > 0.0 { format!("{span}, and the sensor resolves {resolution:.1e} {unit}") } else { span }
}
