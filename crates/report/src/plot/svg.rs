//! SVG text: a sheet with axes, and the marks on it.

use std::fmt::Write;

use super::axis::Ticks;
use super::parts::Run;
use super::{Hue, Mark, Plot, Series};

/// A canvas, in SVG units, which are CSS pixels if the page shows it at full size.
pub(super) struct Canvas {
    pub(super) class: &'static str,
    pub(super) width: f64,
    pub(super) height: f64,
    /// Font size of the axis labels; `tick_size` is that of the tick labels.
    pub(super) label_size: f64,
    pub(super) tick_size: f64,
    /// Approximate number of ticks that there is room for.
    pub(super) x_ticks: f64,
    y_ticks: f64,
    pub(super) dot_radius: f64,
    pub(super) line_width: f64,
}

pub(super) const WIDE: Canvas = Canvas {
    class: "plot wide",
    width: 960.0,
    height: 400.0,
    label_size: 14.0,
    tick_size: 13.0,
    x_ticks: 10.0,
    y_ticks: 6.0,
    dot_radius: 3.2,
    line_width: 2.0,
};

pub(super) const NARROW: Canvas = Canvas {
    class: "plot narrow",
    width: 360.0,
    height: 290.0,
    label_size: 13.0,
    tick_size: 12.0,
    x_ticks: 5.0,
    y_ticks: 5.0,
    dot_radius: 2.6,
    line_width: 1.8,
};

/// Dash patterns, shared by the plots and the swatches. Dashes and gaps have equal lengths: where a dashed
/// line lies on a solid one, both are visible in turn.
pub(super) const DASHES: &str = "8 8";
const DOTS: &str = "2 3";

/// Approximate width of a character, in units of the font size.
pub(super) const LETTER: f64 = 0.56;
/// Length of a tick, in SVG units; `ROOM` is the distance between a tick and its label.
const TICK: f64 = 5.0;
const ROOM: f64 = 4.0;

/// Margins around the axes, in SVG units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margins {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Margins {
    /// Returns the margins around axes with labeled ticks; `letters` is the length of the longest label on
    /// the left.
    pub(super) fn around(canvas: &Canvas, letters: usize) -> Self {
        let ticks = TICK + ROOM + letters as f64 * LETTER * canvas.tick_size;
        Self { left: 1.4 * canvas.label_size + ROOM + ticks, top: 10.0, right: 24.0, bottom: below(canvas) }
    }
}

/// Returns the room for the ticks of the horizontal axis, their labels and the axis label.
pub(super) fn below(canvas: &Canvas) -> f64 {
    26.0 + canvas.tick_size + canvas.label_size
}

/// Style of a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub(super) hue: Hue,
    pub(super) width: f64,
    pub(super) dashes: Option<&'static str>,
}

/// An unfinished drawing. Marks are placed in ticks of its axes, as by [`Ticks::place`].
pub(super) struct Sheet<'a> {
    canvas: &'static Canvas,
    height: f64,
    margins: Margins,
    x: &'a Ticks,
    y_ends: (f64, f64),
    body: String,
}

impl<'a> Sheet<'a> {
    pub(super) fn new(
        canvas: &'static Canvas,
        height: f64,
        margins: Margins,
        x: &'a Ticks,
        y_ends: (f64, f64),
    ) -> Self {
        Self { canvas, height, margins, x, y_ends, body: String::new() }
    }

    /// Returns a horizontal place in SVG units.
    pub(super) fn x(&self, place: f64) -> f64 {
        let width = self.canvas.width - self.margins.left - self.margins.right;
        self.margins.left + width * (place - self.x.ends.0) / (self.x.ends.1 - self.x.ends.0)
    }

    /// Returns a vertical place in SVG units.
    pub(super) fn y(&self, place: f64) -> f64 {
        let bottom = self.height - self.margins.bottom;
        bottom - (bottom - self.margins.top) * (place - self.y_ends.0) / (self.y_ends.1 - self.y_ends.0)
    }

    /// Writes text that is already escaped, or contains nothing to escape.
    fn write(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to memory does not fail.
        let _ = self.body.write_fmt(text);
    }

