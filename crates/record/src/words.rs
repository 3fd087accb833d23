//! Formatting of counts and errors for sentences.

/// Returns a count with its noun in the right number: `1 sample`, `3 samples`.
#[must_use]
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Formats an error to two significant digits, with a power of ten only if that is shorter.
#[must_use]
pub fn two_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = libm::log10(value.abs()).floor();
    if (-2.0..4.0).contains(&exponent) {
        let decimals = (1.0 - exponent).max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}

/// Formats a quantity to three significant digits with the prefix of its unit: 2.3e-4 V as "0.230 mV".
#[must_use]
pub fn prefixed(value: f64, unit: &str) -> String {
    let size = value.abs();
    let (factor, prefix) = match size {
        size if !(1e-10..1e5).contains(&size) => return format!("{value:.2e} {unit}"),
        size if size < 1e-7 => (1e9, "n"),
        size if size < 1e-4 => (1e6, "µ"),
        size if size < 0.1 => (1e3, "m"),
        _ => (1.0, ""),
    };
    let scaled = value * factor;
    let decimals = (2.0 - libm::log10(scaled.abs()).floor()).clamp(0.0, 3.0) as usize;
    format!("{scaled:.decimals$} {prefix}{unit}")
}

#[cfg(test)]
mod tests {
    use super::{prefixed, two_digits};

    #[test]
    fn two_digits_say_how_large_an_error_is() {
        for (value, text) in
            [(0.0123, "0.012"), (1.5, "1.5"), (250.0, "250"), (2.04e-4, "2.0e-4"), (0.0, "0")]
        {
            assert_eq!(two_digits(value), text);
        }
    }

    #[test]
    fn a_quantity_gets_the_prefix_that_leaves_few_digits() {
        for (value, expected) in [
            (2.317e-4, "0.232 mV"),
            (0.0123, "12.3 mV"),
            (1.87e-5, "18.7 µV"),
            (0.1912, "0.191 V"),
            (4e-12, "4.00e-12 V"),
        ] {
            assert_eq!(prefixed(value, "V"), expected);
        }
    }
}
