//! Rows as CSV.

use crate::error::RunError;
use serde::Serialize;

/// Rows as CSV text with a header from the fields' names. Numbers are written with every digit that it
/// takes to read the same double again.
///
/// # Errors
/// [`RunError::Encoding`] where a row has no place in a table.
pub fn to_csv<T: Serialize>(name: &str, rows: &[T]) -> Result<Vec<u8>, RunError> {
    let refused = |problem: String| RunError::Encoding { name: name.to_owned(), problem };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(|error| refused(error.to_string()))?;
    }
    writer.into_inner().map_err(|error| refused(error.to_string()))
}
