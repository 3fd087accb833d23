//! Zeros of functions of one variable.

/// Finds a zero of `margin` between `from`, where it is positive, and `to`, where it is negative, to the
/// resolution of doubles. The method is the Illinois variant of regula falsi, with bisection when that
/// stalls.
///
/// # Reference
/// Dowell, Jarratt, BIT 11 (1971) 168.
pub(crate) fn bracketed(from: f64, to: f64, mut margin: impl FnMut(f64) -> f64) -> f64 {
    let (mut low, mut high) = (from, to);
    let (mut at_low, mut at_high) = (margin(low), margin(high));
    if at_low <= 0.0 {
        return low;
    }
    let mut last = 0;
    for iteration in 0..200 {
        let width = high - low;
        if width <= 2.0 * f64::EPSILON * high.abs() {
            break;
        }
        let mut middle = low + width * at_low / (at_low - at_high);
        if iteration % 8 == 7 || !(middle > low && middle < high) {
            middle = low + 0.5 * width;
        }
        let value = margin(middle);
        if value == 0.0 {
            return middle;
        }
        if value > 0.0 {
            (low, at_low) = (middle, value);
            if last == 1 {
                at_high *= 0.5;
            }
            last = 1;
        } else {
            (high, at_high) = (middle, value);
            if last == -1 {
                at_low *= 0.5;
            }
            last = -1;
        }
    }
    high
}
