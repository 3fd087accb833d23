//! Tests of the whole page.

use results::MethodOutcome;

use super::sample::{self, Folder};
use crate::plot::Hue;
use crate::{RunTexts, comparison_markdown, render, render_comparison, render_run};

const EVIL: &str = "<script>alert(1)</script>\"'&$x$";

#[test]
fn two_renders_are_equal_bytes() {
    let sample = Folder::new();
    assert_eq!(sample.render().unwrap(), sample.render().unwrap());
}

#[test]
fn what_comes_from_files_is_escaped() {
    let mut sample = Folder::new();
    sample.run.name = EVIL.into();
    sample.run.config = EVIL.into();
    sample.run.environment = EVIL.into();
    let result = &mut sample.result;
    result.data.path = EVIL.into();
    result.data.unit = EVIL.into();
    result.data.findings = vec![EVIL.into()];
    result.data.clock_reason = EVIL.into();
    result.envelope.pipeline = EVIL.into();
    result.pipelines[0].clock = EVIL.into();
    result.cautions[0].statement = EVIL.into();
    result.cautions[0].finding = EVIL.into();
    for row in &mut result.results {
        row.title = EVIL.into();
        row.id = EVIL.into();
        if let MethodOutcome::Estimate(found) = &mut row.outcome {
            found.stopped_because = EVIL.into();
        }
    }
    result.results[1].outcome = MethodOutcome::Failed { reason: EVIL.into() };
    let html = sample.render().unwrap();
    assert!(!crate::scripts::stripped(&html).contains("<script"));
    assert!(html.contains("&#60;script&#62;alert(1)"));
}

#[test]
fn the_page_loads_nothing_and_runs_its_own_scripts_only() {
    let html = Folder::new().render().unwrap();
    let rest = crate::scripts::stripped(&html);
    for forbidden in
        ["http://", "https://", "<script", "<link rel=\"stylesheet", "@import", "url(", "src=", "javascript:"]
    {
        assert!(!rest.contains(forbidden), "{forbidden}");
    }
}

#[test]
fn every_color_of_a_plot_follows_the_color_scheme() {
    let html = Folder::new().render().unwrap();
    for attribute in ["fill=\"#", "stroke=\"#"] {
        for (at, _) in html.match_indices(attribute) {
            let start = at + attribute.len() - 1;
            let color = &html[start..start + 7];
            assert!(Hue::ALL.iter().any(|hue| hue.light() == color), "{color}");
        }
    }
    assert!(!html.contains("fill=\"black\"") && !html.contains("stroke=\"black\""));
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
    for wanted in ["oscillation", "derived", "classical", "learned", "guidelines", "amplitude", "errors"] {
        assert!(anchors.contains(&wanted), "{wanted}");
    }
}

#[test]
fn every_part_is_there() {
    let html = Folder::new().render().unwrap();
    for part in [
        "Measured record",
        "Not all within tolerance",
        "Table 3",
        "Table 4",
        "Table 5",
        "Table 6",
        "(a) Decay",
        "(b) Logarithm",
        "Figure 1 (c): error by method",
        "(d) Summary",
        "What does not follow from these numbers",
        "The same record through each pipeline",
        "Findings about the file",
        "Files of the run",
        "no estimate: the budget of 200 generations ran out",
        ">FAIL<",
        "0.0087489415",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn values_that_are_not_finite_break_no_plot() {
    let mut sample = Folder::new();
    for (index, row) in sample.result.results.iter_mut().enumerate() {
        if let MethodOutcome::Estimate(found) = &mut row.outcome {
            found.error_percent = if index % 2 == 0 { f64::NAN } else { f64::INFINITY };
            found.worst_error_percent = f64::NAN;
        }
    }
    sample.result.max_error_percent = f64::NAN;
    sample.envelope()[3].log_amplitude = f64::NAN;
    sample.envelope()[4].log_amplitude = 1e4;
    let html = sample.render().unwrap();
    assert!(!html.contains("id=\"errors\""));
    let drawn = html.split("<svg").skip(1).filter_map(|rest| rest.split_once("</svg>"));
    for (svg, _) in drawn {
        assert!(!svg.contains("NaN") && !svg.contains("inf\"") && !svg.contains("inf "));
    }
}

#[test]
fn what_a_run_lacks_leaves_its_section_out() {
    let mut sample = Folder::new();
    sample.result.cautions.clear();
    sample.result.pipelines.clear();
    sample.result.results.clear();
    let html = sample.render().unwrap();
    assert!(!html.contains("id=\"cautions\"") && !html.contains("id=\"pipelines\""));
    assert!(html.contains("there is nothing to compare"));
}

#[test]
fn the_task_chooses_the_page() {
    let comparison = serde_json::to_string(&sample::result()).unwrap();
    let envelope = "time_s,log_amplitude,oracle,estimate\n0,0,0,0\n1,-1,-1,-1\n";
    let texts = RunTexts {
        name: "a",
        config: "",
        result: &comparison,
        trace: "step,phase,loss,decay_rate\n",
        envelope,
        predictions: "",
        series: "",
        environment: "",
        reader: crate::Reader::CommandLine,
    };
    assert_eq!(render(&texts).unwrap(), render_comparison(&texts).unwrap());
    assert!(render_run(&texts).unwrap_err().to_string().contains("reads \"estimate\""));
    let run = crate::sample::Sample::new().json();
    let texts = RunTexts { result: &run, ..texts };
    assert_eq!(render(&texts).unwrap(), render_run(&texts).unwrap());
    assert!(render_comparison(&texts).unwrap_err().to_string().contains("reads \"compare\""));
    assert!(comparison_markdown(&run).unwrap_err().to_string().contains("reads \"compare\""));
    assert!(comparison_markdown("").unwrap_err().to_string().contains("is missing or empty"));
    assert!(comparison_markdown(&comparison).unwrap().starts_with("# One damping ratio by 21 methods\n"));
}
