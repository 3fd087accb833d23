//! Tests of planning a sweep.

use super::{Axis, Registries, RunData, apply_override, combinations, plan};
use settings::Document;

const CONFIG: &str = "seed = 3\n[data]\npath = \"a.csv\"\n[fit]\nseeds = 2\n[estimator]\nname = \"ols\"\n";
const CLASSICAL: &[&str] = &["ols", "qr"];

fn planned(config: &str, axes: &[&str]) -> Result<Vec<super::PlannedRun>, super::SweepError> {
    let axes: Vec<Axis> = axes.iter().map(|axis| Axis::parse(axis).unwrap()).collect();
    let registries = Registries { estimators: &[], classical: CLASSICAL, learners: &[] };
    plan(&Document::parse("a.toml", config).unwrap(), combinations(&axes)?, 1, &registries)
}

fn refused(config: &str, axes: &[&str]) -> String {
    planned(config, axes).unwrap_err().to_string()
}

#[test]
fn every_combination_is_resolved() {
    let runs = planned(CONFIG, &["estimator=ols,qr", "seed=0..1"]).unwrap();
    let overrides: Vec<String> = runs.iter().map(|run| run.overrides.join(" ")).collect();
    let expected =
        ["estimator=ols seed=0", "estimator=ols seed=1", "estimator=qr seed=0", "estimator=qr seed=1"];
    assert_eq!(overrides, expected);
    assert_eq!(runs.iter().map(|run| run.number).collect::<Vec<_>>(), [1, 2, 3, 4]);
    for run in &runs {
        assert_eq!(run.data, RunData::Record("a.csv".to_owned()));
        assert_eq!(run.digest.len(), "sha256:".len() + 64);
        // The frozen text alone resolves to the same run.
        let again = planned(&run.config, &[]).unwrap();
        assert_eq!(again[0].digest, run.digest);
    }
}

#[test]
fn a_digest_is_of_the_values_not_of_where_they_stand() {
    let elsewhere =
        planned("[estimator]\nname = \"qr\"\n[fit]\nseeds = 2\n[data]\npath = \"a.csv\"", &["seed=1"]);
    let here = planned(CONFIG, &["estimator=ols,qr", "seed=0..1"]).unwrap();
    assert_eq!(elsewhere.unwrap()[0].digest, here[3].digest);
}

#[test]
fn a_bad_combination_is_named_before_anything_runs() {
    assert_eq!(
        refused(CONFIG, &["seed=1,2", "fit.tolerance_percent=0.1,-1"]),
        "combination 2 (seed=1 fit.tolerance_percent=-1): command line: `fit.tolerance_percent=-1`: \
         `fit.tolerance_percent` is -1; expected a finite number from 0 to 1000000000 (%)"
    );
    let unknown = refused(CONFIG, &["estimator=ols,qrr"]);
    assert!(
        unknown.contains("combination 2 (estimator=qrr)") && unknown.contains("did you mean `qr`"),
        "{unknown}"
    );
    let twice = refused(CONFIG, &["seed=1,2,1"]);
    assert!(twice.starts_with("combinations 1 (seed=1) and 3 are the same experiment"), "{twice}");
    let task = refused("task = \"predict\"\n", &["seed=1"]);
    assert!(task.contains("task = \"predict\" cannot be swept"), "{task}");
}

#[test]
fn the_short_form_leaves_out_what_belongs_to_another_estimator() {
    let text = "[estimator]\nname = \"pinn\"\nhidden = [3]\n";
    let keys = |arguments: &[&str]| -> Vec<String> {
        let mut document = Document::parse("a.toml", text).unwrap();
        for argument in arguments {
            apply_override(&mut document, argument).unwrap();
        }
        document.leaves().iter().map(|leaf| format!("{}={}", leaf.key, leaf.value)).collect()
    };
    assert_eq!(keys(&["estimator=ols"]), ["estimator.name=\"ols\""]);
    for same in ["estimator=pinn", "estimator=\"pinn\"", "estimator='pinn'", "estimator = 'pinn' "] {
        assert_eq!(keys(&[same]), ["estimator.name=\"pinn\"", "estimator.hidden=[3]"], "{same}");
    }
    assert_eq!(
        keys(&["estimator.steps=1", "estimator=ols"]),
        ["estimator.steps=1", "estimator.name=\"ols\""]
    );
    // In a sweep, the order of the axes does not matter.
    let both = ["estimator.hidden=[4]", "estimator=ols"];
    let message = refused(text, &both);
    assert!(message.contains("unknown key `estimator.hidden`"), "{message}");
    assert!(refused(text, &["estimator.name=ols"]).contains("estimator=ols instead of estimator.name=ols"));
    // A key that belongs to no estimator is reported as plainly unknown.
    let other = refused("[fit]\nsteps = 3\n", &["estimator.name=ols"]);
    assert!(other.contains("unknown key `fit.steps`") && !other.contains("instead of"), "{other}");
}
