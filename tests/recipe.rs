//! The recipes of CONTRIBUTING.md for a new estimator, a new learner and a new effect, followed to the letter in a copy of the
//! workspace: commands, files and lines are read from it.

use crate::documents::files;
use crate::support::{root, trainer};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

fn edit(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{} has no `{from}`", path.display());
    fs::write(path, text.replacen(from, to, 1)).unwrap();
}

/// The numbered steps below a heading of CONTRIBUTING.md, each as the words that it sets as code, `NAME` replaced.
fn steps(heading: &str, name: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join("CONTRIBUTING.md")).unwrap();
    let section = text.split(&format!("\n## {heading}\n")).nth(1).unwrap().split("\n## ").next().unwrap();
    let list = section.split("\n1. ").nth(1).unwrap().split("\n\n").next().unwrap();
    let starts = |line: &str| line.split_once(". ").is_some_and(|(number, _)| number.parse::<u8>().is_ok());
    let mut steps = vec![String::new()];
    for line in list.lines() {
        if starts(line) {
            steps.push(String::new());
        }
        steps.last_mut().unwrap().push_str(&format!("{line}\n"));
    }
    let code =
        |step: &String| step.split('`').skip(1).step_by(2).map(|word| word.replace("NAME", name)).collect();
    steps.iter().map(code).collect()
}

/// Additions to the crates of a copy: new files, and files with more lines together with their number.
fn added(home: &Path) -> (Vec<String>, Vec<(String, usize)>) {
    let (mut new, mut longer) = (Vec::new(), Vec::new());
    let mut folders = vec![home.join("crates")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(home).unwrap().to_str().unwrap().to_owned();
            let own = || fs::read_to_string(&path).unwrap();
            match fs::read(root().join(&name)) {
                _ if path.is_dir() => folders.push(path),
                Err(_) => new.push(name),
                Ok(before) if before == fs::read(&path).unwrap() => {}
                Ok(before) => {
                    let before = String::from_utf8(before).unwrap();
                    longer.push((name, own().lines().count() - before.lines().count()));
                }
            }
        }
    }
    new.sort();
    longer.sort();
    (new, longer)
}

/// A copy of the workspace.
fn workspace() -> TempDir {
    let scratch = tempfile::tempdir().unwrap();
    let home = scratch.path();
    for name in ["Cargo.toml", "Cargo.lock"] {
        fs::copy(root().join(name), home.join(name)).unwrap();
    }
    // Libraries of another version lie beside the workspace's own in the target folder and never in their place: doc tests,
    // which cargo runs last, would look for these.
    edit(&home.join("Cargo.toml"), "version = \"0.1.0\"", "version = \"0.1.0-recipe\"");
    compile_fast(home);
    // The trainer's tests lie outside the copied folder; examples and gallery outside of the crate that
    // declares them; the crate for Python outside of the crates.
    for folder in ["examples", "book/gallery", "python"] {
        copy(&root().join(folder), &home.join(folder));
    }
    copy(&root().join("crates"), &home.join("crates"));
    copy(&root().join("tests"), &home.join("tests"));
    scratch
}

/// Has a copy's own crates compiled fast rather than run fast, since what they do there takes seconds; libraries stay as they are.
fn compile_fast(home: &Path) {
    let path = home.join("Cargo.toml");
    let mut manifest = fs::read_to_string(&path).unwrap();
    for (run_fast, compiled_fast) in [("3, codegen-units = 1", "1"), ("2", "0")] {
        let [run_fast, compiled_fast] = [run_fast, compiled_fast].map(|level| format!("opt-level = {level}"));
        assert!(manifest.contains(&run_fast), "{run_fast}");
        manifest = manifest.replace(&run_fast, &compiled_fast);
    }
    let table = "[profile.dev.package]\n";
    for crate_manifest in files("crates", "toml").iter().filter(|path| path.ends_with("Cargo.toml")) {
        let text = fs::read_to_string(crate_manifest).unwrap();
        let name = text.lines().find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"')).unwrap();
        let is_set = manifest
            .lines()
            .any(|line| line.starts_with(&format!("{name}.")) || line.starts_with(&format!("{name} =")));
        if !is_set {
            manifest = manifest.replace(table, &format!("{table}{name}.opt-level = 0\n"));
        }
    }
    fs::write(path, manifest).unwrap();
}

