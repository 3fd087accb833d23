//! Workflow from records and a nominal simulator to a stored answer, shared by the command line and the Rust
//! interface.
//!
//! A record is [`load`](read::Loaded)ed with its [`Reading`] options; a nominal simulator is
//! [`read`](nominal::read) or [`guess`]ed. Together they form a [`Question`], whose [`Answer`] holds the
//! diagnosis, the repaired simulator and the content of `diagnosis.json`. This crate does not parse a command
//! line, print, or write files.

#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::disallowed_methods
    )
)]

mod actuator;
mod commanded;
mod error;
pub mod estimate;
pub mod guess;
#[cfg(not(target_arch = "wasm32"))]
pub mod learning;
mod logs;
pub mod look;
mod modes;
pub mod nominal;
mod question;
pub mod read;
mod repair;
mod result;
pub mod rigs;
pub mod robot;

pub use error::{WorkflowError, in_options};
pub use logs::{Log, is_log, is_run, left_out, logs};
pub use modes::{mode_rows, modes, resonance};
pub use question::{Answer, Question, after};
pub use read::{Given, Loaded, Reading};
pub use result::{series_rows, title};