    /// Draws the axes with grid, ticks and labels; `y` is given if the vertical axis has values.
    pub(super) fn axes(&mut self, labels: (&str, &str), y: Option<&Ticks>) {
        let (left, right) = (self.margins.left, self.canvas.width - self.margins.right);
        let (top, bottom) = (self.margins.top, self.height - self.margins.bottom);
        let whole = |ends: (f64, f64)| (ends.0.ceil() as i64..=ends.1.floor() as i64).map(|k| k as f64);
        let grid = Pen { hue: Hue::Grid, width: 1.0, dashes: None };
        let axis = Pen { hue: Hue::Axis, width: 1.0, dashes: None };
        let x_places: Vec<f64> = whole(self.x.ends).collect();
        for place in &x_places {
            self.line((self.x(*place), top), (self.x(*place), bottom), grid);
        }
        for place in whole(self.y_ends) {
            self.line((left, self.y(place)), (right, self.y(place)), grid);
        }
        self.line((left, top), (left, bottom), axis);
        self.line((left, bottom), (right, bottom), axis);

        let size = self.canvas.tick_size;
        let said: Vec<String> = x_places.iter().map(|place| self.x.label(*place)).collect();
        let widest =
            said.iter().map(|words| words.chars().count()).fold(0, usize::max) as f64 * LETTER * size;
        let spacing = (self.x(1.0) - self.x(0.0)).max(1.0);
        let every = ((widest + 2.0 * ROOM) / spacing).ceil().max(1.0) as usize;
        for (place, words) in x_places.iter().zip(&said).step_by(every) {
            let x = self.x(*place);
            self.line((x, bottom), (x, bottom + TICK), axis);
            self.text((x, bottom + TICK + ROOM + 0.8 * size), words, size, "middle");
        }
        for place in y.map(|y| whole(y.ends)).into_iter().flatten() {
            let at = self.y(place);
            let words = y.map(|y| y.label(place)).unwrap_or_default();
            self.line((left - TICK, at), (left, at), axis);
            self.text((left - TICK - ROOM, at + 0.36 * size), &words, size, "end");
        }
        let size = self.canvas.label_size;
        self.text(((left + right) / 2.0, self.height - 0.45 * size), &plain(labels.0), size, "middle");
        if !labels.1.is_empty() {
            let (x, y) = (1.1 * size, (top + bottom) / 2.0);
            let label = escape(&plain(labels.1));
            self.write(format_args!(
                "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"middle\" \
                 transform=\"rotate(-90 {x:.1} {y:.1})\">{label}</text>"
            ));
        }
    }

    pub(super) fn text(&mut self, at: (f64, f64), words: &str, size: f64, anchor: &str) {
        self.write(format_args!(
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{}</text>",
            at.0,
            at.1,
            escape(words)
        ));
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), pen: Pen) {
        self.write(format_args!(
            "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" stroke=\"{}\" stroke-width=\"{}\"{} />",
            from.0,
            from.1,
            to.0,
            to.1,
            pen.hue.light(),
            pen.width,
            dashes(pen.dashes)
        ));
    }

    fn path(&mut self, points: &[(f64, f64)], pen: Pen) {
        self.write(format_args!("<path d=\""));
        for (index, (x, y)) in points.iter().enumerate() {
            let (x, y) = (self.x(*x), self.y(*y));
            self.write(format_args!("{}{x:.2} {y:.2}", if index == 0 { 'M' } else { 'L' }));
        }
        self.write(format_args!(
            "\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{} />",
            pen.hue.light(),
            pen.width,
            dashes(pen.dashes)
        ));
    }

    /// Draws a circle around a place in SVG units; a ring if `ring` gives a line width. `says` is shown as a
    /// tooltip.
    pub(super) fn circle(&mut self, at: (f64, f64), radius: f64, hue: Hue, ring: Option<f64>, says: &str) {
        let color = hue.light();
        let paint = match ring {
            Some(width) => format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\""),
            None => format!("fill=\"{color}\""),
        };
        self.write(format_args!("<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\" {paint}", at.0, at.1));
        self.close("circle", says);
    }

    /// Draws a rectangle between two corners in SVG units.
    pub(super) fn rectangle(&mut self, one: (f64, f64), other: (f64, f64), paint: &str, says: &str) {
        self.write(format_args!(
            "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" {paint}",
            one.0.min(other.0),
            one.1.min(other.1),
            (one.0 - other.0).abs().max(0.5),
            (one.1 - other.1).abs().max(0.5)
        ));
        self.close("rect", says);
    }

    fn close(&mut self, element: &str, says: &str) {
        if says.is_empty() {
            self.write(format_args!(" />"));
        } else {
            self.write(format_args!("><title>{}</title></{element}>", escape(says)));
        }
    }

    /// Returns the SVG; the page chooses its size, font and colors.
    pub(super) fn finish(self, description: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"{}\" viewBox=\"0 0 {} {}\" \
             font-family=\"sans-serif\" fill=\"{}\" role=\"img\" aria-label=\"{}\">{}</svg>",
            self.canvas.class,
            self.canvas.width,
            self.height,
            Hue::Ink.light(),
            escape(description),
            self.body
        )
    }
}