/// Runs cargo in a copy, in the workspace's own target folder.
fn cargo_in(home: &Path, arguments: &[&str]) -> Output {
    let (command, rest) = arguments.split_first().unwrap();
    Command::new(env!("CARGO"))
        .args([command, "--offline"])
        .args(rest)
        .env("CARGO_TARGET_DIR", root().join("target"))
        .current_dir(home)
        .output()
        .unwrap()
}

/// Runs one test target in a copy, for the whole workspace: cargo joins the features of all that it is asked to build, so
/// that only then the libraries built already serve.
fn test_in(home: &Path, target: &str, filter: &str) -> Output {
    cargo_in(home, &["test", "--workspace", "--test", target, "--", filter])
}

/// Checks that a run of tests passes, and that it says certain words.
fn passes(output: &Output, words: &[&str]) {
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(words.iter().all(|words| text.contains(words)), "{text}");
}

/// Returns a file of the effect that the recipe adds, from its law to its tests.
fn of_sine_drag(name: &str) -> PathBuf {
    root().join("tests/recipe").join(name)
}

/// Runs the command of a recipe in a copy of the workspace, with a name for NAME and words replaced; returns what it says.
fn follow(heading: &str, name: &str, home: &Path, replaced: &[(&str, &str)]) -> String {
    let text = fs::read_to_string(root().join("CONTRIBUTING.md")).unwrap();
    let section = text.split(&format!("\n## {heading}\n")).nth(1).unwrap();
    let command = section.lines().find_map(|line| line.strip_prefix("    cargo run -p trainer -- ")).unwrap();
    let command = command.replace("NAME", name);
    let command = replaced.iter().fold(command, |command, (from, to)| command.replace(from, to));
    let mut arguments: Vec<&str> = command.split(' ').collect();
    arguments.extend(["--workspace", home.to_str().unwrap()]);
    let written = trainer(&arguments);
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    String::from_utf8(written.stdout).unwrap()
}

/// Both recipes in one copy, which is compiled once.
#[test]
fn a_new_estimator_takes_four_files_and_a_new_effect_eight_places() {
    let scratch = workspace();
    let home = scratch.path();
    let method = add_an_estimator(home);
    add_an_effect(home);
    the_estimator_passes_the_battery(home, &method);
    the_effect_is_diagnosed_and_hidden(home);
}

/// The recipe's command writes the files and lines that the recipe names. Returns the file of the method.
fn add_an_estimator(home: &Path) -> PathBuf {
    let written = follow("Adding an estimator", "short-descent", home, &[]);
    assert!(written.starts_with("short-descent: estimator, which reads the damping"), "{written}");

    let steps = steps("Adding an estimator", "short-descent");
    let [manifest, method, dependency, entry] = &steps[..] else { panic!("{steps:?}") };
    let (new, longer) = added(home);
    assert_eq!(new, [manifest[0].as_str(), method[0].as_str()]);
    assert_eq!(longer, [(dependency[0].clone(), 1), (entry[0].clone(), 1)]);
    let has = |file: &str, words: &str| fs::read_to_string(home.join(file)).unwrap().contains(words);
    assert!(has(&manifest[0], &format!("name = \"{}\"", manifest[1])));
    assert!(has(&dependency[0], &dependency[1]) && has(&entry[0], &entry[1].replace('-', "_")));
    home.join(&method[0])
}

/// The skeleton passes the whole battery, which sees when its descent is cut short.
fn the_estimator_passes_the_battery(home: &Path, method: &Path) {
    let agrees = "short-descent::it_agrees_with_least_squares";
    passes(&test_in(home, "battery", "short-descent::"), &[agrees, " 0 failed"]);
    edit(method, "const STEPS: u64 = 2000;", "const STEPS: u64 = 3;");
    let rough = test_in(home, "battery", agrees);
    assert!(!rough.status.success(), "{}", String::from_utf8_lossy(&rough.stdout));
}

