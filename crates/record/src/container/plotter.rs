//! Lines for the Arduino IDE's plotter: a label before each number, `angle:4.15,target:0`.

use crate::FEWEST_SAMPLES;
use crate::text::text_of;

/// Number of lines that may be of another kind: a log begins and ends in the middle of one.
const MOST_OTHERS: usize = 2;

/// Returns the table with the labels as titles; `None` if the lines have no labels, or not the same ones.
pub(super) fn text(bytes: &[u8]) -> Option<String> {
    // Lines with labels have a colon before the first one ends.
    bytes.split(|byte| *byte == b'\n').nth(1)?.contains(&b':').then_some(())?;
    let text = text_of(bytes).ok()?;
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    let labels = |line: &str| Some(pairs(line)?.into_iter().map(|(label, _)| label.to_owned()).collect());
    let titles: Vec<String> = labels(lines.get(lines.len() / 2)?)?;
    let mut table = format!("{}\n", titles.join(","));
    let mut rows = 0;
    for line in &lines {
        let Some(pairs) = pairs(line).filter(|pairs| pairs.iter().map(|pair| pair.0).eq(&titles)) else {
            continue;
        };
        table.push_str(&(pairs.iter().map(|pair| pair.1).collect::<Vec<_>>().join(",") + "\n"));
        rows += 1;
    }
    (rows >= FEWEST_SAMPLES && rows + MOST_OTHERS >= lines.len()).then_some(table)
}

/// Returns the labels of a line with their numbers; `None` if it holds anything else. Between two pairs there
/// is a comma, a semicolon, a tab or a blank.
fn pairs(line: &str) -> Option<Vec<(&str, &str)>> {
    let is_end = |sign: char| matches!(sign, ',' | ';') || sign.is_whitespace();
    let (mut found, mut rest) = (Vec::new(), line.trim());
    while !rest.is_empty() {
        let (label, after) = rest.split_once(':')?;
        let after = after.trim_start();
        let (number, left) = after.split_at(after.find(is_end).unwrap_or(after.len()));
        let is_label = label.contains(char::is_alphabetic) && !label.contains([',', ';', '\t', '"']);
        found.push((label.trim(), number));
        (is_label && number.parse::<f64>().is_ok()).then_some(())?;
        rest = left.trim_start_matches(is_end);
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::text;

    #[test]
    fn labels_become_titles() {
        let row = |line: &str| line.to_owned() + "\n";
        let table = format!("angle,target\n{}", row("4.15,-1").repeat(8));
        for line in [
            "angle:4.15,target:-1",
            "angle: 4.15, target: -1",
            "angle:4.15\ttarget:-1",
            "angle:4.15 target:-1",
        ] {
            assert_eq!(text(row(line).repeat(8).as_bytes()).unwrap(), table, "{line}");
        }
        let cut = format!("5,target:-1\n{}angle:4.1", row("angle:4.15,target:-1").repeat(8));
        assert_eq!(text(cut.as_bytes()).unwrap(), table);
        for line in
            ["4.15,-1", "10:12:31.010,4.15", "2024-05-01T12:00:00.01Z,19.87", "angle:4.15deg", "note: none"]
        {
            assert_eq!(text(row(line).repeat(8).as_bytes()), None, "{line}");
        }
        assert_eq!(text(row("angle:4.15").repeat(3).as_bytes()), None, "too few");
    }
}
