//! Axes: range of values, places of the ticks, and labels of the ticks.
//!
//! Places on an axis are counted in ticks from the lowest tick, so that all drawing uses numbers from 0 to
//! about 10, whatever the data are.

use crate::format;

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences have equal lengths.
    Linear,
    /// Equal ratios have equal lengths; only positive values can be shown.
    Log,
}

/// An axis: its label, with the unit, and its scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit, such as `time (s)`.
    pub label: String,
    /// Scale of the values.
    pub scale: Scale,
}

impl Axis {
    /// Creates a linear axis.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear }
    }

    /// Creates a logarithmic axis.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log }
    }

    /// Returns `true` if an axis of this scale can show a value.
    pub(crate) fn can_show(&self, value: f64) -> bool {
        // Beyond this, far above any physical value, differences of finite values overflow.
        const LARGEST: f64 = 1e150;
        match self.scale {
            Scale::Linear => value.abs() <= LARGEST,
            Scale::Log => value.is_finite() && value > 0.0,
        }
    }

    /// Returns ticks for an axis that shows `values`, about `target` of them; `None` if no value can be
    /// shown.
    pub(crate) fn ticks(&self, values: impl Iterator<Item = f64>, target: f64) -> Option<Ticks> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| self.can_show(*value)) {
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            return None;
        }
        Some(match self.scale {
            Scale::Linear => Ticks::linear(low, high, target),
            Scale::Log => Ticks::log(low, high, target),
        })
    }
}

/// Evenly spaced ticks, and the part of them that the axis shows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    scale: Scale,
    /// Value at the lower end, or its decimal logarithm.
    low: f64,
    /// Difference between neighboring ticks, of values or of decimal logarithms.
    step: f64,
    /// Ends of the axis, in ticks.
    pub(crate) ends: (f64, f64),
}

impl Ticks {
    fn linear(low: f64, high: f64, target: f64) -> Self {
        // If the values agree to six digits, the ticks would need longer labels than there is room for.
        let least = 1e-6 * low.abs().max(high.abs());
        let (low, high) =
            if high - low < least { (low - least / 2.0, high + least / 2.0) } else { (low, high) };
        let span = if high > low { high - low } else { 1.0 };
        let step = round_step(span / target);
        let first = (low / step).floor();
        let last = (high / step).ceil();
        Self { scale: Scale::Linear, low: first * step, step, ends: (0.0, (last - first).max(1.0)) }
    }

    fn log(low: f64, high: f64, target: f64) -> Self {
        let (low, high) = (low.log10(), high.log10());
        // Whole decades only, so that every tick is a power of ten.
        let decades = (high.ceil() - low.floor()).max(1.0);
        let step = (decades / target).ceil().max(1.0);
        let first = (low / step).floor();
        let last = (high / step).ceil();
        Self { scale: Scale::Log, low: first * step, step, ends: (0.0, (last - first).max(1.0)) }
    }

    /// Returns the ticks on an axis that ends just beyond the values instead of at a tick. On a horizontal
    /// axis, the room beyond the last value would look like time without data.
    pub(crate) fn close_to(mut self, values: impl Iterator<Item = f64>) -> Self {
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for place in values.map(|value| self.place(value)) {
            from = from.min(place);
            to = to.max(place);
        }
        // A single value still needs an axis around it.
        if to - from > 0.5 {
            let room = 0.015 * (to - from);
            self.ends = (from - room, to + room);
        }
        self
    }

    /// Returns the place of a value that can be shown, in ticks from the lower end.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let value = match self.scale {
            Scale::Linear => value,
            Scale::Log => value.log10(),
        };
        (value - self.low) / self.step
    }

    /// Returns the number of characters of the longest label.
    pub(crate) fn longest_label(&self) -> usize {
        let places = self.ends.0.ceil() as i64..=self.ends.1.floor() as i64;
        places.map(|place| self.label(place as f64).chars().count()).fold(0, usize::max)
    }

    /// Returns the label of the tick at a position.
    pub(crate) fn label(&self, position: f64) -> String {
        let value = self.low + position.round() * self.step;
        match self.scale {
            Scale::Linear => {
                let high = self.low + self.ends.1 * self.step;
                format::tick(value, self.low, high, self.step)
            }
            // Exact: a whole number, and no double's exponent exceeds 324.
            Scale::Log => format::power_of_ten(value.round() as i32),
        }
    }
}

/// Returns the smallest step of 1, 2 or 5 times a power of ten that is at least `least`.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let mantissa = least / power;
    let rounded =
        [1.0, 2.0, 5.0].into_iter().find(|candidate| mantissa <= candidate * (1.0 + 1e-9)).unwrap_or(10.0);
    rounded * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        let ticks = axis.ticks(values.iter().copied(), 5.0).unwrap();
        let count = ticks.ends.1 as i32;
        (0..=count).map(|k| ticks.label(f64::from(k))).collect()
    }

    #[test]
    fn linear_ticks_enclose_the_values_in_round_steps() {
        assert_eq!(labels(&Axis::linear("t"), &[0.0, 19.6]), ["0", "5", "10", "15", "20"]);
        assert_eq!(labels(&Axis::linear("y"), &[-4.13, -0.21]), ["−5", "−4", "−3", "−2", "−1", "0"]);
    }

    #[test]
    fn log_ticks_are_whole_decades_far_below_any_floor() {
        assert_eq!(labels(&Axis::log("y"), &[0.2, 0.3]), ["10⁻¹", "1"]);
        let far = labels(&Axis::log("y"), &[3e-16, 2.0]);
        assert_eq!(far.first().unwrap(), "10⁻¹⁶");
        assert_eq!(far.last().unwrap(), "10⁴");
    }

    #[test]
    fn one_value_and_nearly_equal_values_still_span_an_axis() {
        for values in [&[0.0][..], &[0.190_961], &[0.190_961, 0.190_961 + 1e-14], &[1e140]] {
            let ticks = Axis::linear("y").ticks(values.iter().copied(), 5.0).unwrap();
            for value in values {
                let place = ticks.place(*value);
                assert!((-1e-6..=ticks.ends.1 + 1e-6).contains(&place), "{values:?}");
            }
            assert!(ticks.label(0.0).chars().count() < 24, "{}", ticks.label(0.0));
        }
    }

    #[test]
    fn an_axis_can_end_close_to_its_values() {
        let axis = Axis::linear("step");
        let values = [0.0, 2_060.0];
        let ticks = axis.ticks(values.into_iter(), 5.0).unwrap();
        assert_eq!(ticks.ends, (0.0, 5.0));
        let (from, to) = ticks.close_to(values.into_iter()).ends;
        assert!((-0.1..0.0).contains(&from) && (4.12..4.2).contains(&to));
        let one = axis.ticks([3.0].into_iter(), 5.0).unwrap();
        assert_eq!(one.clone().close_to([3.0].into_iter()), one);
    }

    #[test]
    fn values_without_a_place_are_passed_over() {
        let axis = Axis::log("y");
        assert!(axis.ticks([f64::NAN, -1.0, 0.0].into_iter(), 5.0).is_none());
        assert!(axis.ticks([f64::NAN, 2.0].into_iter(), 5.0).is_some());
        let axis = Axis::linear("y");
        assert!(axis.ticks([f64::INFINITY, 1e300].into_iter(), 5.0).is_none());
    }
}
