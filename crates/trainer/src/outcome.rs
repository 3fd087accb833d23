//! How a command ends.

/// How a command that gave a result ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Done, and every stated check holds.
    Done,
    /// Done, but a stated check failed.
    CheckFailed,
    /// Stopped on request; the best so far is saved.
    Interrupted,
}

impl Outcome {
    /// That of a run whose stated checks hold or do not, unless it was stopped.
    pub(crate) fn of(interrupted: bool, holds: bool) -> Self {
        match (interrupted, holds) {
            (true, _) => Self::Interrupted,
            (false, true) => Self::Done,
            (false, false) => Self::CheckFailed,
        }
    }

    /// The exit code that says so.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::CheckFailed => 1,
            Self::Interrupted => 130,
        }
    }
}
