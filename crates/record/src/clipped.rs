//! Records whose sensor clips the largest swings.

use crate::free::{Turn, turning_points};
use crate::record::Record;
use crate::statistics::{extremes, noise_level, upper_median};
use std::f64::consts::PI;

/// Fewest turning points at a level.
const FEWEST: usize = 3;
/// Ratio of the time that values stand within a band of their extreme to the time that a swing of that amplitude does.
const STANDS: f64 = 1.35;
/// Distance of an extreme from the level, in standard deviations of the noise, up to which it is clipped.
const AT: f64 = 6.0;
/// Samples that such a time is uncertain by.
const ENDS: f64 = 2.0;
/// Largest part of half a swing that a clipped one stands: what stands for longer is held.
const HELD: f64 = 0.95;
/// Part of a plateau that stands at its extreme within the noise: two modes make it long, but not flat.
const FLAT: f64 = 0.6;
/// Amplitude in steps of the sensor from which a level is told from a step.
const STEPS: f64 = 20.0;

/// The part of a record in which the sensor clips.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clipped {
    /// Value that the swing stands at, in the record's unit.
    pub level: f64,
    /// Number of half swings that do.
    pub half_swings: usize,
    /// Stamp at which the last of them ends, in seconds.
    pub to_s: f64,
}

impl Record {
    /// Returns the part of the record in which the values stand at their largest or smallest one for longer than those of
    /// a swing, as those of a sensor do whose range ends there. `None` for fewer than three such half swings on a side.
    #[must_use]
    pub fn clipped(&self) -> Option<Clipped> {
        let values = self.values();
        let [lowest, highest] = extremes(values);
        let (turns, _) = turning_points(values);
        let between = turns.iter().zip(turns.iter().skip(1)).map(|(one, next)| (next.at - one.at) as f64);
        let half_swing = upper_median(between.collect())?;
        let amplitude = 0.5 * (highest - lowest);
        // The band of a plateau, as the search for turning points has it.
        let reach = (AT * noise_level(values)).max(self.quantum());
        let band = (0.04 * amplitude + 6.0 * noise_level(values)).max(self.quantum());
        if STEPS * self.quantum() > amplitude || band > amplitude {
            return None;
        }
        let swing = libm::acos(1.0 - band / amplitude) * 2.0 / PI * half_swing;
        let stands = |turn: &&Turn| {
            let [first, last] = turn.plateau;
            let samples = (last - first) as f64;
            let plateau = values.get(first..=last).unwrap_or_default();
            let top = values.get(turn.at).copied().unwrap_or(f64::NAN);
            let flat = plateau.iter().filter(|value| (**value - top).abs() <= reach).count() as f64;
            samples > STANDS * swing + ENDS && samples < HELD * half_swing && flat > FLAT * samples
        };
        let at = |level: f64| {
            let is_at = |turn: &&Turn| values.get(turn.at).is_some_and(|value| (value - level).abs() <= band);
            let found: Vec<&Turn> = turns.iter().filter(is_at).filter(stands).collect();
            // The last ones hardly reach beyond the level, and stand no longer than a swing does.
            let near = |turn: &&Turn| values.get(turn.at).is_some_and(|value| (value - level).abs() <= reach);
            let clipped: Vec<&Turn> = turns.iter().filter(near).collect();
            let to_s = self.stamps_s().get(clipped.last()?.plateau[1]).copied()?;
            (found.len() >= FEWEST).then_some(Clipped { level, half_swings: clipped.len(), to_s })
        };
        let sides = [highest, lowest].into_iter().filter_map(at);
        sides.max_by(|one, other| one.to_s.total_cmp(&other.to_s))
    }
}

#[cfg(test)]
mod tests {
    use super::Clipped;
    use crate::{Quantity, Record};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn clipped(noise: f64, step: f64, motion: impl Fn(f64) -> f64) -> Option<Clipped> {
        let mut draws = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let times: Vec<f64> = (0..3000).map(|at| 0.01 * f64::from(at)).collect();
        let mut value = |time: &f64| {
            let draw: f64 = StandardNormal.sample(&mut draws);
            step * ((motion(*time) + noise * draw) / step).round()
        };
        let values = times.iter().map(&mut value).collect();
        Record::new(times, values, None, Quantity::Position, "V").unwrap().clipped()
    }

    fn decay(time: f64) -> f64 {
        (-0.12 * time).exp() * (6.0 * time).cos()
    }

    /// The amplitude is 0.5 at 5.78 s.
    #[test]
    fn a_sensor_clips_until_the_swing_is_within_its_range() {
        for noise in [1e-5, 1e-3, 1e-2] {
            for highest in [2.0, 0.5] {
                let found = clipped(noise, 1e-5, |time| decay(time).clamp(-0.5, highest)).unwrap();
                assert!(found.half_swings >= 3 && (3.5..7.0).contains(&found.to_s), "{found:?}");
                assert!((found.level.abs() - 0.5).abs() < 5.0 * noise, "{found:?}");
            }
        }
    }

    /// Decays, an undamped swing, one of few steps, a hold and dry friction that stops it.
    #[test]
    fn a_swing_is_not_clipped() {
        for noise in [1e-4, 1e-3, 0.05] {
            assert_eq!(clipped(noise, 1e-5, decay), None);
            assert_eq!(clipped(noise, 1e-5, |time| (6.0 * time).sin()), None);
            assert_eq!(clipped(noise, 0.06, decay), None);
            assert_eq!(clipped(noise, 1e-5, |time| if time < 5.0 { 1.0 } else { decay(time - 5.0) }), None);
            assert_eq!(clipped(noise, 1e-5, |time| (1.0 - 0.06 * time).max(0.0) * (6.0 * time).cos()), None);
        }
        // Regression: a second mode at twice the frequency makes one side long and low.
        for noise in [1e-4, 1e-3] {
            assert_eq!(
                clipped(noise, 1e-5, |time| decay(time) + 0.25 * decay(2.004 * time + 1e-3)),
                None,
                "{noise}"
            );
        }
    }
}
