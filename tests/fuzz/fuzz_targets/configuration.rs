#![no_main]

#[allow(dead_code, reason = "each fuzzer feeds one")]
#[path = "../targets.rs"]
mod targets;

const ESTIMATORS: &[estimator::Entry] = &[
    estimator_baseline::ENTRY,
    estimator_bayesian::ENTRY,
    estimator_gaussian_process::ENTRY,
    estimator_sindy::ENTRY,
    estimator_symbolic::ENTRY,
];

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::configuration(data, ESTIMATORS));
