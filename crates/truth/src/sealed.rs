//! A value that shows its digest only.

use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::fmt;
use std::marker::PhantomData;
use thiserror::Error;

/// Why a sealed value could not be made or opened.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SealError {
    /// The text is not the one that was sealed.
    #[error(
        "the seal is broken: the text has the digest {found}, not {stated}; it was changed after sealing"
    )]
    Broken {
        /// The digest stated.
        stated: String,
        /// The digest of the text.
        found: String,
    },
    /// The text under an intact seal is not what is expected.
    #[error("the sealed text cannot be read: {problem}; it was written by another version of the program")]
    Unreadable {
        /// What the reader says.
        problem: String,
    },
    /// The value has no text.
    #[error("the value cannot be sealed: {problem} (a fault of the program, please report it)")]
    Unwritable {
        /// What the writer says.
        problem: String,
    },
}

/// A value as JSON text under its SHA-256 digest, `sha256:` and 64 hexadecimal digits.
///
/// It can be stored and handed on unseen: neither `Debug` nor `Display` shows more than the digest.
#[derive(Clone, PartialEq, Eq)]
pub struct Sealed<T> {
    text: String,
    digest: String,
    content: PhantomData<fn() -> T>,
}

impl<T> Sealed<T> {
    /// A sealed value that was stored as text and digest. Whether they belong together shows on opening.
    #[must_use]
    pub fn from_stored(text: String, digest: String) -> Self {
        Self { text, digest, content: PhantomData }
    }

    /// The digest: what may be published before the value.
    #[must_use]
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// The text to be stored. Whoever reads it knows the value; it belongs apart from what the value explains.
    #[must_use]
    pub fn text_to_store(&self) -> &str {
        &self.text
    }
}

impl<T: Serialize + DeserializeOwned> Sealed<T> {
    /// Seals a value.
    ///
    /// # Errors
    /// [`SealError::Unwritable`] where the value has no JSON.
    pub fn seal(value: &T) -> Result<Self, SealError> {
        let mut text = serde_json::to_string_pretty(value)
            .map_err(|error| SealError::Unwritable { problem: error.to_string() })?;
        text.push('\n');
        let digest = digest(&text);
        Ok(Self::from_stored(text, digest))
    }

    /// Opens the seal.
    ///
    /// # Errors
    /// [`SealError::Broken`] where a single byte differs from what was sealed, [`SealError::Unreadable`] where
    /// the text is intact but is no such value.
    pub fn open(&self) -> Result<T, SealError> {
        let found = digest(&self.text);
        if found != self.digest {
            return Err(SealError::Broken { stated: self.digest.clone(), found });
        }
        serde_json::from_str(&self.text).map_err(|error| SealError::Unreadable { problem: error.to_string() })
    }
}

/// SHA-256 of a text as seals and manifests write it: `sha256:` and 64 hexadecimal digits.
#[must_use]
pub fn digest(text: &str) -> String {
    let hex: String = Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect();
    format!("sha256:{hex}")
}

impl<T> fmt::Debug for Sealed<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Sealed({})", self.digest)
    }
}

impl<T> fmt::Display for Sealed<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.digest)
    }
}

#[cfg(test)]
mod tests {
    use super::{SealError, Sealed};

    #[test]
    fn it_opens_to_what_was_sealed_and_shows_nothing_before() {
        let sealed = Sealed::seal(&vec![0.1_f64, 1e-300, -3.5]).unwrap();
        assert_eq!(sealed.open().unwrap(), [0.1, 1e-300, -3.5]);
        assert!(!format!("{sealed:?} {sealed}").contains("3.5"));
        // SHA-256 of the five bytes `true\n`, by another program.
        let known = "sha256:a17fcf0a2f50e2d495e4f90ce263410edc183add6c62699a2facbccf60410f74";
        assert_eq!(Sealed::seal(&true).unwrap().digest(), known);
    }

    #[test]
    fn every_changed_byte_breaks_the_seal() {
        let sealed = Sealed::seal(&vec![12_345_u64, 678]).unwrap();
        let text = sealed.text_to_store();
        for at in 0..text.len() {
            let mut bytes = text.as_bytes().to_vec();
            bytes[at] ^= 1;
            let changed = String::from_utf8(bytes).unwrap();
            let changed = Sealed::<Vec<u64>>::from_stored(changed, sealed.digest().to_owned());
            assert!(matches!(changed.open(), Err(SealError::Broken { .. })), "byte {at}");
        }
        let intact = Sealed::<Vec<u64>>::from_stored(text.to_owned(), sealed.digest().to_owned());
        assert_eq!(intact.open().unwrap(), [12_345, 678]);
        let other = Sealed::<bool>::from_stored(text.to_owned(), sealed.digest().to_owned());
        assert!(matches!(other.open(), Err(SealError::Unreadable { .. })));
    }
}
