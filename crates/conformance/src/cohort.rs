//! Coverage of stated intervals over a cohort of simulated envelopes.

use crate::{Subject, scattered};
use seed::Seed;

/// How often a stated 95 % interval held the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Envelopes tried.
    pub envelopes: u64,
    /// Intervals that held the truth.
    pub held: u64,
}

impl Coverage {
    /// Share of intervals that held the truth.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.held as f64 / self.envelopes as f64
    }

    /// Whether the share lies within `bar` of 95 %, or within three binomial standard errors where that
    /// is wider: few envelopes know the share poorly.
    #[must_use]
    pub fn is_within(&self, bar: f64) -> bool {
        let standard_error = (0.95 * 0.05 / self.envelopes as f64).sqrt();
        (self.share() - 0.95).abs() <= bar.max(3.0 * standard_error)
    }
}

/// Fits simulated envelopes of 69 peaks, λ = 0.19 1/s and a scatter of 0.1 on ln A, a new draw each, and
/// counts the intervals that hold λ.
///
/// # Errors
/// A sentence where a fit fails or states no interval.
pub fn coverage(subject: &Subject<'_>, envelopes: u64) -> Result<Coverage, String> {
    const RATE: f64 = 0.19;
    let mut held = 0;
    for draw in 0..envelopes {
        let seed = Seed::new(draw).child("coverage");
        let envelope = scattered(69, RATE, 0.1, &seed)
            .ok_or_else(|| "the battery's own envelope is unusable".to_owned())?;
        let estimate = subject.fit(&envelope, draw, None).map_err(|error| error.to_string())?;
        let known = estimate.uncertainty.ok_or_else(|| format!("draw {draw}: no interval"))?;
        let [low, high] = known.interval_95;
        held += u64::from((low..=high).contains(&RATE));
    }
    Ok(Coverage { envelopes, held })
}
