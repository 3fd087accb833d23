//! Hysteresis that bends in another way than Dahl's law, or hardly slides.

use super::hysteresis::{Hysteresis, bent_at_first};
use super::{Along, CandidateLaw, EvidenceClass, Hidden, Parameter};
use crate::data::scales::Scales;
use dynamics::{Active, Effect, Moment, SystemEffect, Values};

/// Initial softenings and exponents.
const FORMS: [[f64; 2]; 3] = [[-0.8, 1.0], [0.7, 1.0], [0.3, 2.0]];

/// Those at which a large hysteresis is looked for, each at several displacements relative to the amplitude.
const DENSE_FORMS: [[f64; 2]; 5] = [[-1.4, 1.0], [-0.7, 1.0], [0.7, 1.0], [0.2, 2.0], [0.9, 2.0]];
const DENSE_BENDING: [f64; 4] = [0.1, 0.25, 0.6, 1.2];

/// Displacement, relative to the amplitude, with which a fit of another form begins again.
const BENDING: f64 = 0.3;

/// Limits of the displacement over the largest deflection, and of the softening. A contact that bends further is a
/// spring, and one of a larger softening loses hardly anything.
const LEAST_BENT: f64 = 1e-3;
const MOST_BENT: f64 = 10.0;
const MOST_SOFT: f64 = 3.0;

/// Longest step along the motion, relative to the displacement.
const STEP: f64 = 0.25;

/// Hysteresis after Bouc and Wen: Dahl's parameters, the softening and the exponent. Since the contact may remember
/// its bending for many swings, each segment starts with a hidden state of its own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoucWen;

impl CandidateLaw for BoucWen {
    fn effect(&self) -> Effect {
        Hysteresis.effect()
    }

    fn evidence_class(&self) -> EvidenceClass {
        Hysteresis.evidence_class()
    }

    fn parameters(&self, facts: &Scales) -> Vec<Parameter> {
        let amplitude = facts.amplitude;
        vec![
            Parameter::strength("torque"),
            Parameter::shape("displacement", LEAST_BENT * amplitude, MOST_BENT * amplitude),
            Parameter::shape("softening", -MOST_SOFT, MOST_SOFT),
            Parameter::shape("exponent", 1.0, 3.0),
        ]
    }

    fn is_non_negative(&self) -> bool {
        true
    }

    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        Some(&Hysteresis)
    }

    fn stated(&self, active: &Active) -> Option<Vec<f64>> {
        Hysteresis.stated(active).is_none().then(|| active.values().to_vec())
    }

    fn free_hidden(&self) -> &'static [Hidden] {
        &[Hidden::Share]
    }

    fn stiffness_and_damping(&self, values: &Values<f64>, moment: &Moment<f64>, facts: &Scales) -> [f64; 2] {
        Hysteresis.stiffness_and_damping(values, moment, facts)
    }

    fn shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        let shape =
            |[softening, exponent]: [f64; 2]| vec![1.0, BENDING * facts.amplitude, softening, exponent];
        FORMS.map(shape).to_vec()
    }

    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        let displacements = DENSE_BENDING.map(|part| part * facts.amplitude);
        let of = |displacement| {
            DENSE_FORMS.map(|[softening, exponent]| vec![1.0, displacement, softening, exponent])
        };
        displacements.into_iter().flat_map(of).collect()
    }

    /// A first-order change cannot tell the law from Dahl's, which leads to it.
    fn shapes_for(&self, _facts: &Scales, _residual: &dyn super::Lines) -> Vec<Vec<f64>> {
        Vec::new()
    }

    fn columns(&self, shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        let &[_, displacement, softening, exponent] = shape else { return Vec::new() };
        vec![(along.respond)(&bending([1.0, displacement, softening, exponent], along))]
    }
}

/// Returns −z along a motion that does not reverse between samples, by steps of fourth order.
fn bending(values: Values<f64>, along: &Along<'_>) -> Vec<f64> {
    let [_, displacement, ..] = values;
    let mut z = bent_at_first(displacement, along);
    let mut torque = vec![-z];
    for (index, (before, after)) in along.position.iter().zip(along.position.iter().skip(1)).enumerate() {
        let way = after - before;
        let steps = (way.abs() / (STEP * displacement)).ceil().max(1.0);
        let h = way / steps;
        let here = Moment { velocity: 1.0, direction: way.signum(), ..along.moment(index) };
        let slope = |z: f64| {
            let at = Moment { hidden: [z, 0.0], ..here };
            let at = Moment { region: SystemEffect::Hysteresis.region(&values, &at), ..at };
            let [slope, _] = SystemEffect::Hysteresis.hidden_rate(&values, &at);
            slope
        };
        for _ in 0..steps as usize {
            let first = slope(z);
            let second = slope(z + 0.5 * h * first);
            let third = slope(z + 0.5 * h * second);
            let last = slope(z + h * third);
            z += h / 6.0 * (first + 2.0 * second + 2.0 * third + last);
        }
        torque.push(-z);
    }
    torque
}
