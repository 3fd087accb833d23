#![no_main]

#[path = "../checkpoints.rs"]
mod checkpoints;

libfuzzer_sys::fuzz_target!(|data: &[u8]| checkpoints::checkpoint(
    data,
    &[estimator_pinn::ENTRY, estimator_lstm::AMORTIZED_ENTRY]
));
