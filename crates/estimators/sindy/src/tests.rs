//! Tests of whole fits, shared by all methods that discover laws.

#[path = "../../../sparse/testing/laws.rs"]
mod laws;

const AGREEMENT: f64 = 1e-12;

const ADDED: f64 = 1e-10;

fn odd_bar(_at: usize, rate: f64) -> f64 {
    1e-8 * rate.abs().max(1e-6)
}
