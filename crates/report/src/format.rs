//! Formatting of numbers as text: one notation for the whole report.
//!
//! Numbers have a true minus sign, `× 10ⁿ` with superscripts, narrow spaces between groups of three digits,
//! and no break between a number and its unit. If the uncertainty is known, it determines the digits: two
//! significant digits of the standard error, and the value to the same decimal place.

use results::WithInterval;

/// Keeps a number and its unit, or the parts of one number, on one line.
const NO_BREAK: char = '\u{a0}';
/// Separates groups of three digits (ISO 80000-1).
const GROUP: char = '\u{202f}';
const MINUS: char = '\u{2212}';
/// Text for NaN and the infinities.
const NOT_FINITE: &str = "not finite";
/// Largest number of significant decimal digits that a double can carry.
const MOST_DIGITS: i32 = 16;

/// Formats a value to `digits` significant digits with trailing zeros: `0.0087530`, `3.1 × 10⁻⁷`.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NOT_FINITE.to_owned();
    }
    let digits = digits.max(1);
    let exponent = exponent_after_rounding(value, digits);
    if is_plain(exponent) {
        fixed(value, places(to_i32(digits) - 1 - exponent))
    } else {
        let mantissa = value / 10f64.powi(exponent);
        times_power(&fixed(mantissa, digits - 1), exponent)
    }
}

/// Formats a value that a person wrote, such as a tolerance, with as few digits as identify it: `0.1`.
#[must_use]
pub fn exact(value: f64) -> String {
    if !value.is_finite() {
        return NOT_FINITE.to_owned();
    }
    // `{:e}` prints the shortest mantissa that reads back as the same double.
    let text = format!("{value:e}");
    let (mantissa, exponent) = split_exponent(&text);
    if is_plain(exponent) { typeset(&format!("{value}")) } else { times_power(&typeset(mantissa), exponent) }
}

/// Formats a value to a number of decimal places, with grouped digits: `−1 234.50`.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return NOT_FINITE.to_owned();
    }
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    // A value that rounds to zero has no sign.
    typeset(if is_zero { text.trim_start_matches('-') } else { &text })
}

/// Formats a count; digits are grouped if there are five or more: `9999`, `12 345`.
#[must_use]
pub fn count(value: u64) -> String {
    typeset(&value.to_string())
}

/// Standard error, relative to its value, below which it is left out.
const NO_ERROR: f64 = 1e-9;

/// Formats a value and its standard error in the same unit: `0.008753 ± 0.000021`, `(3.12 ± 0.05) × 10⁻⁷`.
///
/// Without a meaningful standard error (zero, negative, not finite), the value has seven significant digits.
#[must_use]
pub fn with_uncertainty(value: f64, std_error: f64) -> String {
    // A mere rounding error would require digits that nobody reads.
    if !value.is_finite() || !std_error.is_finite() || std_error <= NO_ERROR * value.abs() {
        return significant(value, 7);
    }
    let exponent = exponent_after_rounding(value.abs().max(std_error), 1);
    let power = if is_plain(exponent) { 0 } else { exponent };
    let unit = 10f64.powi(power);
    let decimals = decimals_for(value / unit, std_error / unit);
    let body = format!(
        "{}{NO_BREAK}±{NO_BREAK}{}",
        fixed(value / unit, decimals),
        fixed(std_error / unit, decimals)
    );
    if power == 0 { body } else { times_power(&format!("({body})"), power) }
}

/// Formats the two ends of an interval in the same unit, to the digits that its width justifies: `[0.1901,
/// 0.1919]`.
#[must_use]
pub fn interval(ends: [f64; 2]) -> String {
    let [low, high] = ends;
    if !low.is_finite() || !high.is_finite() {
        return NOT_FINITE.to_owned();
    }
    let exponent = exponent_after_rounding(low.abs().max(high.abs()), 1);
    let power = if is_plain(exponent) { 0 } else { exponent };
    let unit = 10f64.powi(power);
    // A 95 % interval is about four standard errors wide.
    let quarter = (high - low).abs() / 4.0 / unit;
    let decimals = decimals_for(low.abs().max(high.abs()) / unit, quarter);
    let body = format!("[{}, {}]", fixed(low / unit, decimals), fixed(high / unit, decimals));
    if power == 0 { body } else { times_power(&body, power) }
}

/// Formats an error in percent, for which two significant digits suffice: `3.1 × 10⁻⁷ %`.
#[must_use]
pub fn percent(value: f64) -> String {
    quantity(&significant(value, 2), "%")
}

