//! Numbers with intervals, and their deserialization when they are not finite.

use serde::{Deserialize, Deserializer, Serialize};

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WithInterval {
    /// The estimate; not finite, in JSON `null`, if there is none.
    #[serde(deserialize_with = "null_is_not_a_number")]
    pub value: f64,
    /// Lower and upper ends of the 95 % interval; an end that is not finite is `null`.
    #[serde(deserialize_with = "nulls_are_not_numbers")]
    pub interval_95: [f64; 2],
}

/// Distance of the ends of a 95 % interval from a normally distributed estimate, in standard errors.
const NINETY_FIVE: f64 = 1.96;

impl WithInterval {
    /// Creates a normally distributed estimate from its standard error.
    #[must_use]
    pub fn normal(value: f64, std_error: f64) -> Self {
        let half = NINETY_FIVE * std_error;
        Self { value, interval_95: [value - half, value + half] }
    }

    /// Returns the standard error of a normally distributed estimate.
    #[must_use]
    pub fn std_error(&self) -> f64 {
        let [low, high] = self.interval_95;
        0.5 * (high - low) / NINETY_FIVE
    }
}

/// Deserializes a number, reading `null` as NaN: JSON cannot express numbers that are not finite and writes
/// `null`.
pub(crate) fn null_is_not_a_number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

/// Deserializes two numbers like [`null_is_not_a_number`].
pub(crate) fn nulls_are_not_numbers<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<[f64; 2], D::Error> {
    Ok(<[Option<f64>; 2]>::deserialize(deserializer)?.map(|end| end.unwrap_or(f64::NAN)))
}

#[cfg(test)]
mod tests {
    use super::WithInterval;

    #[test]
    fn an_end_that_is_no_number_is_null_and_read_again_as_none() {
        let open = WithInterval { value: 0.25, interval_95: [f64::NEG_INFINITY, 0.75] };
        let text = serde_json::to_string(&open).unwrap();
        assert_eq!(text, "{\"value\":0.25,\"interval_95\":[null,0.75]}");
        let read: WithInterval = serde_json::from_str(&text).unwrap();
        assert!(read.interval_95[0].is_nan() && read.interval_95[1] == 0.75 && read.value == 0.25);
    }
}
