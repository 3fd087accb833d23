//! Codings of angles that jump though the motion does not: wraps after a full turn, and counts below zero
//! written as unsigned numbers.

use crate::statistics::extremes;
use crate::unit::{Dimension, Unit};
use std::f64::consts::TAU;

/// A series with its coding undone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Decoded {
    /// Values without the jumps, in the column's unit.
    pub(crate) values: Vec<f64>,
    /// Name of the coding with its numbers, as a sentence.
    pub(crate) finding: String,
    /// `true` if it wrapped after a turn of the column's unit, which confirms that unit.
    pub(crate) is_turn: bool,
}

/// Number of bits of the counts that are looked for.
const BITS: std::ops::RangeInclusive<u32> = 8..=32;
/// Factor by which the largest step, or the largest change from step to step, has to fall for a coding to be recognized.
const CALMER: f64 = 4.0;
/// Part of the range, from each end, in which a wrapped series has values.
const NEAR_THE_END: f64 = 0.125;

/// Undoes the coding of a series; `None` if its steps are no jumps. A coding is recognized if the largest
/// step is nearly half the range of the code or more, and it, or the largest change from step to step, falls to a
/// quarter or less without the coding.
pub(crate) fn decoded(values: &[f64], unit: Option<Unit>) -> Option<Decoded> {
    let plain = largest_step(values);
    let whole = values.iter().all(|value| value.fract() == 0.0);
    let turns = periods(unit, whole).into_iter().filter_map(|period| {
        let values = unwrapped(values, period).filter(|_| plain >= 0.5 * period)?;
        let finding = format!(
            "the values wrap: each jump by about {} was taken for a passage of the end of the range, and undone",
            (1e3 * period).round() / 1e3
        );
        Some(Decoded { values, finding, is_turn: unit.is_some_and(|unit| period == TAU / unit.to_si()) })
    });
    let signs = BITS.filter(|_| whole).filter_map(|bits| {
        let half = libm::exp2(f64::from(bits - 1));
        let values = signed(values, half).filter(|_| plain >= 0.75 * half)?;
        let finding = format!(
            "the values jump by about {half} where they pass zero: sign and magnitude in {bits} bits, which was undone"
        );
        Some(Decoded { values, finding, is_turn: false })
    });
    // Quick motion of several turns has steps of half a turn as well, but changes them slowly.
    let bend = largest_bend(values);
    let calm = |found: &Decoded| {
        CALMER * largest_step(&found.values) <= plain || CALMER * largest_bend(&found.values) <= bend
    };
    let step = |found: &Decoded| largest_step(&found.values);
    turns.chain(signs).filter(calm).min_by(|one, other| step(one).total_cmp(&step(other)))
}

/// Returns the largest absolute step of a series; 0 for one value.
fn largest_step(values: &[f64]) -> f64 {
    values.iter().zip(values.iter().skip(1)).map(|(one, next)| (next - one).abs()).fold(0.0, f64::max)
}

/// Returns the largest absolute difference of two steps of a series in a row; 0 for two values.
fn largest_bend(values: &[f64]) -> f64 {
    let bend = |part: &[f64]| match part {
        [one, middle, next] => (one - 2.0 * middle + next).abs(),
        _ => f64::NAN,
    };
    values.windows(3).map(bend).fold(0.0, f64::max)
}

/// Returns the lengths of code after which a series may wrap, in its unit.
fn periods(unit: Option<Unit>, whole: bool) -> Vec<f64> {
    let counts = || BITS.map(|bits| libm::exp2(f64::from(bits)));
    match unit {
        // Whole numbers may be counts, whatever unit they are read in.
        Some(unit) if unit.dimension() == Dimension::Angle && unit.order() == 0 => {
            std::iter::once(TAU / unit.to_si()).chain(counts().filter(|_| whole)).collect()
        }
        Some(_) => Vec::new(),
        None if whole => std::iter::once(360.0).chain(counts()).collect(),
        None => vec![360.0, TAU, 1.0],
    }
}

/// Returns a series unwrapped at steps of more than half a period. `None` if its values do not lie within one
/// period, near both of its ends.
fn unwrapped(values: &[f64], period: f64) -> Option<Vec<f64>> {
    let [lowest, highest] = extremes(values);
    let near = NEAR_THE_END * period;
    let within = |from: f64| {
        lowest > from - 1e-3 * period
            && lowest < from + near
            && highest > from + period - near
            && highest < from + 1.001 * period
    };
    if !within(0.0) && !within(-0.5 * period) {
        return None;
    }
    let (mut turns, mut previous) = (0.0, None);
    let unwrap = |value: &f64| {
        let step = previous.map_or(*value, |before: f64| value - before);
        if previous.is_some() && step.abs() > 0.5 * period {
            turns -= step.signum();
        }
        previous = Some(*value);
        value + turns * period
    };
    Some(values.iter().map(unwrap).collect())
}

