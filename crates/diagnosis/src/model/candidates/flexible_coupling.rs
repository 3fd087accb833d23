//! Second body coupled by a spring.
//!
//! A second body appears as a spectral line of its own, within what the samples can show. The search looks for a
//! decaying line, since a steady one sees only 2/(rT) of a line that dies away at rate r within T.

use super::{CandidateLaw, EvidenceClass, Hidden, Lines, MainMode, Mode, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, Moment, Nominal, SystemEffect, Values};

/// Minimum decay of a second mode over the longest record, as a logarithm, and its maximum damping ratio.
const LEAST_DECAY: f64 = 0.3;
const MOST_DAMPED: f64 = 0.7;

/// Limits of a second body's inertia relative to the first one's: smaller bodies move nothing, larger ones
/// take the first body's place.
const SMALLEST_BODY: f64 = 1e-9;
const LARGEST_BODY: f64 = 1e2;

/// Factor in the decay rate, in either direction, beyond which a line at a harmonic belongs to another body.
/// The second bodies that imitated a nonlinear sensor decayed 0.9 to 1.2 times as fast as the harmonic
/// (training banks).
const ANOTHER_DECAY: f64 = 1.5;

/// Initial second body: the number of lines tried, the phase in radians by which it may put the swing off
/// over a segment, and its maximum share of the inertia.
const MODES: usize = 3;
const OUT_OF_PHASE: f64 = 0.1;
const FIRST_BODY: f64 = 0.02;

/// Returns a second body's initial share of the inertia. The body lowers the swing's frequency by half its
/// share, and over a long segment a body that does not have its final frequency yet would lose count of the
/// swings.
fn first_body(facts: &Scales, longest_span: f64) -> f64 {
    let phase = facts.frequency * longest_span;
    (2.0 * OUT_OF_PHASE / phase.max(1.0)).min(FIRST_BODY)
}

/// Second body coupled by a spring: its inertia I, and its stiffness k and damping c, fitted as frequency ω
/// and decay rate r on a body at rest, k = I·ω² and c = 2·I·r. A record shows these directly, and no step
/// makes the motion faster than its samples.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlexibleCoupling;

impl CandidateLaw for FlexibleCoupling {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::FlexibleCoupling)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::SecondBody
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let [slowest, fastest] = facts.modes();
        vec![
            Parameter {
                lower: SMALLEST_BODY * facts.inertia,
                ..Parameter::strength_up_to("inertia", LARGEST_BODY * facts.inertia)
            },
            Parameter::simplifying_shape("stiffness", slowest, fastest),
            Parameter::simplifying_shape("damping", LEAST_DECAY / facts.duration, MOST_DAMPED * fastest),
        ]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn is_flexible(&self) -> bool {
        true
    }

    fn applies(&self, _facts: &Scales, nominal: &Nominal) -> bool {
        nominal.stiffness() > 0.0
    }

    fn values(&self, fitted: &[f64]) -> Vec<f64> {
        let mut values = fitted.to_vec();
        if let [inertia, stiffness, damping] = values.as_mut_slice() {
            *stiffness = *stiffness * *stiffness * *inertia;
            *damping *= 2.0 * *inertia;
        }
        values
    }

    fn fitted(&self, values: &[f64]) -> Vec<f64> {
        let mut fitted = values.to_vec();
        if let [inertia, stiffness, damping] = fitted.as_mut_slice() {
            *stiffness = (*stiffness / *inertia).sqrt();
            *damping /= 2.0 * *inertia;
        }
        fitted
    }

    fn slopes(&self, fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        let &[inertia, frequency, rate] = fitted else { return Vec::new() };
        vec![
            (1, 0, frequency * frequency),
            (1, 1, 2.0 * inertia * frequency),
            (2, 0, 2.0 * rate),
            (2, 2, 2.0 * inertia),
        ]
    }

    /// Returns `false` if the second body hardly swings at all, which is a drift, or if its line is not clear
    /// of the swing's line or a harmonic: it lies within its own half-width, or less than half a turn away
    /// over the record. Such a line shows a damping or a force that changes with amplitude, or clocks that
    /// differ. Only if the body is struck once, at the start of a record, does its decay tell it from the
    /// harmonic of order n, which decays n times as fast as the swing.
    ///
    /// At the limits of its parameters' ranges, a second body whose mode does not decay within the records is
    /// a forcing, and one that is much slower than the swing is a drift.
    fn is_itself(&self, fitted: &[f64], swing: &MainMode<'_>) -> bool {
        let &[body, mode, rate] = fitted else { return true };
        let line = mode * (1.0 + body / swing.inertia).sqrt();
        let order = (line / swing.frequency).round().max(1.0);
        // Beside the swing itself the line has to be clear of the swing's own line too.
        let width = if order > 1.0 { rate } else { rate.max(swing.decay_rate) };
        let apart = (line - order * swing.frequency).abs() > width.max(0.5 * swing.resolution);
        let harmonic = order * swing.decay_rate;
        let differs = rate > ANOTHER_DECAY * harmonic || rate * ANOTHER_DECAY < harmonic;
        let decays_apart = swing.starts_once && order > 1.0 && differs;
        // Every law along a path that a drive repeats has lines at the multiples of the repetition.
        let repeated = swing.repeats.is_some_and(|own| own.has(line));
        rate <= MOST_DAMPED * mode && (apart || decays_apart) && !repeated
    }

    fn free_hidden(&self) -> &'static [Hidden] {
        &[Hidden::Position, Hidden::Velocity]
    }

    /// A second body moves along at low frequency.
    fn stiffness_and_damping(&self, _: &Values<f64>, _: &Moment<f64>, _: &Scales) -> [f64; 2] {
        [0.0, 0.0]
    }

    /// The frequencies come from the residual; a fit begins at them without columns.
    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        Vec::new()
    }

    fn starts(&self, facts: &Scales, inertia: f64, residual: &dyn Lines) -> Vec<(Vec<f64>, f64)> {
        let body = first_body(facts, residual.longest_span()) * inertia;
        let modes = residual.decaying(MODES).into_iter().chain(residual.driven(MODES));
        let start = |mode: Mode| {
            let inertia = mode.inertia.map_or(body, |inertia| inertia.min(body));
            (vec![inertia, mode.frequency, mode.rate], mode.gain)
        };
        modes.map(start).collect()
    }
}
