//! Tests on measured records in their folder beside the project; skipped with a notice if they are absent.

use crate::support::{measured, number, result, root, trainer};
use record::{Clock, ClockChoice, ClockKind, CsvColumns, Format, ReadOptions, Unit, read_file};

fn close(found: f64, expected: f64, digits: i32) {
    let tolerance = 0.5 * 10_f64.powi(-digits);
    assert!((found / expected - 1.0).abs() < tolerance, "{found} is not {expected}");
}

#[test]
fn the_papers_pipeline_gives_the_papers_numbers() {
    let Some(path) = measured("horizontal-pendulum/80P.txt") else { return };
    let (code, result, _) =
        result(&["configs/paper-record.toml", &format!("data.path={path}"), "fit.seeds=10"]);
    assert_eq!(code, 0, "{result}");
    assert_eq!(result["data"]["samples"], 7_625);
    assert_eq!(result["envelope"]["samples"], 14_650);
    assert_eq!(result["envelope"]["peaks"], 69);
    close(number(&result, "/envelope/omega_rad_s"), 21.816_615_649_929, 13);
    close(number(&result, "/oracle/decay_rate"), 0.190_960_999_67, 10);
    close(number(&result, "/oracle/log_amplitude").exp().to_degrees(), 32.190_059, 7);
    close(number(&result, "/oracle/r_squared"), 0.964_475_69, 7);
    close(number(&result, "/oracle/zeta"), 0.008_753_007_466_3, 10);
    let worst = number(&result, "/worst_error_percent");
    assert_eq!(result["seeds"].as_array().unwrap().len(), 10);
    assert!(worst < 1e-4, "worst of ten seeds: {worst} %");
}

#[test]
fn the_believed_clock_of_the_papers_record_is_near_260_hertz() {
    let Some(path) = measured("horizontal-pendulum/80P.txt") else { return };
    let (_, result, _) = result(&[
        "configs/paper-record.toml",
        &format!("data.path={path}"),
        "data.clock=auto",
        "fit.max_steps=0",
    ]);
    assert_eq!(result["data"]["clock"], "uniform-index");
    let rate = number(&result, "/data/sample_rate_hz");
    assert!((rate - 259.6).abs() < 0.1, "{rate}");
    let findings = result["data"]["findings"].to_string();
    assert!(findings.contains("not the stated 500 Hz"), "{findings}");
    assert!(findings.contains("7625 samples, not the stated 14650"), "{findings}");
    // A 12-bit encoder, rounded to two decimals of a degree.
    close(number(&result, "/data/resolution"), std::f64::consts::TAU / 4096.0, 3);
}

#[test]
fn every_measured_record_is_read_and_its_clock_decided() {
    let host_log = || ReadOptions { format: Format::HostLog, ..ReadOptions::default() };
    let columns = |columns| ReadOptions { columns, ..ReadOptions::default() };
    let drive = CsvColumns {
        value: Some("qm_m".to_owned()),
        input: Some("vir_V".to_owned()),
        unit: Some(Unit::Meter),
        ..CsvColumns::default()
    };
    let circuit = CsvColumns {
        value: Some("output_v".to_owned()),
        input: Some("input_v".to_owned()),
        unit: Some(Unit::Volt),
        sample_rate_hz: Some(610.35),
        ..CsvColumns::default()
    };
    use ClockKind::{Host, UniformIndex};
    // File, read options, samples, rate in Hz, clock. The servo's stamps jitter, and its values are too
    // coarse to tell the source of the jitter: the stamps are used.
    let records: [(&str, ReadOptions, usize, f64, ClockKind); 8] = [
        ("horizontal-pendulum/80P.txt", host_log(), 7_625, 259.6, UniformIndex),
        ("horizontal-pendulum/60.txt", host_log(), 6_560, 259.5, UniformIndex),
        ("horizontal-pendulum/100.txt", host_log(), 12_278, 259.5, UniformIndex),
        ("encoder-pendulum/record-a.csv", ReadOptions::default(), 13_604, 99.61, UniformIndex),
        ("servo-pendulum/swing-a.csv", ReadOptions::default(), 400, 99.99, Host),
        ("servo-pendulum/swing-b.csv", ReadOptions::default(), 400, 100.0, Host),
        ("positioning-drive/record.csv", columns(drive), 24_841, 1000.0, UniformIndex),
        ("silverbox/record.csv", columns(circuit), 131_072, 610.35, UniformIndex),
    ];
    for (name, options, samples, rate, kind) in records {
        let Some(path) = measured(name) else { continue };
        let (record, _) = read_file(&root().join(path), &options).unwrap();
        let clock = Clock::new(&record, ClockChoice::Auto).unwrap();
        assert_eq!(record.len(), samples, "{name}");
        assert_eq!(clock.kind, kind, "{name}: {}", clock.reason);
        assert!((clock.sample_rate_hz / rate - 1.0).abs() < 1e-3, "{name}: {}", clock.sample_rate_hz);
    }
}

#[test]
fn a_swing_that_stops_within_a_cycle_has_no_envelope() {
    let Some(path) = measured("servo-pendulum/swing-a.csv") else { return };
    let output = trainer(&["configs/pinn.toml", &format!("data.path={path}"), "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("finds 1 peak; a decay rate needs at least 3"), "{message}");
}
