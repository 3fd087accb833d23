//! Tests of the dependency rules between crates, by cargo's own data.

use crate::support::root;
use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

/// Returns the layer of a crate; a crate may depend on lower layers only. A crate that is missing here fails
/// the test, so that every new crate gets a layer.
fn layer(name: &str) -> Option<u8> {
    Some(match name {
        "record" | "seed" | "settings" | "dynamics" | "least-squares" => 0,
        "envelope" | "export" | "results" | "robot" | "truth" => 1,
        "estimator" | "simulator" => 2,
        "neural" | "sparse" => 3,
        name if name.starts_with("estimator-") => 4,
        "learn" | "oracle" => 4,
        "scoring" | "runs" | "identify" => 5,
        "conformance" | "diagnosis" => 3,
        "registry" => 5,
        "report" | "trials" | "tracking" | "experiment" => 6,
        "studies" | "workflow" => 7,
        "ringdown-lab" | "trainer" | "web" => 8,
        "ringdown-python" => 9,
        _ => return None,
    })
}

fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .args(["--locked", "--offline"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn packages() -> Vec<Value> {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: Value = serde_json::from_str(&text).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

fn name(package: &Value) -> &str {
    package["name"].as_str().unwrap()
}

/// Returns every crate that a crate depends on, by any kind of dependency and with every feature on.
fn reach(package: &str) -> BTreeSet<String> {
    let tree = cargo(&[
        "tree",
        "--package",
        package,
        "--all-features",
        "--edges",
        "normal,build,dev",
        "--prefix",
        "none",
        "--format",
        "{lib}",
    ]);
    tree.lines().map(|line| line.trim().replace('_', "-")).collect()
}

#[test]
fn arrows_point_downward_only() {
    let packages = packages();
    assert!(packages.len() > 10);
    for package in &packages {
        let own = layer(name(package)).unwrap_or_else(|| panic!("{} has no layer", name(package)));
        for dependency in package["dependencies"].as_array().unwrap() {
            // Tests may use any crate, unless a test below forbids it.
            if dependency["kind"] == "dev" {
                continue;
            }
            if let Some(other) = layer(name(dependency)).filter(|_| dependency["path"].is_string()) {
                assert!(other < own, "{} must not use {}", name(package), name(dependency));
            }
        }
    }
}

#[test]
fn an_estimator_reaches_no_oracle_no_truth_and_no_other_estimator() {
    let packages = packages();
    let estimators: Vec<&str> =
        packages.iter().map(name).filter(|name| name.starts_with("estimator-")).collect();
    assert!(estimators.len() >= 2);
    for estimator in &estimators {
        let reached = reach(estimator);
        assert!(reached.contains("estimator"), "cargo tree gave {reached:?}");
        for forbidden in [
            "oracle",
            "truth",
            "simulator",
            "diagnosis",
            "scoring",
            "experiment",
            "runs",
            "report",
            "trainer",
            "linfa-linear",
        ] {
            assert!(!reached.contains(forbidden), "{estimator} reaches {forbidden}");
        }
        for other in estimators.iter().filter(|other| *other != estimator) {
            assert!(!reached.contains(*other), "{estimator} reaches {other}");
        }
    }
}

/// Only crates that make records or score answers may use the truth. Tests count too: a check against the
/// truth inside an estimator's crate would give access to it.
#[test]
fn only_who_makes_or_scores_records_reaches_the_truth() {
    let packages = packages();
    let depends_on = |package: &Value, on: &BTreeSet<String>| {
        package["dependencies"].as_array().unwrap().iter().any(|dependency| on.contains(name(dependency)))
    };
    let mut reaching = BTreeSet::from(["truth".to_owned()]);
    loop {
        let before = reaching.len();
        let found = packages.iter().filter(|package| depends_on(package, &reaching));
        let found: Vec<String> = found.map(|package| name(package).to_owned()).collect();
        reaching.extend(found);
        if reaching.len() == before {
            break;
        }
    }
    assert!(reaching.contains("simulator"), "{reaching:?}");
    for package in &reaching {
        let may = [
            "truth",
            "simulator",
            "scoring",
            "trials",
            "studies",
            "ringdown-lab",
            "trainer",
            "ringdown-python",
            "web",
        ]
        .contains(&package.as_str());
        assert!(may, "{package} reaches the truth");
    }
}

#[test]
fn the_oracle_reaches_nothing_that_estimators_compute_with() {
    let reached = reach("oracle");
    assert!(reached.contains("linfa-linear"), "cargo tree gave {reached:?}");
    for forbidden in ["burn", "neural", "least-squares", "estimator", "experiment", "runs"] {
        assert!(!reached.contains(forbidden), "the oracle reaches {forbidden}");
    }
    // The envelope smooths with nalgebra; the oracle itself must not solve with it.
    let oracle = packages().into_iter().find(|package| name(package) == "oracle").unwrap();
    let direct: Vec<&str> = oracle["dependencies"].as_array().unwrap().iter().map(name).collect();
    assert!(!direct.contains(&"nalgebra"), "{direct:?}");
}

#[test]
fn only_runs_and_the_trainer_reach_the_disk_for_writing() {
    for package in packages() {
        if ["runs", "trainer"].contains(&name(&package)) {
            continue;
        }
        // Only dependencies of the crate itself count, not those of its tests.
        let own = package["dependencies"].as_array().unwrap().iter().filter(|other| other["kind"].is_null());
        let direct: Vec<&str> = own.map(name).collect();
        assert!(!direct.contains(&"tempfile"), "{}", name(&package));
    }
}

#[test]
fn every_crate_takes_the_workspaces_lints() {
    let lints = |file: &str, place: &str| -> toml::Value {
        let manifest: toml::Value =
            std::fs::read_to_string(file).unwrap().parse::<toml::Table>().unwrap().into();
        place.split('.').fold(manifest, |table, key| table[key].clone())
    };
    let mut own = lints(root().join("Cargo.toml").to_str().unwrap(), "workspace.lints");
    // A module for a browser exports its functions under their own names: `boundary.rs` has attributes that count as
    // unsafe, and no unsafe block.
    own["rust"]["unsafe_code"] = "deny".into();
    for package in packages() {
        let manifest = package["manifest_path"].as_str().unwrap();
        let taken = lints(manifest, "lints");
        let is_taken = taken.get("workspace").is_some_and(|taken| taken.as_bool() == Some(true));
        assert!(is_taken || name(&package) == "web" && taken == own, "{}", name(&package));
    }
    let boundary = std::fs::read_to_string(root().join("crates/web/src/boundary.rs")).unwrap();
    assert!(!boundary.contains("unsafe {") && !boundary.contains("unsafe fn"));
}
