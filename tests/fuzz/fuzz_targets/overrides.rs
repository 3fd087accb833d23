#![no_main]

#[path = "../estimators.rs"]
mod estimators;
#[allow(dead_code, reason = "each fuzzer feeds one")]
#[path = "../targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::overrides(data, estimators::ESTIMATORS));
