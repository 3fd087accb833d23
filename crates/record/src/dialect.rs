//! Detection of a file's dialect and layout: separator, decimal sign, comments, header, line of units.

use crate::dates::is_date;
use crate::error::Fault;
use crate::heading::measure_of;
use std::borrow::Cow;

/// Dialect of a file of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dialect {
    /// Separator of cells; a blank stands for any number of blanks and tabs.
    pub(crate) separator: char,
    /// `true` if numbers have a decimal comma.
    pub(crate) decimal_comma: bool,
}

/// Layout of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout<'a> {
    pub(crate) dialect: Dialect,
    /// Line number of the header, from 1; 0 if there is none.
    pub(crate) line: u64,
    /// Titles of the columns; made up if there is no header.
    pub(crate) titles: Vec<Cow<'a, str>>,
    /// Cells of the line of units, if there is one.
    pub(crate) units: Option<Vec<&'a str>>,
    /// Number of lines above the header that are neither empty nor comments.
    pub(crate) preamble: usize,
    /// Lines with samples, with their line numbers.
    pub(crate) rows: Vec<(u64, &'a str)>,
}

/// Dialects in the order of trial; the first of those that read equally many numbers is chosen.
const TRIED: [(char, bool); 10] = [
    (';', false),
    (';', true),
    ('\t', false),
    ('\t', true),
    (',', false),
    (',', true),
    (' ', false),
    (' ', true),
    ('|', false),
    ('|', true),
];

/// Number of lines, at the end of the file, from which the dialect is determined.
const TOLD_FROM: usize = 60;

impl Dialect {
    /// Returns the cells of a line, trimmed and without quotes.
    pub(crate) fn split<'a>(&self, line: &'a str) -> Vec<&'a str> {
        if self.separator == ' ' {
            return blanks(line);
        }
        let (mut cells, mut start, mut quoted) = (Vec::new(), 0, false);
        for (at, sign) in line.char_indices() {
            if sign == '"' {
                quoted = !quoted;
            } else if sign == self.separator && !quoted {
                cells.push(cell(line.get(start..at)));
                start = at + sign.len_utf8();
            }
        }
        cells.push(cell(line.get(start..)));
        cells
    }

    /// Parses a cell as a finite number.
    pub(crate) fn number(&self, text: &str) -> Option<f64> {
        let number = match self.decimal_comma {
            true if text.contains(',') && !text.contains('.') => text.replacen(',', ".", 1).parse().ok(),
            _ => text.parse().ok(),
        };
        number.filter(|number: &f64| number.is_finite())
    }

    /// Counts the cells that are numbers, dates or times.
    fn numbers(&self, cells: &[&str]) -> usize {
        cells.iter().filter(|cell| self.number(cell).is_some() || is_date(cell)).count()
    }

    /// Returns the separator in words.
    pub(crate) fn name(&self) -> &'static str {
        match self.separator {
            ';' => "semicolon",
            '\t' => "tab",
            ' ' => "blank",
            '|' => "bar",
            _ => "comma",
        }
    }
}

fn cell(text: Option<&str>) -> &str {
    let text = text.unwrap_or("").trim();
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).map_or(text, str::trim)
}

/// Splits a line at blanks; a unit in brackets belongs to the name before it.
fn blanks(line: &str) -> Vec<&str> {
    let (mut cells, mut start, mut depth) = (Vec::new(), None::<usize>, 0_i32);
    let mut end = 0;
    for (at, sign) in line.char_indices().chain([(line.len(), ' ')]) {
        if sign.is_whitespace() && depth <= 0 {
            let rest = line[at..].trim_start();
            // In a line of units each bracket is a cell of its own.
            let bracket = |from: usize| line.get(from..).is_some_and(|own| own.starts_with(['[', '(']));
            if let Some(from) = start.filter(|from| !rest.starts_with(['[', '(']) || bracket(*from)) {
                cells.push(cell(line.get(from..end)));
                start = None;
            }
            continue;
        }
        depth += i32::from(matches!(sign, '[' | '(')) - i32::from(matches!(sign, ']' | ')'));
        start.get_or_insert(at);
        end = at + sign.len_utf8();
    }
    cells.extend(start.map(|from| cell(line.get(from..end))));
    cells
}

