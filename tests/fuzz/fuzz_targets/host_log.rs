#![no_main]

#[allow(dead_code, reason = "each fuzzer feeds one")]
#[path = "../targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::host_log(data));
