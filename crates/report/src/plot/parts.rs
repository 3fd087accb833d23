//! Content of a plot, and the result of drawing it.

use super::{Axis, Hue};

/// A point that interrupts a line although no data are missing.
pub const BREAK: (f64, f64) = (f64::NAN, f64::NAN);

/// Neighboring points of a series that can all be shown.
pub(super) type Run = Vec<(f64, f64)>;

/// Content of one plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Series in the order of drawing: the last one is on top.
    pub series: Vec<Series>,
    /// Shaded stretches of the horizontal axis, in units of that axis.
    pub shaded: Vec<(f64, f64)>,
}

/// One series of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name of the series in the legend; series of the same name, hue and mark share one entry.
    pub label: String,
    /// Color of the series.
    pub hue: Hue,
    /// Mark of the series' points.
    pub mark: Mark,
    /// Horizontal and vertical coordinates, in the units of the axes. A line is interrupted by [`BREAK`] and
    /// by values that an axis cannot show: values that are not finite, or not positive on a logarithmic axis.
    pub points: Vec<(f64, f64)>,
}

/// Mark for the points of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A dot for each point.
    Dots,
    /// A line through the points.
    Line,
    /// A dashed line; where it coincides with another line, that line stays visible.
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
    /// Name of the series, not escaped.
    pub label: String,
    /// A small SVG that shows color and mark of the series; it contains nothing from outside this crate.
    pub swatch: String,
}

/// A finished plot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    /// SVG for a wide page, which shows it at about 960 CSS pixels.
    pub wide: String,
    /// SVG for a phone, which shows it at about 350 CSS pixels.
    pub narrow: String,
    /// Data of the interactive plot as JSON, without any `<`; `None` for a plot that is only static.
    pub live: Option<String>,
    /// Entries of the legend, in the order of the series.
    pub legend: Vec<LegendEntry>,
    /// Number of points that the axes could not show.
    pub left_out: usize,
    /// `true` if a line was drawn with fewer points than it has.
    pub thinned: bool,
}
