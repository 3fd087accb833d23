//! The one place that prints.

#![expect(clippy::print_stderr, reason = "this module owns the terminal")]

use std::io::Write;

/// A result, on standard output. A reader that has gone away (`| head`) is no error.
pub(crate) fn result(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}

/// A remark, on standard error.
pub(crate) fn remark(text: &str) {
    eprintln!("{text}");
}

/// An error, on standard error.
pub(crate) fn error(text: &str) {
    eprintln!("error: {text}");
}
