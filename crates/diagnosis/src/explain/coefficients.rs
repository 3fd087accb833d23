//! Coefficients with units and intervals, in the form that the answer reports.

#![allow(clippy::indexing_slicing, reason = "callers find the index among the fit's own parameters")]

use crate::answer::{Calibrated, KnownRow, ParameterEstimate};
use crate::evidence::context::Context;
use crate::evidence::determined::says_something;
use crate::fit::fitted::Fit;
use crate::fit::normal_equations::UNBOUNDED;
use crate::model::candidate::Candidate;
use crate::model::hypothesis::{Calibrated as Coefficient, Known};
use crate::noise::statistics::normal_above;
use dynamics::{NominalSimulator, Units};
use record::Quantity;
use results::WithInterval;

pub(crate) fn around(value: f64, error: f64) -> WithInterval {
    // A standard error from [`UNBOUNDED`] counts as infinite, whatever the variance that multiplied it.
    let error = if error < libm::pow(UNBOUNDED, 0.4) { error } else { f64::INFINITY };
    let reach = normal_above(0.025) * error;
    WithInterval { value, interval_95: [value - reach, value + reach] }
}

/// Returns the estimate and 95 % interval of a global parameter.
pub(crate) fn interval(fit: &Fit, index: usize) -> WithInterval {
    around(fit.point.globals[index], (fit.variance() * fit.inverse[(index, index)]).max(0.0).sqrt())
}

/// Returns a fit's estimates of the parameters of one effect; empty if the fit lacks the effect or holds it.
pub(crate) fn parameters(work: &Context<'_>, fit: &Fit, candidate: Candidate) -> Vec<ParameterEstimate> {
    let facts = &work.data.facts;
    let units = fit.hypothesis.nominal.units();
    let parts = fit.hypothesis.all_parts(facts, &fit.point.globals);
    let own = parts.into_iter().find(|(effect, _, _)| *effect == candidate);
    let Some((_, Some(at), fitted)) = own else { return Vec::new() };
    let spread = fit.spread(candidate, at, fitted);
    let named = candidate.parameters(facts).into_iter().zip(candidate.values(fitted)).zip(spread);
    let mut estimates: Vec<ParameterEstimate> = named
        .enumerate()
        .map(|(index, ((parameter, value), error))| {
            let estimate = around(value, error);
            ParameterEstimate {
                name: parameter.name,
                unit: unit(candidate, index, units, work.data.quantity),
                estimate,
                determined: says_something(facts, candidate.quantity(index), &estimate),
            }
        })
        .collect();
    if let Some(name) = candidate.step_parameter() {
        // The step is read off the values, not fitted.
        let unit = unit(candidate, 0, units, work.data.quantity);
        let estimate = around(facts.resolution, 0.0);
        estimates.insert(0, ParameterEstimate { name, unit, estimate, determined: true });
    }
    estimates
}

fn unit(candidate: Candidate, index: usize, units: Units, observed: Quantity) -> String {
    use dynamics::chain::Observed;
    let observed = match observed {
        Quantity::Position => Observed::Position,
        Quantity::Velocity => Observed::Velocity,
        Quantity::Acceleration => Observed::Acceleration,
    };
    candidate.quantity(index).unit_seen(units, observed).to_owned()
}

/// Returns the coefficients of the oscillator as calibrated without candidates and with them.
pub(crate) fn calibration(work: &Context<'_>, repaired: &Fit) -> Vec<Calibrated> {
    let base = &work.base.calibrated;
    let coefficients = base.hypothesis.nominal.coefficients();
    let row = |which: Coefficient| {
        let of = |fit: &Fit| {
            let place = fit.hypothesis.calibrated.iter().position(|own| *own == which);
            place.map(|place| interval(fit, place))
        };
        let after = of(repaired);
        Calibrated {
            name: which.name(),
            nominal: which.of(&coefficients),
            recalibrated: of(base),
            repaired: after,
            determined: after.map(|after| says_something(&work.data.facts, which.quantity(), &after)),
        }
    };
    Coefficient::PLAIN.into_iter().map(row).collect()
}

/// Returns the same for the effects of the nominal simulator that a fit includes.
pub(crate) fn known(work: &Context<'_>, simulator: &NominalSimulator, repaired: &Fit) -> Vec<KnownRow> {
    let base = &work.base.calibrated;
    let own = |known: &Known| {
        let stated = simulator
            .effects()
            .iter()
            .find(|stated| Candidate::of(&stated.active).is_some_and(|(own, _)| own == known.candidate));
        KnownRow {
            id: known.candidate.id(),
            recalibrate: known.recalibrate,
            nominal: stated.map(|stated| stated.active),
            recalibrated: parameters(work, base, known.candidate),
            repaired: parameters(work, repaired, known.candidate),
        }
    };
    base.hypothesis.known.iter().map(own).collect()
}
