//! Outcomes of commands.

/// Outcome of a command that gave a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Done, and every stated check holds.
    Done,
    /// Done, but a stated check failed.
    CheckFailed,
    /// Stopped on request; the best result so far is saved.
    Interrupted,
}

impl Outcome {
    /// Returns the outcome of a run from the result of its stated checks, unless it was interrupted.
    pub(crate) fn of(interrupted: bool, holds: bool) -> Self {
        match (interrupted, holds) {
            (true, _) => Self::Interrupted,
            (false, true) => Self::Done,
            (false, false) => Self::CheckFailed,
        }
    }

    /// Returns the exit code of this outcome.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::CheckFailed => 1,
            Self::Interrupted => 130,
        }
    }
}
