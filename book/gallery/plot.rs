//! Two panels side by side as one SVG that needs no style sheet.

use std::fmt::Write;

/// One panel: two series over a common axis.
pub(crate) struct Panel {
    pub(crate) title: &'static str,
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
    /// Logarithmic vertical axis.
    pub(crate) is_log: bool,
    /// Points in the place of lines.
    pub(crate) has_dots: bool,
    /// Without the effect; empty where there is nothing to compare with.
    pub(crate) without: Vec<(f64, f64)>,
    /// With the effect.
    pub(crate) with: Vec<(f64, f64)>,
}

const WIDTH: f64 = 330.0;
const HEIGHT: f64 = 170.0;
const LEFT: f64 = 62.0;
const TOP: f64 = 26.0;
/// Most points of a series.
const MOST: usize = 300;
const GRAY: &str = "#909090";
const BLUE: &str = "#2a7ab9";

pub(crate) fn svg(panels: &[Panel; 2]) -> String {
    let (width, height) = (2.0 * (LEFT + WIDTH + 12.0), TOP + HEIGHT + 58.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"12\" fill=\"#7a7a7a\">\n"
    );
    for (index, panel) in panels.iter().enumerate() {
        let left = LEFT + index as f64 * (LEFT + WIDTH + 12.0);
        draw(&mut text, panel, left);
    }
    let line = TOP + HEIGHT + 50.0;
    let _ = writeln!(text, "<text x=\"{LEFT}\" y=\"{line}\" fill=\"{BLUE}\">with the effect</text>");
    let _ = writeln!(text, "<text x=\"{}\" y=\"{line}\" fill=\"{GRAY}\">without</text>", LEFT + 110.0);
    text.push_str("</svg>\n");
    text
}

/// Lower and upper end of an axis over all values, with room; a logarithmic axis in decades.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    // What changes by less than a hundredth is flat, not a picture of its rounding.
    let least = 0.01 * low.abs().max(high.abs()).max(1e-9);
    let room = (0.05 * (high - low)).max(0.5 * (least - (high - low)));
    (low - room, high + room)
}

/// Round numbers within an axis: steps of 1, 2 or 5 times a power of ten, four or so.
fn ticks((low, high): (f64, f64)) -> Vec<f64> {
    let rough = (high - low) / 4.0;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|own| own * power).into_iter().find(|own| *own >= rough);
    let step = step.unwrap_or(10.0 * power);
    let first = (low / step).ceil() as i64;
    (first..).map(|count| count as f64 * step).take_while(|tick| *tick <= high).take(9).collect()
}

/// One, two and five times each power of ten within an axis of decades.
fn log_ticks((low, high): (f64, f64)) -> Vec<f64> {
    let decades = low.floor() as i32..=high.ceil() as i32;
    let all = decades.flat_map(|power| [1.0, 2.0, 5.0].map(|own| own * 10_f64.powi(power)));
    all.filter(|tick| (low..=high).contains(&tick.log10())).collect()
}

fn draw(text: &mut String, panel: &Panel, left: f64) {
    let scaled = |value: f64| if panel.is_log { value.log10() } else { value };
    let all = || panel.without.iter().chain(&panel.with);
    let (x, y) = (extent(all().map(|point| point.0)), extent(all().map(|point| scaled(point.1))));
    let at_x = |value: f64| left + WIDTH * (value - x.0) / (x.1 - x.0);
    let at_y = |value: f64| TOP + HEIGHT * (1.0 - (value - y.0) / (y.1 - y.0));
    let bottom = TOP + HEIGHT;
    let _ = writeln!(text, "<text x=\"{left}\" y=\"16\" font-weight=\"bold\">{}</text>", panel.title);
    for tick in ticks(x) {
        let at = at_x(tick);
        let _ = writeln!(
            text,
            "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#80808040\"/><text x=\"{at:.1}\" y=\"{}\" \
             text-anchor=\"middle\">{}</text>",
            bottom + 15.0,
            number(tick)
        );
    }
    let heights = if panel.is_log { log_ticks(y) } else { ticks(y) };
    for tick in heights {
        let at = at_y(scaled(tick));
        let _ = writeln!(
            text,
            "<path d=\"M{left} {at:.1}h{WIDTH}\" stroke=\"#80808040\"/><text x=\"{}\" y=\"{:.1}\" \
             text-anchor=\"end\">{}</text>",
            left - 6.0,
            at + 4.0,
            number(tick)
        );
    }
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}, over {}</text>",
        left + WIDTH,
        bottom + 32.0,
        panel.y,
        panel.x
    );
    for (points, color) in [(&panel.without, GRAY), (&panel.with, BLUE)] {
        let places = points.iter().map(|(x, y)| (at_x(*x), at_y(scaled(*y))));
        let places: Vec<(f64, f64)> = places.filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
        series(text, &places, color, panel.has_dots);
    }
}

fn series(text: &mut String, places: &[(f64, f64)], color: &str, has_dots: bool) {
    let every = places.len().div_ceil(MOST).max(1);
    let mut path = String::new();
    for (index, (x, y)) in places.iter().step_by(every).enumerate() {
        let _ = match (has_dots, index) {
            (true, _) => write!(path, "M{x:.1} {y:.1}h0"),
            (false, 0) => write!(path, "M{x:.1} {y:.1}"),
            (false, _) => write!(path, "L{x:.1} {y:.1}"),
        };
    }
    let width = if has_dots { 3.5 } else { 1.5 };
    let _ = writeln!(
        text,
        "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
    );
}

/// A tick's number in four digits, without zeros at its end.
fn number(value: f64) -> String {
    if value.abs() < 1e-12 {
        return "0".to_owned();
    }
    let digits = (3.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
