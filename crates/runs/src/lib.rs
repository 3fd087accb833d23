//! Run folders: the only crate that writes to disk.
pub mod result;
