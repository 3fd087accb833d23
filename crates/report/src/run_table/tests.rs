//! Tests of the page and the texts on many runs.

use results::{LearnedScores, Origin, Reached, RunState, RunTable, RunTableRow, RunTableTask, SweepAxis};
use serde_json::{Value, json};

use super::{csv, latex, markdown, text_cells};
use crate::{RunTexts, render};

fn row(run: &str, estimator: &str, seed: u64, error: f64) -> RunTableRow {
    let settings = json!({ "seed": seed });
    RunTableRow {
        task: "estimate".into(),
        estimator: estimator.into(),
        settings: settings.as_object().unwrap().clone(),
        origin: Some(Origin::Simulated),
        zeta: Some(0.01 * (1.0 + error / 100.0)),
        zeta_std_error: Some(1e-4),
        zeta_interval_95: Some([0.0098, 0.0102]),
        decay_rate: Some(0.2),
        oracle_zeta: Some(0.01),
        error_percent: Some(error),
        worst_error_percent: Some(2.0 * error),
        tolerance_percent: Some(0.1),
        reached: Some(Reached::Converged),
        steps: Some(12),
        parameters: Some(30),
        seconds: Some(0.25),
        pass: Some(error < 0.1),
        ..RunTableRow::without_numbers(run, RunState::Done, "")
    }
}

fn table() -> RunTable {
    let axes = vec![SweepAxis { key: "seed".into(), values: vec!["0".into(), "1".into()], scale: None }];
    let broken = RunTableRow::without_numbers("0005-<b>", RunState::Corrupt, "result.json: EOF | <script>");
    let rows = vec![
        row("runs/0001-pinn-seed-0", "pinn", 0, 1e-7),
        row("runs/0002-pinn-seed-1", "pinn", 1, 3e-7),
        row("runs/0003-lstm-seed-0", "lstm", 0, 0.0),
        row("runs/0004-lstm-seed-1", "lstm", 1, 0.5),
        broken,
    ];
    RunTable::new(RunTableTask::Sweep, "a sweep", axes, vec!["seed".into()], rows)
}

fn page(table: &RunTable) -> String {
    let result = serde_json::to_string(table).unwrap();
    let texts = RunTexts { name: "a", result: &result, ..RunTexts::default() };
    render(&texts).unwrap()
}

#[test]
fn the_table_counts_what_became_of_its_runs() {
    let table = table();
    assert_eq!((table.done, table.failed, table.open, table.pass), (4, 1, 0, false));
    let good = RunTable::new(
        RunTableTask::Runs,
        "",
        vec![],
        vec![],
        vec![row("a", "pinn", 0, 1e-7), row("a", "ols", 0, 0.0)],
    );
    // Two methods of one run are one run.
    assert_eq!((good.done, good.failed, good.pass), (1, 0, true));
}

#[test]
fn every_run_has_its_row_and_a_bad_one_its_reason() {
    let html = page(&table());
    assert_eq!(html.matches("<tr").count(), 1 + 5);
    assert!(
        html.contains("result.json: EOF | &#60;script&#62;")
            && !crate::scripts::stripped(&html).contains("<script")
    );
    assert!(html.contains("Simulated record") && html.contains("Some runs gave no result"));
    assert_eq!(html.matches("class=\"fails\"").count(), 2);
    // Both seeds of a method share a row of the first plot: two dots and two rings, drawn twice.
    let gaps = html.split("id=\"gaps\"").nth(1).unwrap().split("</figure>").next().unwrap();
    assert_eq!(gaps.split("<ul").next().unwrap().matches("<circle").count(), 2 * 4);
    assert!(gaps.contains("pinn,") || gaps.contains("pinn"));
    let ratios = html.split("id=\"ratios\"").nth(1).unwrap().split("</figure>").next().unwrap();
    assert_eq!(ratios.split("<ul").next().unwrap().matches("<circle").count(), 2 * 4);
    assert_eq!(page(&table()), html);
}

/// A table of one method whose runs differ in a number and in their seed.
fn swept() -> RunTable {
    const KEY: &str = "estimator.physics_weight";
    let run = |weight: f64, seed: u64, error: f64| {
        let mut row = row(&format!("runs/{weight}-{seed}"), "pinn", seed, error);
        row.settings.insert(KEY.into(), weight.into());
        row
    };
    let rows = vec![run(1e-4, 0, 20.0), run(1e-4, 1, 30.0), run(1.0, 0, 0.5), run(1e6, 0, 1e-6)];
    RunTable::new(RunTableTask::Sweep, "a sweep", vec![], vec![KEY.into(), "seed".into()], rows)
}