fn dashes(pattern: Option<&str>) -> String {
    pattern.map(|pattern| format!(" stroke-dasharray=\"{pattern}\"")).unwrap_or_default()
}

/// Renders a plot. `runs` holds the points of each series, in uninterrupted runs.
pub(super) fn render(
    plot: &Plot,
    runs: &[Vec<Run>],
    canvas: &'static Canvas,
    description: &str,
) -> Option<String> {
    let points = || runs.iter().flatten().flatten();
    let x = plot.x.ticks(points().map(|p| p.0), canvas.x_ticks)?.close_to(points().map(|p| p.0));
    let y = plot.y.ticks(points().map(|p| p.1), canvas.y_ticks)?;
    let margins = Margins::around(canvas, y.longest_label());
    let mut sheet = Sheet::new(canvas, canvas.height, margins, &x, y.ends);
    let within = |value| x.place(value).clamp(x.ends.0, x.ends.1);
    for (from, to) in plot.shaded.iter().filter(|(from, to)| plot.x.can_show(*from) && plot.x.can_show(*to)) {
        let [left, right] = [from, to].map(|end| sheet.x(within(*end)));
        let paint = format!("fill=\"{}\" fill-opacity=\"0.14\"", Hue::Shade.light());
        sheet.rectangle((left, sheet.y(y.ends.1)), (right, sheet.y(y.ends.0)), &paint, "");
    }
    sheet.axes((&plot.x.label, &plot.y.label), Some(&y));
    for (series, runs) in plot.series.iter().zip(runs) {
        for run in runs {
            let placed: Run = run.iter().map(|point| (x.place(point.0), y.place(point.1))).collect();
            put(&mut sheet, series, &placed, x.ends);
        }
    }
    Some(sheet.finish(description))
}

/// Draws an uninterrupted run of a series.
fn put(sheet: &mut Sheet<'_>, series: &Series, points: &[(f64, f64)], ends: (f64, f64)) {
    let pen = |dashes| Pen { hue: series.hue, width: sheet.canvas.line_width, dashes };
    let height = points.first().map_or(0.0, |point| point.1);
    let level = [(ends.0, height), (ends.1, height)];
    match series.mark {
        Mark::Level => sheet.path(&level, pen(Some(DASHES))),
        Mark::DottedLevel => sheet.path(&level, pen(Some(DOTS))),
        Mark::Line | Mark::Dashes | Mark::DottedLine if points.len() > 1 => {
            sheet.path(points, pen(pattern(series.mark)));
        }
        // A line needs two points, but a single point must be visible too.
        Mark::Dots | Mark::Line | Mark::Dashes | Mark::DottedLine => {
            for point in points {
                let at = (sheet.x(point.0), sheet.y(point.1));
                sheet.circle(at, sheet.canvas.dot_radius, series.hue, None, "");
            }
        }
    }
}

fn pattern(mark: Mark) -> Option<&'static str> {
    match mark {
        Mark::Dashes | Mark::Level => Some(DASHES),
        Mark::DottedLine | Mark::DottedLevel => Some(DOTS),
        Mark::Dots | Mark::Line => None,
    }
}

/// Returns a sample of a series' mark, for the legend.
pub(super) fn swatch(series: &Series) -> String {
    let color = series.hue.light();
    swatch_of(&match series.mark {
        Mark::Dots => format!("<circle cx=\"14\" cy=\"6\" r=\"3.5\" fill=\"{color}\" />"),
        mark => format!(
            "<line x1=\"1\" y1=\"6\" x2=\"27\" y2=\"6\" stroke=\"{color}\" stroke-width=\"2\"{} />",
            dashes(pattern(mark))
        ),
    })
}

pub(super) fn swatch_of(shape: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"swatch\" viewBox=\"0 0 28 12\" \
         aria-hidden=\"true\">{shape}</svg>"
    )
}

/// Shortens an axis label, which may quote a unit from a file.
fn plain(label: &str) -> String {
    label.chars().take(60).collect()
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
