//! Held-out prediction: problems, splits, and scores of methods on peaks that were not fitted.
//!
//! [`prepare`] reads or simulates a problem. The caller fits each method to the envelope that [`seen`]
//! returns and passes the resulting [`Trial`]s to [`result`] and [`csv_rows`]. No method is named in this
//! crate.
//!
//! Methods are compared on the same draws: where slow methods are fitted on fewer draws of a simulation, the errors
//! of all methods come from those. Comparing a median over 200 draws with one over 20 had given the same line two
//! ranks.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod error;
mod problem;
mod split;
mod table;
mod tally;
mod trial;
mod verdict;

pub use error::StudyError;
pub use problem::{Missing, Ready, Truth, prepare};
pub use split::Split;
pub use table::{ProblemTrials, StudiedMethod, best_exponentials, csv_rows, result};
pub use tally::Placed;
pub use trial::{Trial, seen};
