//! Printing to the terminal. No other module prints.

use super::wrap::fitted;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::OnceLock;

/// Reason why the first lost result did not reach standard output. It is checked at the end, so that a run
/// whose folder is written is completed all the same.
static LOST: OnceLock<String> = OnceLock::new();

/// Prints a result on standard output. A reader that has gone away (`| head`) is not an error.
pub(crate) fn result(text: &str) {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            LOST.get_or_init(|| error.to_string());
        }
        _ => {}
    }
}

/// Prints sentences and tables on standard output; on a terminal, lines break at spaces.
pub(crate) fn text(text: &str) {
    result(&fitted(text, &std::io::stdout()));
}

/// Returns the reason why some result did not reach standard output; `None` if all did.
pub(crate) fn lost() -> Option<&'static str> {
    LOST.get().map(String::as_str)
}

/// Prints a table on standard output; on a terminal, lines that contain one of the words `red` are printed in
/// red.
pub(crate) fn table(text: &str, red: &[&str]) {
    if !std::io::stdout().is_terminal() {
        return result(text);
    }
    let is_red = |line: &str| red.iter().any(|word| line.contains(word));
    let lines = text.lines().map(|line| {
        let fitted = fitted(line, &std::io::stdout());
        if is_red(line) { format!("\u{1b}[31m{fitted}\u{1b}[0m") } else { fitted }
    });
    result(&lines.collect::<Vec<_>>().join("\n"));
}

/// Prints a remark on standard error. If that fails, there is nobody to tell, and the work continues.
pub(crate) fn remark(text: &str) {
    let text = fitted(text, &std::io::stderr());
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Prints an error on standard error.
pub(crate) fn error(text: &str) {
    remark(&format!("error: {text}"));
}

/// Prints the failure of one of many runs on standard error, in red on a terminal.
pub(crate) fn failure(text: &str) {
    if std::io::stderr().is_terminal() {
        remark(&format!("\u{1b}[31m{text}\u{1b}[0m"));
    } else {
        error(text);
    }
}
