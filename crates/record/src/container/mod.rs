//! Files that hold a table in another form than lines of text: recognized by their content and turned into
//! the text of a plain table.
//!
//! The text has a header and one line per sample, as the reader of the `csv` format expects it; that reader
//! chooses columns and units. Names of files play no role, because instruments and people rename them.

mod bytes;
mod cassy;
mod json;
mod literal;
mod lvm;
mod mat;
mod npy;
mod npz;
mod plotter;
mod scope;
mod serial;
mod sheet;
#[cfg(test)]
mod tests;
mod unread;
mod wav;

use crate::text::text_of;
pub(crate) use unread::Unread;

/// Content of a file as a plain table.
pub(crate) struct Contained {
    /// Kind of the file, as `read as:` says it.
    pub(crate) kind: &'static str,
    pub(crate) text: String,
}

/// Returns the content of a file as a plain table, or `None` if the file is of none of the kinds that this
/// module knows, in which case it may be a plain table itself.
pub(crate) fn table(bytes: &[u8]) -> Option<Result<Contained, Unread>> {
    let lines = || -> Option<Contained> {
        let serial = serial::text(bytes);
        let sent = serial.as_ref().map_or(bytes, |text| text.as_bytes());
        let labeled = plotter::text(sent).map(|text| Contained { kind: "labels with numbers", text });
        labeled
            .or(serial.map(|text| Contained { kind: "lines of a serial monitor", text }))
            .or_else(|| Some(Contained { kind: "an oscilloscope's table", text: scope::text(bytes)? }))
            .or_else(|| Some(Contained { kind: "a CASSY table", text: cassy::text(bytes)? }))
    };
    of("a WAVE sound", wav::text(bytes))
        .or_else(|| of("a NumPy array", npy::text(bytes)))
        .or_else(|| of("an archive of NumPy arrays", npz::text(bytes)))
        .or_else(|| of("a MATLAB file", mat::text(bytes)))
        .or_else(|| textual(bytes))
        .or_else(|| lines().map(Ok))
}

fn of(kind: &'static str, read: Option<Result<String, Unread>>) -> Option<Result<Contained, Unread>> {
    read.map(|read| read.map(|text| Contained { kind, text }))
}

/// Returns the table of a file that is text, but not lines of columns.
fn textual(bytes: &[u8]) -> Option<Result<Contained, Unread>> {
    // Most files are plain tables: these first signs spare them from being decoded twice.
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start().first()?;
    if !matches!(start, b'L' | b'{' | b'[' | b'<' | 0xfe | 0xff) {
        return None;
    }
    let text = text_of(bytes).ok()?;
    let text = text.trim_start_matches('\u{feff}').trim_start();
    of("a LabVIEW measurement file", lvm::text(text).or_else(|| phyphox(text)))
        .or_else(|| of("JSON", json::text(text)))
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
