//! Files that hold a table in another form than lines of text: recognized by their content and turned into
//! the text of a plain table.
//!
//! The text has a header and one line per sample, as the reader of the `csv` format expects it; that reader
//! chooses columns and units. Names of files play no role, because instruments and people rename them.

mod bytes;
mod json;
mod literal;
mod lvm;
mod npy;
mod npz;
mod scope;
mod serial;
mod sheet;
#[cfg(test)]
mod tests;
mod unread;
mod wav;

use crate::text::text_of;
pub(crate) use unread::Unread;

/// Returns the text of a plain table with the content of a file, or `None` if the file is of none of the
/// kinds that this module knows, in which case it may be a plain table itself.
pub(crate) fn text(bytes: &[u8]) -> Option<Result<String, Unread>> {
    let binary = || wav::text(bytes).or_else(|| npy::text(bytes)).or_else(|| npz::text(bytes));
    let lines = || serial::text(bytes).or_else(|| scope::text(bytes)).map(Ok);
    binary().or_else(|| textual(bytes)).or_else(lines)
}

/// Returns the table of a file that is text, but not lines of columns.
fn textual(bytes: &[u8]) -> Option<Result<String, Unread>> {
    // Most files are plain tables: these first signs spare them from being decoded twice.
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start().first()?;
    if !matches!(start, b'L' | b'{' | b'[' | b'<' | 0xfe | 0xff) {
        return None;
    }
    let text = text_of(bytes).ok()?;
    let text = text.trim_start_matches('\u{feff}').trim_start();
    lvm::text(text).or_else(|| phyphox(text)).or_else(|| json::text(text))
}

/// Returns the refusal of an experiment's description by the app phyphox, which is XML and holds no samples.
fn phyphox(text: &str) -> Option<Result<String, Unread>> {
    let start: String = text.chars().take(4000).collect();
    (start.starts_with('<') && start.contains("<phyphox")).then(|| {
        Err(Unread {
            kind: "an experiment's description by phyphox",
            problem: "it says how to measure and holds no samples".to_owned(),
            remedy: "in the app, open the recording, choose Export Data and then CSV".to_owned(),
        })
    })
}
