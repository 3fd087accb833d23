//! Friction with a pre-sliding spring, after Dahl.
//!
//! Sets with a contact that hardly slides are kept, with its displacement at its bound: discarding them discarded the
//! path to the sets that they lead to.

use super::coulomb_friction::CoulombFriction;
use super::{Along, CandidateLaw, EvidenceClass, Parameter, grid};
use crate::data::scales::Scales;
use crate::model::contact::bent;
use dynamics::{Active, Effect, Moment, SystemEffect, Values};

/// Initial displacements, relative to the amplitude.
const BENDING: [f64; 4] = [0.005, 0.02, 0.06, 0.2];

/// Displacements at which a large hysteresis is looked for.
const DENSE_BENDING: [f64; 7] = [0.005, 0.015, 0.04, 0.08, 0.14, 0.2, 0.28];

/// Maximum displacement over the largest deflection. A contact that bends further hardly slides in most of a
/// record: it acts as a spring and a loss that grow with the amplitude, as other laws do.
const MOST_BENT: f64 = 0.3;

/// Friction with a pre-sliding spring: the torque while sliding, and the displacement over which it builds
/// up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hysteresis;

impl CandidateLaw for Hysteresis {
    fn effect(&self) -> Effect {
        Effect::System(SystemEffect::Hysteresis)
    }

    fn evidence_class(&self) -> EvidenceClass {
        EvidenceClass::Friction
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let amplitude = facts.amplitude;
        vec![
            Parameter::strength("torque"),
            Parameter::shape("displacement", 1e-3 * amplitude, MOST_BENT * amplitude),
        ]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    /// Hysteresis that builds up at once is Coulomb friction.
    fn tends_to(&self) -> Option<&'static dyn CandidateLaw> {
        Some(&CoulombFriction)
    }

    fn bending_displacement(&self) -> Option<usize> {
        Some(1)
    }

    /// Values of the general law are those of [`BoucWen`](super::bouc_wen::BoucWen).
    fn stated(&self, active: &Active) -> Option<Vec<f64>> {
        let &[torque, displacement, softening, exponent] = active.values() else { return None };
        (softening == 0.0 && exponent == 1.0).then(|| vec![torque, displacement])
    }

    /// A bent contact is a spring while it bends.
    fn stiffness_and_damping(
        &self,
        values @ &[torque, displacement, ..]: &Values<f64>,
        moment: &Moment<f64>,
        facts: &Scales,
    ) -> [f64; 2] {
        let deflection = moment.position - (moment.nominal.rest_angle + facts.rest_moved);
        let z = bent(deflection, moment.velocity / facts.frequency, displacement).z;
        let along = Moment { velocity: moment.direction, hidden: [z, 0.0], ..*moment };
        let along = Moment { region: SystemEffect::Hysteresis.region(values, &along), ..along };
        let [rate, _] = SystemEffect::Hysteresis.hidden_rate(values, &along);
        [torque * (rate * moment.direction).max(0.0), 0.0]
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.amplitude, &BENDING, |displacement| vec![1.0, displacement])
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        grid(facts.amplitude, &DENSE_BENDING, |displacement| vec![1.0, displacement])
    }

    fn columns(&self, shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        let &[_, displacement] = shape else { return Vec::new() };
        vec![(along.respond)(&bending(displacement, along))]
    }
}

/// Returns z of Dahl's law at the first sample of a motion: that of a steady swing, and none where a record begins.
pub(super) fn bent_at_first(displacement: f64, along: &Along<'_>) -> f64 {
    let rest = along.nominal.rest_angle + along.facts.rest_moved;
    match (along.position.first(), along.velocity.first()) {
        (Some(position), Some(velocity)) if !along.first => {
            bent(position - rest, velocity / along.facts.frequency, displacement).z
        }
        _ => 0.0,
    }
}

/// Returns −z of Dahl's law along a motion: exact between samples if the motion does not reverse.
fn bending(displacement: f64, along: &Along<'_>) -> Vec<f64> {
    let position = along.position;
    let mut z = bent_at_first(displacement, along);
    let mut torque = vec![-z];
    for (before, after) in position.iter().zip(position.iter().skip(1)) {
        let way = after - before;
        let direction = if way < 0.0 { -1.0 } else { 1.0 };
        z = direction - (direction - z) * libm::exp(-way.abs() / displacement);
        torque.push(-z);
    }
    torque
}
