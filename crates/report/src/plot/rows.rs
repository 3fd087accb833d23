//! Dot plot of one quantity by name: a row for each name, dots along a horizontal axis.
//!
//! On a wide page the names are left of the axis. On a narrow page each name is above its own row, where it
//! has the whole width.

use super::axis::Ticks;
use super::svg::{self, Canvas, LETTER, Margins, Pen, Sheet};
use super::{Axis, Drawing, Hue, LegendEntry};
use crate::format;

/// Distance between the names and the axis on a wide page, in SVG units.
const GAP: f64 = 10.0;
/// Largest number of characters of a name; longer names are cut.
const MOST_LETTERS: usize = 48;
/// Width of a letter of a name, in units of the font size: digits and capitals are wider than [`LETTER`].
const NAME_LETTER: f64 = 0.61;
/// Largest number of rows; beyond it, a table is easier to read than a plot.
const MOST_ROWS: usize = 200;

/// Rows of dots along one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct DotRows {
    /// Axis of the quantity.
    pub x: Axis,
    /// Rows from top to bottom.
    pub rows: Vec<DotRow>,
    /// Meaning of the dots of [`DotRow::value`], for the legend.
    pub value_label: String,
    /// Meaning of the rings of [`DotRow::extreme`], for the legend.
    pub extreme_label: String,
    /// Name and place of a dashed line across all rows.
    pub level: Option<(String, f64)>,
}

/// Number of characters of the longest number on an axis.
const LONGEST_NUMBER: f64 = 9.0;

/// One name and its values; `None`, and values that the axis cannot show, have no mark.
#[derive(Debug, Clone, PartialEq)]
pub struct DotRow {
    /// Name of the row.
    pub name: String,
    /// Value drawn as a dot.
    pub value: Option<f64>,
    /// Value drawn as a ring, joined to the dot.
    pub extreme: Option<f64>,
    /// Interval drawn as a bar behind the dot; not drawn unless the axis can show both ends.
    pub interval: Option<[f64; 2]>,
}

impl DotRow {
    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        [self.value, self.extreme].into_iter().flatten().chain(self.interval.into_iter().flatten())
    }
}

/// Differences between the wide and the narrow drawing.
struct Form {
    canvas: &'static Canvas,
    row_height: f64,
    /// `true` if names are above their rows.
    above: bool,
}

const WIDE: Form = Form { canvas: &svg::WIDE, row_height: 25.0, above: false };
const NARROW: Form = Form { canvas: &svg::NARROW, row_height: 37.0, above: true };

impl DotRows {
    /// Draws the rows, with `description` as the text for screen readers.
    ///
    /// `None` if no row has a value that the axis can show.
    #[must_use]
    pub fn draw(&self, description: &str) -> Option<Drawing> {
        let rows = self.rows.get(..self.rows.len().min(MOST_ROWS)).unwrap_or_default();
        let left_out = rows.iter().flat_map(DotRow::values).filter(|value| !self.x.can_show(*value)).count();
        Some(Drawing {
            wide: self.render(rows, &WIDE, description)?,
            narrow: self.render(rows, &NARROW, description)?,
            live: None,
            legend: self.legend(),
            left_out,
            thinned: false,
        })
    }

    fn render(&self, rows: &[DotRow], form: &Form, description: &str) -> Option<String> {
        let shown = || rows.iter().flat_map(DotRow::values).filter(|value| self.x.can_show(*value));
        let mut values: Vec<f64> = shown().collect();
        if values.is_empty() {
            return None;
        }
        values.extend(self.level.iter().map(|level| level.1).filter(|level| self.x.can_show(*level)));
        let ticks = self.x.ticks(values.into_iter(), form.canvas.x_ticks)?;

        let mut sheet =
            Sheet::new(form.canvas, form.height(rows), form.margins(rows), &ticks, (0.0, rows.len() as f64));
        sheet.axes((&self.x.label, ""), None);
        for (index, row) in rows.iter().enumerate() {
            self.draw_row(&mut sheet, row, place(index, rows.len()), form, &ticks);
        }
        if let Some((_, level)) = self.level.as_ref().filter(|level| self.x.can_show(level.1)) {
            let x = sheet.x(ticks.place(*level));
            let pen = Pen { hue: Hue::Data, width: form.canvas.line_width, dashes: Some(svg::DASHES) };
            sheet.line((x, sheet.y(rows.len() as f64)), (x, sheet.y(0.0)), pen);
        }
        Some(sheet.finish(description))
    }

