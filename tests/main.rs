//! Acceptance tests: what a user, a script or a published problem can expect of the program.
//!
//! All tests are in one binary, because each binary links all of burn. It belongs to the trainer's package,
//! so that cargo passes it the path of the program.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::disallowed_methods,
    reason = "tests"
)]

mod architecture;
mod bad_input;
mod browser;
mod cite;
mod command_line;
mod comparison;
mod defaults;
mod diagnose;
mod documents;
mod explain;
mod exports;
mod field;
mod fuzz_regressions;
mod gaps;
mod honesty;
mod init;
mod json_schema;
mod launching;
mod learning;
mod listing;
mod measured_records;
mod modules;
mod nist;
mod nominal;
mod page;
mod prediction;
mod reading;
mod recipe;
mod resuming;
mod rigs;
mod robots;
mod run_folders;
mod rust_interface;
mod schema;
mod searching;
mod servo;
mod shares;
mod simulation;
mod slurm;
mod support;
mod sweep;
mod told;
mod trials;
mod units;
mod unnamed;
mod verifying;
