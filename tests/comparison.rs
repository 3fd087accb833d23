//! Tests of `task = "compare"`: the paper's methods side by side.

use crate::support::{measured, number, result, trainer};
use serde_json::Value;

fn rows(result: &Value) -> &Vec<Value> {
    result["results"].as_array().unwrap()
}

fn estimate<'a>(result: &'a Value, id: &str) -> &'a Value {
    let row = rows(result).iter().find(|row| row["id"] == id).unwrap_or_else(|| panic!("no {id}"));
    row.pointer("/outcome/estimate").unwrap_or_else(|| panic!("{row}"))
}

#[test]
fn every_method_agrees_on_the_shipped_record() {
    let (code, result, folder) = result(&["configs/compare.toml"]);
    assert_eq!(code, 0, "{result}");
    assert_eq!(result["task"], "compare");
    assert_eq!(result["data"]["origin"], "simulated");
    let numbers: Vec<u64> = rows(&result).iter().map(|row| row["number"].as_u64().unwrap()).collect();
    assert!(numbers.is_sorted(), "{numbers:?}");
    for file in ["report.html", "tables.md", "table.tex", "config.toml", "envelope.csv", "environment.json"] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.to_lowercase().contains("simulated record"));
    // Every comparison has the library's result, which agrees with the reference.
    let library = &result["libraries"][0];
    assert_eq!((&library["id"], &library["family"]), (&"linfa-linear".into(), &"library".into()));
    assert!(number(library, "/outcome/estimate/digits_of_agreement") > 12.0, "{library}");
    assert!(page.contains("linfa and linfa-linear"));
    let again = trainer(&["report", folder.path().to_str().unwrap()]);
    assert_eq!(again.status.code(), Some(0));
    assert_eq!(std::fs::read_to_string(folder.path().join("report.html")).unwrap(), page);
}

/// Of 150 s, plain gradient descent learns little in its 10,000 steps: that says nothing about the record.
#[test]
fn a_weak_baseline_does_not_fail_a_record_of_ones_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("long.csv");
    let sample = |k: u32| {
        let time = f64::from(k) * 0.02;
        format!("{time:.2},{:.9}\n", 0.5 * (-0.02 * time).exp() * (5.65 * time).cos())
    };
    std::fs::write(&file, "t,theta\n".to_owned() + &(0..7_500).map(sample).collect::<String>()).unwrap();
    let path = format!("data.path={}", file.display());
    let compare = |more: &str| {
        let methods = "compare.methods=gradient-descent,ols";
        result(&["configs/compare.toml", &path, "data.value=theta", "data.unit=rad", methods, more])
    };
    let (code, found, folder) = compare("seed=0");
    assert_eq!(
        (code, &found["pass"], &found["results"][1]["excused"]),
        (0, &true.into(), &true.into()),
        "{found}"
    );
    assert!(number(&found, "/results/1/outcome/estimate/error_percent") > 1.0, "{found}");
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("does not count") && page.contains("data.origin"));
    // A miss counts if the configuration took the steps away.
    assert_eq!(compare("fit.max_steps=100").0, 1);
}

#[test]
fn the_papers_tables_come_out_on_its_record() {
    if measured("horizontal-pendulum/80P.txt").is_none() {
        return;
    }
    let (code, result, _) = result(&["configs/paper.toml", "fit.seeds=2"]);
    assert_eq!(code, 0, "{result}");
    // Table 3 and section 5, to the printed digits.
    let printed = |path: &str, expected: &str, digits: usize| {
        assert_eq!(format!("{:.*}", digits, number(&result, path)), expected, "{path}");
    };
    printed("/derived/period_s", "0.288", 3);
    printed("/derived/frequency_hz", "3.47", 2);
    printed("/envelope/omega_rad_s", "21.82", 2);
    printed("/oracle/decay_rate", "0.191", 3);
    printed("/oracle/zeta", "0.00875", 5);
    printed("/derived/stiffness_n_m_per_rad", "0.238", 3);
    printed("/derived/damping_n_m_s_per_rad", "0.000191", 6);
    printed("/derived/critical_damping_n_m_s_per_rad", "0.0218", 4);
    printed("/derived/quality_factor", "57", 0);
    printed("/derived/half_life_s", "3.6", 1);
    printed("/derived/time_constant_s", "5.2", 1);
    // Tables 4 and 5: every ζ is 0.00875301, and the errors are at least ten times smaller than the paper's
    // largest, 0.046 %.
    for row in rows(&result) {
        let found = row.pointer("/outcome/estimate").unwrap_or_else(|| panic!("{row}"));
        assert_eq!(format!("{:.8}", number(found, "/zeta")), "0.00875301", "{row}");
        assert!(number(found, "/worst_error_percent") < 0.0046, "{row}");
    }
    let cautions = result["cautions"].to_string();
    for words in ["Q/π = 18.2 cycles", "69 cycles", "7625 samples", "confirms viscous damping"] {
        assert!(cautions.contains(words), "no `{words}` in {cautions}");
    }
}

