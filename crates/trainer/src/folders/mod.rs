//! The folders of runs: beginning and resuming one, its environment, its page.

pub(crate) mod environment;
pub(crate) mod page;
pub(crate) mod resume;
