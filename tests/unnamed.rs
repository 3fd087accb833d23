//! Tests of a torque along the position: the text for users, and its part in the repaired simulator.

use crate::support::{number, result, simulated, trainer};
use serde_json::Value;

/// Returns the configuration of a decay that lacks only a torque that repeats 20 times per turn, or every
/// 2π/20 m.
fn config(coordinate: &str) -> String {
    format!(
        r#"
name = "waves"
coordinate = "{coordinate}"
[record]
rate_hz = 130.0
seconds = 8.0
[start]
position = 0.7
[sensor]
noise = 5e-4
[[effects]]
id = "unknown"
parameters.torque = 0.8
parameters.wavenumber = 20.0
parameters.phase = 0.4
"#
    )
}

#[test]
fn it_is_unknown_described_in_words_and_part_of_the_repaired_simulator() {
    for (coordinate, unit, often) in
        [("angle", "1", "repeats 20.0 times a turn"), ("displacement", "rad/m", "repeats every 0.31")]
    {
        let scratch = tempfile::tempdir().unwrap();
        let at = |name: &str| scratch.path().join(name).to_str().unwrap().to_owned();
        let file = simulated(scratch.path(), &config(coordinate), &[]);
        let (code, found, folder) =
            result(&["diagnose", &file("record-000.csv"), "--nominal", &file("nominal.toml")]);
        assert_eq!(code, 0, "{found}");
        assert_eq!(found["verdict"]["status"], "unknown", "{found}");
        assert_eq!(found["verdict"]["effects"], Value::Array(Vec::new()));
        let summary = found["verdict"]["summary"].as_str().unwrap();
        assert!(summary.contains(often), "{summary}");
        let row = found["effects"].as_array().unwrap().iter().find(|row| row["id"] == "unknown").unwrap();
        assert_eq!(row["parameters"]["wavenumber"]["unit"], unit);
        assert!((number(row, "/parameters/torque/value") / 0.8 - 1.0).abs() < 0.05, "{row}");
        assert!(number(&found, "/gap/ratio_to_floor") < 1.05);
        let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
        assert!(
            report.contains("a position-dependent torque") && report.contains("and an unexplained torque")
        );
        let repaired = folder.path().join("repaired.toml");
        let again = trainer(&["simulate", repaired.to_str().unwrap(), "--quiet", "--out", &at("again")]);
        assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    }
}
