//! Baselines for every learner: models without knowledge, and simulators.

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

/// Entry of a baseline in the registry.
pub struct Baseline {
    /// Identifier, as in configurations.
    pub id: &'static str,
    /// Name for tables and reports.
    pub title: &'static str,
    /// Builds the baseline from the training part.
    pub make: fn(&DataSet, &Context<'_>) -> Result<Fitted, LearnError>,
}

/// All baselines, in the order of tables.
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
