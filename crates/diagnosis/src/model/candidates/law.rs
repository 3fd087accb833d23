//! What a candidate is to a diagnosis.

use super::{Along, EvidenceClass, Lines, MainMode, Parameter};
use crate::data::scales::Scales;
use crate::model::sensor::Sensor;
use dynamics::scalar::Dual;
use dynamics::{Active, Coefficients, Effect, Moment, Nominal, Quantity, Values};

/// An effect as a diagnosis fits it.
///
/// Required is what no default could be right for: which effect it is, its class, its parameters, whether its
/// linear coefficients have a sign. The rest has a default that is right for a torque which depends smoothly on the state
/// and is linear in its one parameter, so that a file states what is special about its effect and nothing else.
pub(crate) trait CandidateLaw: Sync {
    /// The effect of the dynamics that it fits; id, budget class, units and literature are those of its description.
    fn effect(&self) -> Effect;

    /// The class of effects that explain alike to which it belongs.
    fn evidence_class(&self) -> EvidenceClass;

    /// Parameters as a fit moves them, with bounds; [`Self::values`] turns them into the law's.
    fn parameters(&self, facts: &Scales) -> Vec<Parameter>;

    /// Whether the coefficients of its [`Self::columns`] cannot be negative.
    fn is_non_negative(&self) -> bool;

    /// Whether it can sit where it likes on a record and soak up what no law explains: a stop at any deflection, a line at
    /// any frequency, a drift. Default: it cannot; its shape follows from the motion.
    fn is_flexible(&self) -> bool {
        false
    }

    /// Whether every mechanism may be expected to have it: dry friction, drag, a weight, a spring that bends. Default: not.
    fn is_plain(&self) -> bool {
        false
    }

    /// The class that a law without a name belongs to by its mechanism: a set with it is no set without the class. Default: none.
    fn stands_for(&self) -> Option<EvidenceClass> {
        None
    }

    /// Whether it takes one of the places that a set has. Default: it does.
    fn counts(&self) -> bool {
        true
    }

    /// Whether it can act on these records at all. Default: on all.
    fn applies(&self, _facts: &Scales, _nominal: &Nominal) -> bool {
        true
    }

    /// Whether a fit of records of a quantity can follow it. Default: of any.
    fn is_observed_in(&self, _quantity: record::Quantity) -> bool {
        true
    }

    /// Whether the motion depends smoothly on its parameters. Default: as the law's description says; what a fit follows in
    /// the measuring chain leaves the motion as it is.
    fn is_smooth(&self) -> bool {
        match self.effect() {
            Effect::System(effect) => effect.description().smooth,
            Effect::MeasuringChain(_) => true,
        }
    }

