//! What every learner is judged beside: models that know nothing, or what a simulator knows.

mod arx;
mod persistence;
mod simulated;
#[cfg(test)]
mod tests;

pub use arx::Arx;
pub use persistence::Persistence;
pub use simulated::{Simulated, exact, nominal, recalibrated, repaired, system_of};

use crate::data::DataSet;
use crate::{Context, Fitted, LearnError};
use estimator::Reached;

/// A baseline of the registry.
pub struct Baseline {
    /// Identifier, as in configurations.
    pub id: &'static str,
    /// Name in words.
    pub title: &'static str,
    /// Makes it from the training part.
    pub make: fn(&DataSet, &Context<'_>) -> Result<Fitted, LearnError>,
}

/// Every baseline, in the order of tables.
pub static BASELINES: &[Baseline] = &[
    Baseline { id: "persistence", title: "Last value held", make: |_, _| Ok(done(Persistence, 0)) },
    Baseline { id: "nominal", title: "Nominal simulator", make: nominal },
    Baseline { id: "recalibrated", title: "Recalibrated simulator", make: recalibrated },
    Baseline { id: "arx", title: "Linear ARX", make: |data, _| Arx::fit(data).map(|model| done(model, 1)) },
    Baseline { id: "repaired", title: "Repaired simulator (diagnose)", make: repaired },
];

fn done(model: impl crate::Model + 'static, steps: u64) -> Fitted {
    Fitted { model: Box::new(model), reached: Reached::Converged, steps }
}
