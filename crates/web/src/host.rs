//! Border to the page: its help, and the form of its answers.

use serde_json::Value;

/// Clock and listener that the page lends to a request.
pub trait Host {
    /// Returns the seconds since some moment.
    fn seconds(&self) -> f64;
    /// Tells the stage of the work that begins, in words.
    fn stage(&self, text: &str);
}

/// Answer to a request, or a message.
pub(crate) type Answered = Result<Value, String>;
