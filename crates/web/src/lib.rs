//! The page on which a log is dropped: what a browser calls, without a server behind it.
//!
//! A [`Dropped`] holds the dropped files and answers requests in JSON with the functions that the command line calls. It
//! knows no browser. The module `boundary`, which only wasm32 has, lends it memory, a clock and a listener. All of it runs
//! in a web worker, on one thread.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

#[cfg(target_arch = "wasm32")]
mod boundary;
mod diagnose;
mod dropped;
mod estimate;
mod examples;
mod host;
mod looked;
mod picture;
mod reading;

#[cfg(test)]
mod tests;

pub use dropped::Dropped;
pub use host::Host;
