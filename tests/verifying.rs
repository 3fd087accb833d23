//! Tests of `trainer verify`: a finished run is repeated from its folder alone.

use crate::support::{root, trainer};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn run(arguments: &[&str], scratch: &Path, name: &str) -> PathBuf {
    let out = scratch.join(name);
    let output = trainer(&[arguments, &["--quiet", "--out", out.to_str().unwrap()]].concat());
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    out
}

fn verify(run: &Path) -> (Option<i32>, String) {
    let output = trainer(&["verify", run.to_str().unwrap()]);
    let said = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(said).unwrap())
}

#[test]
fn every_kind_of_run_verifies_as_identical() {
    let scratch = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("estimate", &["configs/pinn.toml", "fit.max_steps=4", "fit.seeds=2"][..]),
        ("compare", &["configs/compare.toml", "compare.methods=ols,sindy,pinn", "fit.max_steps=9"]),
        (
            "predict",
            &[
                "configs/beyond.toml",
                "predict.problems=control",
                "predict.draws=2",
                "predict.methods=ols,sindy",
            ],
        ),
        ("learn", &["configs/learn/sindy.toml", "sindy.members=4", "sindy.refit_samples=500"]),
        ("simulate", &["configs/simulate.toml", "simulate.systems=2"]),
    ] {
        let out = run(arguments, scratch.path(), name);
        assert_eq!(verify(&out), (Some(0), format!("{}: identical\n", out.display())), "{name}");
    }
}

#[test]
fn a_number_that_was_changed_is_told_with_both_values() {
    let scratch = tempfile::tempdir().unwrap();
    let out = run(&["configs/pinn.toml", "fit.max_steps=4"], scratch.path(), "run");
    let path = out.join("result.json");
    let mut result: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let before = result["estimate"]["zeta"].clone();
    result["estimate"]["zeta"] = serde_json::json!(0.0087);
    std::fs::write(&path, serde_json::to_string_pretty(&result).unwrap()).unwrap();
    let (code, said) = verify(&out);
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains(&format!("result.json: estimate.zeta: 0.0087 kept, {before} made again")),
        "{said}"
    );
    let output = trainer(&["verify", out.to_str().unwrap(), "--json"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&value["identical"], &value["differences"][0]["place"]),
        (&Value::Bool(false), &"estimate.zeta".into())
    );
}

#[test]
fn what_cannot_be_verified_is_refused_with_what_was_expected() {
    let scratch = tempfile::tempdir().unwrap();
    let record = scratch.path().join("record.csv");
    std::fs::copy(root().join("experiments/default-record/record.csv"), &record).unwrap();
    let path = format!("data.path={}", record.display());
    let out = run(&["configs/pinn.toml", "fit.max_steps=1", &path], scratch.path(), "run");
    let (code, said) = verify(&out);
    assert_eq!(code, Some(0), "{said}");
    let whole = std::fs::read(&record).unwrap();
    std::fs::write(&record, &whole[..whole.len() - 1]).unwrap();
    let (code, said) = verify(&out);
    assert_eq!((code, said.matches("sha256:").count()), (Some(2), 2), "{said}");
    std::fs::remove_file(&record).unwrap();
    let (code, said) = verify(&out);
    assert!(
        code == Some(2)
            && said.contains("is not there")
            && said.contains("change to the folder in which the run was made"),
        "{said}"
    );
    std::fs::write(&record, whole).unwrap();
    let config = out.join("config.toml");
    let text = std::fs::read_to_string(&config).unwrap();
    std::fs::write(&config, text.replace("max_steps = 1 ", "max_steps = 2 ")).unwrap();
    let (code, said) = verify(&out);
    assert!(code == Some(2) && said.contains("config.toml: has been changed since the run began"), "{said}");
    let (code, said) = verify(scratch.path());
    assert!(code == Some(2) && said.contains("there is no run in it"), "{said}");
}
