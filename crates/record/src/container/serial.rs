//! Logs of a serial monitor: each line behind the time of day at which the host received it,
//! `10:12:31.000 -> 0, 2.150`, as the Arduino IDE shows them.

use crate::text::text_of;

/// Mark between the host's clock and the line that the device sent.
const MARK: &str = " -> ";

/// Returns the lines as the device sent them, without the host's clock; `None` if not every line has it.
pub(super) fn text(bytes: &[u8]) -> Option<String> {
    let start = bytes.get(..bytes.len().min(40))?;
    if !start.windows(MARK.len()).any(|part| part == MARK.as_bytes()) {
        return None;
    }
    let text = text_of(bytes).ok()?;
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let sent: Option<Vec<&str>> = lines.map(of_device).collect();
    sent.map(|lines| lines.join("\n"))
}

/// Returns the part of a line behind a time of day.
fn of_device(line: &str) -> Option<&str> {
    let (clock, sent) = line.split_once(MARK)?;
    let is_clock = clock.matches(':').count() == 2
        && clock.trim().chars().all(|sign| sign.is_ascii_digit() || ":.,".contains(sign));
    is_clock.then_some(sent)
}

#[cfg(test)]
mod tests {
    use super::text;

    #[test]
    fn the_clock_of_the_host_is_left_out() {
        let log = "10:12:31.000 -> 0, 2.150\n10:12:31.010 -> 10, 2.148\n\n";
        assert_eq!(text(log.as_bytes()).unwrap(), "0, 2.150\n10, 2.148");
        assert_eq!(text(b"10:12:31.000 -> 0, 2.150\nno clock\n"), None);
        assert_eq!(text(b"a -> b\n"), None);
        assert_eq!(text(b"time,angle\n0,1\n"), None);
    }
}