/// Returns whole numbers of which those from `half` on have a sign bit; `None` if a number needs more bits,
/// or if none has the sign.
fn signed(values: &[f64], half: f64) -> Option<Vec<f64>> {
    let fits = values.iter().all(|value| (0.0..2.0 * half).contains(value));
    let has_sign = values.iter().any(|value| *value >= half);
    let decode = |value: &f64| if *value >= half { half - value } else { *value };
    (fits && has_sign).then(|| values.iter().map(decode).collect())
}

#[cfg(test)]
mod tests {
    use super::decoded;
    use crate::unit::Unit;

    fn swing(offset: f64, amplitude: f64) -> Vec<f64> {
        (0..600).map(f64::from).map(|t| offset + amplitude * (-0.004 * t).exp() * (0.11 * t).cos()).collect()
    }

    fn off(found: &[f64], true_: &[f64]) -> f64 {
        let shift = found[0] - true_[0];
        found.iter().zip(true_).map(|(one, other)| (one - other - shift).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn each_coding_is_undone() {
        let motion = swing(170.0, 60.0);
        let wrapped: Vec<f64> =
            motion.iter().map(|value| (value + 180.0).rem_euclid(360.0) - 180.0).collect();
        for unit in [Some(Unit::Degree), None] {
            assert!(off(&decoded(&wrapped, unit).unwrap().values, &motion) < 1e-9);
        }
        for bits in [10, 12, 14, 16] {
            let turn = f64::from(bits).exp2();
            let counts: Vec<f64> = swing(0.04 * turn, 0.2 * turn).iter().map(|value| value.round()).collect();
            let wrapped: Vec<f64> = counts.iter().map(|value| value.rem_euclid(turn)).collect();
            for unit in [None, Some(Unit::Radian)] {
                assert!(off(&decoded(&wrapped, unit).unwrap().values, &counts) < 1e-9, "{bits}");
            }
            let signs: Vec<f64> =
                counts.iter().map(|value| if *value < 0.0 { 0.5 * turn - value } else { *value }).collect();
            assert!(off(&decoded(&signs, None).unwrap().values, &counts) < 1e-9, "{bits}");
        }
        let radians: Vec<f64> =
            swing(6.0, 1.0).iter().map(|value| value.rem_euclid(std::f64::consts::TAU)).collect();
        assert!(off(&decoded(&radians, Some(Unit::Radian)).unwrap().values, &swing(6.0, 1.0)) < 1e-9);
    }

    /// Regression: a swing of several turns, whose steps reach a third of a turn, was read with its jumps.
    #[test]
    fn quick_motion_of_several_turns_is_unwrapped() {
        let motion = swing(0.0, 1200.0);
        let wrapped: Vec<f64> =
            motion.iter().map(|value| (value + 180.0).rem_euclid(360.0) - 180.0).collect();
        assert!(off(&decoded(&wrapped, Some(Unit::Degree)).unwrap().values, &motion) < 1e-9);
        // Of steps beyond half a turn nobody knows the direction.
        let motion = swing(0.0, 4000.0);
        let wrapped: Vec<f64> =
            motion.iter().map(|value| (value + 180.0).rem_euclid(360.0) - 180.0).collect();
        assert_eq!(decoded(&wrapped, Some(Unit::Degree)), None);
    }

    /// Steps that belong to the motion, a wrong value, and noise are left alone.
    #[test]
    fn what_does_not_wrap_stays() {
        assert_eq!(decoded(&swing(0.0, 170.0), Some(Unit::Degree)), None);
        assert_eq!(decoded(&swing(0.0, 700.0), Some(Unit::Degree)), None);
        let square: Vec<f64> = (0..400).map(|at| if at / 20 % 2 == 0 { -100.0 } else { 100.0 }).collect();
        assert_eq!(decoded(&square, Some(Unit::Degree)), None);
        let counts: Vec<f64> = swing(2000.0, 900.0).iter().map(|value| value.round()).collect();
        assert_eq!(decoded(&counts, None), None);
        assert_eq!(decoded(&swing(0.0, 0.3), None), None);
        assert_eq!(decoded(&[], None), None);
    }
}