    /// Ids of effects that it is easily confused with. Default: those of its description.
    fn resembles(&self) -> &'static [&'static str] {
        self.effect().description().confused_with
    }

    /// The candidate that it is at one of its own sizes. A set never holds both. Default: none.
    fn generalizes(&self) -> Option<&'static dyn CandidateLaw> {
        None
    }

    /// The simpler candidate that it tends to at an end of its shape, with the same first parameter. Default: the one
    /// that it generalizes.
    fn tends_to(&self) -> Option<&'static dyn CandidateLaw> {
        self.generalizes()
    }

    /// Quantity that a fitted parameter measures. Default: what the description says of the law's parameter in this place.
    fn quantity(&self, index: usize) -> Quantity {
        self.effect()
            .description()
            .parameters
            .get(index)
            .map_or(Quantity::Ratio, |parameter| parameter.quantity)
    }

    /// The law's parameters that a fit moves, of an effect that a nominal simulator has; none where this one cannot be
    /// fitted. Default: all of them.
    fn stated(&self, active: &Active) -> Option<Vec<f64>> {
        Some(active.values().to_vec())
    }

    /// The law's parameters from a fit's. Default: the same.
    fn values(&self, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }

    /// A fit's parameters from the law's: the inverse of [`Self::values`].
    fn fitted(&self, values: &[f64]) -> Vec<f64> {
        values.to_vec()
    }

    /// Derivatives of [`Self::values`]: row, column and value of what differs from the unit matrix.
    fn slopes(&self, _fitted: &[f64]) -> Vec<(usize, usize, f64)> {
        Vec::new()
    }

    /// Whether fitted values are what the effect's name says, beside a swing. Default: always.
    fn is_itself(&self, _fitted: &[f64], _swing: &MainMode) -> bool {
        true
    }

    /// Number of hidden state variables that a segment in the middle of a record cannot know and has to fit. Default: none.
    fn free_hidden(&self) -> usize {
        0
    }

    /// Place of the displacement over which a contact bends before it slides, among its parameters. Its hidden state is then
    /// that of a steady swing where a segment begins in the middle of a record. Default: no such contact.
    fn bending_displacement(&self) -> Option<usize> {
        None
    }

    /// Whether its torque is a weight's: it moves the equilibrium, adds to the stiffness against small swings, and turns with
    /// the mount; its two fitted parameters are both parts of the torque. Default: it is not.
    fn is_weight(&self) -> bool {
        false
    }

    /// Stiffness −∂τ/∂θ and damping −∂τ/∂θ̇ that it adds at a moment, for small deviations of the motion. Default: the
    /// law's own derivatives at the given hidden state; none for the measuring chain.
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

    /// The shapes that it is tried at: parameters, as the fit moves them, with unit coefficients. Default: its only
    /// parameter is its coefficient.
    fn shapes(&self, _facts: &Scales) -> Vec<Vec<f64>> {
        vec![vec![1.0]]
    }

    /// The same for a fit whose residual can be looked at. Default: [`Self::shapes`].
    fn shapes_for(&self, facts: &Scales, _residual: &dyn Lines) -> Vec<Vec<f64>> {
        self.shapes(facts)
    }

    /// Whether its shapes are the best of as many as the residual has frequencies, which a chance gain has to
    /// outdo. Default: they are not chosen from the residual.
    fn is_chosen_by_frequency(&self) -> bool {
        false
    }

    /// Parameters to begin a fit at, with about what each would take away of the squares, for an effect that no columns
    /// stand for. Default: none; its columns say it.
    fn starts(&self, _facts: &Scales, _inertia: f64, _residual: &dyn Lines) -> Vec<(Vec<f64>, f64)> {
        Vec::new()
    }

    /// The law's values of which each column is the torque's response, at a shape. Default: the shape itself.
    fn unit_values(&self, shape: &[f64], _facts: &Scales) -> Vec<Vec<f64>> {
        vec![shape.to_vec()]
    }

    /// The first-order changes of the observed values, by each of its linear coefficients, at a shape. Default: the responses
    /// to the law's own torque at [`Self::unit_values`]. A candidate of the measuring chain, which has no torque, states its
    /// own: without them it never enters a set.
    fn columns(&self, shape: &[f64], along: &Along<'_>) -> Vec<Vec<f64>> {
        match self.effect() {
            Effect::System(effect) => {
                let units = self.unit_values(shape, along.facts);
                units.iter().map(|values| along.response_to(effect, values)).collect()
            }
            Effect::MeasuringChain(_) => Vec::new(),
        }
    }

    /// Places of its linear parameters among all, one for each of its columns. Default: the first.
    fn linear_places(&self) -> &'static [usize] {
        &[0]
    }

    /// The parameters that the coefficients of its columns stand for, at a shape. Default: the shape with the coefficients
    /// at [`Self::linear_places`].
    fn linear_parameters(&self, shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
        let mut parameters = shape.to_vec();
        for (&place, coefficient) in self.linear_places().iter().zip(coefficients) {
            if let Some(slot) = parameters.get_mut(place) {
                *slot = *coefficient;
            }
        }
        parameters
    }

    /// Adds what it does to readings to a sensor. Default: nothing; it acts in the system.
    fn read(&self, _values: &[f64], _sensor: &mut Sensor) {}

    /// Place of the derivative by a parameter in [`crate::model::sensor::Observed::by_parameter`]. Default: none; readings depend
    /// on the parameter by way of the motion.
    fn sensor_derivative(&self, _parameter: usize) -> Option<usize> {
        None
    }

    /// Whether readings stay behind the motion by its one parameter: see [`crate::measurement::encoder_hysteresis`]. Default: they
    /// do not.
    fn holds_readings(&self) -> bool {
        false
    }

    /// Name of the law's parameter that is the sensor's step, which shows in the values without a fit. Default: none.
    fn step_parameter(&self) -> Option<&'static str> {
        None
    }
}

/// The moment with derivatives by position and velocity, in a region.
fn differentiated(moment: &Moment<f64>, region: i8) -> Moment<Dual<2>> {
    let constant = Dual::<2>::from;
    let c = &moment.nominal;
    Moment {
        time: constant(moment.time),
        position: Dual::variable(moment.position, 0),
        velocity: Dual::variable(moment.velocity, 1),
        input: constant(moment.input),
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

/// Values on a grid relative to a scale, each made into a shape.
pub(crate) fn grid(scale: f64, parts: &[f64], shape: impl Fn(f64) -> Vec<f64>) -> Vec<Vec<f64>> {
    parts.iter().map(|part| shape(part * scale)).collect()
}

/// Parameters of an effect that is its own shape: corrected by the coefficient of its secant, within reason.
pub(crate) fn secant(shape: &[f64], coefficients: &[f64]) -> Vec<f64> {
    shape.iter().zip(coefficients).map(|(size, coefficient)| size * coefficient.clamp(0.3, 3.0)).collect()
}