/// Formats a share in percent with one decimal, or with three if a share below 1 would look like 100 %:
/// `99.970 %`.
#[must_use]
pub fn share(value: f64) -> String {
    let left = (1.0 - value).abs();
    quantity(&fixed(100.0 * value, if left < 0.001 && left > 0.0 { 3 } else { 1 }), "%")
}

/// Formats a probability to three decimals. Values that would round to 0 or 1 are given as below 0.001 or
/// above 0.999.
#[must_use]
pub fn probability(value: f64) -> String {
    if value > 0.0 && value < 5e-4 {
        format!("<{NO_BREAK}0.001")
    } else if (1.0 - 5e-4..1.0).contains(&value) {
        format!(">{NO_BREAK}0.999")
    } else {
        fixed(value, 3)
    }
}

/// Text for an estimate whose interval carries no information.
pub const UNDETERMINED: &str = "not determined by these data";

/// Formats an estimate with its 95 % interval, to the digits that the interval justifies: `484.12 N m
/// [483.90, 484.34]`.
#[must_use]
pub fn estimate(value: f64, interval_95: [f64; 2], unit: &str) -> String {
    let [low, high] = interval_95;
    let quarter = (high - low) / 4.0;
    let digits = if quarter.is_finite() && quarter > 0.0 && value.is_finite() {
        fixed_beside(value, quarter)
    } else {
        significant(value, 4)
    };
    format!("{} {}", quantity(&digits, unit), interval(interval_95))
}

/// Formats a value to the decimal place of its standard error's second digit.
fn fixed_beside(value: f64, std_error: f64) -> String {
    let exponent = exponent_after_rounding(value.abs().max(std_error), 1);
    let power = if is_plain(exponent) { 0 } else { exponent };
    let unit = 10f64.powi(power);
    let text = fixed(value / unit, decimals_for(value / unit, std_error / unit));
    if power == 0 { text } else { times_power(&text, power) }
}

/// Formats a share with its interval: `71.0 % [65.2 %, 77.1 %]`.
#[must_use]
pub fn share_with_interval(of: &WithInterval) -> String {
    let [low, high] = of.interval_95.map(share);
    format!("{} [{low}, {high}]", share(of.value))
}

/// Returns a unit symbol as it follows a number; the unit `1` of a pure number becomes empty.
#[must_use]
pub fn unit(symbol: &str) -> &str {
    if symbol == "1" { "" } else { symbol }
}

/// Formats a time span to three significant digits, in the unit from nanoseconds to seconds that leaves no
/// leading zeros: `1.20 µs`, `45.1 s`.
#[must_use]
pub fn duration(seconds: f64) -> String {
    let (scale, unit) = match seconds.abs() {
        0.0 => return quantity("0", "s"),
        size if size < 1e-6 => (1e9, "ns"),
        size if size < 1e-3 => (1e6, "µs"),
        size if size < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    quantity(&significant(seconds * scale, 3), unit)
}

/// Replaces non-breaking and narrow spaces by ordinary ones, for files and searches.
#[must_use]
pub fn plain_spaces(text: &str) -> String {
    text.replace([NO_BREAK, GROUP], " ")
}

/// Formats a number and its unit, kept on one line. An empty unit leaves only the number.
#[must_use]
pub fn quantity(number: &str, unit: &str) -> String {
    if unit.is_empty() { number.to_owned() } else { format!("{number}{NO_BREAK}{unit}") }
}

/// Formats a power of ten: `10⁻⁶`; the zeroth is `1`.
#[must_use]
pub fn power_of_ten(exponent: i32) -> String {
    if exponent == 0 { "1".to_owned() } else { format!("10{}", superscript(exponent)) }
}

/// Formats the label of one of evenly spaced ticks from `low` to `high`, `step` apart: with as many decimals
/// as the step needs, and with `× 10ⁿ` on axes of very large or very small numbers.
pub(crate) fn tick(value: f64, low: f64, high: f64, step: f64) -> String {
    let largest = exponent_after_rounding(low.abs().max(high.abs()), 1);
    let finest = exponent_after_rounding(step, 1);
    if (-3..6).contains(&largest) {
        return fixed(value, places(-finest));
    }
    let mantissa = value / 10f64.powi(largest);
    let text = fixed(mantissa, places(largest - finest));
    if value.abs() < step / 2.0 { "0".to_owned() } else { times_power(&text, largest) }
}

/// Returns the decimal places that show two significant digits of `std_error`, and no digit of `value` that a
/// double does not carry.
fn decimals_for(value: f64, std_error: f64) -> usize {
    let carried = MOST_DIGITS - 1 - exponent_after_rounding(value, 1);
    let wanted = if std_error > 0.0 { 1 - exponent_after_rounding(std_error, 2) } else { 7 };
    places(wanted.min(carried))
}

/// Returns decimal places: zero if a number ends before its decimal point.
fn places(wanted: i32) -> usize {
    wanted.max(0) as usize
}

/// Returns the decimal exponent of a value rounded to `digits` significant digits, so that 9.96 to two digits
/// counts as 10. Zero has exponent 0.
fn exponent_after_rounding(value: f64, digits: usize) -> i32 {
    let decimals = digits.saturating_sub(1);
    split_exponent(&format!("{value:.decimals$e}")).1
}

/// Splits `"1.5e-7"` into `("1.5", -7)`.
fn split_exponent(text: &str) -> (&str, i32) {
    match text.split_once('e') {
        Some((mantissa, exponent)) => (mantissa, exponent.parse().unwrap_or(0)),
        None => (text, 0),
    }
}

/// Returns `true` if numbers of this decimal exponent are written without a power of ten.
fn is_plain(exponent: i32) -> bool {
    (-4..6).contains(&exponent)
}

fn to_i32(digits: usize) -> i32 {
    i32::try_from(digits).unwrap_or(MOST_DIGITS)
}

fn times_power(mantissa: &str, exponent: i32) -> String {
    format!("{mantissa}{NO_BREAK}×{NO_BREAK}10{}", superscript(exponent))
}

fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            '9' => '⁹',
            _ => '⁰',
        })
        .collect()
}

