//! Folders of runs: beginning and resuming a run, its environment, its report.

pub(crate) mod environment;
pub(crate) mod page;
pub(crate) mod resume;
