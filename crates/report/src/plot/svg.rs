//! From a plot to SVG text, by kuva.

use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::annotations::ShadedRegion;
use kuva::render::layout::{AxisLabelOverlap, Layout, TickFormat};
use kuva::render::plots::Plot as KuvaPlot;
use kuva::render::render::{Primitive, Scene, render_multiple};
use kuva::render::theme::Theme;

use super::axis::Ticks;
use super::{Hue, Mark, Plot, Run, Series};

/// The canvas, in SVG units that are CSS pixels where the page shows it full size.
pub(super) struct Canvas {
    pub(super) class: &'static str,
    pub(super) width: f64,
    pub(super) height: f64,
    /// Font sizes of the axis labels and of the ticks.
    pub(super) label_size: u32,
    pub(super) tick_size: u32,
    /// About how many ticks there is room for.
    pub(super) x_ticks: f64,
    y_ticks: f64,
    pub(super) dot_radius: f64,
    pub(super) line_width: f64,
}

pub(super) const WIDE: Canvas = Canvas {
    class: "plot wide",
    width: 960.0,
    height: 400.0,
    label_size: 14,
    tick_size: 13,
    x_ticks: 10.0,
    y_ticks: 6.0,
    dot_radius: 3.2,
    line_width: 2.0,
};

pub(super) const NARROW: Canvas = Canvas {
    class: "plot narrow",
    width: 360.0,
    height: 290.0,
    label_size: 13,
    tick_size: 12,
    x_ticks: 5.0,
    y_ticks: 5.0,
    dot_radius: 2.6,
    line_width: 1.8,
};

/// Dash patterns, shared by the plots and the swatches. Dashes and gaps are of equal length: where a
/// dashed line lies on a drawn-through one, both are seen in turn.
pub(super) const DASHES: &str = "8 8";
const DOTS: &str = "2 3";

/// `runs` holds the points of each series of the plot, in unbroken stretches.
pub(super) fn render(plot: &Plot, runs: &[Vec<Run>], canvas: &Canvas, description: &str) -> Option<String> {
    let points = || runs.iter().flatten().flatten();
    let x_ticks = plot.x.ticks(points().map(|p| p.0), canvas.x_ticks)?.close_to(points().map(|p| p.0));
    let y_ticks = plot.y.ticks(points().map(|p| p.1), canvas.y_ticks)?;

    let mut layers = Vec::new();
    for (series, runs) in plot.series.iter().zip(runs) {
        for run in runs {
            let placed = run.iter().map(|(x, y)| (x_ticks.place(*x), y_ticks.place(*y))).collect();
            layers.push(layer(series, placed, &x_ticks, canvas));
        }
    }
    let mut layout = layout(plot, canvas, &x_ticks, &y_ticks);
    let within = |x| x_ticks.place(x).clamp(x_ticks.ends.0, x_ticks.ends.1);
    for (from, to) in &plot.shaded {
        if plot.x.can_show(*from) && plot.x.can_show(*to) {
            layout = layout.with_shaded_region(
                ShadedRegion::vertical(within(*from), within(*to))
                    .with_color(Hue::Shade.light())
                    .with_opacity(0.14),
            );
        }
    }

    finish(render_multiple(layers, layout), canvas, canvas.height, description)
}

/// The scene as SVG whose size, font and colors the page chooses.
pub(super) fn finish(mut scene: Scene, canvas: &Canvas, height: f64, description: &str) -> Option<String> {
    // kuva numbers its clip paths with a counter of the process, which would make the text depend
    // on what was drawn before. Nothing here lies outside the axes, so nothing is to be clipped.
    scene.defs.clear();
    scene.elements.retain(|e| !matches!(e, Primitive::ClipStart { .. } | Primitive::ClipEnd));
    let svg = SvgBackend::new().render_scene(&scene);

    // kuva's opening tag fixes the size and the font; the page is to choose both.
    let body = svg.split_once('>').map(|(_, body)| body)?;
    Some(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"{}\" viewBox=\"0 0 {} {}\" \
         font-family=\"sans-serif\" fill=\"{}\" role=\"img\" aria-label=\"{}\">{body}",
        canvas.class,
        canvas.width,
        height,
        Hue::Ink.light(),
        escape(description),
    ))
}

