//! What a method is, and how its fit ended.

use serde::{Deserialize, Serialize};

/// State in which a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reached {
    /// The method's own condition for a solution holds.
    Converged,
    /// The budget ended first.
    BudgetSpent,
    /// The loss stopped being finite or grew without bound; the best state before is reported.
    Diverged,
    /// Somebody asked to stop; the best state so far is reported.
    Interrupted,
    /// No step improves the fit, and the method's own condition does not hold either.
    Stalled,
}

impl Reached {
    /// Every state.
    pub const ALL: [Self; 5] =
        [Self::Converged, Self::BudgetSpent, Self::Diverged, Self::Interrupted, Self::Stalled];

    /// The name as results write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::BudgetSpent => "budget_spent",
            Self::Diverged => "diverged",
            Self::Interrupted => "interrupted",
            Self::Stalled => "stalled",
        }
    }

    /// The state as a table says it.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::BudgetSpent => "budget spent",
            other => other.name(),
        }
    }
}

/// Relation of an estimator's converged value to the slope of the least-squares line through ln A.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimand {
    /// It is that slope: a converged fit that differs from certified least squares is wrong.
    #[default]
    LeastSquares,
    /// It approximates that slope by a skill learned beforehand: it differs by the error of its training.
    Approximation,
    /// It is something else, and may differ from least squares.
    Own,
    /// It is nothing: the floor row.
    Nothing,
}

impl Estimand {
    /// Every relation.
    pub const ALL: [Self; 4] = [Self::LeastSquares, Self::Approximation, Self::Own, Self::Nothing];

    /// The name as files write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LeastSquares => "least_squares",
            Self::Approximation => "approximation",
            Self::Own => "own",
            Self::Nothing => "nothing",
        }
    }

    /// Whether a value of this relation can differ from least squares, in words.
    #[must_use]
    pub const fn may_differ(self) -> &'static str {
        match self {
            Self::LeastSquares => "no",
            Self::Approximation => "by its training",
            Self::Own => "yes",
            Self::Nothing => "–",
        }
    }
}

/// A part of an estimator that is taken away for a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ablation {
    /// Every parameter of the learned part (network, process, expression) is held at zero; what stands beside it,
    /// such as a straight line, is trained.
    LearnedPartAtZero,
    /// What the learned part reads is replaced by white noise of the same range; its targets stay as they are.
    NoiseForInput,
}

impl Ablation {
    /// Both, in the order of tables.
    pub const ALL: [Self; 2] = [Self::LearnedPartAtZero, Self::NoiseForInput];

    /// The name as files write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LearnedPartAtZero => "learned_part_at_zero",
            Self::NoiseForInput => "noise_for_input",
        }
    }
}

/// Where a method comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// One of the reference's classical methods.
    Classical,
    /// An estimator that learns.
    Learned,
    /// A library that is not of this project.
    Library,
}

impl Family {
    /// Every family.
    pub const ALL: [Self; 3] = [Self::Classical, Self::Learned, Self::Library];

    /// The name as files write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Classical => "classical",
            Self::Learned => "learned",
            Self::Library => "library",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Ablation, Estimand, Family, Reached};
    use serde_json::to_value;

    #[test]
    fn names_are_what_the_files_say() {
        for state in Reached::ALL {
            assert_eq!(to_value(state).unwrap(), state.name());
        }
        for relation in Estimand::ALL {
            assert_eq!(to_value(relation).unwrap(), relation.name());
        }
        for family in Family::ALL {
            assert_eq!(to_value(family).unwrap(), family.name());
        }
        for part in Ablation::ALL {
            assert_eq!(to_value(part).unwrap(), part.name());
        }
    }
}
