//! Run folders: the only crate that writes to disk.
//!
//! Every file is written whole to a temporary name, flushed to the disk and renamed; a crash leaves the
//! old file or the new one, never half of one. A folder is made once and never written over.

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
mod error;
mod folder;
pub mod result;
mod sweep;
mod table;

pub use catalog::{KeptRun, has_run_files, list_runs, read_run};
pub use error::RunError;
pub use folder::{RunFolder, Texts, default_root};
pub use sweep::{SweepFolder, SweepFolderError};
pub use table::to_csv;
