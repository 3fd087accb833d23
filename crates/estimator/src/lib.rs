//! The contract every estimator fulfills.