/// Returns `true` if a cell states that there is no number: empty, `NaN`, `NA`, `null`, `-`, infinite.
pub(crate) fn is_missing(text: &str) -> bool {
    const WORDS: [&str; 8] = ["nan", "na", "n/a", "null", "none", "inf", "infinity", "nil"];
    let bare = text.trim_start_matches(['-', '+']);
    bare.is_empty() || WORDS.iter().any(|word| bare.eq_ignore_ascii_case(word))
}

/// Returns the content of a comment line, or `None` for other lines.
fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    ["#", "%", "//"].iter().find_map(|mark| line.strip_prefix(mark))
}

/// Returns the contents of all comments that begin with `#`.
pub(crate) fn statements(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| line.trim_start().strip_prefix('#'))
}

/// Determines the dialect and the layout of a text.
///
/// # Errors
/// [`Fault::Empty`].
pub(crate) fn layout(text: &str) -> Result<Layout<'_>, Fault> {
    let all = || text.lines().zip(1_u64..).map(|(line, number)| (number, line));
    let lines: Vec<(u64, &str)> =
        all().filter(|(_, line)| !line.trim().is_empty() && comment(line).is_none()).collect();
    let told_from = lines.len().saturating_sub(TOLD_FROM).max(usize::from(lines.len() > 1));
    let (_, last) = lines.split_at(told_from);
    let dialect = tell(last);
    let (width, usual) = (usual_width(dialect, last), usual_numbers(dialect, last));
    let is_data = |line: &str| {
        let cells = dialect.split(line);
        let count = dialect.numbers(&cells);
        // Facts above a header may hold more cells than the samples.
        count > 0 && 2 * count > usual && filled(&cells) <= width
    };
    let first = lines.iter().position(|(_, line)| is_data(line)).unwrap_or(lines.len());
    let (above, _) = lines.split_at(first);
    let is_title = |line: &str, width: usize| {
        let cells = dialect.split(line);
        dialect.numbers(&cells) == 0
            && filled(&cells) >= width
            && cells.iter().any(|cell| cell.chars().any(char::is_alphabetic))
    };
    let find = |width: usize| above.iter().rposition(|(_, line)| is_title(line, width));
    let Some(mut at) = find(width).or_else(|| find(2)) else {
        // Words that a program prints before its first numbers are no samples.
        let is_word = |line: &str| dialect.numbers(&dialect.split(line)) == 0;
        let words = lines.iter().take_while(|(_, line)| is_word(line)).count();
        let rows = lines.get(words..).filter(|rows| !rows.is_empty()).unwrap_or(&lines);
        return in_comment(text, dialect, rows, width);
    };
    let mut units = None;
    let row = |at: usize| above.get(at).map_or((1, ""), |row| *row);
    let cells = dialect.split(row(at).1);
    let before = at.checked_sub(1).filter(|before| is_title(row(*before).1, width));
    if let Some(before) = before.filter(|_| are_units(&cells)) {
        units = Some(cells);
        at = before;
    }
    let (line, header) = row(at);
    let after = at + 1 + usize::from(units.is_some());
    let units = units.or_else(|| units_of_scope(dialect, above));
    // The header may be the last line.
    let rows = lines.get(after..).unwrap_or(&[]);
    // Skips a rule of dashes below the header.
    let is_rule =
        |line: &str| line.trim().chars().all(|sign| "-=_+|".contains(sign)) && line.trim().len() > 2;
    let rows = match rows {
        [(_, line), below @ ..] if is_rule(line) => below,
        rows => rows,
    };
    let titles = dialect.split(header).into_iter().map(Cow::Borrowed).collect();
    Ok(Layout { dialect, line, titles, units, preamble: at, rows: rows.to_vec() })
}