/// kuva's theme in the hues that the page's style sheet knows.
pub(super) fn theme() -> Theme {
    Theme {
        background: "none".into(),
        axis_color: Hue::Axis.light().into(),
        tick_color: Hue::Axis.light().into(),
        grid_color: Hue::Grid.light().into(),
        text_color: Hue::Ink.light().into(),
        ..Theme::light()
    }
}

pub(super) fn labels(ticks: &Ticks) -> TickFormat {
    let ticks = ticks.clone();
    TickFormat::Custom(Arc::new(move |position| ticks.label(position)))
}

fn layout(plot: &Plot, canvas: &Canvas, x: &Ticks, y: &Ticks) -> Layout {
    Layout::new(x.ends, y.ends)
        .with_theme(theme())
        .with_width(canvas.width)
        .with_height(canvas.height)
        .with_label_size(canvas.label_size)
        .with_tick_size(canvas.tick_size)
        .with_x_axis_min(x.ends.0)
        .with_x_axis_max(x.ends.1)
        .with_y_axis_min(y.ends.0)
        .with_y_axis_max(y.ends.1)
        .with_x_tick_step(1.0)
        .with_y_tick_step(1.0)
        .with_x_tick_format(labels(x))
        .with_y_tick_format(labels(y))
        .with_x_label_overlap(AxisLabelOverlap::Thin)
        .with_x_label(plain(&plot.x.label))
        .with_y_label(plain(&plot.y.label))
}

fn layer(series: &Series, points: Run, x: &Ticks, canvas: &Canvas) -> KuvaPlot {
    let level = || {
        let height = points.first().map_or(0.0, |point| point.1);
        vec![(x.ends.0, height), (x.ends.1, height)]
    };
    let line = |points: Run, width: f64, dashes: Option<&str>| {
        let line = LinePlot::new().with_data(points).with_color(series.hue.light()).with_stroke_width(width);
        KuvaPlot::Line(match dashes {
            Some(dashes) => line.with_line_style(kuva::plot::LineStyle::Custom(dashes.to_owned())),
            None => line,
        })
    };
    let width = canvas.line_width;
    match series.mark {
        Mark::Level => line(level(), width, Some(DASHES)),
        Mark::DottedLevel => line(level(), width, Some(DOTS)),
        // A line needs two points; a single one is to be seen all the same.
        Mark::Dots | Mark::Line | Mark::Dashes | Mark::DottedLine
            if series.mark == Mark::Dots || points.len() == 1 =>
        {
            KuvaPlot::Scatter(
                ScatterPlot::new()
                    .with_data(points)
                    .with_color(series.hue.light())
                    .with_size(canvas.dot_radius),
            )
        }
        Mark::Dashes => line(points, width, Some(DASHES)),
        Mark::DottedLine => line(points, width, Some(DOTS)),
        Mark::Dots | Mark::Line => line(points, width, None),
    }
}

/// What stands before a series' name in the legend.
pub(super) fn swatch(series: &Series) -> String {
    let color = series.hue.light();
    let line = |width: &str, dashes: &str| {
        format!(
            "<line x1=\"1\" y1=\"6\" x2=\"27\" y2=\"6\" stroke=\"{color}\" \
             stroke-width=\"{width}\"{dashes} />"
        )
    };
    let dashed = |pattern: &str| line("2", &format!(" stroke-dasharray=\"{pattern}\""));
    let shape = match series.mark {
        Mark::Dots => format!("<circle cx=\"14\" cy=\"6\" r=\"3.5\" fill=\"{color}\" />"),
        Mark::Line => line("2", ""),
        Mark::Dashes | Mark::Level => dashed(DASHES),
        Mark::DottedLine | Mark::DottedLevel => dashed(DOTS),
    };
    swatch_of(&shape)
}

pub(super) fn swatch_of(shape: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"swatch\" viewBox=\"0 0 28 12\" \
         aria-hidden=\"true\">{shape}</svg>"
    )
}

/// Axis labels may quote a unit from a file. kuva escapes them, but reads `$…$` as mathematics.
pub(super) fn plain(label: &str) -> String {
    label.chars().filter(|c| *c != '$').take(60).collect()
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
