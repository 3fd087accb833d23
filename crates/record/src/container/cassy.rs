//! Text exports of CASSY: lines with ranges, scale and decimals, then the titles behind `DEF=`, then the
//! samples, and the same again for each further measurement.

use crate::text::text_of;

/// Tags of the lines above the samples. The last one stands before titles.
const TAGS: [&str; 5] = ["MIN", "MAX", "SCALE", "DEC", "DEF"];

/// Returns the table: the titles of the first measurement and the samples of all of them, one below the other;
/// `None` for other files.
pub(super) fn text(bytes: &[u8]) -> Option<String> {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    tagged(std::str::from_utf8(start.get(..4)?).ok()?)?;
    let text = text_of(bytes).ok()?;
    let (mut titles, mut rows) = (Vec::new(), Vec::new());
    for line in text.trim_start_matches('\u{feff}').lines() {
        match tagged(line) {
            // One line with all titles, or a line for each.
            Some(("DEF", rest)) if rows.is_empty() => titles.push(rest),
            Some(_) => {}
            None => rows.push(line),
        }
    }
    (!titles.is_empty()).then(|| format!("{}\n{}\n", titles.join("\t"), rows.join("\n")))
}

/// Splits a line at its tag: `MIN=0` or `MIN`, a tab and `0`.
fn tagged(line: &str) -> Option<(&'static str, &str)> {
    TAGS.into_iter().find_map(|tag| Some((tag, line.strip_prefix(tag)?.strip_prefix(['=', '\t'])?)))
}

#[cfg(test)]
mod tests {
    use super::text;

    #[test]
    fn titles_and_samples_are_left() {
        let top = "MIN=0\t-5\r\nMAX=9\t5\r\nSCALE=1\t1\r\nDEC=1\t1\r\n";
        let table = "\"Zeit\" t / s\t\"Winkel\" &a_A1 / °\n0,0\t1,0\n0,1\t0,5\n";
        let titles = "DEF=\"Zeit\" t / s\t\"Winkel\" &a_A1 / °\r\n";
        assert_eq!(text(format!("{top}{titles}0,0\t1,0\r\n0,1\t0,5\r\n").as_bytes()).unwrap(), table);
        let again = format!("\u{feff}{top}{titles}0,0\t1,0\n{top}{titles}0,1\t0,5\n");
        assert_eq!(text(again.as_bytes()).unwrap(), table);
        let tabs = "MIN\t0\t-5\nDEF\tt / s\tU_A1 / V\n0.0\t1.0\n";
        assert_eq!(text(tabs.as_bytes()).unwrap(), "t / s\tU_A1 / V\n0.0\t1.0\n");
        let each = "MIN=0\nDEF=\"t / s\"\nMIN=-1\nDEF=\"U_A1 / V\"\n0.0\t1.0\n";
        assert_eq!(text(each.as_bytes()).unwrap(), "\"t / s\"\t\"U_A1 / V\"\n0.0\t1.0\n");
        assert_eq!(text(b"MINUTES,angle\n0,1\n"), None);
        assert_eq!(text(b"MIN=0\n0,1\n"), None);
    }
}
