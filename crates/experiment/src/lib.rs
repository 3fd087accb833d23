//! The configuration of an experiment: schema, overrides, checks.