#[test]
fn methods_can_be_chosen_by_name() {
    let (code, result, _) =
        result(&["configs/compare.toml", "compare.methods=pinn,qr,baseline", "fit.seeds=2"]);
    let ids: Vec<&str> = rows(&result).iter().map(|row| row["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["qr", "pinn", "baseline"]);
    assert_eq!(number(estimate(&result, "qr"), "/seeds"), 1.0, "it draws nothing");
    assert_eq!(number(estimate(&result, "pinn"), "/seeds"), 2.0);
    // The null estimator is out of tolerance, and the exit code reports it.
    assert_eq!(code, 1);
    assert_eq!(estimate(&result, "baseline")["pass"], false);
}

/// λ does not depend on the network: the line beside it has the slope (PINN), or the weights hold the answer
/// for any input (LSTM).
#[test]
fn a_table_says_what_networks_contributed() {
    let (code, result, _) = result(&["configs/compare.toml", "compare.methods=pinn,lstm,qr"]);
    assert_eq!(code, 0, "{result}");
    let without = |id: &str, ablation: &str| {
        let found = &estimate(&result, id)["ablations"];
        let row = found.as_array().unwrap().iter().find(|row| row["ablation"] == ablation);
        number(row.unwrap_or_else(|| panic!("{found}")), "/error_percent")
    };
    assert!(without("pinn", "learned_part_at_zero") < 1e-3 && without("pinn", "noise_for_input") > 1.0);
    assert!(without("lstm", "learned_part_at_zero") > 1.0 && without("lstm", "noise_for_input") < 1e-3);
    assert_eq!(estimate(&result, "qr").get("ablations"), None);
    assert!(rows(&result).iter().all(|row| row["estimand"] == "least_squares"), "{result}");
}

#[test]
fn an_unknown_method_is_refused_with_the_nearest_name() {
    let output = trainer(&["configs/compare.toml", "compare.methods=pin"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("unknown method \"pin\"; did you mean `pinn`?"), "{message}");
    let output = trainer(&["configs/compare.toml", "estimator.name=pinn"]);
    assert_eq!(output.status.code(), Some(2));
}

/// `compare.methods=gru` said "unknown method" of a learner that `trainer new` had written.
#[test]
fn a_learner_among_methods_is_refused_with_the_command_that_runs_it() {
    let runs_it = "`trainer configs/learn.toml learn.learners=state-space`";
    for arguments in [
        &["configs/compare.toml", "compare.methods=state-space"][..],
        &["configs/pinn.toml", "estimator=state-space"],
        &["sweep", "configs/pinn.toml", "estimator=pinn,state-space"],
    ] {
        let output = trainer(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(
            message.contains("`state-space` is a learner of dynamics") && message.contains(runs_it),
            "{message}"
        );
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads| {
        let (_, mut result, _) = result(&["configs/compare.toml", "fit.seeds=2", "--threads", threads]);
        result["seconds"] = Value::Null;
        result["libraries"][0]["outcome"]["estimate"]["seconds"] = Value::Null;
        for row in result["results"].as_array_mut().unwrap() {
            if let Some(found) = row.pointer_mut("/outcome/estimate") {
                found["seconds"] = Value::Null;
            }
        }
        result
    };
    assert_eq!(run("1"), run("2"));
}

/// A noiseless exponential has residuals too, from the placement of peaks. They are correlated, and their
/// size says nothing about the decay.
#[test]
fn of_an_exponential_without_noise_no_pattern_is_reported() {
    let scratch = tempfile::tempdir().unwrap();
    let record = scratch.path().join("exponential.csv");
    let rows = (0..5200).map(|index| {
        let time = f64::from(index) / 260.0;
        format!("{time:.6},{:.12}\n", 0.6 * (-0.21 * time).exp() * (21.0 * time).cos())
    });
    std::fs::write(&record, format!("time_s,angle_rad\n{}", rows.collect::<String>())).unwrap();
    let path = format!("data.path={}", record.display());
    for (config, pipeline) in [("configs/ols.toml", "paper"), ("configs/compare.toml", "recommended")] {
        let out = scratch.path().join(pipeline);
        let pipeline = format!("envelope.pipeline={pipeline}");
        let output = trainer(&[config, &path, &pipeline, "data.clock=host", "--out", out.to_str().unwrap()]);
        let page = std::fs::read_to_string(out.join("report.html")).unwrap();
        for text in [String::from_utf8_lossy(&output.stdout).into_owned(), page] {
            for phrase in ["are correlated", "not exponential", "not independent"] {
                assert!(!text.contains(phrase), "{config} {pipeline}: {phrase}");
            }
        }
    }
}
