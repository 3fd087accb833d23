//! Agreement of recordings: does a joint have the same coefficients in all of them?

use super::read::RobotQuestion;
use robot::{JointCoefficient, coefficients};

/// Difference from the other recordings, in standard errors, from which a quantity differs: by chance in one of 16,000 cases.
const DIFFERS: f64 = 4.0;

impl RobotQuestion {
    /// Returns the quantities in which each recording differs from the others together, such as `elbow: damping`.
    pub(super) fn differences(&self) -> Vec<Vec<String>> {
        let mut differ = vec![Vec::new(); self.recordings.len()];
        for joint in &self.asked {
            // A joint that stands still in a recording tells nothing there.
            let found: Vec<Option<Vec<JointCoefficient>>> = self
                .recordings
                .iter()
                .map(|own| coefficients(self.model.joints(), &own.along, *joint).ok())
                .collect();
            let name = self.name_of(*joint);
            for (at, (own, differ)) in found.iter().zip(&mut differ).enumerate() {
                for (which, own) in own.iter().flatten().enumerate() {
                    let others = found.iter().enumerate().filter(|(other, _)| *other != at);
                    let others = others.filter_map(|(_, other)| other.as_ref()?.get(which));
                    if is_apart(own, others) {
                        differ.push(format!("{name}: {}", own.quantity));
                    }
                }
            }
        }
        differ
    }
}

/// Returns `true` if an estimate differs from the weighted mean of others by more than chance.
fn is_apart<'a>(own: &JointCoefficient, others: impl Iterator<Item = &'a JointCoefficient>) -> bool {
    let (mut weights, mut sum) = (0.0, 0.0);
    for other in others.filter(|other| other.error > 0.0) {
        let weight = other.error.powi(-2);
        weights += weight;
        sum += weight * other.value;
    }
    weights > 0.0
        && (own.value - sum / weights).abs() > DIFFERS * (own.error.powi(2) + weights.recip()).sqrt()
}
