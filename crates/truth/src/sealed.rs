//! Sealed values: JSON text that shows only its digest.

use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::fmt;
use std::marker::PhantomData;
use thiserror::Error;

/// Reason why a value could not be sealed or opened.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SealError {
    /// The text differs from the one that was sealed.
    #[error(
        "the seal is broken: the text has the digest {found}, not {stated}; it was changed after sealing"
    )]
    Broken {
        /// Digest stated by the seal.
        stated: String,
        /// Digest of the text.
        found: String,
    },
    /// The seal is intact, but the text does not hold a value of the expected type.
    #[error("the sealed text cannot be read: {problem}; it was written by another version of the program")]
    Unreadable {
        /// Message of the JSON parser.
        problem: String,
    },
    /// The value cannot be written as JSON.
    #[error("the value cannot be sealed: {problem} (a fault of the program, please report it)")]
    Unwritable {
        /// Message of the JSON writer.
        problem: String,
    },
}

/// A value as JSON text, sealed with its SHA-256 digest (`sha256:` and 64 hexadecimal digits).
///
/// It can be stored and passed on unseen: `Debug` and `Display` show only the digest.
#[derive(Clone, PartialEq, Eq)]
pub struct Sealed<T> {
    text: String,
    digest: String,
    content: PhantomData<fn() -> T>,
}

impl<T> Sealed<T> {
    /// Restores a sealed value from its stored text and digest. [`open`](Self::open) checks whether they
    /// match.
    #[must_use]
    pub fn from_stored(text: String, digest: String) -> Self {
        Self { text, digest, content: PhantomData }
    }

    /// Returns the digest, which may be published before the value.
    #[must_use]
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// Returns the text to store. It reveals the value, so store it apart from the records that the value
    /// explains.
    #[must_use]
    pub fn text_to_store(&self) -> &str {
        &self.text
    }
}

impl<T: Serialize + DeserializeOwned> Sealed<T> {
    /// Seals a value.
    ///
    /// # Errors
    /// [`SealError::Unwritable`] if the value cannot be written as JSON.
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
    /// [`SealError::Broken`] if a single byte differs from what was sealed; [`SealError::Unreadable`] if the
    /// text is intact but does not hold a value of this type.
    pub fn open(&self) -> Result<T, SealError> {
        let found = digest(&self.text);
        if found != self.digest {
            return Err(SealError::Broken { stated: self.digest.clone(), found });
        }
        serde_json::from_str(&self.text).map_err(|error| SealError::Unreadable { problem: error.to_string() })
    }
}

/// Returns the SHA-256 of a text in the form used by seals and manifests: `sha256:` and 64 hexadecimal
/// digits.
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
        // SHA-256 of the five bytes `true\n`, computed by another program.
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
