//! Ablations: fits without a method's learned part, which measure its contribution.

use super::method::{Method, Request};
use envelope::Envelope;
use estimator::{Ablation, Estimand, Reached};
use oracle::linfa_decay_rate;
use results::{AblationRow, Failure, Family, MethodEstimate, MethodOutcome, MethodRow};
use std::time::Instant;

/// Fits the first seed without each part that can be removed; empty for a method that learns nothing.
pub(crate) fn ablations(
    method: &Method,
    envelope: &Envelope,
    seed: u64,
    request: &Request<'_>,
    oracle: f64,
) -> Vec<AblationRow> {
    if !method.has_ablations() {
        return Vec::new();
    }
    // Trained only once if the training does not depend on the envelope.
    let trained = method.pretrained_quietly(seed, request);
    let error_percent =
        |rate: &f64| scoring::error_percent(envelope.damping_ratio(*rate), envelope.damping_ratio(oracle));
    let row = |ablation: Ablation| {
        let found = match &trained {
            _ if request.cancel.is_requested() => Err(Failure::NotBegun),
            Ok(trained) => {
                trained.fit_without(ablation, envelope, seed, request).map_err(|error| Failure::of(&error))
            }
            Err(error) => Err(Failure::of(error)),
        };
        let error = found.as_ref().map(error_percent);
        AblationRow {
            ablation,
            error_percent: error.ok().filter(|error| error.is_finite()),
            failure: found.err(),
        }
    };
    Ablation::ALL.map(row).into()
}

/// Fits the same line with linfa-linear on linfa's data set.
pub(crate) fn linfa(envelope: &Envelope, oracle: f64, tolerance_percent: f64) -> MethodRow {
    let start = Instant::now();
    let outcome = match linfa_decay_rate(envelope) {
        Err(error) => MethodOutcome::Failed { reason: Failure::of(&error) },
        Ok((decay_rate, _)) => {
            let zeta = envelope.damping_ratio(decay_rate);
            let error_percent = scoring::error_percent(zeta, envelope.damping_ratio(oracle));
            MethodOutcome::Estimate(MethodEstimate {
                decay_rate,
                zeta,
                zeta_std_error: None,
                error_percent,
                median_error_percent: error_percent,
                worst_error_percent: error_percent,
                digits_of_agreement: scoring::digits_of_agreement(error_percent),
                seeds: 1,
                steps: 0,
                // Intercept and slope.
                parameters: 2,
                seconds: start.elapsed().as_secs_f64(),
                reached: Reached::Converged,
                stopped_because: "solved in closed form, by QR".to_owned(),
                pass: scoring::passes(error_percent, tolerance_percent),
                ablations: Vec::new(),
            })
        }
    };
    MethodRow {
        number: None,
        id: "linfa-linear".to_owned(),
        title: "linfa and linfa-linear".to_owned(),
        family: Family::Library,
        estimand: Estimand::LeastSquares,
        excused: false,
        outcome,
    }
}
