//! A share of the runs of a sweep, or of the cases of a batch.

use super::SweepError;
use sha2::{Digest, Sha256};
use std::fmt;
use std::str::FromStr;

/// Largest number of shares.
const MOST_SHARDS: usize = 10_000;

/// Share number `index` of `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    of: usize,
}

impl Shard {
    /// The whole work: share 1 of 1.
    pub const ALL: Self = Self { index: 1, of: 1 };

    /// Returns `true` if the run at `position` in the frozen list, from 0, belongs to this share.
    ///
    /// Every run belongs to exactly one share. Neighboring runs belong to different shares, so that each
    /// share covers every part of the list.
    #[must_use]
    pub fn takes(self, position: usize) -> bool {
        position % self.of == self.index - 1
    }

    /// Returns `true` if the case called `name` belongs to this share, by the SHA-256 of the name.
    ///
    /// Every case belongs to exactly one share and stays in it even if other cases are added or removed while
    /// shares wait in a queue.
    #[must_use]
    pub fn takes_named(self, name: &str) -> bool {
        let digest = Sha256::digest(name.as_bytes());
        let number = digest.iter().take(8).fold(0, |number: u64, byte| number << 8 | u64::from(*byte));
        number % self.of as u64 == self.index as u64 - 1
    }
}

impl FromStr for Shard {
    type Err = SweepError;

    /// Parses `I/N` with I from 1 to N.
    ///
    /// # Errors
    /// [`SweepError::BadShard`] for any other text, and for N above ten thousand.
    fn from_str(text: &str) -> Result<Self, SweepError> {
        let ends = text.split_once('/').map(|(index, of)| (index.trim().parse(), of.trim().parse()));
        match ends {
            Some((Ok(index), Ok(of))) if 1 <= index && index <= of && of <= MOST_SHARDS => {
                Ok(Self { index, of })
            }
            _ => Err(SweepError::BadShard { found: text.to_owned() }),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn every_run_belongs_to_one_share() {
        let shards: Vec<Shard> = (1..=3).map(|index| format!("{index}/3").parse().unwrap()).collect();
        for position in 0..10 {
            assert_eq!(shards.iter().filter(|shard| shard.takes(position)).count(), 1);
        }
        assert!((0..10).all(|position| Shard::ALL.takes(position)));
        assert_eq!(shards[1].to_string(), "2/3");
    }

    /// Separate machines have to agree on the share of a name, so it must not change between versions.
    #[test]
    fn a_case_stays_in_its_share_whatever_else_there_is() {
        let shards: Vec<Shard> = (1..=3).map(|index| format!("{index}/3").parse().unwrap()).collect();
        let counts =
            shards.iter().map(|shard| (0..300).filter(|id| shard.takes_named(&id.to_string())).count());
        assert_eq!(counts.clone().sum::<usize>(), 300);
        assert!(counts.clone().all(|count| (70..130).contains(&count)), "{:?}", counts.collect::<Vec<_>>());
        // sha256("elbow-07") begins with 3f2a2446057a86fa.
        assert_eq!(shards.iter().position(|shard| shard.takes_named("elbow-07")), Some(2));
    }

    #[test]
    fn what_is_no_share_is_refused() {
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "a/b", "1/20000"] {
            let refused = text.parse::<Shard>().unwrap_err().to_string();
            assert!(refused.contains("with I from 1 to N"), "{text}: {refused}");
        }
    }
}
