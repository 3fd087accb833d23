//! In-memory storage for checkpoints, for tests.

use estimator::Checkpoints;
use std::cell::RefCell;

/// Storage that accepts a state at every step and holds the last one, with the number of the step that
/// follows it.
#[derive(Debug, Default)]
pub(crate) struct Kept(RefCell<Option<(u64, Vec<u8>)>>);

impl Kept {
    /// Returns the number of the step that follows the stored state.
    pub(crate) fn step(&self) -> Option<u64> {
        self.0.borrow().as_ref().map(|(step, _)| *step)
    }
}

impl Checkpoints for Kept {
    fn latest(&self) -> Option<Vec<u8>> {
        self.0.borrow().as_ref().map(|(_, state)| state.clone())
    }

    fn is_due(&self) -> bool {
        true
    }

    fn keep(&self, step: u64, state: &[u8]) -> Result<(), String> {
        *self.0.borrow_mut() = Some((step, state.to_vec()));
        Ok(())
    }
}
