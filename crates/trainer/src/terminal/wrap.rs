//! Lines for a terminal: broken at spaces, because a terminal itself breaks them inside words.

use std::io::IsTerminal;

/// Narrowest terminal whose lines are broken here.
const LEAST_WIDTH: usize = 40;

/// Returns text that fits the terminal on a stream; the same text if the stream is no terminal.
pub(crate) fn fitted(text: &str, stream: &impl Width) -> String {
    stream
        .width()
        .filter(|width| *width >= LEAST_WIDTH)
        .map_or_else(|| text.to_owned(), |width| wrapped(text, width))
}

/// Stream with a width in characters if it is a terminal.
pub(crate) trait Width {
    fn width(&self) -> Option<usize>;
}

#[cfg(unix)]
impl<Stream: IsTerminal + std::os::fd::AsFd> Width for Stream {
    fn width(&self) -> Option<usize> {
        let size = self.is_terminal().then(|| rustix::termios::tcgetwinsize(self).ok())??;
        Some(usize::from(size.ws_col))
    }
}

#[cfg(not(unix))]
impl<Stream: IsTerminal> Width for Stream {
    fn width(&self) -> Option<usize> {
        None
    }
}

/// Breaks lines that are longer than `width` characters at spaces. The lines that follow begin below the last
/// cell, if the line is a row of a table. Commands are left whole, so that they can be copied.
fn wrapped(text: &str, width: usize) -> String {
    let is_command = |line: &str| {
        let line = line.trim_start();
        line.starts_with("trainer ") || line.starts_with("cargo ")
    };
    let broken = text.split('\n').map(|line| match line.chars().count() > width && !is_command(line) {
        true => broken(line, width),
        false => line.to_owned(),
    });
    broken.collect::<Vec<_>>().join("\n")
}

fn broken(line: &str, width: usize) -> String {
    let indent = " ".repeat(indent(line, width));
    let mut lines = Vec::new();
    let mut rest: Vec<char> = line.chars().collect();
    while rest.len() > width {
        let first = rest.iter().position(|letter| *letter != ' ').unwrap_or(rest.len());
        let space = rest.iter().take(width + 1).rposition(|letter| *letter == ' ');
        // A word that is longer than a line is left to the terminal.
        let end = space
            .filter(|at| *at > first)
            .or_else(|| rest.iter().skip(first).position(|letter| *letter == ' ').map(|at| first + at));
        let Some(end) = end else { break };
        let (line, after) = rest.split_at(end);
        let after: String = after.iter().collect();
        lines.push(line.iter().collect::<String>().trim_end().to_owned());
        rest = format!("{indent}{}", after.trim_start()).chars().collect();
    }
    lines.push(rest.into_iter().collect());
    lines.join("\n")
}

/// Returns the indentation of a line's continuation: the place of its last cell, which follows two spaces, if
/// there is enough room behind it, else that of the line itself.
fn indent(line: &str, width: usize) -> usize {
    let letters: Vec<char> = line.chars().take(width).collect();
    let own = letters.iter().position(|letter| *letter != ' ').unwrap_or(0);
    let cell = letters.windows(3).rposition(|of| matches!(of, [' ', ' ', next] if *next != ' '));
    match cell.map(|at| at + 2).filter(|at| *at > own && 3 * at <= 2 * width) {
        Some(cell) => cell,
        None => own.min(width / 2),
    }
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    #[test]
    fn lines_break_at_spaces_alone() {
        assert_eq!(wrapped("one two three\nfour", 8), "one two\nthree\nfour");
        assert_eq!(wrapped("exactly8 x", 8), "exactly8\nx");
        assert_eq!(wrapped("note: incomprehensibilities end", 10), "note:\nincomprehensibilities\nend");
        assert_eq!(wrapped("short", 8), "short");
        assert_eq!(wrapped("  indented words here", 12), "  indented\n  words here");
    }

    #[test]
    fn a_long_last_cell_continues_below_itself() {
        assert_eq!(wrapped(" time  a few words of it", 18), " time  a few words\n       of it");
    }

    #[test]
    fn commands_stay_whole() {
        let command = "  cargo run -p trainer -- init LOG.csv";
        assert_eq!(wrapped(command, 20), command);
    }
}
