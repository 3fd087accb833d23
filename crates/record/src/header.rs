//! What a header without the columns that are looked for is instead.

use crate::error::Fault;
use crate::host_log;
use csv::StringRecord;

/// Separators that other programs write.
const OTHERS: [(char, &str); 3] = [(';', "semicolons"), ('\t', "tabs"), (' ', "blanks")];

/// Letters of a line that a message shows.
const SHOWN: usize = 60;

/// What the header on a line is where it is that of a host log, is no header, or has other separators than commas.
pub(crate) fn misread(text: &str, header: &StringRecord, line: u64) -> Option<Fault> {
    let mut lines = text.lines().skip(usize::try_from(line).ok()?.checked_sub(1)?);
    let written = lines.next()?.trim();
    let found = || written.chars().take(SHOWN).collect();
    if host_log::is_header(header.iter()) {
        return Some(Fault::HostLogHeader { line, found: found() });
    }
    let is_number = |field: &str| field.parse::<f64>().is_ok();
    let mut fields = written.split([';', '\t', ' ', ',']).filter(|field| !field.is_empty()).peekable();
    if fields.peek().is_some() && fields.all(is_number) {
        return Some(Fault::NoHeader { line, found: found() });
    }
    // A lone column's name may hold a blank; its numbers hold none.
    let samples = lines.next().unwrap_or(written);
    let separates = |sign: char| header.len() == 1 && written.contains(sign) && samples.trim().contains(sign);
    let (_, separator) = OTHERS.into_iter().find(|(sign, _)| separates(*sign))?;
    Some(Fault::OtherSeparator { line, found: found(), separator })
}

#[cfg(test)]
mod tests {
    use crate::{ReadOptions, read_text};

    fn refusal(text: &str) -> String {
        read_text("r.csv", text.as_bytes(), &ReadOptions::default()).unwrap_err().to_string()
    }

    #[test]
    fn other_separators_are_named() {
        for (header, name) in [
            ("time_s;angle_rad\n0,01;0,5\n", "semicolons"),
            ("time_s\tangle_rad\n0.01\t0.5\n", "tabs"),
            ("# a comment\ntime_s   angle_rad\n0.01   0.5\n", "blanks"),
        ] {
            let message = refusal(header);
            assert!(message.contains(&format!("` is separated by {name}; expected commas")), "{message}");
            assert!(message.contains("the header `time_s"), "{message}");
        }
        let message = refusal("my angle\n0.5\n");
        assert!(message.contains("there is no column `time_s`"), "{message}");
    }

    #[test]
    fn a_missing_header_is_named() {
        for text in ["0.0,0.5\n0.1,0.4\n", "0.0;0.5\n", "0,0;0,5\n", "0.0 0.5\n", "-1e-3\t2\n"] {
            let message = refusal(text);
            assert!(message.starts_with("r.csv:1: the first line holds numbers, `"), "{message}");
        }
    }

    #[test]
    fn a_host_log_is_named() {
        let message = refusal("Timestamp, Time_Elapsed(s), Angle(deg)\n---\n16:04:31.2, 1.0, 2.0\n");
        assert!(message.ends_with("is that of a host log; set data.format = \"host-log\""), "{message}");
    }

    #[test]
    fn decimal_commas_are_not_read_as_other_numbers() {
        let message = refusal("time_s,angle_deg\n0,01,29,20\n");
        assert!(message.starts_with("r.csv:2: 4 fields under a header of 2; "), "{message}");
        assert!(message.contains("Write decimal points"), "{message}");
        let message = refusal("time_s,angle_deg\n\"0,01\",\"29,20\"\n");
        assert!(
            message.ends_with("`0,01` in column `time_s` is not a number; write a decimal point"),
            "{message}"
        );
        let message = refusal("time_s,angle_deg\n0.01,\n");
        assert!(message.ends_with("an empty cell in column `angle_deg`; expected a number"), "{message}");
    }

    #[test]
    fn a_comma_at_the_end_of_each_line_is_no_field() {
        let rows: String = (0..20).map(|i| format!("{i},{},\n", i % 3)).collect();
        let read =
            read_text("r.csv", format!("time_s,angle_rad\n{rows}").as_bytes(), &ReadOptions::default());
        assert_eq!(read.unwrap().0.len(), 20);
    }
}
