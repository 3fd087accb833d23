//! Node in the graph of a field's operations.

use super::expression::Operation;

/// Node of the graph.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) operation: Operation,
    /// `true` if it depends on parameters only.
    pub(crate) constant: bool,
    /// `true` if it depends on the state, or on a free parameter.
    pub(crate) wanted: bool,
    /// `true` if a result depends on it.
    pub(super) used: bool,
    /// `true` if its own series is needed: as a result, in a nonlinear operation, or in a derivative.
    pub(super) kept: bool,
}

impl Node {
    /// Returns `true` if its series has to be computed once constants are known.
    pub(crate) fn varies(&self) -> bool {
        self.used && !self.constant
    }

    /// Returns `true` if its own series is needed.
    pub(crate) fn is_kept(&self) -> bool {
        self.kept
    }
}
