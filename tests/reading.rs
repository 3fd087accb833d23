//! Tests of reading one swing from the files of several programs: the answer is the same for each format.

use crate::support::{number, root, trainer};
use serde_json::Value;
use std::path::Path;

/// Number of samples of the swing.
pub(crate) const SAMPLES: usize = 1000;

/// Returns time in seconds and angle in radians of a sample: 22 rad/s, a damping of 0.3 per unit of inertia.
pub(crate) fn swing(index: usize) -> (f64, f64) {
    let time = index as f64 / 100.0;
    // Noise without a generator, so that the values do not follow a smooth formula.
    let noise = (index as f64 * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0) - 0.5;
    (time, 0.7 * (-0.15 * time).exp() * (22.0 * time).cos() + 1e-3 * noise)
}

fn file(header: &str, row: impl Fn(usize, f64, f64) -> String) -> String {
    (0..SAMPLES).fold(format!("{header}\n"), |text, index| {
        let (time, angle) = swing(index);
        text + &row(index, time, angle) + "\n"
    })
}

fn comma(number: f64) -> String {
    format!("{number:.7}").replace('.', ",")
}

/// Returns for each format its name, the text, the coordinate of the nominal simulator, and the options that
/// it needs.
pub(crate) fn files() -> Vec<(&'static str, String, &'static str, &'static [&'static str])> {
    let deg = f64::to_degrees;
    let iso = |i: usize| format!("2024-05-01T12:00:{:02}.{:03}Z", i / 100, i % 100 * 10);
    vec![
        ("plain", file("time_s,angle_rad", |_, t, a| format!("{t:.2},{a:.9}")), "angle", &[]),
        (
            "semicolons",
            file("Zeit;Winkel [deg]", |_, t, a| format!("{};{}", comma(t), comma(deg(a)))),
            "angle",
            &[],
        ),
        ("tabs", file("t\ttheta", |_, t, a| format!("{t:.2}\t{a:.9}")), "angle", &[]),
        (
            "nanoseconds since 1970",
            file("%time,field.position0", |i, _, a| {
                format!("{},{a:.9}", 1_714_564_800_000_000_000_u64 + 10_000_000 * i as u64)
            }),
            "angle",
            &[],
        ),
        ("dates", file("stamp,angle", |i, _, a| format!("{},{a:.9}", iso(i))), "angle", &[]),
        (
            "unit in the header",
            file("time,angle [deg]", |_, t, a| format!("{t:.2},{:.7}", deg(a))),
            "angle",
            &[],
        ),
        (
            "displacement",
            file("timestamp_ms,displacement_m", |_, t, a| format!("{:.0},{a:.9}", 1e3 * t)),
            "displacement",
            &[],
        ),
        ("position", file("time,position", |_, t, a| format!("{t:.2},{a:.9}")), "displacement", &[]),
        (
            "series",
            file("time_s,joint,angle_rad", |_, t, a| {
                format!("{t:.2},Rotation,{a:.9}\n{t:.2},Pitch,{}", 0.5 - a)
            }),
            "angle",
            &["where", "joint=Rotation"],
        ),
        ("units line", file("Time;Angle\ns;deg", |_, t, a| format!("{t:.2};{:.7}", deg(a))), "angle", &[]),
        (
            "microcontroller",
            file("millis,angle_deg", |_, t, a| format!("{:.0},{:.7}", 1e3 * t, deg(a))),
            "angle",
            &[],
        ),
        ("blanks", file("# t y", |_, t, a| format!("{t:.2} {a:.9}")), "angle", &[]),
    ]
}

