//! From a record to fitted methods: the parts shared by estimating, comparing and predicting.

pub(crate) mod ablations;
pub(crate) mod agreement;
pub(crate) mod cautions;
pub(crate) mod fit;
pub(crate) mod input;
pub(crate) mod known_truth;
pub(crate) mod method;
pub(crate) mod watcher;
