//! TensorBoard's event files: records framed as TensorFlow does, each a protocol buffer of the message
//! `Event`.
//!
//! Format: `tensorflow/core/lib/io/record_writer.h` for the frames, `tensorflow/core/util/event.proto` and
//! `tensorflow/core/framework/summary.proto` for the messages. A scalar in this format is a 32-bit float,
//! which has seven digits.

use crate::Finished;

/// Returns the name of the event file within a run's folder. It has to contain `tfevents` for TensorBoard to
/// find it.
#[must_use]
pub fn file_name(run: &Finished) -> String {
    format!("tensorboard/events.out.tfevents.{}.ringdown", run.began_ms / 1000)
}

/// Encodes the whole file: its version, the curves by step, and the result's numbers at the last step.
///
/// A run's folder holds no times of single steps, so all steps have the run's start time.
#[must_use]
pub fn events(run: &Finished) -> Vec<u8> {
    let time = run.began_ms as f64 / 1000.0;
    let mut file = Vec::new();
    frame(&mut file, &event(time, 0, &bytes(3, b"brain.Event:2")));
    for curve in &run.curves {
        for (step, value) in &curve.points {
            frame(&mut file, &event(time, *step, &scalar(&format!("trace/{}", curve.name), *value)));
        }
    }
    let ends = run.curves.iter().filter_map(|curve| curve.points.last());
    let last = ends.map(|(step, _)| *step).fold(0, i64::max);
    for (name, value) in &run.metrics {
        let tag = format!("result/{}", name.replace('.', "/"));
        frame(&mut file, &event(time, last, &scalar(&tag, *value)));
    }
    file
}

/// Encodes `Event { wall_time = 1, step = 2 }` with one more field.
fn event(time: f64, step: i64, content: &[u8]) -> Vec<u8> {
    let mut message = key(1, 1);
    message.extend(time.to_le_bytes());
    message.extend(key(2, 0));
    message.extend(varint(step as u64));
    message.extend(content);
    message
}

/// Encodes `Event.summary = 5` with one `Summary.value = 1 { tag = 1, simple_value = 2 }`.
fn scalar(tag: &str, value: f64) -> Vec<u8> {
    let mut inner = bytes(1, tag.as_bytes());
    inner.extend(key(2, 5));
    inner.extend((value as f32).to_le_bytes());
    bytes(5, &bytes(1, &inner))
}

/// Encodes a field with a length: text, bytes or a message.
fn bytes(field: u8, content: &[u8]) -> Vec<u8> {
    let mut message = key(field, 2);
    message.extend(varint(content.len() as u64));
    message.extend(content);
    message
}

fn key(field: u8, wire_type: u8) -> Vec<u8> {
    varint(u64::from(field) << 3 | u64::from(wire_type))
}

/// Encodes a number with seven bits in each byte, lowest bits first; the eighth bit is set if more bytes
/// follow.
fn varint(mut value: u64) -> Vec<u8> {
    let mut digits = Vec::new();
    while value >= 0x80 {
        digits.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    digits.push(value as u8);
    digits
}

/// Appends a frame: length, checksum of the length, content, checksum of the content.
fn frame(file: &mut Vec<u8>, content: &[u8]) {
    let length = (content.len() as u64).to_le_bytes();
    file.extend(length);
    file.extend(masked_checksum(&length).to_le_bytes());
    file.extend(content);
    file.extend(masked_checksum(content).to_le_bytes());
}

/// Computes the masked checksum: a CRC-32C, rotated and shifted, so that checksums of data that contain
/// checksums differ from these (`tensorflow/core/lib/hash/crc32c.h`).
fn masked_checksum(content: &[u8]) -> u32 {
    crc32c::crc32c(content).rotate_right(15).wrapping_add(0xa282_ead8)
}

#[cfg(test)]
mod tests {
    use super::{masked_checksum, varint};

    /// The check value of the Castagnoli polynomial, 0xe3069283, masked.
    #[test]
    fn the_checksum_is_masked() {
        assert_eq!(masked_checksum(b"123456789"), 0xc78a_b0e5);
    }

    /// Examples of the protocol buffers' documentation.
    #[test]
    fn whole_numbers_are_written_seven_bits_a_byte() {
        assert_eq!(varint(1), [1]);
        assert_eq!(varint(150), [0x96, 0x01]);
        assert_eq!(varint(u64::MAX).len(), 10);
    }
}
