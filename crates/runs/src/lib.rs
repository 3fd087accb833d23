//! Run folders: the only crate that writes to disk.
//!
//! Every file is written whole to a temporary name, flushed to the disk and renamed; a crash leaves the
//! old file or the new one, never half of one. A folder is made once and never written over; one program at a
//! time works in it, and one that was killed there can be followed by another that resumes.

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
