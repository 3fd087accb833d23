//! Tests of the claims in the documents.

use crate::support::{Shipped, measured, result, root, trainer};
use std::path::{Path, PathBuf};

/// Returns the files with an ending below a folder of the workspace, sorted by path.
pub(crate) fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn source_files_stay_readable_in_length() {
    for path in files("crates", "rs").into_iter().chain(files("tests", "rs")) {
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= 520, "{} has {lines} lines", path.display());
    }
}

/// Doc comments begin with a noun or a verb, so that their first word tells what the item is or does.
#[test]
fn doc_comments_begin_with_what_the_item_is() {
    const BEGINNINGS: [&str; 9] =
        ["What", "Whether", "How", "Where", "Which", "Who", "When", "That which", "Of which"];
    fn docs(line: &str) -> Option<&str> {
        let words = line.trim_start();
        words.strip_prefix("/// ").or_else(|| words.strip_prefix("//! "))
    }
    let mut seen = 0;
    let mut found = Vec::new();
    for path in files("crates", "rs").into_iter().chain(files("tests", "rs")).chain(files("examples", "rs")) {
        let text = std::fs::read_to_string(&path).unwrap();
        let mut is_first = true;
        for (place, line) in text.lines().enumerate() {
            let Some(words) = docs(line) else {
                is_first = true;
                continue;
            };
            seen += usize::from(is_first);
            let is_indirect =
                |beginning: &&str| words.split(' ').zip(beginning.split(' ')).all(|(a, b)| a == b);
            if is_first && BEGINNINGS.iter().any(is_indirect) {
                found.push(format!("{}:{}: {words}", path.display(), place + 1));
            }
            is_first = false;
        }
    }
    assert!(seen > 5000, "{seen} doc comments");
    assert!(found.is_empty(), "{} doc comments: {}", found.len(), found.join("\n"));
}