/// A damping of one's own, from its law to the lines of the registries.
fn add_an_effect(home: &Path) {
    let before = added(home);
    let steps = steps("Adding an effect", "sine_drag");
    let places: Vec<_> = steps.iter().map(|step| home.join(&step[0])).collect();
    let [law, laws, registry, candidate, candidates, trial, trials, literature] = &places[..] else {
        panic!("{steps:?}")
    };
    // A line for the new effect below one that there is.
    let below = |path: &Path, line: &str, new: &str| edit(path, line, &format!("{line}\n{new}"));
    fs::copy(of_sine_drag("law.rs"), law).unwrap();
    below(laws, "mod quadratic_drag;", "mod sine_drag;");
    below(laws, "pub use quadratic_drag::QuadraticDrag;", "pub use sine_drag::SineDrag;");
    below(registry, "    QuadraticDrag,", "    SineDrag,");

    fs::copy(of_sine_drag("candidate.rs"), candidate).unwrap();
    below(candidates, "pub(crate) mod quadratic_drag;", "pub(crate) mod sine_drag;");
    below(
        candidates,
        "    Candidate::new(&quadratic_drag::QuadraticDrag),",
        "    Candidate::new(&sine_drag::SineDrag),",
    );

    fs::copy(of_sine_drag("trial.rs"), trial).unwrap();
    below(trials, "mod quadratic_drag;", "mod sine_drag;");
    below(trials, "    quadratic_drag::EFFECT,", "    sine_drag::EFFECT,");
    // Other effects cite the work already.
    assert!(fs::read_to_string(literature).unwrap().contains("{nayfeh1979,"));

    let (mut new, mut longer) = added(home);
    new.retain(|name| !before.0.contains(name));
    longer.retain(|own| !before.1.contains(own));
    assert_eq!(new, [3, 0, 5].map(|step: usize| steps[step][0].as_str()));
    let lines: Vec<usize> = longer.iter().map(|(_, lines)| *lines).collect();
    assert_eq!((longer.len(), lines), (4, vec![2, 2, 1, 2]), "{longer:?}");
}

/// Tests of a new effect, from its law to the answer of a diagnosis and to trials that hide it. The gallery, whose command the
/// recipe names, is left out: it would compile the whole workspace.
fn the_effect_is_diagnosed_and_hidden(home: &Path) {
    for (owner, test) in [("diagnosis", "diagnosed"), ("trials", "hidden")] {
        let tests = home.join("crates").join(owner).join("tests");
        fs::create_dir(&tests).unwrap();
        let own = tests.join(format!("sine_drag_{test}.rs"));
        fs::copy(of_sine_drag(&format!("{test}.rs")), own).unwrap();
        passes(&test_in(home, &format!("sine_drag_{test}"), ""), &["1 passed"]);
    }
    passes(&cargo_in(home, &["test", "-p", "dynamics", "--lib", "sine_drag"]), &["1 passed"]);
    passes(&test_in(home, "other_simulators", ""), &[" 0 failed"]);
}

/// The recipe's own command writes the files that the recipe names, and nothing else, for each kind that it names.
#[test]
fn a_new_learner_takes_the_files_that_the_recipe_names() {
    let text = fs::read_to_string(root().join("CONTRIBUTING.md")).unwrap();
    let section = text.split("\n## Adding a learner\n").nth(1).unwrap().split("\n## ").next().unwrap();
    let words: Vec<String> =
        section.split('`').skip(1).step_by(2).map(|word| word.replace("NAME", "own_learner")).collect();
    let (source, registry, config) = (&words[0], format!("crates/learn/src/{}", words[1]), &words[2]);
    for kind in ["sequence", "field", "regressor"] {
        assert!(section.contains(kind), "the recipe does not name {kind}");
        let scratch = workspace();
        let home = scratch.path();
        copy(&root().join("configs"), &home.join("configs"));
        follow("Adding a learner", "own-learner", home, &[("sequence", kind)]);
        assert_eq!(added(home), (vec![source.clone()], vec![(registry.clone(), 2)]));
        let config = fs::read_to_string(home.join(config.replace('_', "-"))).unwrap();
        assert!(config.contains("learners = [\"own-learner\"]"), "{config}");
    }
}