    fn draw_row(&self, sheet: &mut Sheet<'_>, row: &DotRow, place: f64, form: &Form, ticks: &Ticks) {
        let size = form.canvas.tick_size;
        let (middle, left) = (sheet.y(place), sheet.x(ticks.ends.0));
        let (x, y, anchor, marks) = if form.above {
            (left + 4.0, middle - 5.0, "start", middle + form.row_height * 0.24)
        } else {
            (left - GAP, middle + 0.36 * size, "end", middle)
        };
        sheet.text((x, y), &shortened(&row.name), size, anchor);
        let at = |value: Option<f64>| value.filter(|v| self.x.can_show(*v)).map(|v| sheet.x(ticks.place(v)));
        let (value, extreme) = (at(row.value), at(row.extreme));
        let ends = row.interval.map(|[low, high]| (at(Some(low)), at(Some(high))));
        let pen = |hue| Pen { hue, width: form.canvas.line_width, dashes: None };
        if let Some((Some(low), Some(high))) = ends {
            sheet.line((low, marks), (high, marks), pen(Hue::Estimate));
        }
        let radius = form.canvas.dot_radius;
        let says = |label: &str, value: Option<f64>| {
            format!("{}\n{label}: {}", row.name, format::significant(value.unwrap_or(f64::NAN), 4))
        };
        if let (Some(value), Some(extreme)) = (value, extreme) {
            sheet.line((value, marks), (extreme, marks), pen(Hue::Second));
        }
        if let Some(x) = extreme {
            let ring = Some(form.canvas.line_width);
            let says = says(&self.extreme_label, row.extreme);
            sheet.circle((x, marks), radius + 2.6, Hue::Second, ring, &says);
        }
        if let Some(x) = value {
            let says = says(&self.value_label, row.value);
            sheet.circle((x, marks), radius, Hue::Estimate, None, &says);
        }
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let dot = format!("<circle cx=\"14\" cy=\"6\" r=\"3.5\" fill=\"{}\" />", Hue::Estimate.light());
        let ring = format!(
            "<circle cx=\"14\" cy=\"6\" r=\"4.8\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" />",
            Hue::Second.light()
        );
        let level = format!(
            "<line x1=\"1\" y1=\"6\" x2=\"27\" y2=\"6\" stroke=\"{}\" stroke-width=\"2\" \
             stroke-dasharray=\"{}\" />",
            Hue::Data.light(),
            svg::DASHES
        );
        let entry =
            |label: &str, shape: &str| LegendEntry { label: label.to_owned(), swatch: svg::swatch_of(shape) };
        let mut entries = vec![entry(&self.value_label, &dot)];
        if self.rows.iter().any(|row| row.extreme.is_some()) {
            entries.push(entry(&self.extreme_label, &ring));
        }
        let drawn = self.level.iter().filter(|(_, value)| self.x.can_show(*value));
        entries.extend(drawn.map(|(label, _)| entry(label, &level)));
        entries
    }
}

/// Room above the first row.
const TOP: f64 = 8.0;

impl Form {
    fn height(&self, rows: &[DotRow]) -> f64 {
        rows.len() as f64 * self.row_height + svg::below(self.canvas) + TOP
    }

    /// Returns the margins. Right of the axis, and left of it on a narrow page, there is room for half of a
    /// tick's label.
    fn margins(&self, rows: &[DotRow]) -> Margins {
        let letters = rows.iter().map(|row| shortened(&row.name).chars().count()).fold(0, usize::max);
        let names = letters as f64 * NAME_LETTER * self.canvas.tick_size;
        let left = if self.above { 24.0 } else { names + GAP + 4.0 };
        // Half of the last number extends beyond the end of the axis.
        let right = (0.5 * LONGEST_NUMBER * LETTER * self.canvas.tick_size).max(24.0);
        Margins { left, top: TOP, right, bottom: svg::below(self.canvas) }
    }
}

