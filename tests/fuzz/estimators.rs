//! Estimators without burn, which takes an hour to build with a fuzzer's instrumentation. Configurations of
//! the others differ only in declared keys.

pub(crate) const ESTIMATORS: &[estimator::Entry] = &[
    estimator_baseline::ENTRY,
    estimator_bayesian::ENTRY,
    estimator_gaussian_process::ENTRY,
    estimator_sindy::ENTRY,
    estimator_symbolic::ENTRY,
];
