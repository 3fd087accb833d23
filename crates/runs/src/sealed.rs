//! Sealed files, read whole or not at all: a first line, the digest of the bytes, and the bytes.

use crate::atomic;
use crate::disk::Disk;
use crate::error::RunError;
use sha2::{Digest, Sha256};
use std::path::Path;

/// First line of a sealed file.
const MARK: &[u8] = b"ringdown.checkpoint/1\n";

/// Length of a SHA-256 digest, in bytes.
const DIGEST: usize = 32;

/// Writes bytes atomically, as [`atomic::write`] does, with their digest.
pub(crate) fn write(disk: &Disk, path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    atomic::write(disk, path, &seal(bytes))
}

/// Reads and verifies a file that [`write`] wrote.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, RunError> {
    let content = std::fs::read(path).map_err(RunError::io(path, "read"))?;
    open(&content).map_err(|problem| RunError::Damaged { path: path.to_owned(), problem })
}

fn seal(bytes: &[u8]) -> Vec<u8> {
    let mut content = MARK.to_vec();
    content.extend_from_slice(&Sha256::digest(bytes));
    content.extend_from_slice(bytes);
    content
}

fn open(content: &[u8]) -> Result<Vec<u8>, String> {
    let rest = content.strip_prefix(MARK).ok_or("it does not begin as a checkpoint")?;
    let (stated, bytes) = rest.split_at_checked(DIGEST).ok_or("it ends within its head")?;
    if Sha256::digest(bytes).as_slice() == stated {
        Ok(bytes.to_vec())
    } else {
        Err(format!("its {} bytes do not have the digest that it states", bytes.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::{MARK, open, seal};

    #[test]
    fn every_flipped_bit_and_every_cut_is_noticed() {
        for bytes in [&b""[..], b"x", b"parameters, optimizer, step, generator, trace"] {
            let sealed = seal(bytes);
            assert_eq!(open(&sealed).unwrap(), bytes);
            let head = sealed.len() - bytes.len();
            for at in 0..sealed.len() {
                let says = match at {
                    at if at < MARK.len() => "does not begin as a checkpoint",
                    at if at < head => "ends within its head",
                    _ => "do not have the digest",
                };
                assert!(open(&sealed[..at]).unwrap_err().contains(says), "{at}");
                for bit in 0..8 {
                    let mut flipped = sealed.clone();
                    flipped[at] ^= 1 << bit;
                    let says = if at < MARK.len() { "as a checkpoint" } else { "do not have the digest" };
                    assert!(open(&flipped).unwrap_err().contains(says), "byte {at} bit {bit}");
                }
            }
            assert!(open(&[&sealed[..], b"\n"].concat()).unwrap_err().contains("do not have the digest"));
        }
    }
}