/// Returns the units that Tektronix' oscilloscopes write among the facts above the header, in a line for the
/// time and in one for the channels.
fn units_of_scope<'a>(dialect: Dialect, above: &[(u64, &'a str)]) -> Option<Vec<&'a str>> {
    let fact = |name: &str| {
        above.iter().map(|(_, line)| dialect.split(line)).find(|cells| cells.first() == Some(&name))
    };
    let time = fact("Horizontal Units").and_then(|cells| cells.get(1).copied());
    let channels = fact("Vertical Units")?.into_iter().skip(1);
    // A time without a unit is in seconds.
    Some(std::iter::once(time.unwrap_or("s")).chain(channels).collect())
}

fn are_units(cells: &[&str]) -> bool {
    let bare = || cells.iter().map(|cell| cell.trim_matches(['[', ']', '(', ')']));
    let told = bare().filter(|bare| bare.chars().any(char::is_alphabetic));
    let (known, unknown): (Vec<_>, Vec<_>) = told.partition(|bare| measure_of(bare).is_some());
    // Units of columns that nobody observes, as degrees or percent, are seldom known.
    known.len() > unknown.len() || known.is_empty() && unknown.is_empty()
}

/// Returns the number of cells up to the last nonempty one.
fn filled(cells: &[&str]) -> usize {
    cells.len() - cells.iter().rev().take_while(|cell| cell.is_empty()).count()
}

