//! Coefficients with units and intervals, as the answer gives them.

use crate::answer::{Calibrated, Interval, ParameterEstimate};
use crate::candidate::{Candidate, Distortion};
use crate::error::DiagnosisError;
use crate::fit::Fit;
use crate::hypothesis::Calibrated as Coefficient;
use crate::statistics::normal_above;
use crate::work::Work;
use dynamics::{SystemEffect, Units};
use record::Quantity;

/// Standard error of a global parameter, widened for the residual's autocorrelation.
fn interval(fit: &Fit, index: usize) -> Interval {
    let value = fit.point.globals.get(index).copied().unwrap_or_default();
    let variance = fit.squares / fit.freedom() * fit.autocorrelation_time() * fit.inverse[(index, index)];
    let reach = normal_above(0.025) * variance.max(0.0).sqrt();
    Interval { value, interval_95: [value - reach, value + reach] }
}

pub(crate) fn parameters(work: &Work<'_>, fit: &Fit, candidate: Candidate) -> Vec<ParameterEstimate> {
    let facts = &work.data.facts;
    let units = fit.hypothesis.nominal.units();
    let mut at = fit.hypothesis.calibrated.len();
    for own in &fit.hypothesis.candidates {
        let parameters = own.parameters(facts);
        if *own == candidate {
            let mut estimates: Vec<ParameterEstimate> = parameters
                .iter()
                .enumerate()
                .map(|(index, parameter)| ParameterEstimate {
                    name: parameter.name,
                    unit: unit(candidate, index, units, work.data.quantity),
                    estimate: interval(fit, at + index),
                })
                .collect();
            // The second parameter of Stribeck friction is fitted as an excess over the first.
            if candidate == Candidate::System(SystemEffect::StribeckFriction) {
                let first = estimates.first().map_or(0.0, |estimate| estimate.estimate.value);
                if let Some(second) = estimates.get_mut(1) {
                    second.estimate.value += first;
                    second.estimate.interval_95 = second.estimate.interval_95.map(|end| end + first);
                }
            }
            return estimates;
        }
        at += parameters.len();
    }
    Vec::new()
}

fn unit(candidate: Candidate, index: usize, units: Units, quantity: Quantity) -> String {
    match candidate {
        Candidate::System(effect) => effect
            .description()
            .parameters
            .get(index)
            .map_or_else(String::new, |parameter| parameter.quantity.unit(units).to_owned()),
        Candidate::Chain(distortion) => {
            let position = match quantity {
                Quantity::Position => dynamics::Quantity::Position.unit(units).to_owned(),
                Quantity::Velocity => dynamics::Quantity::Velocity.unit(units).to_owned(),
                Quantity::Acceleration => format!("{}/s", dynamics::Quantity::Velocity.unit(units)),
            };
            match distortion {
                Distortion::Lag => "s".to_owned(),
                Distortion::Nonlinearity if index == 1 => "rad".to_owned(),
                Distortion::Nonlinearity | Distortion::Saturation => position,
                Distortion::Drift => format!("{position}/s"),
                Distortion::Clock => "1/s".to_owned(),
            }
        }
    }
}
pub(crate) fn calibration(work: &Work<'_>, repaired: &Fit) -> Result<Vec<Calibrated>, DiagnosisError> {
    let base = &work.base.calibrated;
    let coefficients = base.hypothesis.nominal.coefficients();
    let all = [Coefficient::Inertia, Coefficient::Damping, Coefficient::Stiffness, Coefficient::RestAngle];
    Ok(all
        .into_iter()
        .map(|which| {
            let place = base.hypothesis.calibrated.iter().position(|own| *own == which);
            Calibrated {
                name: which.name(),
                nominal: which.of(&coefficients),
                recalibrated: place.map(|place| interval(base, place)),
                repaired: place.map(|place| interval(repaired, place)),
            }
        })
        .collect())
}
