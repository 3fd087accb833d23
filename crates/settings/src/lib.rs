//! Declared configuration keys: defaults, ranges, units, and error messages with line and column.
//!
//! A configurable part declares its keys as data ([`Field`]): kind and range, default, unit, meaning, and
//! source of the default. The checks, the resolved configuration and the help text all use that declaration,
//! so that they cannot contradict each other.
//!
//! Steps of a configuration: text → [`Document`] (leaves with their origin) → merged with its base files →
//! overrides applied → [`Resolved`] (every key known, typed and in range, defaults filled in) → a plain
//! struct by serde.
//!
//! # Example
//!
//! ```
//! use settings::{Default, Document, Field, Kind, Resolved, Section};
//!
//! const FIT: &[Field] =
//!     &[Field::new("max_steps", Kind::Integer { min: 1, max: 10_000 }, Default::Integer(100))
//!         .unit("steps")
//!         .meaning("Most steps of the fit.")];
//! let sections = [Section { name: "fit", fields: FIT }];
//!
//! let mut document = Document::parse("fit.toml", "[fit]\nmax_steps = 20\n")?;
//! let resolved = Resolved::new(&document, &sections)?;
//! assert_eq!(resolved.values_text(), "fit.max_steps = 20\n");
//!
//! // A value out of range is refused, with the place where it stands and what is expected there.
//! document.apply_override("fit.max_steps=0")?;
//! let refusal = Resolved::new(&document, &sections).unwrap_err().to_string();
//! assert!(refusal.contains("fit.max_steps"), "{refusal}");
//! # Ok::<(), settings::SettingsError>(())
//! ```

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
