//! A second body tied on by a spring.

use super::{CandidateLaw, EvidenceClass, Lines, MainMode, Mode, Parameter};
use crate::data::scales::Scales;
use dynamics::{Effect, Moment, Nominal, SystemEffect, Values};

/// A second mode's decay over the longest record as a logarithm at least, and its damping ratio at most.
const LEAST_DECAY: f64 = 0.3;
const MOST_DAMPED: f64 = 0.7;

/// A second body's part of the inertia: smaller ones move nothing, larger ones are the body themselves.
const SMALLEST_BODY: f64 = 1e-9;
const LARGEST_BODY: f64 = 1e2;

/// Factor in the decay rate, either way, beyond which a line at a harmonic is another body's. Those by which a second
/// body stands in for a sensor that is not linear decayed 0.9 to 1.2 times as fast as the harmonic (training banks).
const ANOTHER_DECAY: f64 = 1.5;

/// A second body to begin with: how many lines, by how much of a radian it puts the swing out of phase over a
/// segment, its part of the inertia at most.
const MODES: usize = 3;
const OUT_OF_PHASE: f64 = 0.1;
const FIRST_BODY: f64 = 0.02;

/// A second body's part of the inertia to begin with: it lowers the swing's frequency by half its part, and
/// over a long segment a body that is not yet where it belongs would lose count of the swings.
fn first_body(facts: &Scales, longest_span: f64) -> f64 {
    let phase = facts.frequency * longest_span;
    (2.0 * OUT_OF_PHASE / phase.max(1.0)).min(FIRST_BODY)
}

/// A second body tied on by a spring: its inertia I, and its stiffness k and damping c as frequency and decay rate on a body
/// at rest, k = I·ω² and c = 2·I·r. These are what a record shows, and no step makes the motion faster than its samples.
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

    /// A second body that hardly swings at all is a drift, and one whose line in the spectrum lies within its
    /// own half-width of the swing's or of a harmonic, or comes to less than half a turn beside it, is no second line: it shows a damping or
    /// a force that changes with amplitude, or clocks that differ. Only where it is struck once, at a record's beginning, does its decay tell it
    /// from the harmonic of order n: that one decays n times as fast as the swing. At the ends of its
    /// parameters' ranges one whose mode does not decay within the records is a forcing, one much slower than
    /// the swing a drift.
    fn is_itself(&self, fitted: &[f64], swing: &MainMode) -> bool {
        let &[body, mode, rate] = fitted else { return true };
        let line = mode * (1.0 + body / swing.inertia).sqrt();
        let order = (line / swing.frequency).round().max(1.0);
        // Beside the swing itself it has to stand clear of the swing's own line too.
        let width = if order > 1.0 { rate } else { rate.max(swing.decay_rate) };
        let apart = (line - order * swing.frequency).abs() > width.max(0.5 * swing.resolution);
        let harmonic = order * swing.decay_rate;
        let differs = rate > ANOTHER_DECAY * harmonic || rate * ANOTHER_DECAY < harmonic;
        let decays_apart = swing.starts_once && order > 1.0 && differs;
        rate <= MOST_DAMPED * mode && (apart || decays_apart)
    }

    fn free_hidden(&self) -> usize {
        2
    }

    /// A second body moves along at low frequency.
    fn stiffness_and_damping(&self, _: &Values<f64>, _: &Moment<f64>, _: &Scales) -> [f64; 2] {
        [0.0, 0.0]
    }

    /// Its frequencies come from the residual, and it begins a fit there without columns.
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