#[test]
fn the_help_shows_the_exit_codes_and_examples() {
    let output = trainer(&["--help"]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    for words in ["configs/pinn.toml", "Exit codes", "130 interrupted"] {
        assert!(text.contains(words), "{text}");
    }
}

/// Overrides that reduce trials from any configuration to a few short cases.
pub(crate) const FEW_TRIALS: &[&str] = &[
    "trials.none=1",
    "trials.calibration=0",
    "trials.single=1",
    "trials.pair=0",
    "trials.left_out=0",
    "trials.foreign=0",
    "trials.releases=0",
    "trials.driven=0",
    "trials.stressed=0",
    "trials.measured_cases=0",
    "trials.engine_cases=0",
    "trials.composite=0",
    "trials.rigs_cases=0",
    "record.seconds=5",
    "record.rate_hz=130",
];

/// Parts of the long records of benchmarks, short but with the first and the last rows that the files name.
const FEW_ROWS: &[&str] = &[
    "problem.silverbox.part.training.to_row=45650",
    "problem.silverbox.part.validation.to_row=95000",
    "problem.silverbox.part.multisine.from_row=125000",
    "problem.silverbox.part.arrow.to_row=5000",
    "problem.silverbox.part.arrow-inside.to_row=4000",
    "problem.bouc-wen.part.training.to_row=5000",
    "problem.bouc-wen.part.validation.from_row=38000",
    "problem.bouc-wen.part.sine-sweep.from_row=150000",
];

/// Returns overrides that reduce the training of a configuration's learners to its begin.
fn little_learning(path: &Path) -> Vec<String> {
    let mut quick = vec!["learn.max_steps=2", "bayesian.warm_up=2", "bayesian.draws=10"];
    quick.extend(["neural-state-space.members=1", "gaussian-process.samples=1000", "pinn.samples=500"]);
    let all = ["learn.toml", "measured.toml", "table.toml"].iter().any(|name| path.ends_with(name));
    // Each learner has its own configuration.
    quick.extend(all.then_some("learn.learners=sindy"));
    // The repaired simulator needs a diagnosis of each system: a test in `learning::` has one.
    quick.extend(all.then_some("learn.baselines=persistence,nominal,recalibrated,arx"));
    // Networks train on the benchmarks' records for minutes; other configurations run them.
    let is_benchmark = path.to_str().unwrap().contains("benchmark");
    quick.extend(is_benchmark.then_some("learn.learners=sindy,grey-box"));
    let own = path.file_stem().unwrap().to_str().unwrap();
    quick.extend(FEW_ROWS.iter().filter(|words| words.starts_with(&format!("problem.{own}."))));
    // The problems of a table are those of other files.
    quick.extend(path.ends_with("table.toml").then_some("learn.problems=drag-cubic"));
    quick.extend(path.ends_with("benchmarks.toml").then_some("learn.problems=cascaded-tanks"));
    quick.into_iter().map(str::to_owned).collect()
}

/// Runs each configuration as a user would, with the study of many problems and the trials cut short. The
/// null estimator's configuration misses its bar by design.
#[test]
fn every_shipped_configuration_runs() {
    for path in files("configs", "toml") {
        if path.ends_with("beyond.toml") {
            // The configuration runs even if a record is absent.
            let problems = "predict.problems=control,quadratic-drag,shipped-record,rig-60";
            let quick = ["predict.draws=1", "predict.draws_seeded=1", "predict.max_steps=10", problems];
            let (code, result, _) = result(&[&[path.to_str().unwrap()], &quick[..]].concat());
            assert_eq!(code, 0, "{}: {result}", path.display());
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        if text.contains("task = \"trials\"") {
            let (code, result, _) = result(&[&[path.to_str().unwrap()], FEW_TRIALS].concat());
            assert_eq!(code, 0, "{}: {result}", path.display());
            assert_eq!(result["cases"], 2, "{}", path.display());
            continue;
        }
        if text.contains("task = \"learn\"") {
            let quick = little_learning(&path);
            let quick: Vec<&str> = quick.iter().map(String::as_str).collect();
            let (code, result, _) = result(&[&[path.to_str().unwrap()], &quick[..]].concat());
            assert_eq!(code, 0, "{}: {result}", path.display());
            continue;
        }
        let needs = text.lines().find_map(|line| line.strip_prefix("path = \"../../shared/data/"));
        if needs.is_some_and(|rest| measured(rest.split('"').next().unwrap()).is_none()) {
            continue;
        }
        // Amortized methods train to the end in the conformance battery, which takes half a minute; after a
        // few steps they miss the bar.
        let amortized = path.to_str().unwrap().ends_with("-amortized.toml");
        let quick = amortized.then_some("fit.max_steps=10");
        let arguments: Vec<&str> = path.to_str().into_iter().chain(quick).collect();
        let (code, result, _) = result(&arguments);
        let expected = i32::from(amortized || path.ends_with("baseline.toml"));
        assert_eq!(code, expected, "{}: {result}", path.display());
    }
}

/// The CI gate runs the test command of the README, word for word.
#[test]
fn the_gate_runs_the_readmes_test_command() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let gate = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let commands: Vec<&str> = readme
        .lines()
        .filter_map(|line| line.strip_prefix("    "))
        .filter(|line| line.starts_with("cargo "))
        .take(2)
        .collect();
    let [run, test] = commands[..] else { panic!("{commands:?}") };
    assert_eq!(run, "cargo run -p trainer -- configs/pinn.toml");
    assert!(gate.lines().any(|line| line == test), "`{test}` is not a line of .ci/run");
}

/// Returns the main documents and the book's pages.
fn documents() -> Vec<PathBuf> {
    let top = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root().join(name));
    top.into_iter().chain(files("book/src", "md")).chain(files("experiments", "md")).collect()
}

/// Returns the parts of a text between two marks.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Vec<&'a str> {
    text.split(open).skip(1).filter_map(|rest| rest.split(close).next()).collect()
}

#[test]
fn links_of_the_documents_lead_somewhere() {
    let mut checked = 0;
    for path in documents() {
        let text = std::fs::read_to_string(&path).unwrap();
        for target in between(&text, "](", ")") {
            let file = target.split('#').next().unwrap();
            if target.contains("://") || file.is_empty() {
                continue;
            }
            assert!(path.with_file_name(file).exists(), "{}: {target} leads nowhere", path.display());
            checked += 1;
        }
    }
    assert!(checked > 60, "{checked}");
}

#[test]
fn every_page_of_the_book_stands_in_its_contents_and_includes_what_exists() {
    let summary = std::fs::read_to_string(root().join("book/src/SUMMARY.md")).unwrap();
    let listed = between(&summary, "](", ")");
    for path in files("book/src", "md") {
        let name = path.strip_prefix(root().join("book/src")).unwrap().to_str().unwrap();
        assert!(name == "SUMMARY.md" || listed.contains(&name), "{name} is not in SUMMARY.md");
        let text = std::fs::read_to_string(&path).unwrap();
        for include in between(&text, "{{#include ", "}}") {
            let (file, anchor) =
                include.split_once(':').map_or((include, None), |(file, anchor)| (file, Some(anchor)));
            let included = std::fs::read_to_string(path.with_file_name(file));
            let included = included.unwrap_or_else(|error| panic!("{name} includes {file}: {error}"));
            let is_there = anchor.is_none_or(|anchor| included.contains(&format!("ANCHOR: {anchor}\n")));
            assert!(is_there, "{name}: {file} has no anchor {anchor:?}");
        }
    }
}

