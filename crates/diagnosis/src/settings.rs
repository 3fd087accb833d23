//! Settings of a diagnosis.

use dynamics::Hold;
use seed::Seed;

/// Settings of a diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// False-alarm probability of the search, 0.001 to 0.2: the probability that the gain of the best
    /// candidate exceeds the search threshold by chance, if no effect is missing.
    pub false_alarm: f64,
    /// Largest number of effects in one fitted set, clamped to 1 to 5.
    pub most_effects: usize,
    /// Ids of effects that are not considered, for callers who know that an effect is absent, and for trials
    /// in which the cause has no name.
    pub without: Vec<String>,
    /// Behavior of the inputs between their samples, if it is known; otherwise the records decide.
    pub hold: Option<Hold>,
    /// Seed of all random draws: the bootstraps and the null distribution.
    pub seed: Seed,
}

impl Settings {
    pub(crate) fn considers(&self, id: &str) -> bool {
        !self.without.iter().any(|other| other == id)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self { false_alarm: 0.01, most_effects: 5, without: Vec::new(), hold: None, seed: Seed::new(0) }
    }
}
