//! Heat map of a quantity over two others: the color of a cell deepens with the size of its value.
//!
//! Each sign has one hue of varying opacity, so that the map follows the reader's color scheme like every
//! other plot.

use super::axis::Ticks;
use super::svg::{self, Canvas, Margins, Sheet};
use super::{Axis, Drawing, Hue, LegendEntry};
use crate::format;

/// Opacity of the smallest value; with less, a cell would look like no cell.
const FAINTEST: f64 = 0.06;

/// A map of cells over two axes, both linear.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Cells of the map.
    pub cells: Vec<HeatCell>,
    /// Unit of the values, for the legend.
    pub unit: String,
    /// Meaning of an outlined cell, for the legend; empty if no cell is outlined.
    pub outline: String,
}

/// One cell; a cell whose value is not finite is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatCell {
    /// Ends of the cell along the horizontal axis.
    pub x: [f64; 2],
    /// Ends of the cell along the vertical axis.
    pub y: [f64; 2],
    /// Value of the cell: [`Hue::Estimate`] if positive, [`Hue::Oracle`] if negative.
    pub value: f64,
    /// `true` if the cell is outlined.
    pub outlined: bool,
}

impl HeatCell {
    fn is_shown(&self, map: &HeatMap) -> bool {
        self.value.is_finite()
            && self.x.iter().all(|end| map.x.can_show(*end))
            && self.y.iter().all(|end| map.y.can_show(*end))
    }
}

impl HeatMap {
    /// Draws the map, with `description` as the text for screen readers.
    ///
    /// `None` if no cell can be shown.
    #[must_use]
    pub fn draw(&self, description: &str) -> Option<Drawing> {
        let left_out = self.cells.iter().filter(|cell| !cell.is_shown(self)).count();
        Some(Drawing {
            wide: self.render(&svg::WIDE, description)?,
            narrow: self.render(&svg::NARROW, description)?,
            live: None,
            legend: self.legend(),
            left_out,
            thinned: false,
        })
    }

    fn shown(&self) -> impl Iterator<Item = &HeatCell> {
        self.cells.iter().filter(|cell| cell.is_shown(self))
    }

    fn largest(&self) -> f64 {
        self.shown().map(|cell| cell.value.abs()).fold(0.0, f64::max)
    }

    fn render(&self, canvas: &'static Canvas, description: &str) -> Option<String> {
        let ends = |of: fn(&HeatCell) -> [f64; 2]| self.shown().flat_map(of).collect::<Vec<_>>();
        let (across, along) = (ends(|cell| cell.x), ends(|cell| cell.y));
        let x = self.x.ticks(across.iter().copied(), canvas.x_ticks)?.close_to(across.iter().copied());
        let y = self.y.ticks(along.iter().copied(), canvas.x_ticks.min(6.0))?;
        let margins = Margins::around(canvas, y.longest_label());
        let mut sheet = Sheet::new(canvas, canvas.height, margins, &x, y.ends);
        sheet.axes((&self.x.label, &self.y.label), Some(&y));
        let largest = self.largest();
        for cell in self.shown() {
            self.draw_cell(&mut sheet, cell, largest, (&x, &y));
        }
        Some(sheet.finish(description))
    }

