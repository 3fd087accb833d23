//! Reader of RIFF WAVE files, as oscilloscopes, sound cards and vibration loggers write them.
//!
//! Source: Microsoft and IBM, *Multimedia Programming Interface and Data Specifications 1.0*, with
//! Microsoft's `WAVEFORMATEXTENSIBLE`; EBU Tech 3306 for RF64.

#![allow(clippy::indexing_slicing, reason = "the head of the chunk was read")]

use super::bytes::{length_at, number_at};
use super::sheet::{Cell, Sheet};
use super::unread::Unread;

const PCM: u64 = 1;
const FLOAT: u64 = 3;
const EXTENSIBLE: u64 = 0xfffe;

/// Format of the samples.
struct Format {
    /// Encoding: [`PCM`] or [`FLOAT`].
    tag: u64,
    channels: usize,
    /// Sampling rate, in hertz.
    rate_hz: f64,
    /// Number of bytes of one sample of one channel.
    size: usize,
}

/// Returns the table of a WAVE file: the time, in seconds, and each channel as a fraction of full scale.
pub(super) fn text(bytes: &[u8]) -> Option<Result<String, Unread>> {
    let is_riff = bytes.starts_with(b"RIFF") || bytes.starts_with(b"RF64");
    (is_riff && bytes.get(8..12) == Some(b"WAVE")).then(|| read(bytes).map_err(unread))
}

fn unread(problem: String) -> Unread {
    Unread {
        kind: "a WAVE file",
        problem,
        remedy: "convert it to plain samples, in Python with\n    \
                 import soundfile; values, rate = soundfile.read('in.wav')\n    \
                 soundfile.write('out.wav', values, rate, subtype='FLOAT')"
            .to_owned(),
    }
}

fn read(bytes: &[u8]) -> Result<String, String> {
    let (format, data) = chunks(bytes)?;
    let names: Vec<String> = std::iter::once("time_s".to_owned())
        .chain((1..=format.channels).map(|channel| format!("channel_{channel}")))
        .collect();
    let mut sheet = Sheet::new(&[], &names);
    // The product cannot overflow: it was compared with the format's own frame of 16 bits.
    for (index, frame) in data.chunks_exact(format.size * format.channels).enumerate() {
        let time = Cell::Float(index as f64 / format.rate_hz);
        sheet.row(
            std::iter::once(time)
                .chain(frame.chunks_exact(format.size).map(|sample| value(format.tag, sample))),
        );
    }
    Ok(sheet.finish())
}

/// Returns the format and the bytes of the samples.
fn chunks(bytes: &[u8]) -> Result<(Format, &[u8]), String> {
    let (mut at, mut format) = (12, None);
    // The size in the file's first chunk counts all bytes after it.
    let unfinished = length_at(bytes, 4, 4).is_none_or(|size| size < bytes.len() - 8);
    while let (Some(name), Some(size)) = (bytes.get(at..at + 4), length_at(bytes, at + 4, 4)) {
        // A recorder that was cut off has not yet written its size, or has fewer bytes than it announced.
        let rest = &bytes[at + 8..];
        let unknown = name == b"data" && (size == 0xffff_ffff || size == 0 && unfinished);
        let body = rest.get(..size).filter(|_| !unknown).unwrap_or(rest);
        match (name, format.take()) {
            (b"fmt ", _) => format = Some(self::format(body)?),
            (b"data", Some(format)) => return Ok((format, body)),
            (b"data", None) => return Err("its samples come before their format".to_owned()),
            (_, kept) => format = kept,
        }
        // Chunks begin at even offsets.
        at = (at + 8).saturating_add(size).saturating_add(size % 2);
        if at > bytes.len() {
            break;
        }
    }
    Err("it holds no samples".to_owned())
}

fn format(body: &[u8]) -> Result<Format, String> {
    let incomplete = || "the description of its samples is incomplete".to_owned();
    let field = |at: usize, size: usize| number_at(body, at, size).ok_or_else(incomplete);
    let tag = match field(0, 2)? {
        EXTENSIBLE => field(24, 2)?,
        tag => tag,
    };
    let (channels, rate, frame) = (field(2, 2)?, field(4, 4)?, field(12, 2)?);
    if channels == 0 || rate == 0 || frame == 0 || frame % channels != 0 {
        return Err("the description of its samples contradicts itself".to_owned());
    }
    let size = frame / channels;
    if !matches!((tag, size), (PCM, 1..=4) | (FLOAT, 4 | 8)) {
        return Err(format!("its samples are compressed or unusual (encoding {tag}, {} bits)", 8 * size));
    }
    let length = |number: u64| usize::try_from(number).map_err(|_| incomplete());
    Ok(Format { tag, channels: length(channels)?, rate_hz: rate as f64, size: length(size)? })
}

/// Returns a sample as a fraction of full scale. Samples of one byte are unsigned, longer ones signed; those
/// with fewer valid bits than their bytes have are filled up with zeros from below.
fn value(tag: u64, sample: &[u8]) -> Cell {
    let Some(bits) = number_at(sample, 0, sample.len()) else { return Cell::Missing };
    match (tag, sample.len()) {
        // Both casts keep all bits: the lengths are those of the types.
        (FLOAT, 4) => Cell::Single(f32::from_bits(bits as u32)),
        (FLOAT, _) => Cell::Float(f64::from_bits(bits)),
        (_, 1) => Cell::Float((bits as f64 - 128.0) / 128.0),
        (_, size) => {
            // Moved to the top of 64 bits, the number's sign is the sign of the whole.
            let top = (bits << (64 - 8 * size)) as i64;
            Cell::Float(top as f64 / -(i64::MIN as f64))
        }
    }
}
