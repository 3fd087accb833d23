//! Declared configuration keys: defaults, ranges, units, and checks that point at line and column.
//!
//! A part that can be configured declares its keys as data ([`Field`]): kind and range, default, unit,
//! meaning, source of the default. The checks, the resolved configuration and the help text all come
//! from that declaration, so that they cannot part from each other.
//!
//! The way of a configuration: text → [`Document`] (leaves with their origin) → put on its bases → overrides applied →
//! [`Resolved`] (every key known, typed, in range, defaults filled in) → a plain struct by serde.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod base;
mod document;
mod error;
mod field;
pub mod json_schema;
mod origin;
mod resolved;

pub use document::{Document, Leaf};
pub use error::SettingsError;
pub use field::{Default, Field, Kind, Section};
pub use origin::Origin;
pub use resolved::{Resolved, Setting, nearest};

#[cfg(test)]
mod tests;
