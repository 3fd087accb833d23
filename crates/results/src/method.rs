//! Description of a method, and the state in which its fit ended.

use serde::{Deserialize, Serialize};

/// State in which a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reached {
    /// The method's own convergence condition holds.
    Converged,
    /// The budget ran out before convergence.
    BudgetSpent,
    /// The loss became infinite or NaN, or grew without bound; the best state before that is reported.
    Diverged,
    /// The user asked to stop; the best state so far is reported.
    Interrupted,
    /// No step improves the fit, although the method's convergence condition does not hold.
    Stalled,
}

impl Reached {
    /// All states.
    pub const ALL: [Self; 5] =
        [Self::Converged, Self::BudgetSpent, Self::Diverged, Self::Interrupted, Self::Stalled];

    /// Returns the name used in results.
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

    /// Returns the state in words for tables.
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
    /// The value is that slope; a converged fit that differs from certified least squares is wrong.
    #[default]
    LeastSquares,
    /// The value approximates that slope with a skill learned beforehand; it differs by the error of that
    /// training.
    Approximation,
    /// The value is another quantity and may differ from least squares.
    Own,
    /// The value estimates nothing: the floor row.
    Nothing,
}

impl Estimand {
    /// All relations.
    pub const ALL: [Self; 4] = [Self::LeastSquares, Self::Approximation, Self::Own, Self::Nothing];

    /// Returns the name used in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LeastSquares => "least_squares",
            Self::Approximation => "approximation",
            Self::Own => "own",
            Self::Nothing => "nothing",
        }
    }

    /// Returns a short answer for tables: may a value of this relation differ from least squares?
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

/// A part of an estimator that is removed for a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ablation {
    /// Every parameter of the learned part (network, process, expression) is held at zero; the rest, such as
    /// a straight line, is trained.
    LearnedPartAtZero,
    /// The input of the learned part is replaced by white noise of the same range; its targets stay the same.
    NoiseForInput,
}

impl Ablation {
    /// Both ablations, in the order of tables.
    pub const ALL: [Self; 2] = [Self::LearnedPartAtZero, Self::NoiseForInput];

    /// Returns the name used in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LearnedPartAtZero => "learned_part_at_zero",
            Self::NoiseForInput => "noise_for_input",
        }
    }
}

/// Origin of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// One of the reference's classical methods.
    Classical,
    /// An estimator that learns.
    Learned,
    /// A third-party library.
    Library,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 3] = [Self::Classical, Self::Learned, Self::Library];

    /// Returns the name used in files.
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
