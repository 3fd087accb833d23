//! Tables as CSV.

use crate::error::RunError;
use serde::Serialize;

/// Encodes rows as CSV text with a header of the field names. Numbers have as many digits as needed to read
/// the same double again.
///
/// # Errors
/// [`RunError::Encoding`] if a row cannot be written as a row of a table.
pub fn to_csv<T: Serialize>(name: &str, rows: &[T]) -> Result<Vec<u8>, RunError> {
    let refused = |problem: String| RunError::Encoding { name: name.to_owned(), problem };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(|error| refused(error.to_string()))?;
    }
    writer.into_inner().map_err(|error| refused(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::to_csv;
    use results::TraceRow;

    #[test]
    fn what_is_read_again_is_what_was_written_to_the_bit() {
        let row = |step, phase: &str, loss| TraceRow { step, phase: phase.into(), loss, decay_rate: -loss };
        let rows = [row(0, "a, \"b\"", 0.1 + 0.2), row(u64::MAX, "", f64::MIN_POSITIVE / 3.0)];
        let text = to_csv("trace.csv", &rows).unwrap();
        assert!(text.starts_with(b"step,phase,loss,decay_rate\n"));
        let read: Vec<TraceRow> =
            csv::Reader::from_reader(&text[..]).deserialize().map(Result::unwrap).collect();
        assert_eq!(read, rows);
        assert_eq!(to_csv::<TraceRow>("trace.csv", &[]).unwrap(), b"");
    }
}
