//! Files of instruments and programs, and what is said of them.

use super::{comma, file, holds_the_swing, read, read_with, refusal};
use crate::{CsvColumns, ReadOptions, read_text};

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

/// A word that a program prints first is no title.
#[test]
fn words_before_the_numbers_are_no_titles() {
    let text = file("10:12:30.990 -> Ready", |_, t, a| format!("10:12:31.010 -> {t:.2}, {a:.7}"));
    holds_the_swing(&read(text.trim_start()), 1e-6);
}

#[test]
fn units_in_a_row_of_their_own_need_not_all_be_known() {
    let text = file("No;Time;Battery;angle;Humidity\n;s;V;deg;%RH", |at, t, a| {
        format!("{at};{t:.2};12.1;{:.6};45.2", a.to_degrees())
    });
    holds_the_swing(&read(&text), 1e-6);
}

#[test]
fn of_efforts_that_tie_one_that_stands_still_drives_nothing() {
    let text = file("time_s,position0,effort0,effort1", |_, t, a| format!("{t:.2},{a:.7},0.0,0.0"));
    let options = ReadOptions { driven: true, ..ReadOptions::default() };
    let (record, _) = read_text("a.csv", text.as_bytes(), &options).unwrap();
    assert!(record.input().is_none());
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

/// Regression: angles in radians that wrap, of more than a turn, were refused as degrees by a diagnosis.
#[test]
fn angles_that_wrap_after_a_turn_of_their_unit_are_not_doubted() {
    let half = std::f64::consts::PI;
    let wrapped = |angle: f64| (30.0 * angle + half).rem_euclid(2.0 * half) - half;
    let text: String = (0..3000)
        .map(|at| 0.01 * f64::from(at))
        .map(|time| format!("{time:.2},{:.5}\n", wrapped((-0.02 * time).exp() * (2.0 * time).cos())))
        .collect();
    let (_, source) = read(&format!("time_s,yaw_rad\n{text}"));
    assert_eq!(source.findings.len(), 1, "{:?}", source.findings);
    assert!(source.findings[0].contains("the values wrap"), "{:?}", source.findings);
    assert!(!source.reading.value.is_stated_by_header(), "{}", source.reading.value.because);
}

#[test]
fn dates_of_other_countries_are_read() {
    let row = |date: &'static str, half: &'static str| {
        move |i: usize, _: f64, a: f64| {
            format!("{date} 10:00:{:02}.{:03}{half},{a:.7}", i / 100, i % 100 * 10)
        }
    };
    for (date, half, said) in
        [("14.06.2023", "", 0), ("06/14/2023", "", 0), ("6/14/2023", " AM", 0), ("06/07/2023", " PM", 1)]
    {
        let found = read(&file("time,angle_rad", row(date, half)));
        holds_the_swing(&found, 1e-6);
        assert_eq!(found.1.findings.len(), said, "{:?}", found.1.findings);
    }
    let (_, source) = read(&file("time,angle_rad", row("06/07/2023", "")));
    assert!(source.findings[0].contains("read with the month first"), "{:?}", source.findings);
}

#[test]
fn units_above_the_header_of_an_oscilloscope_are_taken() {
    let top =
        "Model,TBS1052B\n\nHorizontal Units,S,\nSample Interval,0.01,\nVertical Units,mV,\nLabel,,\nTIME,CH1";
    let found = read(&file(top, |_, t, a| format!("{t:.8},{:.6}", 1e3 * a)));
    holds_the_swing(&found, 1e-6);
    let sentence = &found.1.reading.sentence;
    assert!(sentence.contains("time = \"TIME\" in s; value = \"CH1\" in mV;"), "{sentence}");
}

/// Regression: the voltage of the sensor was taken for what drives the system.
#[test]
fn a_voltage_in_proportion_to_the_angle_is_no_input() {
    let options = ReadOptions { driven: true, ..ReadOptions::default() };
    let read = |text: &str| read_text("r.csv", text.as_bytes(), &options).unwrap();
    let text = file("time_s,adc_voltage_v,angle_deg", |_, t, a| {
        format!("{t:.2},{:.3},{:.2}", a.to_degrees() / 10.0 + 2.5, a.to_degrees())
    });
    let (record, source) = read(&text);
    assert!(record.input().is_none());
    assert!(source.findings[0].contains("name it with `data.input`"), "{:?}", source.findings);
    for (name, other) in [("a command", 1.0), ("a column at rest", 0.0)] {
        let (record, _) = read(&file("time_s,command,angle_deg", |_, t, a| {
            format!("{t:.2},{:.4},{:.2}", other * (8.0 * t).sin(), a.to_degrees())
        }));
        assert!(record.input().is_some(), "{name}");
    }
}
