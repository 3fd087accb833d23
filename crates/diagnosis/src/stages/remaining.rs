//! Left-over beside the named effects: a torque without a name, noise, and everything else.

use super::{Judged, Refined};

use crate::error::DiagnosisError;
use crate::evidence::context::Context;
use crate::evidence::discrepancy;
use crate::evidence::held_out::HeldOut;
use crate::evidence::left_over::unexplained;
use crate::explain::gap::{Stages, gap};
use crate::explain::position_torque::{Unnamed, unnamed};
use crate::fit::fitted::Fit;
use crate::linear::tangent::Path;
use crate::residual::floor;
use crate::sets::weights::{acts, unknown};
use results::{GapSummary, LeftOverRow};

/// Error, relative to the white noise floor, above which a residual cannot be noise. First-order
/// autoregressive noise stays below it up to a correlation of 0.84 from sample to sample.
const FAR_ABOVE: f64 = 3.0;

/// Left-over, and the size of the gap before and after the repair.
pub(crate) struct Remaining {
    pub(crate) unnamed: Option<Unnamed>,
    /// Standard deviation of the noise.
    pub(crate) noise: f64,
    /// Motion along the unjoined segments.
    pub(crate) paths: Vec<Path>,
    pub(crate) gap: GapSummary,
    /// Mean square that recalibration leaves beyond the noise.
    pub(crate) excess: f64,
    /// Probability that everything missing has no name. `left_over` is the probability that anything is left
    /// beside the named effects.
    pub(crate) nameless: f64,
    pub(crate) left_over: f64,
}

impl Remaining {
    pub(crate) fn of(
        work: &Context<'_>,
        refined: &Refined,
        judged: &Judged<'_>,
        unit: &'static str,
    ) -> Result<Self, DiagnosisError> {
        let held = &judged.held;
        let (data, segments) = (&refined.data, &refined.segments);
        let unnamed = unnamed(work, held)?;
        let (fitted, after, later) = match &unnamed {
            Some(torque) => (&torque.fitted, &torque.after, torque.last_third),
            None => (&held.fitted, &held.after, held.last_third[1]),
        };
        let floors = floor::squares(segments, &fitted.residuals);
        let noise = floor::of_squares(&floors);
        let paths = Path::of(segments, fitted)?;
        let ceiling = discrepancy::ceiling(segments, fitted, &paths)?;
        let stages = Stages {
            nominal: &held.nominal,
            recalibrated: &held.recalibrated,
            repaired: after,
            ceiling: &ceiling,
        };
        let gap = gap(&stages, (noise, &floors), [held.last_third[0], later], unit);
        let noise_square = noise.value * noise.value;
        let excess = gap.recalibrated.powi(2) - noise_square;
        let left = unexplained(data, held.repaired)?;
        let gained = (refined.base.calibrated.squares - held.repaired.squares).max(0.0);
        let mut share = left.squares / (left.squares + gained).max(f64::MIN_POSITIVE);
        let mut evidence = left.evidence;
        if let Some(torque) = &unnamed {
            share = share.max(torque.share.value);
            evidence = evidence.max(torque.evidence);
        }
        let with_names = held.after.mean_square();
        if with_names > (FAR_ABOVE * data.facts.with_drive(noise.value)).powi(2) {
            // No noise is that smooth: whatever its spectrum, the residual is a part of the gap.
            share = share.max((with_names - noise_square) / excess.max(f64::MIN_POSITIVE));
            evidence = f64::INFINITY;
        }
        if gap.ratio_to_floor_interval_95[1] < 1.0 {
            // An error below the noise is part of the noise, whose spectrum is then not white.
            evidence = 0.0;
        }
        let left_over = acts(evidence);
        let nameless = unknown(left_over, share.min(1.0));
        Ok(Self { unnamed, noise: noise.value, paths, gap, excess, nameless, left_over })
    }

    /// Returns the held-out residuals, with the torque without a name if there is one.
    pub(crate) fn after<'b>(&'b self, judged: &'b Judged<'_>) -> &'b HeldOut {
        self.unnamed.as_ref().map_or(&judged.held.after, |torque| &torque.after)
    }

    /// Returns the fit with everything found, on the shooting interval.
    pub(crate) fn complete<'b>(&'b self, judged: &'b Judged<'_>) -> &'b Fit {
        self.unnamed.as_ref().map_or(judged.held.repaired, |torque| &torque.followed)
    }

    /// Returns the same on the unjoined segments.
    pub(crate) fn fitted<'b>(&'b self, judged: &'b Judged<'_>) -> &'b Fit {
        self.unnamed.as_ref().map_or(&judged.held.fitted, |torque| &torque.fitted)
    }

    /// Returns the left-over beyond the noise, relative to the gap and to the noise.
    pub(crate) fn summary(&self) -> LeftOverRow {
        LeftOverRow { share_of_gap: 1.0 - self.gap.closure.value, over_noise: self.gap.ratio_to_floor }
    }
}

#[cfg(test)]
mod tests {
    use super::FAR_ABOVE;

    /// Second differences of autoregressive noise of unit variance have the variance 6 − 8ρ + 2ρ².
    #[test]
    fn colored_noise_stays_below_what_is_no_noise() {
        let over_floor = |rho: f64| (6.0 / (6.0 - 8.0 * rho + 2.0 * rho * rho)).sqrt();
        assert!(over_floor(0.84) < FAR_ABOVE && over_floor(0.85) > FAR_ABOVE);
    }
}
