//! Page of one run: the template and its values.

use askama::Template;

use crate::figures::{Figure, figures, lead};
use crate::frame::{Frame, finish};
use crate::modes::{ModeView, mode_views};
use crate::parse::Run;
use crate::plot::Axis;
use crate::remarks::is_believed;
use crate::tables::{self, ComparisonRow, Fact, SeedView};
use crate::verdict;
use crate::whole;
use crate::{Reader, ReportError, RunTexts};
use results::DataSummary;

#[derive(Template)]
#[template(path = "run.html")]
struct RunPage<'a> {
    frame: Frame<'a>,
    estimator: &'a str,
    comparison: Vec<ComparisonRow>,
    /// Titles and facts.
    cards: Vec<(&'static str, Vec<Fact>)>,
    modes: Vec<ModeView>,
    seeds: Vec<SeedView>,
    /// The plot below the verdict, if there is one.
    lead: Vec<Figure>,
    figures: Vec<Figure>,
    has_trace: bool,
}

pub(crate) fn render(texts: &RunTexts<'_>, run: &Run) -> Result<String, ReportError> {
    let result = &run.result;
    let frame = Frame::new(
        texts,
        "estimation of a damping ratio",
        verdict::verdict(result),
        &result.data,
        &result.oracle,
        &result.pipelines,
    )
    .disagreeing(result.disagreement.as_ref(), is_believed(&result.pipelines, &result.data));
    let mut figures = figures(run);
    let lead = lead(&mut figures);
    let page = RunPage {
        frame: Frame { next: verdict::next(result), ..frame },
        estimator: &result.estimator_title,
        comparison: tables::comparison(result),
        cards: [
            ("Training", tables::training(result)),
            ("Envelope", tables::envelope(result)),
            ("Reference", tables::oracle(result)),
        ]
        .into_iter()
        .chain(result.truth.as_ref().map(|known| ("Truth of the simulated record", tables::truth(known))))
        .collect(),
        modes: mode_views(&result.modes),
        seeds: tables::seeds(&result.seeds),
        lead,
        figures: part(&result.data).into_iter().chain(figures).collect(),
        has_trace: !run.trace.is_empty(),
    };
    finish(&page)
}

/// Returns the plot of the record if only a part of it was read.
fn part(data: &DataSummary) -> Option<Figure> {
    let axis = Axis::linear(format!("recorded ({})", data.unit));
    whole::figure(
        "whole".to_owned(),
        "The part that was read".to_owned(),
        axis,
        &data.reading,
        Reader::CommandLine,
    )
}

#[cfg(test)]
mod tests {
    use crate::plot::Hue;
    use crate::sample::Sample;
    use crate::scripts;

    #[test]
    fn pipelines_that_disagree_come_before_the_answer_only_if_another_is_to_be_believed() {
        let mut sample = Sample::new();
        sample.result.disagreement = Some("The other way gives 3.7.".into());
        let place = |sample: &Sample, what: &str| sample.render().unwrap().find(what).unwrap();
        assert!(place(&sample, "other way gives") < place(&sample, "class=\"verdict"));
        for row in &mut sample.result.pipelines {
            row.in_force = row.pipeline == "recommended" && row.clock == "uniform-index";
        }
        assert!(place(&sample, "other way gives") > place(&sample, "id=\"pipelines\""));
    }

    #[test]
    fn two_renders_are_equal_bytes() {
        let sample = Sample::new();
        assert_eq!(sample.render().unwrap(), sample.render().unwrap());
    }

    #[test]
    fn what_comes_from_files_is_escaped() {
        const EVIL: &str = "<script>alert(1)</script>\"'&$x$";
        let mut sample = Sample::new();
        sample.name = EVIL.into();
        sample.config = EVIL.into();
        sample.environment = EVIL.into();
        let result = &mut sample.result;
        result.estimator_title = EVIL.into();
        result.data.path = EVIL.into();
        result.data.digest = EVIL.into();
        result.data.clock = EVIL.into();
        result.data.clock_reason = EVIL.into();
        result.data.unit = EVIL.into();
        result.data.findings = vec![EVIL.into()];
        result.envelope.pipeline = EVIL.into();
        result.estimate.stopped_because = EVIL.into();
        result.pipelines[0].pipeline = EVIL.into();
        result.pipelines[0].clock = EVIL.into();
        if let Some(row) = sample.trace.last_mut() {
            row.phase = EVIL.into();
        }
        let html = sample.render().unwrap();
        assert!(!scripts::stripped(&html).contains("<script"));
        assert!(html.contains("&#60;script&#62;alert(1)"));
    }

    /// The scripts are those of this crate, to the byte that the policy names.
    #[test]
    fn the_page_loads_nothing_and_runs_its_own_scripts_only() {
        let html = Sample::new().render().unwrap();
        let rest = scripts::stripped(&html);
        for forbidden in [
            "http://",
            "https://",
            "<script",
            "<link rel=\"stylesheet",
            "@import",
            "url(",
            "src=",
            "javascript:",
            "onload",
        ] {
            assert!(!rest.contains(forbidden), "{forbidden}");
        }
    }

    #[test]
    fn every_color_of_a_plot_follows_the_color_scheme() {
        let html = Sample::new().render().unwrap();
        for hue in Hue::ALL {
            for attribute in ["fill", "stroke"] {
                let rule = format!("[{attribute}=\"{}\"]", hue.light());
                assert!(html.contains(&rule), "{rule}");
            }
        }
        for attribute in ["fill=\"#", "stroke=\"#"] {
            for (at, _) in html.match_indices(attribute) {
                let start = at + attribute.len() - 1;
                let color = &html[start..start + 7];
                assert!(Hue::ALL.iter().any(|hue| hue.light() == color), "{color}");
            }
        }
    }

    #[test]
    fn values_that_are_not_finite_break_no_plot() {
        let mut sample = Sample::new();
        for (index, row) in sample.trace.iter_mut().enumerate() {
            match index % 5 {
                0 => row.loss = f64::NAN,
                1 => row.loss = f64::INFINITY,
                2 => row.decay_rate = f64::NEG_INFINITY,
                3 => row.decay_rate = f64::NAN,
                _ => (),
            }
        }
        sample.envelope[3].estimate = f64::NAN;
        let html = sample.render().unwrap();
        assert!(html.contains("are left out"));
        let drawn = html.split("<svg").skip(1).filter_map(|rest| rest.split_once("</svg>"));
        for (svg, _) in drawn {
            assert!(!svg.contains("NaN") && !svg.contains("inf\"") && !svg.contains("inf "));
        }
        // A trace of nothing but NaN leaves out its plots, and the page states it.
        for row in &mut sample.trace {
            row.loss = f64::NAN;
            row.decay_rate = f64::NAN;
        }
        assert!(!sample.render().unwrap().contains("id=\"loss\""));
    }

    #[test]
    fn a_method_without_steps_has_no_training_plots() {
        let mut sample = Sample::new();
        sample.trace.clear();
        let html = sample.render().unwrap();
        assert!(html.contains("no steps were recorded"));
        assert!(!html.contains("id=\"loss\""));
        assert!(html.contains("id=\"residuals\""));
    }

    #[test]
    fn the_origin_is_loud() {
        for (origin, label) in [
            (results::Origin::Measured, "Measured record"),
            (results::Origin::Simulated, "Simulated record"),
            (results::Origin::Unstated, "Origin not stated"),
        ] {
            let mut sample = Sample::new();
            sample.result.data.origin = origin;
            assert!(sample.render().unwrap().contains(label));
        }
    }
}
