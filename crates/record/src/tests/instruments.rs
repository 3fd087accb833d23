//! Files of instruments and programs, and what is said of them.

use super::{comma, file, holds_the_swing, read, read_with, refusal};
use crate::CsvColumns;

#[test]
fn titles_of_cassy_are_found_behind_their_tag() {
    let row = |_, t: f64, a: f64| format!("{}\t{}", comma(t, 3), comma(a.to_degrees(), 5));
    let top = "MIN=0\t-40\nMAX=2\t40\nSCALE=1\t1\nDEC=3\t3";
    for titles in ["DEF=\"Zeit\" t / s\t\"Winkel\" &a_A1 / °", "DEF\tt / s\t&a_A1 / °"] {
        let found = read(&file(&format!("{top}\n{titles}"), row));
        holds_the_swing(&found, 1e-6);
        let sentence = &found.1.reading.sentence;
        assert!(sentence.starts_with("read as: a CASSY table, decimal comma; time = "), "{sentence}");
        assert!(sentence.contains("&a_A1 / °\" in deg;"), "{sentence}");
    }
}

#[test]
fn labels_before_numbers_are_titles() {
    let text = file("", |_, t, a| format!("10:12:31.010 -> t:{t:.2} angle:{a:.7} target:0"));
    holds_the_swing(&read(text.trim_start()), 1e-6);
    let text = file("", |_, _, a| format!("angle:{:.6},target:0", a.to_degrees()));
    let columns =
        CsvColumns { sample_rate_hz: Some(100.0), unit: Some(crate::Unit::Degree), ..CsvColumns::default() };
    holds_the_swing(&read_with(text.trim_start(), columns), 1e-6);
}

#[test]
fn a_single_column_has_no_separator_and_no_header() {
    let text = file("", |_, _, a| format!("{a:.7}"));
    let message = refusal(&text);
    assert!(message.contains("the columns are `value`. Set"), "{message}");
    let columns = CsvColumns { sample_rate_hz: Some(100.0), ..CsvColumns::default() };
    let (_, source) = read_with(&text, columns);
    assert!(
        source.reading.sentence.starts_with("read as: a single column; no time"),
        "{}",
        source.reading.sentence
    );
    assert_eq!(source.reading.separator, "none");
    let json = (0..9).map(|at| format!("{{\"time_s\":{at},\"angle\":{}}}\n", at % 3)).collect::<String>();
    assert!(read(&json).1.reading.sentence.starts_with("read as: JSON; time = "));
}