/// Returns the layout of a text whose header is in the last comment above the samples, as in `# time angle`
/// or in `%time,field.data` as ROS writes it, or of a text that has no header.
fn in_comment<'a>(
    text: &'a str,
    dialect: Dialect,
    lines: &[(u64, &'a str)],
    width: usize,
) -> Result<Layout<'a>, Fault> {
    let Some(&(first, _)) = lines.first() else {
        return Err(Fault::Empty { needed: crate::FEWEST_SAMPLES });
    };
    let before = text.lines().zip(1_u64..).take_while(|(_, line)| *line < first);
    let found = before.filter_map(|(content, line)| comment(content).map(|content| (content, line)));
    let titles = |(content, line): (&'a str, u64)| (dialect.split(content.trim()), line);
    let is_header = |(cells, _): &(Vec<&str>, u64)| {
        cells.len() == width
            && cells.iter().all(|cell| cell.contains(char::is_alphabetic) && !cell.contains(": "))
    };
    let (titles, line) = match found.map(titles).filter(is_header).last() {
        Some((titles, line)) => (titles.into_iter().map(Cow::Borrowed).collect(), line),
        None => (made_up(dialect, lines, width), 0),
    };
    Ok(Layout { dialect, line, titles, units: None, preamble: 0, rows: lines.to_vec() })
}

/// Returns titles for the columns of a text without a header: `time` for a first column that increases from
/// line to line, `value` for the only other one, else `column_1` and so on.
fn made_up<'a>(dialect: Dialect, lines: &[(u64, &str)], width: usize) -> Vec<Cow<'a, str>> {
    let first = |line: &str| dialect.split(line).first().and_then(|cell| dialect.number(cell));
    let stamps: Vec<f64> = lines.iter().filter_map(|(_, line)| first(line)).collect();
    let rises = stamps.windows(2).filter(|pair| pair.first() < pair.last()).count();
    let falls = stamps.windows(2).any(|pair| pair.first() > pair.last());
    let dates = lines.iter().all(|(_, line)| dialect.split(line).first().is_some_and(|cell| is_date(cell)));
    let timed = width > 1 && (dates || !falls && 2 * rises > stamps.len());
    let others = width - usize::from(timed);
    let title = |at: usize| match at {
        0 if timed => Cow::Borrowed("time"),
        _ if others == 1 => Cow::Borrowed("value"),
        _ => Cow::Owned(format!("column_{}", at + 1)),
    };
    (0..width).map(title).collect()
}

/// Returns the dialect in which the largest share of cells are numbers, with lines of equal width.
fn tell(lines: &[(u64, &str)]) -> Dialect {
    let mut best = (-1.0, None);
    let mut lone = (0, Dialect { separator: ';', decimal_comma: false });
    for (separator, decimal_comma) in TRIED {
        let dialect = Dialect { separator, decimal_comma };
        let width = usual_width(dialect, lines);
        let (mut cells, mut numbers) = (0, 0);
        for (_, line) in lines {
            let found = dialect.split(line);
            let is_number =
                |cell: &&&str| dialect.number(cell).is_some() || is_missing(cell) || is_date(cell);
            // A line of another width counts against the dialect with all its cells.
            cells += found.len().max(width);
            numbers += if filled(&found) <= width { found.iter().filter(is_number).count() } else { 0 };
        }
        let share = numbers as f64 / cells.max(1) as f64;
        if width >= 2 && share > best.0 + 1e-9 {
            best = (share, Some(dialect));
        }
        if width == 1 && numbers > lone.0 && separator == ';' {
            lone = (numbers, dialect);
        }
    }
    best.1.unwrap_or(lone.1)
}

/// Returns the most common of some counts, and the larger one of two that are equally common; 0 without any.
fn most_common(counts: impl Iterator<Item = usize>) -> usize {
    let mut tally = std::collections::BTreeMap::new();
    for count in counts {
        *tally.entry(count).or_insert(0_usize) += 1;
    }
    tally.into_iter().max_by_key(|(count, lines)| (*lines, *count)).map_or(0, |(count, _)| count)
}

/// Returns the number of cells that most lines have.
fn usual_width(dialect: Dialect, lines: &[(u64, &str)]) -> usize {
    most_common(lines.iter().map(|(_, line)| filled(&dialect.split(line))))
}

/// Returns the number of numbers that most lines have.
fn usual_numbers(dialect: Dialect, lines: &[(u64, &str)]) -> usize {
    most_common(lines.iter().map(|(_, line)| dialect.numbers(&dialect.split(line))))
}

#[cfg(test)]
mod tests {
    use super::{Dialect, layout};

    #[test]
    fn separators_decimal_signs_and_headers_are_told() {
        for (text, separator, decimal_comma, line, titles) in [
            ("t;w\n0,1;0,5\n0,2;0,4\n", ';', true, 1, "t|w"),
            ("t\tw\n0.1\t0.5\n", '\t', false, 1, "t|w"),
            ("# text\nt   w\n0.1   0.5\n 0.2 -1\n", ' ', false, 2, "t|w"),
            ("t,w\n\"0,1\",\"0,5\"\n", ',', true, 1, "t|w"),
            ("time [s] angle [deg]\n0.1 0.5\n0.2 0.5\n", ' ', false, 1, "time [s]|angle [deg]"),
            ("Log of a swing\nRate,100\nt,w\n1,2\n2,3\n", ',', false, 3, "t|w"),
            ("Segments,1,Size,3\nt,w\n1,2\n2,3\n3,4\n4,5\n", ',', false, 2, "t|w"),
            ("# t w\n0.1 0.5\n0.2 0.4\n", ' ', false, 1, "t|w"),
            ("%time,field.data\n1,2\n2,3\n", ',', false, 1, "time|field.data"),
            ("// rig 4\nt,joint,w\n1,a,2\n2,b,3\n", ',', false, 2, "t|joint|w"),
            ("t;w\ns;deg\n0,1;3\n0,2;4\n", ';', true, 1, "t|w"),
            ("stamp,w\n2024-05-01 12:00:00.1,3\n2024-05-01 12:00:00.2,3\n", ',', false, 1, "stamp|w"),
        ] {
            let found = layout(text).unwrap();
            assert_eq!(found.dialect, Dialect { separator, decimal_comma }, "{text}");
            assert_eq!((found.line, found.titles.join("|").as_str()), (line, titles), "{text}");
        }
        assert_eq!(layout("t;w\ns;deg\n0,1;3\n0,2;4\n").unwrap().units, Some(vec!["s", "deg"]));
    }
}
