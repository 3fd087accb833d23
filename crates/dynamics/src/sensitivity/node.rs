//! A node in the graph of a field's operations.

use super::expression::Operation;

/// A node of the graph.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) operation: Operation,
    /// Depends on parameters only.
    pub(crate) constant: bool,
    /// Depends on the state, or on a parameter that is free.
    pub(crate) wanted: bool,
    /// A result depends on it.
    pub(super) used: bool,
    /// Its series is needed by itself: as a result, in a nonlinear operation, or in a derivative.
    pub(super) kept: bool,
}

impl Node {
    /// Whether its series has to be computed, once constants are known.
    pub(crate) fn varies(&self) -> bool {
        self.used && !self.constant
    }

    /// Whether its series is needed by itself.
    pub(crate) fn is_kept(&self) -> bool {
        self.kept
    }
}
