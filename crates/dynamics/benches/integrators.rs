//! Time of the integrators.

fn main() {}
