//! Estimators that do without burn, which takes an hour to build with a fuzzer's instruments; configurations
//! differ from one estimator to the next in declared keys alone.

pub(crate) const ESTIMATORS: &[estimator::Entry] = &[
    estimator_baseline::ENTRY,
    estimator_bayesian::ENTRY,
    estimator_gaussian_process::ENTRY,
    estimator_sindy::ENTRY,
    estimator_symbolic::ENTRY,
];
