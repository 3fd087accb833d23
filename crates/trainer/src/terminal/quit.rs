//! Quitting with `q` and Enter on a terminal: same as Ctrl-C.
//!
//! A single key would need the terminal in raw mode, which a killed program leaves behind; a line does not.
//! Nothing is read while the program is in the background, since the system would stop it for that.

use estimator::Cancel;

/// Watches for `q` if standard input is a terminal.
#[cfg(unix)]
pub(crate) fn watch(cancel: &'static Cancel) {
    use std::io::IsTerminal;
    if std::io::stdin().is_terminal() {
        // The thread ends with the program; nothing waits for it.
        std::thread::spawn(move || unix::watch(cancel));
    }
}

#[cfg(not(unix))]
pub(crate) fn watch(_cancel: &'static Cancel) {}

#[cfg(unix)]
mod unix {
    use estimator::Cancel;
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use std::io::stdin;
    use std::time::Duration;

    /// Maximum time before a waiting line is noticed.
    const PATIENCE: Timespec = Timespec { tv_sec: 0, tv_nsec: 200_000_000 };

    pub(super) fn watch(cancel: &'static Cancel) {
        let input = stdin();
        while !cancel.is_requested() {
            let mut asked = [PollFd::new(&input, PollFlags::IN)];
            match poll(&mut asked, Some(&PATIENCE)) {
                Ok(0) => continue,
                Ok(_) => {}
                Err(_) => return,
            }
            let in_foreground =
                rustix::termios::tcgetpgrp(&input).is_ok_and(|group| group == rustix::process::getpgrp());
            if !in_foreground {
                std::thread::sleep(Duration::from_millis(200));
                continue;
            }
            let mut line = String::new();
            match input.read_line(&mut line) {
                // No more input will come.
                Ok(0) | Err(_) => return,
                Ok(_) if line.trim().eq_ignore_ascii_case("q") => cancel.request(),
                Ok(_) => {}
            }
        }
    }
}