/// Learners of one's own, one of each kind, written by `trainer new`: they compile, train, come back from their files and
/// give the same bits twice. Building a copy takes minutes; run it with
/// `cargo test -p trainer --test acceptance recipe::a_new_learner -- --ignored`.
#[test]
#[ignore = "builds a copy of the workspace; the command stands in the comment above"]
fn a_new_learner_takes_one_command_and_trains() {
    let scratch = workspace();
    let home = scratch.path();
    copy(&root().join("configs"), &home.join("configs"));
    let place = home.to_str().unwrap();
    for (name, kind) in [("one-layer", "sequence"), ("power-torque", "field"), ("plain-law", "regressor")] {
        let written = trainer(&["new", "learner", name, "--kind", kind, "--workspace", place]);
        assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
        let again = trainer(&["new", "learner", name, "--kind", kind, "--workspace", place]);
        assert_eq!(again.status.code(), Some(2));
    }
    let run = |arguments: &[&str]| {
        let output = cargo_in(home, arguments);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
        text
    };
    let text = run(&["test", "-p", "learn", "--lib", "--", "learners::tests::a_model_predicts"]);
    assert!(text.contains("a_model_predicts_the_same_from_its_file ... ok"), "{text}");
    let listed = run(&["run", "-p", "trainer", "--", "list", "learners"]);
    assert!(["one-layer", "power-torque", "plain-law"].iter().all(|name| listed.contains(name)), "{listed}");
    let config = "configs/learn/one-layer.toml";
    let trained = run(&["run", "-p", "trainer", "--", config, "one-layer.epochs=2", "--json"]);
    let trained: serde_json::Value = serde_json::from_str(&trained).unwrap();
    let rows = trained["results"].as_array().unwrap();
    let error = |id: &str| {
        let row = rows.iter().find(|row| row["id"] == id).unwrap();
        row["test"]["free_run_rmse"].as_f64().unwrap()
    };
    assert!(error("one-layer") < error("arx"), "{trained}");
}

#[test]
fn a_name_that_cannot_be_one_and_a_place_that_is_no_checkout_are_refused() {
    let nowhere = tempfile::tempdir().unwrap();
    let place = nowhere.path().to_str().unwrap();
    for (name, words) in [
        ("Two Words", "is not an identifier"),
        ("loop", "is not an identifier"),
        ("fine", "is not in a checkout of Ringdown"),
    ] {
        let output = trainer(&["new", "learner", name, "--kind", "field", "--workspace", place]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(words), "{name}: {message}");
    }
    let home = root();
    let taken = |words: &[&str]| {
        let output = trainer(&[&["new"], words, &["--workspace", home.to_str().unwrap()]].concat());
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(taken(&["learner", "lstm", "--kind", "sequence"]).contains("there is a learner `lstm` already"));
    assert!(taken(&["estimator", "lstm"]).contains("there is an estimator `lstm` already"));
    assert!(taken(&["estimator", "ols"]).contains("there is an estimator `ols` already"));
}

/// The form of the command before learners had one of their own; it says that it makes a learner.
#[test]
fn a_new_estimator_of_a_kind_is_a_learner() {
    let scratch = workspace();
    let home = scratch.path();
    let place = home.to_str().unwrap();
    let written = trainer(&["new", "estimator", "own", "--kind", "field", "--workspace", place]);
    let said = String::from_utf8(written.stdout).unwrap();
    assert!(said.starts_with("own: learner, which learns dynamics"), "{said}");
    assert!(
        home.join("crates/learn/src/learners/own.rs").exists()
            && home.join("configs/learn/own.toml").exists()
    );
    assert!(!home.join("crates/estimators/own").exists());
}
