//! Run folders. This is the only crate that writes to disk.
//!
//! A file is written completely under a temporary name, flushed to disk (unless a seed can reproduce it) and
//! renamed, so a crash leaves the old file or the new one, never half of one. Only the log of events grows in
//! place. A folder is created once and never overwritten. Only one program at a time works in it; if that
//! program is killed, another one can resume its run.

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

mod atomic;
mod catalog;
mod digest;
mod disk;
mod error;
mod events;
#[cfg(any(test, feature = "faults"))]
pub mod faults;
mod folder;
mod lock;
mod scratch;
mod sealed;
mod sweep;
mod table;

pub use atomic::write_file;
pub use catalog::{KeptRun, has_run_files, list_runs, read_run};
pub use digest::digest;
pub use disk::Disk;
pub use error::RunError;
pub use events::{Event, EventLog};
pub use folder::{RunFolder, Texts, default_root, to_json};
pub use scratch::Scratch;
pub use sweep::{Claim, SweepFolder, SweepFolderError};
pub use table::to_csv;
