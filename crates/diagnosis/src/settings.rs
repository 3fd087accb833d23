//! What a caller may choose.

use seed::Seed;

/// How to diagnose.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Probability with which an effect is named where there is none; 0.001 to 0.2.
    pub false_alarm: f64,
    /// Most effects named together, 1 to 5.
    pub most_effects: usize,
    /// Ids of effects that are not considered: a vocabulary with holes, for whoever knows that an effect is
    /// absent, and for trials of what is said where the cause has no name.
    pub without: Vec<String>,
    /// Randomness of the bootstraps.
    pub seed: Seed,
}

impl Settings {
    pub(crate) fn considers(&self, id: &str) -> bool {
        !self.without.iter().any(|other| other == id)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self { false_alarm: 0.01, most_effects: 5, without: Vec::new(), seed: Seed::new(0) }
    }
}