fn plot<'a>(html: &'a str, id: &str) -> &'a str {
    html.split(&format!("id=\"{id}\"")).nth(1).unwrap().split("</figure>").next().unwrap()
}

#[test]
fn a_metric_is_plotted_against_a_swept_number_over_its_decades() {
    let html = page(&swept());
    let plot = plot(&html, "by-estimator-physics-weight");
    assert!(plot.contains("Distance from the reference in ζ against physics_weight"), "{plot}");
    assert!(plot.contains(">10⁻⁴<") && plot.contains(">10⁶<") && plot.contains("median"));
    // The label of a row is its value, and nothing of it is cut.
    assert!(html.contains(">physics_weight = 1e6<") && html.contains(">physics_weight = 1e6, seed = 0<"));
}

#[test]
fn words_are_rows_and_learners_have_their_errors() {
    let learner = |id: &str, error: f64| RunTableRow {
        task: "learn".into(),
        estimator: id.into(),
        learned: Some(LearnedScores {
            problem: "drag".into(),
            validation_over_noise: Some(error),
            test_over_noise: Some(2.0 * error),
            test_rmse: Some(0.25),
            unit: "rad".into(),
            horizon_s: Some(3.5),
            coverage_95: None,
        }),
        parameters: Some(7),
        seconds: Some(1.5),
        ..RunTableRow::without_numbers(&format!("runs/{id}"), RunState::Done, "")
    };
    let rows = vec![learner("lstm", 1.25), learner("sindy", 9.0)];
    let table = RunTable::new(RunTableTask::Sweep, "", vec![], vec![], rows);
    let html = page(&table);
    assert!(plot(&html, "by-method").contains("Validation error by method"));
    assert!(html.contains(">test error, × noise</th>") && html.contains("<td>1.25</td><td>2.50</td>"));
    assert!(!html.contains(">ζ</th>") && !html.contains("in 95 % band"), "a column without content");
    let (header, rows) = text_cells(&table);
    assert!(header.contains(&"test × noise".to_owned()) && rows[1].contains(&"18.000".to_owned()));
    assert!(csv(&table).lines().next().unwrap().ends_with(
        "reason,problem,validation_over_noise,test_over_noise,test_rmse,unit,horizon_s,coverage_95"
    ));
    assert!(!csv(&self::table()).contains("validation_over_noise"));
}

#[test]
fn records_of_different_origins_are_loud() {
    let mut table = table();
    table.rows[0].origin = Some(Origin::Measured);
    assert!(page(&table).contains("Records of different origins"));
}

#[test]
fn the_csv_holds_every_digit_and_quotes_what_it_has_to() {
    let mut table = table();
    table.rows[0].zeta = Some(0.1 + 0.2);
    table.rows[4].reason = "a, \"b\"".into();
    let text = csv(&table);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let at = |name: &str| header.iter().position(|column| column == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[0][at("zeta")].parse::<f64>().unwrap(), 0.1 + 0.2);
    assert_eq!((&rows[0][at("seed")], &rows[1][at("seed")]), ("0", "1"));
    assert_eq!((&rows[4][at("state")], &rows[4][at("zeta")]), ("corrupt", ""));
    assert_eq!(&rows[4][at("reason")], "a, \"b\"");
}

#[test]
fn every_line_of_the_markdown_has_its_columns() {
    let text = markdown(&table());
    let widths: Vec<usize> = text
        .lines()
        .filter(|line| line.starts_with('|'))
        .map(|line| line.replace("\\|", "").matches('|').count())
        .collect();
    assert_eq!(widths, [widths[0]; 7]);
    assert!(text.contains("**CORRUPT**") && text.contains("**FAIL**"));
    assert!(!text.contains("<script"));
    let text = latex(&table());
    let widths: Vec<usize> =
        text.lines().filter(|line| line.ends_with("\\\\")).map(|line| line.matches('&').count()).collect();
    assert_eq!(widths, [widths[0]; 6]);
    assert!(text.contains("\\caption{a sweep}") && text.contains("95 \\% interval"), "{text}");
}

#[test]
fn a_terminal_gets_the_number_of_a_run_and_its_reason() {
    let (header, rows) = text_cells(&table());
    assert!(rows.iter().all(|row| row.len() == header.len()));
    assert_eq!(rows[1][..3], ["0002", "pinn", "1"]);
    assert!(rows[3].last().unwrap().contains("FAILS"));
    assert!(rows[4].last().unwrap().starts_with("CORRUPT: result.json"));
}

#[test]
fn numbers_that_are_none_survive_the_file() {
    let mut before = table();
    before.rows[0].error_percent = Some(f64::NAN);
    let text = serde_json::to_string(&before).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["rows"][0]["error_percent"], Value::Null);
    assert!(page(&before).contains("The runs"));
}
