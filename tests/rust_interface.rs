//! Tests that the Rust interface gives the same results as the command line.

use crate::support::{Shipped, result, root, trainer};
use ringdown_lab::{
    Arrays, DiagnosisOptions, Error, EstimateOptions, Nominal, Reading, Record, diagnose, estimate,
};
use serde_json::Value;

fn shipped(name: &str) -> String {
    root().join("experiments/default-record").join(name).display().to_string()
}

/// Removes durations, which differ from run to run.
fn timeless(mut value: Value) -> Value {
    fn forget(value: &mut Value) {
        match value {
            Value::Object(entries) => {
                entries.remove("seconds");
                entries.values_mut().for_each(forget);
            }
            Value::Array(entries) => entries.iter_mut().for_each(forget),
            _ => {}
        }
    }
    forget(&mut value);
    value
}

#[test]
fn a_diagnosis_is_that_of_the_command_line() {
    let (record, nominal) = (shipped("record.csv"), shipped("nominal.toml"));
    let scratch = tempfile::tempdir().unwrap();
    let (told, folder) = (Shipped::get().answer(), Shipped::get().copy_below(scratch.path()));

    let nominal = Nominal::read(&nominal).unwrap();
    let record = Record::read(&record, &nominal.reading(Reading::default())).unwrap();
    let found = diagnose(&[record], &nominal, &DiagnosisOptions::default()).unwrap();
    let own: Value = serde_json::from_str(&found.to_json().unwrap()).unwrap();
    assert_eq!(timeless(own), timeless(told));
    // The other files of the folder are the same too.
    for (name, text) in found.files() {
        assert_eq!(std::fs::read_to_string(folder.join(name)).unwrap(), text, "{name}");
    }
    // The report is a page of the same answer.
    let page = folder.join("again.html");
    found.report(&page).unwrap();
    assert!(std::fs::read_to_string(page).unwrap().contains(&found.verdict().summary));
    // The repaired simulator is a nominal simulator with the effects that close the gap.
    let repaired = found.repaired_nominal().unwrap().to_toml();
    let closing: Vec<_> = found.effects().iter().filter(|effect| effect.gap_share.is_some()).collect();
    assert!(!closing.is_empty());
    for effect in closing {
        assert!(repaired.contains(&effect.id), "{repaired}");
    }
}

#[test]
fn an_estimate_is_that_of_the_command_line() {
    let record = Record::read(shipped("record.csv"), &Reading::default()).unwrap();
    for method in ["ols", "sindy"] {
        let path = format!("data.path={}", shipped("record.csv"));
        let chosen = format!("estimator={method}");
        let (_, told, _folder) =
            result(&["configs/pinn.toml", &path, &chosen, "fit.seeds=1", "envelope.pipeline=recommended"]);
        let found = estimate(&record, method, &EstimateOptions::default()).unwrap();
        assert_eq!(told["estimate"]["zeta"].as_f64(), Some(found.damping_ratio));
        assert_eq!(told["estimate"]["zeta_std_error"].as_f64(), found.damping_ratio_std_error);
        assert_eq!(told["estimate"]["reached"].as_str(), Some(found.reached.name()));
        assert_eq!(told["error_percent"].as_f64(), Some(found.error_percent));
        assert_eq!(told["envelope"]["peaks"].as_u64(), Some(found.peaks as u64));
    }
}

#[test]
fn a_guess_is_that_of_trainer_init() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("rig");
    let output = trainer(&["init", &shipped("record.csv"), "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let record = Record::read(shipped("record.csv"), &Reading::default()).unwrap();
    let told = Nominal::read(out.join("nominal.toml")).unwrap();
    assert_eq!(Nominal::guess(&record).unwrap().to_toml(), told.to_toml());
}

#[test]
fn errors_say_what_the_command_line_says() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let backward = write("backward.csv", "time_s,angle_rad\n0.0,0.1\n0.05,0.2\n0.035,0.1\n");
    let nominal = write("bad.toml", "inertia = 1.0\ndampin = 0.1\n");
    let told = |record: &str, nominal: &str| {
        let output = trainer(&["diagnose", record, "--nominal", nominal]);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let error = Record::read(&backward, &Reading::default()).unwrap_err();
    assert!(matches!(error, Error::Record(_)));
    assert!(told(&backward, &shipped("nominal.toml")).contains(&error.to_string()), "{error}");
    let error = Nominal::read(&nominal).unwrap_err();
    assert!(matches!(error, Error::Config(_)));
    assert!(told(&shipped("record.csv"), &nominal).contains(&error.to_string()), "{error}");

    // A record without motion gives no information about any system.
    let times: Vec<f64> = (0..500).map(|i| f64::from(i) / 100.0).collect();
    let still = Record::new(times, vec![0.1; 500], Arrays::default()).unwrap();
    let nominal = Nominal::swinging(2.0, 0.01).unwrap();
    let error = diagnose(&[still], &nominal, &DiagnosisOptions::default()).unwrap_err();
    assert!(matches!(error, Error::Diagnosis(_)), "{error}");
    assert!(error.to_string().contains("does not move"), "{error}");
}

#[test]
fn options_out_of_range_are_refused_with_the_range() {
    let nominal = Nominal::swinging(2.0, 0.01).unwrap();
    let usual = DiagnosisOptions::default;
    for (options, words) in [
        (DiagnosisOptions { false_alarm: 0.5, ..usual() }, "0.001 to 0.2"),
        (DiagnosisOptions { most_effects: 0, ..usual() }, "1 to 5"),
        (DiagnosisOptions { without: vec!["drag".to_owned()], ..usual() }, "drag"),
    ] {
        let error = diagnose(&[], &nominal, &options).unwrap_err();
        assert!(matches!(error, Error::Config(_)) && error.to_string().contains(words), "{error}");
    }
    let record = Record::read(shipped("record.csv"), &Reading::default()).unwrap();
    let error = estimate(&record, "pin", &EstimateOptions::default()).unwrap_err();
    assert!(error.to_string().contains("pinn"), "{error}");
}