    fn draw_cell(&self, sheet: &mut Sheet<'_>, cell: &HeatCell, largest: f64, (x, y): (&Ticks, &Ticks)) {
        let [left, right] = cell.x.map(|end| sheet.x(x.place(end)));
        let [bottom, top] = cell.y.map(|end| sheet.y(y.place(end)));
        let hue = if cell.value < 0.0 { Hue::Oracle } else { Hue::Estimate };
        let share = if largest > 0.0 { cell.value.abs() / largest } else { 0.0 };
        let range = |[from, to]: [f64; 2]| {
            format!("{} to {}", format::significant(from, 3), format::significant(to, 3))
        };
        let says = format!(
            "{}: {}\n{}: {}\n{}{}",
            self.x.label,
            range(cell.x),
            self.y.label,
            range(cell.y),
            format::quantity(&format::significant(cell.value, 3), &self.unit),
            if cell.outlined { format!(", {}", self.outline) } else { String::new() }
        );
        let paint = format!("fill=\"{}\" fill-opacity=\"{:.3}\"", hue.light(), opacity(share));
        sheet.rectangle((left, bottom), (right, top), &paint, &says);
        if cell.outlined {
            // No fill and no pointer events: the cell below shows its content.
            let paint = format!(
                "fill=\"none\" stroke=\"{}\" stroke-width=\"1.2\" pointer-events=\"none\"",
                Hue::Ink.light()
            );
            sheet.rectangle((left + 0.8, bottom - 0.8), (right - 0.8, top + 0.8), &paint, "");
        }
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let swatch = |hue: Hue, opacity: f64| {
            svg::swatch_of(&format!(
                "<rect x=\"4\" y=\"0\" width=\"20\" height=\"12\" fill=\"{}\" opacity=\"{opacity:.2}\" />",
                hue.light()
            ))
        };
        let largest = self.largest();
        let mut entries = Vec::new();
        for (hue, sign) in [(Hue::Estimate, 1.0), (Hue::Oracle, -1.0)] {
            // The extreme of each sign and half of it, with the opacity of the cells.
            let extreme = self.shown().map(|cell| cell.value * sign).fold(0.0, f64::max);
            for value in [extreme, extreme / 2.0].into_iter().filter(|value| *value > 0.0) {
                let label = format::quantity(&format::significant(sign * value, 2), &self.unit);
                entries.push(LegendEntry { label, swatch: swatch(hue, opacity(value / largest)) });
            }
        }
        if self.shown().any(|cell| cell.outlined) {
            let shape = format!(
                "<rect x=\"5\" y=\"1\" width=\"18\" height=\"10\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\" />",
                Hue::Ink.light()
            );
            entries.push(LegendEntry { label: self.outline.clone(), swatch: svg::swatch_of(&shape) });
        }
        entries
    }
}

/// Returns the opacity of a value from its share of the largest value.
fn opacity(share: f64) -> f64 {
    FAINTEST + (1.0 - FAINTEST) * share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(values: &[f64]) -> HeatMap {
        HeatMap {
            x: Axis::linear("position (rad)"),
            y: Axis::linear("velocity (rad/s)"),
            cells: values
                .iter()
                .enumerate()
                .map(|(index, value)| HeatCell {
                    x: [index as f64, index as f64 + 1.0],
                    y: [-1.0, 1.0],
                    value: *value,
                    outlined: index == 0,
                })
                .collect(),
            unit: "rad".into(),
            outline: "above the band".into(),
        }
    }

    #[test]
    fn every_cell_is_drawn_in_the_hue_of_its_sign() {
        let drawing = map(&[2.0, -1.0, 0.0]).draw("a map").unwrap();
        for svg in [&drawing.wide, &drawing.narrow] {
            assert_eq!(svg.matches("fill-opacity").count(), 3, "{svg}");
            assert_eq!(svg.matches(&format!("fill=\"{}\"", Hue::Oracle.light())).count(), 1);
        }
        let labels: Vec<String> =
            drawing.legend.iter().map(|entry| entry.label.replace('\u{a0}', " ")).collect();
        assert_eq!(labels, ["2.0 rad", "1.0 rad", "−1.0 rad", "−0.50 rad", "above the band"]);
    }

    #[test]
    fn what_has_no_value_is_counted_and_breaks_nothing() {
        let drawing = map(&[1.0, f64::NAN]).draw("").unwrap();
        assert_eq!(drawing.left_out, 1);
        assert!(!drawing.wide.contains("NaN"));
        assert!(map(&[f64::NAN]).draw("").is_none());
        assert!(map(&[]).draw("").is_none());
        assert!(map(&[0.0, 0.0]).draw("").is_some());
    }

    #[test]
    fn drawings_of_one_map_are_equal() {
        assert_eq!(map(&[1.0, 2.0]).draw("x"), map(&[1.0, 2.0]).draw("x"));
    }
}
