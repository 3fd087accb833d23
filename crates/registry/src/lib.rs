//! Registry of all estimators. A new estimator needs one line here and one in the manifest.

use estimator::Entry;

/// Every estimator: the null estimator first, then those of the paper in its order, then those that the paper
/// does not have.
pub const ESTIMATORS: &[Entry] = &[
    estimator_baseline::ENTRY,
    estimator_sindy::ENTRY,
    estimator_pinn::ENTRY,
    estimator_neural_ode::ENTRY,
    estimator_lstm::ENTRY,
    estimator_symbolic::ENTRY,
    estimator_weak_sindy::ENTRY,
    estimator_bayesian::ENTRY,
    estimator_envelope_matching::ENTRY,
    estimator_gaussian_process::ENTRY,
    estimator_transformer::ENTRY,
    estimator_lstm::AMORTIZED_ENTRY,
    estimator_transformer::AMORTIZED_ENTRY,
];
