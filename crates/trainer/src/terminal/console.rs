//! The one place that prints.

use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::OnceLock;

/// Why a result did not reach standard output, the first time. It is asked for at the end: a run whose folder is
/// written is to be completed all the same.
static LOST: OnceLock<String> = OnceLock::new();

/// A result, on standard output. A reader that has gone away (`| head`) is no error.
pub(crate) fn result(text: &str) {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            LOST.get_or_init(|| error.to_string());
        }
        _ => {}
    }
}

/// Why some result did not reach standard output; `None` where all did.
pub(crate) fn lost() -> Option<&'static str> {
    LOST.get().map(String::as_str)
}

/// A table, on standard output: on a terminal, lines that hold one of these words in red.
pub(crate) fn table(text: &str, red: &[&str]) {
    if !std::io::stdout().is_terminal() {
        return result(text);
    }
    let is_red = |line: &str| red.iter().any(|word| line.contains(word));
    let lines = text
        .lines()
        .map(|line| if is_red(line) { format!("\u{1b}[31m{line}\u{1b}[0m") } else { line.to_owned() });
    result(&lines.collect::<Vec<_>>().join("\n"));
}

/// A remark, on standard error. Where that cannot be written there is nobody to tell, and the work goes on.
pub(crate) fn remark(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// An error, on standard error.
pub(crate) fn error(text: &str) {
    remark(&format!("error: {text}"));
}

/// What one of many failed of, on standard error; red on a terminal.
pub(crate) fn failure(text: &str) {
    if std::io::stderr().is_terminal() {
        remark(&format!("\u{1b}[31m{text}\u{1b}[0m"));
    } else {
        error(text);
    }
}
