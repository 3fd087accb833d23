//! Errors of a diagnosis.

use dynamics::DynamicsError;
use thiserror::Error;

/// Reason why records cannot be diagnosed. The message says what was found and what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DiagnosisError {
    /// There is no record.
    #[error("there is no record; give at least one")]
    NoRecord,
    /// The record has too few samples.
    #[error(
        "record {record} has {found} samples; a diagnosis needs at least {needed}. Record longer, or faster"
    )]
    TooFewSamples {
        /// Number of the record, from 1.
        record: usize,
        /// Number of samples found.
        found: usize,
        /// Number of samples needed.
        needed: usize,
    },
    /// The record has too few cycles of the swing.
    #[error(
        "record {record} shows {found:.1} cycles of about {period_s:.4} s; a diagnosis needs at least {needed}. \
         Record longer, or release from farther out"
    )]
    TooFewCycles {
        /// Number of the record, from 1.
        record: usize,
        /// Number of cycles found.
        found: f64,
        /// Number of cycles needed.
        needed: f64,
        /// Nominal period in seconds.
        period_s: f64,
    },
    /// The values do not change, or by no more than the sensor resolves.
    #[error(
        "record {record} does not move: {}. Check the column, or release from farther out",
        still(*.span, *.resolution, .unit)
    )]
    NoMotion {
        /// Number of the record, from 1.
        record: usize,
        /// Largest minus smallest value.
        span: f64,
        /// Resolution of the sensor in the unit of the values; 0 if unknown.
        resolution: f64,
        /// Unit of the values.
        unit: &'static str,
    },
    /// The record has no input, and the nominal simulator has no restoring torque that could move it.
    #[error(
        "record {record} has no input column, but the nominal system has no spring: without its input nothing \
         moves it. Name the input's column"
    )]
    MissingInput {
        /// Number of the record, from 1.
        record: usize,
    },
    /// The record swings at another frequency than the nominal simulator.
    #[error(
        "record {record} swings with a period of {measured_s:.4} s, the nominal simulator with {nominal_s:.4} s, \
         {ratio:.1} times off: this is not the same system, or the units are wrong. Check the unit of time, the \
         nominal inertia and stiffness{}", known_factor(*ratio)
    )]
    AnotherPeriod {
        /// Number of the record, from 1.
        record: usize,
        /// Nominal period in seconds.
        nominal_s: f64,
        /// Measured period in seconds.
        measured_s: f64,
        /// Ratio of the larger to the smaller period.
        ratio: f64,
    },
    /// The records observe different quantities or have different units.
    #[error(
        "record {record} observes another quantity, or in another unit, than record 1; diagnose them \
         separately"
    )]
    MixedQuantities {
        /// Number of the record, from 1.
        record: usize,
    },
    /// The caller asked to stop.
    #[error("interrupted after the stage `{stage}`; nothing was answered")]
    Interrupted {
        /// Last stage that was completed.
        stage: &'static str,
    },
    /// The nominal simulator cannot be fitted to the record.
    #[error("the nominal simulator cannot be fitted to the record: {reason}")]
    NotFitted {
        /// Reason, as text.
        reason: String,
    },
    /// Error of the dynamics.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
}

/// Returns a hint at a known mistake that causes a factor between two periods. Periods of one system differ
/// by a few percent at most; a tolerance of a tenth to either side covers that.
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

/// Describes how little the values of a record change.
fn still(span: f64, resolution: f64, unit: &str) -> String {
    if span == 0.0 {
        return "all its values are the same".to_owned();
    }
    let span = format!("its values span {span:.1e} {unit}");
    if resolution > 0.0 { format!("{span}, and the sensor resolves {resolution:.1e} {unit}") } else { span }
}
