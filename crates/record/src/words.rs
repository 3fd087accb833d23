//! Words for what was found.

/// So many of something, in words that agree: `1 sample`, `3 samples`.
#[must_use]
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
