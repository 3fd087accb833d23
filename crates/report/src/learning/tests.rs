use crate::{RunTexts, render};
use results::{
    LearnCoefficient, LearnData, LearnEnd, LearnKind, LearnPart, LearnPartError, LearnProblem,
    LearnPublished, LearnResult, LearnRow, LearnTest, Origin, RESULT_SCHEMA, Reached,
};
use std::collections::BTreeMap;

fn row(id: &str, kind: LearnKind, error: Option<f64>) -> LearnRow {
    LearnRow {
        problem: "swing".to_owned(),
        id: id.to_owned(),
        title: format!("Method {id}"),
        kind,
        draws: Vec::new(),
        validation: None,
        test: error.map(|error| LearnTest {
            free_run_rmse: Some(error),
            unit: "rad".to_owned(),
            over_noise: Some(error / 1e-3),
            horizon_s: 4.0,
            one_step_rmse: None,
            parts: Vec::new(),
            coverage_95: Some(0.947),
        }),
        coefficients: Some(BTreeMap::from([(
            "theta".to_owned(),
            LearnCoefficient {
                value: -16.02,
                unit: "1/s^2".to_owned(),
                interval_95: Some([-16.1, -15.9]),
                inclusion: Some(1.0),
                truth: Some(-16.0),
            },
        )])),
        equation: None,
        torque_error: Some(0.012),
        parameters: 4,
        seconds: 0.2,
        reached: LearnEnd::Trained(Reached::Converged),
        failure: error.is_none().then(|| "needs <a> nominal simulator".to_owned()),
        model: None,
    }
}

fn page(learner: f64) -> String {
    page_of(learner, Vec::new())
}

/// Renders a page; the learner has ten times its error on each stated part.
fn page_of(learner: f64, parts: Vec<LearnPart>) -> String {
    let errors =
        |part: &LearnPart| LearnPartError { part: part.id.clone(), free_run_rmse: Some(10.0 * learner) };
    let mut sindy = row("sindy", LearnKind::Learner, Some(learner));
    if let Some(test) = sindy.test.as_mut() {
        test.parts = parts.iter().map(errors).collect();
    }
    let problem = LearnProblem {
        id: "swing".to_owned(),
        title: "A swing".to_owned(),
        origin: Origin::Simulated,
        absent: None,
        unit: "rad".to_owned(),
        data: LearnData { records: 6, train: 3, validation: 1, test: 2 },
        training_samples: 1500,
        rate_hz: 50.0,
        period_s: 1.0,
        warm_up_s: 1.0,
        parts,
        noise: 1e-3,
        test_s: 9.0,
        input_hold: None,
        missing: vec!["a: 3 missing cells left as gaps".to_owned()],
    };
    let result = LearnResult {
        schema: RESULT_SCHEMA.to_owned(),
        task: "learn".to_owned(),
        seed: 0,
        data: problem.data,
        problems: vec![problem],
        results: vec![
            sindy,
            row("arx", LearnKind::Baseline, Some(0.1)),
            row("nominal", LearnKind::Baseline, None),
            row("sindy:at-zero", LearnKind::Ablation, Some(0.7)),
        ],
        seconds: 1.0,
    };
    let result = serde_json::to_string(&result).unwrap();
    let predictions = "problem,method,record,time_s,observed,predicted,std\nswing,sindy,r,1,0.1,0.1,\nswing,sindy,r,2,0.2,0.2,\n";
    let series = "problem,method,position,velocity,input,truth,learned,std\nswing,sindy,0.1,0.2,0,-1.6,-1.61,\nswing,sindy,0.2,0.2,0,-3.2,-3.21,\n";
    let trace =
        "problem,method,step,phase,train,validation\nswing,sindy,1,whole,0.1,\nswing,sindy,2,whole,0.01,\n";
    render(&RunTexts { name: "run", result: &result, predictions, series, trace, ..RunTexts::default() })
        .unwrap()
}

#[test]
fn a_page_shows_scores_coefficients_and_plots_and_says_where_a_row_failed() {
    let page = page(0.002);
    for words in [
        "Learning helps on every data set",
        "94.7 %",
        "−16.02",
        "needs &#60;a&#62; nominal simulator",
        "Free runs: A swing (simulated)",
        "Learned torque: A swing (simulated)",
        "What the free runs miss: A swing (simulated)",
        "Training: A swing (simulated)",
        "problem-swing-errors",
        "Method sindy:at-zero",
    ] {
        assert!(page.contains(words), "no {words}");
    }
}

/// An ablation is a row of the table, but not a method in the plots.
#[test]
fn an_ablation_is_a_row_and_in_no_plot() {
    let page = page(0.002);
    // The result is part of the page too, with its quotes escaped.
    assert_eq!(page.matches(">Method sindy:at-zero<").count(), 1);
    assert!(page.matches(">Method arx<").count() > 1);
    // Without one-step errors and training of its own, both cells are empty, neither infinite nor zero.
    let cells = |title: &str| {
        let row = page.split(&format!(">{title}<")).nth(1).unwrap().split("</tr>").next().unwrap();
        row.split("<td>").skip(1).map(|cell| cell.split('<').next().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let [ablation, baseline] = ["Method sindy:at-zero", "Method arx"].map(cells);
    assert_eq!([&ablation[3], &ablation[7]], ["", ""], "{ablation:?}");
    assert_eq!([&baseline[3], &baseline[7]], ["∞", "0.20"], "{baseline:?}");
}

#[test]
fn a_learner_behind_a_baseline_is_no_success() {
    assert!(page(0.2).contains("Learning helps nowhere"));
}

#[test]
fn a_table_has_a_column_for_each_test_part_and_a_row_for_each_method_of_others() {
    let published = vec![LearnPublished { name: "Others".to_owned(), free_run_rmse: 0.0123 }];
    let page = page_of(0.002, vec![LearnPart { id: "sweep".to_owned(), samples: 500, published }]);
    for words in [">sweep (rad)<", ">Validation (rad)<", ">0.0200<", ">Others (published)<", ">0.0123<"] {
        assert!(page.contains(words), "no {words}");
    }
    let table = page.split("<table").nth(1).unwrap().split("</table>").next().unwrap();
    let columns = table.matches("<th scope=\"col\"").count();
    let rows = table.split("<tr").skip(2).filter(|row| !row.contains("colspan"));
    rows.for_each(|row| assert_eq!(1 + row.matches("<td>").count(), columns, "{row}"));
}
