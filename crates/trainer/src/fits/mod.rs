//! From a record to fitted methods: what estimating, comparing and predicting share.

pub(crate) mod ablations;
pub(crate) mod agreement;
pub(crate) mod cautions;
pub(crate) mod fit;
pub(crate) mod input;
pub(crate) mod known_truth;
pub(crate) mod method;
pub(crate) mod watcher;
