//! Interface of a candidate to the rest of the diagnosis.

use super::{Along, EvidenceClass, Hidden, Lines, MainMode, Parameter};
use crate::data::scales::Scales;
use crate::model::sensor::Sensor;
use dynamics::scalar::Dual;
use dynamics::{Active, Coefficients, Effect, Moment, Nominal, Quantity, Values};
use std::any::Any;

/// Effect in the form that a diagnosis fits.
///
/// The required methods have no sensible default: the effect, its class, its parameters, and the sign of its
/// linear coefficients. All others default to what is right for a torque that depends smoothly on the state
/// and is linear in its one parameter. So an effect's file states only what is special about it.
pub(crate) trait CandidateLaw: Any + Sync {
    /// Returns the effect of the dynamics that is fitted. Its description gives id, budget class, units and
    /// literature.
    fn effect(&self) -> Effect;

    /// Returns the class of effects that act alike to which this one belongs.
    fn evidence_class(&self) -> EvidenceClass;

    /// Returns the fit parameters with bounds; [`Self::values`] converts them to those of the law.
    fn parameters(&self, facts: &Scales) -> Vec<Parameter>;

    /// Returns `true` if the coefficients of [`Self::columns`] cannot be negative.
    fn is_non_negative(&self) -> bool;

    /// Returns `true` if the effect is flexible: it can act anywhere on a record and absorb what no law
    /// explains, such as a stop at any deflection, a line at any frequency, or a spring or clock that drifts.
    /// Default: `false`; its shape follows from the motion, or from time alone.
    fn is_flexible(&self) -> bool {
        false
    }

    /// Returns `true` if any mechanism may have the effect: dry friction, drag, a weight, a nonlinear spring.
    /// Default: `false`.
    fn is_plain(&self) -> bool {
        false
    }

    /// Returns the class that an unnamed law belongs to by its mechanism: a set with the law does not count
    /// as a set without the class. Default: `None`.
    fn stands_for(&self) -> Option<EvidenceClass> {
        None
    }

    /// Returns `true` if the effect counts toward the size of a set. Default: `true`.
    fn counts(&self) -> bool {
        true
    }

    /// Returns `true` if the effect can act on these records at all. Default: `true`.
    fn applies(&self, _facts: &Scales, _nominal: &Nominal) -> bool {
        true
    }

    /// Returns `true` if a fit of records of a quantity can include the effect. Default: `true`.
    fn is_observed_in(&self, _quantity: record::Quantity) -> bool {
        true
    }

    /// Returns `true` if the motion depends smoothly on the effect's parameters. Default: as the law's
    /// description says; an effect of the measurement chain does not change the motion.
    fn is_smooth(&self) -> bool {
        match self.effect() {
            Effect::System(effect) => effect.description().smooth,
            Effect::MeasuringChain(_) => true,
        }
    }

