//! A quantity over two others: cells whose color deepens with the size of the value.
//!
//! The color is one hue for each sign, more or less opaque, so that it follows the reader's color scheme like every
//! other plot's.

use kuva::plot::ScatterPlot;
use kuva::render::color::Color;
use kuva::render::layout::{AxisLabelOverlap, ComputedLayout, Layout};
use kuva::render::plots::Plot as KuvaPlot;
use kuva::render::render::{Primitive, Scene, render_multiple};

use super::axis::Ticks;
use super::svg::{self, Canvas};
use super::{Axis, Drawing, Hue, LegendEntry};
use crate::format;

/// Opacity of the smallest value; below it a cell could not be told from none.
const FAINTEST: f64 = 0.06;
/// Above the plot and right of it.
const TOP: f64 = 10.0;
const RIGHT: f64 = 24.0;

/// Cells over two axes, both linear.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The cells.
    pub cells: Vec<HeatCell>,
    /// Unit of the values, for the legend.
    pub unit: String,
    /// What an outlined cell is, in the legend; empty where none is.
    pub outline: String,
}

/// One cell; one whose value is not finite is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatCell {
    /// Its ends along the horizontal axis.
    pub x: [f64; 2],
    /// Its ends along the vertical axis.
    pub y: [f64; 2],
    /// Its value: [`Hue::Estimate`] where positive, [`Hue::Oracle`] where negative.
    pub value: f64,
    /// Whether it is outlined.
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
    /// Draws the map. `description` is what a screen reader says instead.
    ///
    /// `None` where no cell can be shown.
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

    fn render(&self, canvas: &Canvas, description: &str) -> Option<String> {
        let ends = |of: fn(&HeatCell) -> [f64; 2]| self.shown().flat_map(of).collect::<Vec<_>>();
        let (across, along) = (ends(|cell| cell.x), ends(|cell| cell.y));
        let x = self.x.ticks(across.iter().copied(), canvas.x_ticks)?.close_to(across.iter().copied());
        let y = self.y.ticks(along.iter().copied(), canvas.x_ticks.min(6.0))?;
        let layout = self.layout(canvas, &x, &y);
        let computed = ComputedLayout::from_layout(&layout);
        // As with rows of dots: kuva draws the axes around nothing, the cells follow from the same layout.
        let mut scene = render_multiple(vec![KuvaPlot::Scatter(ScatterPlot::new())], layout);
        let largest = self.largest();
        for cell in self.shown() {
            draw(&mut scene, cell, largest, (&x, &y), &computed);
        }
        svg::finish(scene, canvas, canvas.height, description)
    }

    fn layout(&self, canvas: &Canvas, x: &Ticks, y: &Ticks) -> Layout {
        let (label, tick) = (f64::from(canvas.label_size), f64::from(canvas.tick_size));
        Layout::new(x.ends, y.ends)
            .with_theme(svg::theme())
            .with_width(canvas.width)
            .with_height(canvas.height)
            .with_label_size(canvas.label_size)
            .with_tick_size(canvas.tick_size)
            .with_force_margins(label + 4.2 * tick, RIGHT)
            .with_force_margins_y(TOP, 26.0 + label + tick)
            .with_x_axis_min(x.ends.0)
            .with_x_axis_max(x.ends.1)
            .with_y_axis_min(y.ends.0)
            .with_y_axis_max(y.ends.1)
            .with_x_tick_step(1.0)
            .with_y_tick_step(1.0)
            .with_x_tick_format(svg::labels(x))
            .with_y_tick_format(svg::labels(y))
            .with_x_label_overlap(AxisLabelOverlap::Thin)
            .with_x_label(svg::plain(&self.x.label))
            .with_y_label(svg::plain(&self.y.label))
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
            // The extreme of each sign and half of it, as deep as they are drawn.
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

/// How opaque a value is, from its share of the largest.
fn opacity(share: f64) -> f64 {
    FAINTEST + (1.0 - FAINTEST) * share.clamp(0.0, 1.0)
}

fn draw(
    scene: &mut Scene,
    cell: &HeatCell,
    largest: f64,
    (x, y): (&Ticks, &Ticks),
    computed: &ComputedLayout,
) {
    let [left, right] = cell.x.map(|end| computed.map_x(x.place(end)));
    let [bottom, top] = cell.y.map(|end| computed.map_y(y.place(end)));
    let hue = if cell.value < 0.0 { Hue::Oracle } else { Hue::Estimate };
    let share = if largest > 0.0 { cell.value.abs() / largest } else { 0.0 };
    let rectangle = |fill: &str, opacity: Option<f64>, stroke: Option<Hue>, inset: f64| Primitive::Rect {
        x: left + inset,
        y: top + inset,
        width: (right - left - 2.0 * inset).max(0.5),
        height: (bottom - top - 2.0 * inset).max(0.5),
        fill: Color::from(fill),
        stroke: stroke.map(|hue| Color::from(hue.light())),
        stroke_width: stroke.map(|_| 1.2),
        opacity,
    };
    scene.add(rectangle(hue.light(), Some(opacity(share)), None, 0.0));
    if cell.outlined {
        scene.add(rectangle("none", None, Some(Hue::Ink), 0.8));
    }
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
