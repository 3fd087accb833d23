//! Disks that fail, for tests. The program is built without the feature `faults`, so none of this is part of
//! it.

use std::io::{Error, Result};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Error that the system reports if an operation fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// EIO: the device failed.
    Device,
    /// ENOSPC: the disk is full.
    Full,
}

/// Duration of a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lasts {
    /// One operation fails.
    Once,
    /// All operations fail from the first one on, as if the program were killed there.
    ForGood,
}

/// Failure of a disk: the operation that fails, counted from 0, and the error it gives. A write that fails
/// has written half of its bytes.
#[derive(Debug)]
pub struct Faults {
    first: usize,
    refusal: Refusal,
    lasts: Lasts,
    asked: AtomicUsize,
}

impl Faults {
    /// Lets the operation number `first` fail.
    #[must_use]
    pub fn new(first: usize, refusal: Refusal, lasts: Lasts) -> Self {
        Self { first, refusal, lasts, asked: AtomicUsize::new(0) }
    }

    /// Lets no operation fail; operations are only counted.
    #[must_use]
    pub fn none() -> Self {
        Self::new(usize::MAX, Refusal::Device, Lasts::Once)
    }

    /// Returns the number of operations so far, including failed ones.
    #[must_use]
    pub fn asked(&self) -> usize {
        self.asked.load(Ordering::Relaxed)
    }

    pub(crate) fn next(&self, bytes: usize) -> (usize, Result<()>) {
        let at = self.asked.fetch_add(1, Ordering::Relaxed);
        let fails = match self.lasts {
            Lasts::Once => at == self.first,
            Lasts::ForGood => at >= self.first,
        };
        if !fails {
            return (bytes, Ok(()));
        }
        let code = match self.refusal {
            Refusal::Device => 5,
            Refusal::Full => 28,
        };
        (bytes / 2, Err(Error::from_raw_os_error(code)))
    }
}

#[cfg(test)]
mod tests {
    use super::{Faults, Lasts, Refusal};
    use std::io::ErrorKind;

    /// Returns the number of bytes written and the error of each of four writes of ten bytes.
    fn writes(faults: &Faults) -> Vec<(usize, Option<ErrorKind>)> {
        (0..4)
            .map(|_| faults.next(10))
            .map(|(bytes, end)| (bytes, end.err().map(|error| error.kind())))
            .collect()
    }

    #[test]
    fn one_operation_fails_or_all_from_it_on_and_a_write_half_way() {
        let full = (5, Some(ErrorKind::StorageFull));
        let faults = Faults::new(1, Refusal::Full, Lasts::Once);
        assert_eq!(writes(&faults), [(10, None), full, (10, None), (10, None)]);
        assert_eq!(faults.asked(), 4);
        let faults = Faults::new(2, Refusal::Full, Lasts::ForGood);
        assert_eq!(writes(&faults), [(10, None), (10, None), full, full]);
        assert_eq!(writes(&Faults::none()), [(10, None); 4]);
        let device = Faults::new(0, Refusal::Device, Lasts::Once).next(0).1.unwrap_err();
        assert_eq!(device.raw_os_error(), Some(5));
    }
}
