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
    let exponent = value.abs().log10().floor();
    if (-2.0..4.0).contains(&exponent) {
        let decimals = (1.0 - exponent).max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::two_digits;

    #[test]
    fn two_digits_say_how_large_an_error_is() {
        for (value, text) in
            [(0.0123, "0.012"), (1.5, "1.5"), (250.0, "250"), (2.04e-4, "2.0e-4"), (0.0, "0")]
        {
            assert_eq!(two_digits(value), text);
        }
    }
}
