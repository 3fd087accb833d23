//! Coefficients with units and intervals, as the answer gives them.

use crate::answer::{Calibrated, Interval, ParameterEstimate};
use crate::candidate::{Candidate, Distortion};
use crate::error::DiagnosisError;
use crate::fit::Fit;
use crate::hypothesis::Calibrated as Coefficient;
use crate::matrices::{entry, set};
use crate::statistics::normal_above;
use crate::work::Work;
use dynamics::Units;
use nalgebra::DMatrix;
use record::Quantity;

/// Variance that the inverse of the normal equations is a multiple of: the residual's, for as many samples as its
/// autocorrelation leaves.
fn variance(fit: &Fit) -> f64 {
    fit.squares / fit.freedom() * fit.autocorrelation_time()
}

fn around(value: f64, error: f64) -> Interval {
    let reach = normal_above(0.025) * error;
    Interval { value, interval_95: [value - reach, value + reach] }
}

/// A global parameter with its interval.
fn interval(fit: &Fit, index: usize) -> Interval {
    let value = fit.point.globals.get(index).copied().unwrap_or_default();
    around(value, (variance(fit) * entry(&fit.inverse, index, index)).max(0.0).sqrt())
}

/// Standard errors of a law's parameters, whose fitted ones begin at a place among the globals.
fn spread(fit: &Fit, candidate: Candidate, at: usize, fitted: &[f64]) -> Vec<f64> {
    let count = fitted.len();
    let mut change = DMatrix::identity(count, count);
    for (row, column, slope) in candidate.slopes(fitted) {
        set(&mut change, row, column, slope);
    }
    let own = DMatrix::from_fn(count, count, |i, j| entry(&fit.inverse, at + i, at + j));
    let covariance = &change * own * change.transpose() * variance(fit);
    covariance.diagonal().iter().map(|square| square.max(0.0).sqrt()).collect()
}

/// What a fit says of an effect's parameters.
pub(crate) fn parameters(work: &Work<'_>, fit: &Fit, candidate: Candidate) -> Vec<ParameterEstimate> {
    let facts = &work.data.facts;
    let units = fit.hypothesis.nominal.units();
    let mut at = fit.hypothesis.calibrated.len();
    for own in &fit.hypothesis.candidates {
        let parameters = own.parameters(facts);
        if *own == candidate {
            let fitted = fit.point.globals.get(at..at + parameters.len()).unwrap_or_default();
            let spread = spread(fit, *own, at, fitted);
            let mut estimates: Vec<ParameterEstimate> = parameters
                .iter()
                .zip(own.values(fitted))
                .zip(spread)
                .enumerate()
                .map(|(index, ((parameter, value), error))| ParameterEstimate {
                    name: parameter.name,
                    unit: unit(candidate, index, units, work.data.quantity),
                    estimate: around(value, error),
                })
                .collect();
            if candidate == Candidate::Chain(Distortion::ReadingHysteresis) {
                // Read off the values, without a fit.
                let unit = unit(candidate, 0, units, work.data.quantity);
                estimates.insert(
                    0,
                    ParameterEstimate { name: "step", unit, estimate: around(facts.resolution, 0.0) },
                );
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
                Distortion::Nonlinearity | Distortion::Saturation | Distortion::ReadingHysteresis => position,
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
