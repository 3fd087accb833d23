//! What is to be seen in a plot, and what drawing it gives.

use super::{Axis, Hue};

/// A point that interrupts a line where nothing is missing from it.
pub const BREAK: (f64, f64) = (f64::NAN, f64::NAN);

/// Neighboring points of a series that can all be shown.
pub(super) type Run = Vec<(f64, f64)>;

/// What is to be seen in one plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series, drawn in this order: the last is on top.
    pub series: Vec<Series>,
    /// Stretches of the horizontal axis that are shaded, in units of that axis.
    pub shaded: Vec<(f64, f64)>,
}

/// One series of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend; series of the same name, hue and mark share one entry.
    pub label: String,
    /// Its color.
    pub hue: Hue,
    /// How its points are drawn.
    pub mark: Mark,
    /// Horizontal and vertical coordinates, in the units of the axes. What an axis cannot show
    /// (not finite; not positive on a logarithmic axis) interrupts a line, and so does [`BREAK`].
    pub points: Vec<(f64, f64)>,
}

/// How the points of a series are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A dot each.
    Dots,
    /// A line through them.
    Line,
    /// A dashed line; laid over a line that it may coincide with, it leaves that visible.
    Dashes,
    /// A dotted line.
    DottedLine,
    /// A dashed horizontal line across the whole plot, at the first point's height.
    Level,
    /// A dotted horizontal line across the whole plot, at the first point's height.
    DottedLevel,
}

/// One entry of a legend.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LegendEntry {
    /// The series' name, not escaped.
    pub label: String,
    /// A small SVG that shows its color and its mark; holds nothing from outside this crate.
    pub swatch: String,
}

/// A finished plot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    /// SVG for a page that gives it about 960 CSS pixels.
    pub wide: String,
    /// SVG for a phone, which gives it about 350.
    pub narrow: String,
    /// Data of the interactive plot as JSON, which holds no `<`; `None` for a plot that stays as it is drawn.
    pub live: Option<String>,
    /// The entries of the legend, in the order of the series.
    pub legend: Vec<LegendEntry>,
    /// How many points the axes could not show.
    pub left_out: usize,
    /// Whether a line was drawn with fewer points than it has.
    pub thinned: bool,
}