    /// Returns the ids of effects that this one is easily confused with. Default: those of its description.
    fn resembles(&self) -> &'static [&'static str] {
        self.effect().description().confused_with
    }

    /// Returns the candidate that this one becomes at one of its own sizes. A set never holds both. Default:
    /// `None`.
    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        None
    }

    /// Returns the simpler candidate that this one tends to at an end of its shape, with the same first
    /// parameters. Default: the one that it generalizes.
    fn tends_to(&self) -> Option<&'static dyn CandidateLaw> {
        self.generalizes()
    }

    /// Returns the quantity that a fit parameter measures. Default: that of the law's parameter at the same
    /// index.
    fn quantity(&self, index: usize) -> Quantity {
        self.effect()
            .description()
            .parameters
            .get(index)
            .map_or(Quantity::Ratio, |parameter| parameter.quantity)
    }

    /// Returns the law's parameters that a fit moves, of an effect that a nominal simulator has; `None` if
    /// this one cannot be fitted. Default: all of them.
    fn stated(&self, active: &Active) -> Option<Vec<f64>> {
        Some(active.values().to_vec())
    }

    /// Converts fit parameters to those of the law. Default: the same.
    fn values(&self, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }

    /// Converts the law's parameters to fit parameters: the inverse of [`Self::values`].
    fn fitted(&self, values: &[f64]) -> Vec<f64> {
        values.to_vec()
    }

    /// Returns the derivatives of [`Self::values`]: row, column and value of each entry that differs from the
    /// unit matrix.
    fn slopes(&self, _fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        Vec::new()
    }

    /// Returns `true` if the effect with these fit parameters deserves its name, beside a swing. Default:
    /// `true`.
    fn is_itself(&self, _fitted: &[f64], _swing: &MainMode<'_>) -> bool {
        true
    }

    /// Returns the hidden state variables that are unknown at the start of a segment in the middle of a record
    /// and have to be fitted. Default: none.
    fn free_hidden(&self) -> &'static [Hidden] {
        &[]
    }

    /// Returns the index, among the parameters, of the displacement over which a contact bends before it
    /// slides. In a segment in the middle of a record, its hidden state starts as that of a steady swing.
    /// Default: `None`, no such contact.
    fn bending_displacement(&self) -> Option<usize> {
        None
    }

    /// Returns `true` if the torque is that of a weight: it moves the equilibrium, adds to the stiffness
    /// against small swings, and turns with the mount; its two fit parameters are both components of the
    /// torque. Default: `false`.
    fn is_weight(&self) -> bool {
        false
    }

    /// Returns the stiffness −∂τ/∂θ and the damping −∂τ/∂θ̇ that the effect adds at a moment, for small
    /// deviations of the motion. Default: the law's own derivatives at the given hidden state; zero for the
    /// measurement chain.
    fn stiffness_and_damping(&self, values: &Values<f64>, moment: &Moment<f64>, _facts: &Scales) -> [f64; 2] {
        match self.effect() {
            Effect::System(effect) => {
                let region = effect.region(values, moment);
                let torque = effect.torque(&values.map(Dual::<2>::from), &differentiated(moment, region));
                torque.partials.map(|slope| -slope)
            }
            Effect::MeasuringChain(_) => [0.0, 0.0],
        }
    }

    /// Returns the shapes at which the effect is tried: fit parameters with unit coefficients. Default: its
    /// only parameter is its coefficient.
    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0]]
    }

    /// Returns the shapes at which a large effect is looked for along the measured motion, densely enough that a
    /// fit converges from the closest. Default: [`Self::shapes`].
    fn dense_shapes(&self, facts: &Scales) -> Vec<Vec<f64>> {
        self.shapes(facts)
    }

    /// Returns `true` if the effect's one parameter is its shape, so that its torque is not linear in it.
    /// Default: `false`.
    fn is_its_own_shape(&self) -> bool {
        false
    }

    /// Returns the shapes given the residual of a fit. Default: [`Self::shapes`].
    fn shapes_for(&self, facts: &Scales, _residual: &dyn Lines) -> Vec<Vec<f64>> {
        self.shapes(facts)
    }

    /// Returns `true` if the shapes are the best of as many as the residual has frequencies; their gain then
    /// has to exceed the best one by chance. Default: `false`, they are not chosen from the residual.
    fn is_chosen_by_frequency(&self) -> bool {
        false
    }

    /// Returns parameters at which a fit begins, each with its approximate gain in squares, for an effect
    /// without columns. Default: none.
    fn starts(&self, _facts: &Scales, _inertia: f64, _residual: &dyn Lines) -> Vec<(Vec<f64>, f64)> {
        Vec::new()
    }

    /// Returns the law's values whose torque responses are the columns at a shape. Default: the shape itself.
    fn unit_values(&self, shape: &[f64], _facts: &Scales) -> Vec<Vec<f64>> {
        vec![shape.to_vec()]
    }

    /// Returns the first-order changes of the observed values by each of the linear coefficients, at a shape.
    /// Default: the responses to the law's own torque at [`Self::unit_values`]. A candidate of the
    /// measurement chain has no torque and has to provide its own columns: without them it never enters a
    /// set.
    fn columns(&self, shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        match self.effect() {
            Effect::System(effect) => {
                let units = self.unit_values(shape, along.facts);
                units.iter().map(|values| along.response_to(effect, values)).collect()
            }
            Effect::MeasuringChain(_) => Vec::new(),
        }
    }

    /// Returns the indices of the linear parameters among all, one for each column. Default: the first.
    fn linear_places(&self) -> &'static [usize] {
        &[0]
    }

    /// Returns the parameters that the coefficients of the columns stand for, at a shape. Default: the shape
    /// with the coefficients at [`Self::linear_places`].
    fn linear_parameters(&self, shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
        let mut parameters = shape.to_vec();
        for (&place, coefficient) in self.linear_places().iter().zip(coefficients) {
            if let Some(slot) = parameters.get_mut(place) {
                *slot = *coefficient;
            }
        }
        parameters
    }

    /// Adds the effect on readings to a sensor. Default: nothing, since the effect acts in the system.
    fn read(&self, _values: &[f64], _sensor: &mut Sensor) {}

    /// Returns the index of the derivative by a parameter in
    /// [`crate::model::sensor::Observed::by_parameter`]. Default: `None`; readings depend on the parameter by
    /// way of the motion.
    fn sensor_derivative(&self, _parameter: usize) -> Option<usize> {
        None
    }

    /// Returns `true` if readings lag behind the motion by the effect's one parameter: see
    /// [`crate::model::encoder_hysteresis`]. Default: `false`.
    fn holds_readings(&self) -> bool {
        false
    }

    /// Returns the name of the law's parameter that is the sensor's step, which the values show without a
    /// fit. Default: `None`.
    fn step_parameter(&self) -> Option<&'static str> {
        None
    }
}

/// Returns the moment with derivatives by position and velocity, in a region.
fn differentiated(moment: &Moment<f64>, region: i8) -> Moment<Dual<2>> {
    let constant = Dual::<2>::from;
    let c = &moment.nominal;
    Moment {
        time: constant(moment.time),
        position: Dual::variable(moment.position, 0),
        velocity: Dual::variable(moment.velocity, 1),
        input: constant(moment.input),
        input_rate: constant(moment.input_rate),
        hidden: moment.hidden.map(constant),
        nominal: Coefficients {
            inertia: constant(c.inertia),
            damping: constant(c.damping),
            stiffness: constant(c.stiffness),
            rest_angle: constant(c.rest_angle),
            input_gain: constant(c.input_gain),
        },
        direction: moment.direction,
        region,
    }
}

/// Scales the values of a grid and makes each into a shape.
pub(crate) fn grid(scale: f64, parts: &[f64], shape: impl Fn(f64) -> Vec<f64>) -> Vec<Vec<f64>> {
    parts.iter().map(|part| shape(part * scale)).collect()
}

/// Returns the parameters of an effect that is its own shape: corrected by the coefficient of its secant,
/// within limits.
pub(crate) fn secant(shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
    shape.iter().zip(coefficients).map(|(size, coefficient)| size * coefficient.clamp(0.3, 3.0)).collect()
}

/// Returns `true` if records show a drive whose spring or damping may be software: a servo that follows an input.
pub(crate) fn has_drive(facts: &Scales, nominal: &Nominal) -> bool {
    facts.input_torque > 0.0 && (nominal.stiffness() > 0.0 || nominal.damping() > 0.0)
}