/// Returns the middle of a row, on an axis that counts rows from the bottom.
fn place(index: usize, count: usize) -> f64 {
    count as f64 - index as f64 - 0.5
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= MOST_LETTERS {
        return name.to_owned();
    }
    let mut short: String = name.chars().take(MOST_LETTERS - 1).collect();
    short.push('…');
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(values: &[(Option<f64>, Option<f64>)]) -> DotRows {
        DotRows {
            x: Axis::log("error (%)"),
            rows: values
                .iter()
                .enumerate()
                .map(|(index, (value, extreme))| DotRow {
                    name: format!("method <{index}>"),
                    value: *value,
                    extreme: *extreme,
                    interval: None,
                })
                .collect(),
            value_label: "first seed".into(),
            extreme_label: "worst seed".into(),
            level: Some(("tolerance".into(), 0.1)),
        }
    }

    #[test]
    fn every_row_is_named_and_marked() {
        let drawing =
            rows(&[(Some(1e-9), Some(1e-7)), (Some(0.3), Some(0.3)), (None, None)]).draw("").unwrap();
        for svg in [&drawing.wide, &drawing.narrow] {
            for index in 0..3 {
                assert!(svg.contains(&format!("method &lt;{index}&gt;")));
            }
            assert_eq!(svg.matches("<circle").count(), 4);
            assert!(svg.contains(">10⁻"));
        }
        assert_eq!(drawing.legend.len(), 3);
        assert_eq!(drawing.left_out, 0);
    }

    #[test]
    fn an_interval_is_a_bar_behind_its_dot() {
        let mut plot = rows(&[(Some(1e-3), None), (Some(1e-2), None)]);
        let bar = format!("stroke=\"{}\"", Hue::Estimate.light());
        let bars = |plot: &DotRows| plot.draw("").unwrap().wide.matches(&bar).count();
        assert_eq!(bars(&plot), 0);
        plot.rows[0].interval = Some([1e-4, 1e-2]);
        assert_eq!(bars(&plot), 1);
        // Without rings, there is no legend entry for rings.
        assert_eq!(plot.draw("").unwrap().legend.len(), 2);
        // One end has no logarithm: only the dot is drawn.
        plot.rows[0].interval = Some([0.0, 1e-2]);
        let drawing = plot.draw("").unwrap();
        assert_eq!(drawing.left_out, 1);
        assert_eq!((bars(&plot), drawing.wide.matches("<circle").count()), (0, 2));
    }

    #[test]
    fn values_without_a_place_are_counted_and_break_nothing() {
        let drawing =
            rows(&[(Some(1e-9), Some(f64::NAN)), (Some(0.0), Some(f64::INFINITY))]).draw("").unwrap();
        assert_eq!(drawing.left_out, 3);
        assert!(!drawing.wide.contains("NaN") && !drawing.wide.contains("inf"));
        assert!(rows(&[(Some(0.0), None)]).draw("").is_none());
        assert!(rows(&[]).draw("").is_none());
    }

    #[test]
    fn long_names_are_cut() {
        let mut plot = rows(&[(Some(1e-9), None)]);
        plot.rows[0].name = format!("x {}", "y".repeat(100));
        let drawing = plot.draw("").unwrap();
        assert!(drawing.wide.contains(">x yyy") && drawing.wide.contains("y…<"));
        // The tooltip shows the whole name.
        assert!(drawing.wide.contains(&format!("<title>x {}", "y".repeat(100))));
    }

    #[test]
    fn drawings_of_equal_rows_are_equal() {
        let plot = rows(&[(Some(1e-9), Some(1e-7))]);
        assert_eq!(plot.draw("x"), plot.draw("x"));
    }
}