pub(crate) fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn json(arguments: &[&str], context: &str) -> Value {
    let output = trainer(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{context}: {error}: {message}"))
}

fn estimate(record: &str, out: &str, options: &[String], context: &str) -> Value {
    let path = format!("data.path={record}");
    let mut arguments = vec![
        "configs/ols.toml",
        &path,
        "data.clock=auto",
        "envelope.pipeline=recommended",
        "--json",
        "--out",
        out,
    ];
    arguments.extend(options.iter().map(String::as_str));
    json(&arguments, context)
}

#[test]
fn a_swing_has_the_same_damping_in_every_file() {
    let scratch = tempfile::tempdir().unwrap();
    let mut expected = None;
    for (name, text, _, options) in files() {
        let record = write(scratch.path(), &format!("{name}.csv"), &text);
        let keys: Vec<String> =
            options.chunks(2).map(|pair| format!("data.{}={}", pair[0], pair[1])).collect();
        let out = scratch.path().join(name);
        let found = estimate(&record, out.to_str().unwrap(), &keys, name);
        let zeta = number(&found, "/oracle/zeta");
        let expected = *expected.get_or_insert(zeta);
        assert!((zeta / expected - 1.0).abs() < 1e-4, "{name}: {zeta} for {expected}");
        let sentence = found["data"]["reading"]["sentence"].as_str().unwrap();
        assert!(
            sentence.starts_with("read as: ") && sentence.ends_with("; rate 100.0 Hz"),
            "{name}: {sentence}"
        );
    }
    assert!((expected.unwrap() - 0.15 / 22.0).abs() < 1e-4);
}

#[test]
fn a_swing_has_the_same_verdict_in_every_file() {
    let scratch = tempfile::tempdir().unwrap();
    let mut expected = None;
    for (name, text, coordinate, options) in files() {
        let record = write(scratch.path(), &format!("{name}.csv"), &text);
        let nominal = format!(
            "coordinate = \"{coordinate}\"\ninertia = 1.0\ndamping = 0.3\nstiffness = 480.0\nrest_angle = 0.0\n"
        );
        let nominal = write(scratch.path(), &format!("{name}.toml"), &nominal);
        let out = scratch.path().join(name);
        let mut arguments = vec![
            "diagnose",
            &record,
            "--nominal",
            &nominal,
            "--most-effects",
            "1",
            "--json",
            "--out",
            out.to_str().unwrap(),
        ];
        let flags: Vec<String> =
            options.chunks(2).flat_map(|pair| [format!("--{}", pair[0]), pair[1].to_owned()]).collect();
        arguments.extend(flags.iter().map(String::as_str));
        let found = json(&arguments, name);
        let answer =
            (found["verdict"]["status"].clone(), number(&found, "/calibration/stiffness/recalibrated/value"));
        let expected = expected.get_or_insert(answer.clone());
        assert_eq!(answer.0, expected.0, "{name}");
        assert!((answer.1 / expected.1 - 1.0).abs() < 1e-4, "{name}: {} for {}", answer.1, expected.1);
        let sentence = found["records"][0]["reading"]["sentence"].as_str().unwrap();
        assert!(sentence.starts_with("read as: "), "{name}: {sentence}");
    }
}

#[test]
fn missing_cells_are_gaps_and_counted_once() {
    let scratch = tempfile::tempdir().unwrap();
    let text = file("time_s,angle_rad", |i, t, a| match i {
        200..205 => format!("{t:.2},NaN"),
        500..510 => format!("{t:.2},"),
        _ => format!("{t:.2},{a:.9}"),
    });
    let record = write(scratch.path(), "holes.csv", &text);
    let found = estimate(&record, scratch.path().join("run").to_str().unwrap(), &[], "holes");
    assert_eq!(
        (&found["data"]["samples"], &found["data"]["reading"]["missing_cells"]),
        (&985.into(), &15.into())
    );
    assert!((number(&found, "/oracle/zeta") - 0.15 / 22.0).abs() < 1e-4);
    let output = trainer(&["configs/ols.toml", &format!("data.path={record}"), "data.missing=refuse"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("holes.csv:202: 15 missing cells, the first in column `angle_rad`"),
        "{message}"
    );
}

#[test]
fn what_the_reader_found_reads_the_file_again() {
    let scratch = tempfile::tempdir().unwrap();
    let (_, text, _, _) = files().swap_remove(1);
    let path = write(scratch.path(), "log.csv", &text);
    let options = record::ReadOptions::default();
    let found = record::look(&path, &std::fs::read(&path).unwrap(), &options).unwrap();
    let keys: Vec<String> =
        found.source.reading.options().iter().map(|(key, value)| format!("data.{key}={value}")).collect();
    let out = [scratch.path().join("one"), scratch.path().join("other")]
        .map(|out| out.to_str().unwrap().to_owned());
    let one = estimate(&path, &out[0], &[], "found");
    let other = estimate(&path, &out[1], &keys, "stated");
    assert_eq!(one["oracle"], other["oracle"]);
    assert!(root().join("configs/ols.toml").exists());
}

/// A body that is struck again swings freely twice: each swing is a record of its own.
#[test]
fn two_strikes_are_two_records() {
    let scratch = tempfile::tempdir().unwrap();
    let path = |name: &str| scratch.path().join(name).to_str().unwrap().to_owned();
    let swing = |time: f64| (-0.2 * time).exp() * (12.0 * time).cos();
    let value = |time: f64| if time < 9.0 { 0.3 * swing(time) } else { 0.4 * swing(time - 9.0) };
    let noise =
        |at: u32| 1e-3 * (f64::from(at) * 43.758).sin() * (f64::from(at) * f64::from(at) * 0.713).cos();
    let rows =
        (0..1800).map(|at| format!("{},{}\n", 0.01 * f64::from(at), value(0.01 * f64::from(at)) + noise(at)));
    std::fs::write(path("log.csv"), format!("time_s,angle_rad\n{}", rows.collect::<String>())).unwrap();
    let nominal = "inertia = 1.0\ndamping = 0.4\nstiffness = 144.04\nrest_angle = 0.0\n";
    std::fs::write(path("nominal.toml"), nominal).unwrap();
    let out = path("out");
    let output =
        trainer(&["diagnose", &path("log.csv"), "--nominal", &path("nominal.toml"), "--json", "--out", &out]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let records = found["records"].as_array().unwrap();
    assert_eq!(records.len(), 2, "{}", found["records"]);
    let part = |at: usize| &records[at]["reading"]["part_s"];
    assert_ne!(part(0), part(1));
    assert!(found["gap"]["ratio_to_floor"].as_f64().unwrap() < 1.3, "{}", found["gap"]);
}
