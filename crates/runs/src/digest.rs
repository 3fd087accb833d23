//! Digests of texts and bytes.

use sha2::{Digest, Sha256};

/// Returns the SHA-256 digest in hexadecimal, prefixed with `sha256:`, in the form used in results.
#[must_use]
pub fn digest(bytes: &[u8]) -> String {
    format!("sha256:{}", hexadecimal(&Sha256::digest(bytes)))
}

pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::digest;

    /// First example of FIPS 180-2, appendix B.1.
    #[test]
    fn it_is_the_standard_s() {
        assert_eq!(digest(b"abc"), "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
