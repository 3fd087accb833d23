//! Numbers in the bytes of a file.

/// Returns the unsigned number in `size` bytes, lowest byte first, at an offset.
pub(super) fn number_at(bytes: &[u8], at: usize, size: usize) -> Option<u64> {
    let bytes = bytes.get(at..at.checked_add(size)?)?;
    Some(bytes.iter().rev().fold(0, |number, byte| (number << 8) | u64::from(*byte)))
}

/// Returns the number at an offset as a length or an offset.
pub(super) fn length_at(bytes: &[u8], at: usize, size: usize) -> Option<usize> {
    number_at(bytes, at, size)?.try_into().ok()
}
