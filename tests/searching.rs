//! Tests of `trainer sweep --search`: selected points instead of all combinations, the best one named, and
//! the same bits for any way of running it.

use crate::support::trainer;
use crate::sweep::{code, json, results, said, scratch, start, states, sweep, wait_for};
use serde_json::Value;
use std::path::Path;

/// Creates a study of one learner on six short simulated records, below a scratch folder.
fn study(folder: &Path, learner: &str, section: &str) -> String {
    let system = crate::support::root().join("configs/learn/systems/friction-gravity.toml");
    let system = std::fs::read_to_string(system).unwrap();
    let system = system.replace("records = 20", "records = 6").replace("seconds = 10.0", "seconds = 6.0");
    std::fs::write(folder.join("system.toml"), system).unwrap();
    let text = format!(
        "task = \"learn\"\nname = \"small\"\n[learn]\nlearners = [\"{learner}\"]\nbaselines = []\n[{learner}]\n{section}\n\
         [problem.friction-gravity]\nsimulation = \"system.toml\"\ntest_records = 2\nvalidation_records = 1\n"
    );
    let path = folder.join("study.toml");
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Quick fit, with its search range in the file.
const SINDY: &str = "refit = false\nmembers = 0\nthreshold = { from = 1e-3, to = 0.5, scale = \"log\" }";

fn search_of(out: &str) -> Value {
    json(&Path::new(out).join("result.json"))["search"].clone()
}

/// Returns the validation errors of the runs relative to the noise, in the order of their numbers.
fn errors(out: &str) -> Vec<f64> {
    let lines = json(&Path::new(out).join("sweep.json"))["runs"].as_array().unwrap().clone();
    let of = |line: &Value| {
        let result = json(&Path::new(out).join(line["run"].as_str().unwrap()).join("result.json"));
        let rows = result["results"].as_array().unwrap().clone();
        let row = rows.into_iter().find(|row| row["kind"] == "learner").unwrap();
        row["validation"]["over_noise"].as_f64().unwrap_or(f64::INFINITY)
    };
    lines.iter().map(of).collect()
}

#[test]
fn a_random_search_names_the_best_and_writes_its_configuration() {
    let (folder, out) = scratch();
    let config = study(folder.path(), "sindy", SINDY);
    let asked = ["sweep", &config, "--search", "random", "--trials", "6"];
    let output = sweep(&asked, &out, &["--threads", "2"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let errors = errors(&out);
    let found = search_of(&out);
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(found["best"]["value"].as_f64(), Some(least), "{errors:?}");
    assert_eq!((&found["measured"], &found["warning"]), (&6.into(), &Value::Null));
    assert!(errors.iter().any(|error| *error > least), "{errors:?}");
    let shown = String::from_utf8(output.stdout).unwrap();
    let number = found["best"]["number"].as_u64().unwrap();
    assert!(shown.contains(&format!("trial {number:04}")) && shown.contains("best.toml"), "{shown}");
    let page = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(page.contains("Searched") && page.contains("best.toml"));

    // Two shares give the same points and results, and the best configuration runs with the same result.
    let (_two, two) = scratch();
    for share in ["1/2", "2/2"] {
        assert_eq!(code(&sweep(&asked, &two, &["--shard", share, "--quiet"])), 0);
    }
    assert_eq!(results(&out), results(&two));
    let again = folder.path().join("again");
    let best = format!("{out}/best.toml");
    let run = trainer(&[&best, "--json", "--out", again.to_str().unwrap()]);
    assert_eq!(code(&run), 0, "{}", said(&run));
    let result: Value = serde_json::from_slice(&run.stdout).unwrap();
    let row = result["results"].as_array().unwrap().iter().find(|row| row["kind"] == "learner").unwrap();
    assert_eq!(row["validation"]["over_noise"].as_f64(), Some(least));
}

/// Proposals depend on the seed and the results only: not on the threads, and not on an interruption.
#[cfg(unix)]
#[test]
fn a_search_that_was_killed_proposes_what_it_would_have() {
    let (folder, one) = scratch();
    let config = study(folder.path(), "sindy", SINDY);
    let asked = ["sweep", &config, "--search", "tpe", "--trials", "15", "--batch", "2"];
    let output = sweep(&asked, &one, &["--threads", "2"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert_eq!(states(&one), ["done"; 15]);
    let (_two, two) = scratch();
    let mut child = start(&asked, &two, &["--threads", "1"]);
    wait_for(&mut child, &two, 11);
    child.kill().unwrap();
    child.wait().unwrap();
    // The search is resumed from the folder alone.
    let output = sweep(&["sweep"], &two, &["--resume", "--threads", "1", "--quiet"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert_eq!(results(&one), results(&two));
    assert_eq!(search_of(&one)["best"], search_of(&two)["best"]);
    // Another number of trials is another search.
    let other = sweep(&["sweep", &config, "--search", "tpe", "--trials", "16"], &one, &["--resume"]);
    assert!(code(&other) == 2 && said(&other).contains("15 trials in batches of 2"), "{}", said(&other));
}

/// The trial that passed all rungs was stopped twice and resumed to the same bits.
#[test]
fn halving_stops_the_worse_and_the_best_is_what_it_would_have_been() {
    let (folder, out) = scratch();
    let section = "units = 4\nepochs = 6\nwindows = 32\nsamples_per_period = 16";
    let config = study(folder.path(), "lstm", section);
    let asked = [
        "sweep",
        &config,
        "--search",
        "random",
        "--trials",
        "4",
        "--halving",
        "1",
        "--keep-one-in",
        "2",
        "lstm.learning_rate={from=1e-4,to=3e-2,scale=\"log\"}",
    ];
    let output = sweep(&asked, &out, &["--threads", "2"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let mut ended = states(&out);
    ended.sort();
    assert_eq!(ended, ["done", "stopped", "stopped", "stopped"], "{}", said(&output));
    let rungs = json(&Path::new(&out).join("sweep.json"))["search"]["halving"]["rungs"].clone();
    let sizes: Vec<usize> =
        rungs.as_array().unwrap().iter().map(|rung| rung["values"].as_array().unwrap().len()).collect();
    assert_eq!(sizes, [4, 2, 1]);
    assert_eq!(
        (&rungs[0]["steps"], &rungs[1]["steps"], &rungs[2]["steps"]),
        (&1.into(), &2.into(), &Value::Null)
    );
    // Each rung keeps the better half of the previous one.
    let values = |rung: &Value| -> Vec<(u64, f64)> {
        let of = |own: &Value| (own["number"].as_u64().unwrap(), own["value"].as_f64().unwrap());
        rung["values"].as_array().unwrap().iter().map(of).collect()
    };
    let (first, second) = (values(&rungs[0]), values(&rungs[1]));
    let worst_kept = first.iter().filter(|(number, _)| second.iter().any(|own| own.0 == *number));
    let worst_kept = worst_kept.map(|own| own.1).fold(0.0, f64::max);
    let left = first.iter().filter(|(number, _)| second.iter().all(|own| own.0 != *number));
    assert!(left.map(|own| own.1).fold(f64::INFINITY, f64::min) >= worst_kept, "{first:?} {second:?}");
    // The best trial gives the same bits without interruption.
    let alone = folder.path().join("alone");
    let run = trainer(&[&format!("{out}/best.toml"), "--quiet", "--out", alone.to_str().unwrap()]);
    assert_eq!(code(&run), 0, "{}", said(&run));
    let best = Path::new(&out).join(search_of(&out)["best"]["run"].as_str().unwrap());
    let model = "model/friction-gravity/lstm.safetensors";
    assert_eq!(std::fs::read(alone.join(model)).unwrap(), std::fs::read(best.join(model)).unwrap());
    // Resuming finds nothing to do.
    let again = sweep(&asked, &out, &["--resume", "--quiet"]);
    assert_eq!((code(&again), states(&out).len()), (0, 4), "{}", said(&again));
}

#[test]
fn an_estimator_is_searched_too_and_what_fails_counts_as_the_worst() {
    let (folder, out) = scratch();
    let bad = folder.path().join("bad.csv");
    std::fs::write(&bad, "time_s,angle_rad\n0,1\n0.1,x\n").unwrap();
    let paths = format!("data.path={},experiments/default-record/record.csv", bad.display());
    let asked = ["sweep", "configs/lstm.toml", &paths, "seed=0..50", "--search", "random", "--trials", "5"];
    let output = sweep(&asked, &out, &["--maximize", "steps"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let found = search_of(&out);
    assert!(found["failed"].as_u64().unwrap() > 0 && found["measured"].as_u64().unwrap() > 0, "{found}");
    let table = json(&Path::new(&out).join("result.json"));
    let rows = table["rows"].as_array().unwrap().iter();
    let steps = rows.filter_map(|row| row["steps"].as_f64()).fold(0.0, f64::max);
    assert_eq!(found["best"]["value"].as_f64(), Some(steps));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("failed and count as the worst"), "{shown}");
}

#[test]
fn what_a_search_cannot_do_is_said_with_the_remedy() {
    let (folder, _) = scratch();
    let config = study(folder.path(), "sindy", "refit = false\nmembers = 0");
    let range = "sindy.threshold={from=1e-3,to=0.5,scale=\"log\"}";
    for (words, says) in [
        (vec!["--search", "random"], "draws from ranges and choices"),
        (
            vec!["--search", "tpe", range, "--shard", "1/2"],
            "--search tpe chooses by the results of all trials",
        ),
        (vec!["--search", "tpe", range, "--halving", "3"], "take --search random"),
        (
            vec!["--search", "random", range, "--halving", "3", "--minimize", "test.over_noise"],
            "take --minimize validation.over_noise",
        ),
        (vec!["--search", "random", "sindy.threshold={from=0.5}"], "from below to"),
        (vec!["--search", "random", range, "sindy.members=0..1", "seed=0,x"], "combination"),
        (vec!["--search", "random", "seed=1..3", "--trials", "4"], "only about 3 different points"),
        (vec!["--trials", "4"], "--search"),
    ] {
        let (_place, out) = scratch();
        let output = sweep(&["sweep", &config], &out, &words);
        assert!(code(&output) == 2 && said(&output).contains(says), "{words:?}: {}", said(&output));
    }
    let (_place, out) = scratch();
    let asked =
        ["--search", "random", range, "--trials", "2", "--threads", "1", "--minimize", "test.rmse_free_run"];
    let output = sweep(&["sweep", &config], &out, &asked);
    assert_eq!(code(&output), 2);
    assert!(said(&output).contains("result.json has no number at test.rmse_free_run"), "{}", said(&output));
    assert!(said(&output).contains("test.free_run_rmse"), "{}", said(&output));
    let (_place, out) = scratch();
    let asked = ["--search", "random", range, "--trials", "2", "--minimize", "test.free_run_rmse"];
    let output = sweep(&["sweep", &config], &out, &asked);
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(code(&output) == 0 && shown.contains("The best trial was chosen on the test part"), "{shown}");
}
