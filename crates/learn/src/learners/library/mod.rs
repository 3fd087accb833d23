//! Laws that are sums of stated terms, shared by the sparse learners.

mod ensemble;
mod finish;
mod law;
mod terms;
mod thresholding;

pub use ensemble::inclusion;
pub use finish::{Finishing, finish, restore};
pub(crate) use law::LAW;
pub use law::law;
pub use terms::{Library, Term};
pub(crate) use terms::{signed, weighted};
pub use thresholding::{Regression, thresholded};