/// Typesets a plain decimal numeral with a true minus sign, and with its integer part in groups of three if
/// that part has five digits or more.
fn typeset(numeral: &str) -> String {
    let (sign, rest) = match numeral.strip_prefix('-') {
        Some(rest) => (Some(MINUS), rest),
        None => (None, numeral),
    };
    let (whole, fraction) = match rest.split_once('.') {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (rest, None),
    };
    let grouped = whole.len() >= 5;
    let mut text = String::with_capacity(numeral.len() + 4);
    text.extend(sign);
    for (position, digit) in whole.chars().enumerate() {
        if grouped && position > 0 && (whole.len() - position).is_multiple_of(3) {
            text.push(GROUP);
        }
        text.push(digit);
    }
    if let Some(fraction) = fraction {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Replaces the non-breaking characters by plain spaces, to keep the expectations readable.
    fn plain(text: &str) -> String {
        text.replace([NO_BREAK, GROUP], " ")
    }

    #[test]
    fn significant_digits_are_kept_and_powers_of_ten_typeset() {
        assert_eq!(plain(&significant(0.008_753, 5)), "0.0087530");
        assert_eq!(plain(&significant(3.14e-7, 2)), "3.1 × 10⁻⁷");
        assert_eq!(plain(&significant(-21.816_61, 6)), "−21.8166");
        assert_eq!(plain(&significant(0.0, 3)), "0.00");
        assert_eq!(plain(&significant(9.96e-8, 2)), "1.0 × 10⁻⁷");
        assert_eq!(plain(&significant(12_345.0, 5)), "12 345");
        assert_eq!(plain(&significant(6.02e23, 3)), "6.02 × 10²³");
    }

    #[test]
    fn what_is_not_finite_is_said_in_words() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(significant(value, 3), "not finite");
            assert_eq!(exact(value), "not finite");
            assert_eq!(fixed(value, 3), "not finite");
            assert_eq!(with_uncertainty(value, 1.0), "not finite");
            assert_eq!(interval([0.0, value]), "not finite");
        }
        assert_eq!(with_uncertainty(1.0, f64::NAN), "1.000000");
    }

    #[test]
    fn written_values_keep_their_few_digits() {
        assert_eq!(exact(0.1), "0.1");
        assert_eq!(plain(&exact(5e-7)), "5 × 10⁻⁷");
        assert_eq!(exact(-2.0), "−2");
        assert_eq!(exact(0.0), "0");
    }

    #[test]
    fn a_rounded_zero_has_no_sign() {
        assert_eq!(fixed(-0.0004, 2), "0.00");
        assert_eq!(fixed(-0.0, 0), "0");
    }

    #[test]
    fn digits_follow_the_uncertainty() {
        assert_eq!(plain(&with_uncertainty(0.008_753_04, 0.000_207)), "0.00875 ± 0.00021");
        assert_eq!(plain(&with_uncertainty(0.190_961, 0.004_54)), "0.1910 ± 0.0045");
        assert_eq!(plain(&with_uncertainty(3.123e-7, 5.4e-9)), "(3.123 ± 0.054) × 10⁻⁷");
        assert_eq!(plain(&with_uncertainty(50.001_234, 0.000_099_7)), "50.00123 ± 0.00010");
        assert_eq!(plain(&with_uncertainty(1.0, 250.0)), "1 ± 250");
    }

    #[test]
    fn an_uncertainty_below_a_double_invents_no_digits() {
        let text = with_uncertainty(0.190_961, 1e-30);
        assert!(text.len() < 50, "{text}");
        assert_eq!(with_uncertainty(200.0, 1e-14), "200.0000");
    }

    #[test]
    fn an_estimate_has_the_digits_of_its_interval() {
        assert_eq!(plain(&estimate(484.123_456, [483.9, 484.35], "N m")), "484.12 N m [483.90, 484.35]");
        assert_eq!(
            plain(&estimate(1.533_986_9e-6, [1.53e-6, 1.54e-6], "")),
            "1.5340 × 10⁻⁶ [1.5300, 1.5400] × 10⁻⁶"
        );
        assert_eq!(plain(&estimate(1.5, [1.5, 1.5], "s")), "1.500 s [1.5000000, 1.5000000]");
    }

    #[test]
    fn no_probability_is_a_row_of_zeros() {
        assert_eq!(plain(&probability(7.6e-147)), "< 0.001");
        assert_eq!(probability(0.0), "0.000");
        assert_eq!(probability(0.9512), "0.951");
        assert_eq!(plain(&probability(0.9996)), "> 0.999");
        assert_eq!(probability(1.0), "1.000");
    }

    #[test]
    fn intervals_share_their_digits_and_power() {
        assert_eq!(interval([0.181_98, 0.199_94]), "[0.1820, 0.1999]");
        assert_eq!(plain(&interval([-2.0e-7, 3.0e-7])), "[−2.0, 3.0] × 10⁻⁷");
        assert_eq!(interval([1.0, 1.0]), "[1.0000000, 1.0000000]");
    }

    #[test]
    fn no_share_looks_like_the_whole_that_is_less() {
        assert_eq!(plain(&share(0.711)), "71.1 %");
        assert_eq!(plain(&share(0.9997)), "99.970 %");
        assert_eq!(plain(&share(1.0)), "100.0 %");
        assert_eq!(
            plain(&share_with_interval(&WithInterval { value: 0.5, interval_95: [-0.1, 1.0] })),
            "50.0 % [−10.0 %, 100.0 %]"
        );
        assert_eq!([unit("1"), unit("N m")], ["", "N m"]);
    }

    #[test]
    fn spans_of_time_choose_their_unit() {
        assert_eq!(plain(&duration(1.2e-6)), "1.20 µs");
        assert_eq!(plain(&duration(4.51e-2)), "45.1 ms");
        assert_eq!(plain(&duration(3.4e-8)), "34.0 ns");
        assert_eq!(plain(&duration(83.25)), "83.2 s");
        assert_eq!(plain(&duration(0.0)), "0 s");
        assert_eq!(plain(&duration(f64::NAN)), "not finite s");
    }

    #[test]
    fn counts_are_grouped_from_five_digits() {
        assert_eq!(count(9_999), "9999");
        assert_eq!(plain(&count(1_234_567)), "1 234 567");
    }

    #[test]
    fn ticks_show_what_their_step_needs() {
        assert_eq!(tick(0.2, 0.0, 1.0, 0.2), "0.2");
        assert_eq!(plain(&tick(15_000.0, 0.0, 20_000.0, 5_000.0)), "15 000");
        assert_eq!(plain(&tick(2e-9, -4e-9, 4e-9, 2e-9)), "2 × 10⁻⁹");
        assert_eq!(tick(0.0, -4e-9, 4e-9, 2e-9), "0");
        assert_eq!(tick(1e-25, -0.4, 0.4, 0.2), "0.0");
    }

    #[test]
    fn powers_of_ten() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(power_of_ten(0), "1");
    }
}
