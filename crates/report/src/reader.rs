//! Reader of a report, and what its sentences can refer to.

/// Source from which the reader of a report has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reader {
    /// From the folder of a run, beside the command line.
    #[default]
    CommandLine,
    /// From the page in a browser, which has fields in place of options.
    Page,
}

/// Writes the options that a sentence names as the fields of the page: `--time-unit ms` becomes `“time unit” ms`.
#[must_use]
pub fn in_fields(sentence: &str) -> String {
    let mut parts = sentence.split("--");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_option = !text.ends_with(|sign: char| sign.is_alphanumeric() || sign == '-')
            && part.starts_with(|sign: char| sign.is_ascii_lowercase());
        if !is_option {
            text.push_str("--");
            text.push_str(part);
            continue;
        }
        let end = part.find(|sign: char| !sign.is_ascii_lowercase() && sign != '-').unwrap_or(part.len());
        let (name, rest) = part.split_at(end);
        text.push_str(&format!("“{}”{rest}", name.replace('-', " ")));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::in_fields;

    #[test]
    fn options_become_fields_and_dashes_stay() {
        assert_eq!(
            in_fields("read with --from 0.2 --to 4, or --time-unit ms"),
            "read with “from” 0.2 “to” 4, or “time unit” ms"
        );
        assert_eq!(in_fields("--input none"), "“input” none");
        for other in ["a--b", "0--1", "-- a", "a - b", ""] {
            assert_eq!(in_fields(other), other);
        }
    }
}