#[test]
fn every_term_of_the_glossary_is_defined_in_a_sentence_and_has_a_dated_source() {
    let text = std::fs::read_to_string(root().join("book/src/glossary.md")).unwrap();
    let rows: Vec<Vec<&str>> = (text.lines().skip_while(|line| !line.starts_with("|---")).skip(1))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    assert!(rows.len() >= 40, "{}", rows.len());
    for row in &rows {
        let [term, means, source] = row[..] else { panic!("{row:?}") };
        assert!(means.ends_with('.') && means.len() > 20, "{term}: {means}");
        // A year, or the part number of a standard.
        let has_year = source.split(|letter: char| !letter.is_ascii_digit()).any(|number| number.len() >= 4);
        assert!(has_year, "{term}: {source}");
    }
    let terms: Vec<String> = rows.iter().map(|row| row[0].to_lowercase()).collect();
    assert!(terms.is_sorted(), "{terms:?}");
}

/// Returns the words of every command in the documents with one of these beginnings; continued lines are
/// joined.
fn commands(beginning: &str) -> Vec<(PathBuf, Vec<String>)> {
    let mut found = Vec::new();
    for path in documents() {
        let text = std::fs::read_to_string(&path).unwrap().replace("\\\n", " ");
        for line in text.lines().filter_map(|line| line.trim().strip_prefix(beginning)) {
            found.push((path.clone(), line.split_whitespace().map(|word| word.replace('\'', "")).collect()));
        }
    }
    found
}

#[test]
fn commands_of_the_documents_name_commands_options_and_files_that_exist() {
    let help = |arguments: &[&str]| String::from_utf8(trainer(arguments).stdout).unwrap();
    let whole = help(&["--help"]);
    let all = [commands("cargo run -p trainer -- "), commands("cargo run --release -p trainer -- ")].concat();
    assert!(all.len() > 30, "{}", all.len());
    for (path, words) in all {
        let place = path.display();
        let first = words[0].as_str();
        let is_configuration = first.ends_with(".toml");
        let own = if is_configuration || first.starts_with('-') {
            whole.clone()
        } else {
            assert!(whole.contains(&format!("\n  {first} ")), "{place}: `{first}` is no command");
            help(&[first, "--help"])
        };
        for word in &words {
            if let Some(option) = word.strip_prefix("--").and_then(|word| word.split('=').next()) {
                assert!(own.contains(&format!("--{option}")), "{place}: {first} has no option --{option}");
            }
            // A name in capitals stands for the reader's own file.
            if word.starts_with("configs/") || word.starts_with("experiments/") {
                assert!(root().join(word).exists(), "{place}: {word} is not there");
            }
        }
    }
}

#[test]
fn examples_and_tests_that_the_documents_name_exist() {
    let manifest = std::fs::read_to_string(root().join("crates/ringdown/Cargo.toml")).unwrap();
    let examples = commands("cargo run -p ringdown-lab --example ");
    assert!(examples.len() >= 5, "{}", examples.len());
    for (path, words) in examples {
        let name = format!("name = \"{}\"", words[0]);
        assert!(manifest.contains(&name), "{}: no example {}", path.display(), words[0]);
    }
    for (path, words) in commands("cargo test -p ") {
        let name = format!("name = \"{}\"", words[0]);
        let is_there = files("crates", "toml")
            .iter()
            .any(|manifest| std::fs::read_to_string(manifest).unwrap().contains(&name));
        assert!(is_there, "{}: no package {}", path.display(), words[0]);
    }
}

/// The lines of the diagnosis in the README and in the first hour, each of which may be cut off, match the
/// command's output.
#[test]
fn the_diagnosis_that_the_documents_show_is_what_the_command_says() {
    let plain = |line: &str| line.replace('’', "'").split_whitespace().collect::<Vec<_>>().join(" ");
    let told: Vec<String> = Shipped::get().said.lines().map(plain).collect();
    let rows = ["certain ", "likely ", "open ", "simulator as given ", "recalibrated ", "repaired "];
    for document in ["README.md", "book/src/first-hour.md"] {
        let text = std::fs::read_to_string(root().join(document)).unwrap();
        let shown = text.lines().filter_map(|line| line.strip_prefix("    ")).map(plain);
        let shown: Vec<String> = shown.filter(|line| rows.iter().any(|row| line.starts_with(row))).collect();
        assert!(shown.len() >= 6, "{document}: {shown:?}");
        for line in shown {
            let is_there = told.iter().any(|own| own.starts_with(&line));
            assert!(is_there, "{document} shows `{line}`; the command says\n{}", told.join("\n"));
        }
    }
}
