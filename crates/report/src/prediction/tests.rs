//! Tests of the whole page and its tables.

use results::{PredictionOutcome, ProblemOutcome, ProblemStudy};

use super::sample::Folder;
use crate::plot::Hue;
use crate::{RunTexts, comparison_markdown, prediction_markdown, render, render_prediction};

const EVIL: &str = "<script>alert(1)</script>|\"'&$x$";

fn study(folder: &mut Folder, index: usize) -> &mut ProblemStudy {
    match &mut folder.result.problems[index].outcome {
        ProblemOutcome::Studied(study) => study,
        ProblemOutcome::Absent { reason } => panic!("{reason}"),
    }
}

#[test]
fn every_part_is_there() {
    let html = Folder::new().render().unwrap();
    for part in [
        "Records of different origins",
        "Simulated record",
        "Measured record",
        "Some records are absent",
        "the record lost.csv is not there",
        "How peaks were held out",
        "Best exponential",
        "no fit: sindy needs at least 8 peaks",
        "Envelope: Dry friction (simulated)",
        "Envelope: The paper&#39;s rig (measured)",
        "Laws discovered",
        "d ln A/dt = -0.15 - 0.0138/A on the first draw; 4 of 20 draws give d ln A/dt = -c - c/A",
        "d ln A/dt = -0.15 - 0.0138/A on the first fold; 4 folds give",
        "90.0 [68.3, 98.8]",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn two_renders_are_equal_bytes_and_load_nothing() {
    let html = Folder::new().render().unwrap();
    assert_eq!(html, Folder::new().render().unwrap());
    let rest = crate::scripts::stripped(&html);
    for forbidden in ["http://", "https://", "<script", "@import", "url(", "src=", "javascript:"] {
        assert!(!rest.contains(forbidden), "{forbidden}");
    }
    for attribute in ["fill=\"#", "stroke=\"#"] {
        for (at, _) in html.match_indices(attribute) {
            let start = at + attribute.len() - 1;
            assert!(Hue::ALL.iter().any(|hue| hue.light() == &html[start..start + 7]));
        }
    }
}

#[test]
fn no_anchor_is_used_twice() {
    let html = Folder::new().render().unwrap();
    let mut anchors: Vec<&str> =
        html.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let count = anchors.len();
    anchors.sort_unstable();
    anchors.dedup();
    assert_eq!(anchors.len(), count);
    assert!(anchors.contains(&"problem-dry-envelope") && anchors.contains(&"problem-rig-deviations"));
}

#[test]
fn what_comes_from_files_is_escaped() {
    let mut folder = Folder::new();
    folder.name = EVIL.into();
    folder.result.problems[0].title = EVIL.into();
    folder.result.problems[2].outcome = ProblemOutcome::Absent { reason: EVIL.into() };
    let study = study(&mut folder, 0);
    study.unit = EVIL.into();
    study.verdict = vec![EVIL.into()];
    study.methods[0].title = EVIL.into();
    if let PredictionOutcome::Scored(scores) = &mut study.methods[0].outcome {
        scores.equation = Some(EVIL.into());
    }
    study.methods[3].outcome = PredictionOutcome::Failed { reason: EVIL.into() };
    let html = folder.render().unwrap();
    assert!(
        !crate::scripts::stripped(&html).contains("<script") && html.contains("&#60;script&#62;alert(1)")
    );
    let text = prediction_markdown(&serde_json::to_string(&folder.result).unwrap()).unwrap();
    assert!(!text.contains("<script") && text.contains("&lt;script&gt;alert(1)"));
}

#[test]
fn what_is_not_finite_breaks_nothing_and_stands_last() {
    let mut folder = Folder::new();
    for row in folder.rows.iter_mut().filter(|row| row.method == "sindy" && row.held_out) {
        row.predicted = f64::NEG_INFINITY;
        row.std_error = None;
    }
    let study = study(&mut folder, 0);
    study.methods.rotate_left(1);
    if let PredictionOutcome::Scored(scores) = &mut study.methods[3].outcome {
        let score = scores.extrapolation.as_mut().unwrap();
        score.rms_log_error = f64::INFINITY;
        score.worst_rms_log_error = f64::INFINITY;
        score.mean_log_density = Some(f64::NEG_INFINITY);
    }
    let html = folder.render().unwrap();
    assert!(html.contains("not finite"));
    for (svg, _) in html.split("<svg").skip(1).filter_map(|rest| rest.split_once("</svg>")) {
        assert!(!svg.contains("NaN") && !svg.contains("inf\"") && !svg.contains("inf "));
    }
}

#[test]
fn a_method_without_predictions_says_so() {
    let mut folder = Folder::new();
    if let PredictionOutcome::Scored(scores) = &mut study(&mut folder, 1).methods[0].outcome {
        scores.interpolation = None;
        scores.extrapolation = None;
    }
    assert!(
        crate::glossary::unexplained(&folder.render().unwrap())
            .contains("no prediction: the method gives a decay rate only")
    );
    folder.rows.clear();
    let html = folder.render().unwrap();
    assert!(!html.contains("id=\"problem-dry-envelope\"") && html.contains("id=\"problem-dry-errors\""));
}

#[test]
fn every_row_of_the_markdown_has_its_columns() {
    let text = prediction_markdown(&serde_json::to_string(&Folder::new().result).unwrap()).unwrap();
    let mut width = None;
    for line in text.lines() {
        if !line.starts_with('|') {
            width = None;
            continue;
        }
        let cells = line.replace("\\|", "").matches('|').count();
        assert_eq!(*width.get_or_insert(cells), cells, "{line}");
    }
    assert!(text.starts_with("# Methods scored on peaks they did not see\n"));
    assert!(text.contains("**Measured record.**") && text.contains("**ABSENT.** the record lost.csv"));
}

#[test]
fn the_task_chooses_the_page() {
    let folder = Folder::new();
    let result = serde_json::to_string(&folder.result).unwrap();
    let texts = RunTexts { name: "a", result: &result, ..RunTexts::default() };
    assert_eq!(render(&texts).unwrap(), render_prediction(&texts).unwrap());
    assert!(comparison_markdown(&result).unwrap_err().to_string().contains("reads \"compare\""));
    let other = crate::sample::Sample::new().json();
    let refused = render_prediction(&RunTexts { result: &other, ..texts }).unwrap_err().to_string();
    assert!(refused.contains("reads \"predict\""), "{refused}");
}
