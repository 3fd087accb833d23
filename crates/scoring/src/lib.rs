//! How far an estimate is from the oracle, and whether that passes.
