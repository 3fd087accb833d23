//! Digests of texts and bytes.

use sha2::{Digest, Sha256};

/// SHA-256 in hexadecimal, prefixed `sha256:`, as results write it.
#[must_use]
pub fn digest(bytes: &[u8]) -> String {
    format!("sha256:{}", hexadecimal(&Sha256::digest(bytes)))
}

pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
