//! Plots as inline SVG. All drawing of the crate is here.
//!
//! A [`Plot`] shows two quantities, [`DotRows`] show one quantity by name, and a [`HeatMap`] shows one
//! quantity over two others. `draw` returns a [`Drawing`], whose colors come from the style sheet of the page
//! (see [`Hue`]). Each plot is drawn twice, for a wide and for a narrow page, because text in an SVG shrinks
//! with it; the page shows one of the two.
//!
//! The legend is not part of the SVG. The page sets it in HTML, where it wraps and where its names, which
//! come from files, are escaped like all other text.

mod axis;
mod heat;
mod hue;
mod live;
mod parts;
mod rows;
mod svg;
mod thin;

pub use axis::{Axis, Scale};
pub use heat::{HeatCell, HeatMap};
pub use hue::Hue;
use parts::Run;
pub use parts::{BREAK, Drawing, LegendEntry, Mark, Plot, Series};
pub use rows::{DotRow, DotRows};

/// Number of points in all lines of a plot beyond which it looks the same with fewer.
const MOST_POINTS: usize = 2_000;

impl Plot {
    /// Draws the plot, with `description` as the text for screen readers.
    ///
    /// `None` if no series has a point that the axes can show.
    #[must_use]
    pub fn draw(&self, description: &str) -> Option<Drawing> {
        let mut runs: Vec<Vec<Run>> = self.series.iter().map(|s| self.runs(s)).collect();
        let left_out = self
            .series
            .iter()
            .flat_map(|series| &series.points)
            .filter(|point| !point.0.is_nan() && !self.can_show(**point))
            .count();
        let mut thinned = false;
        let total: usize = runs.iter().flatten().map(Vec::len).sum();
        let lines = runs
            .iter_mut()
            .zip(&self.series)
            .filter(|(_, series)| series.mark != Mark::Dots)
            .flat_map(|(runs, _)| runs);
        if total > MOST_POINTS {
            for run in lines {
                let kept = thin::thin(run, MOST_POINTS * run.len() / total);
                thinned |= kept.len() < run.len();
                *run = kept;
            }
        }
        let legend = self.legend();
        let entry = |series: &Series| {
            let swatch = svg::swatch(series);
            legend.iter().position(|entry| entry.label == series.label && entry.swatch == swatch)
        };
        Some(Drawing {
            wide: svg::render(self, &runs, &svg::WIDE, description)?,
            narrow: svg::render(self, &runs, &svg::NARROW, description)?,
            live: self.live(entry),
            legend,
            left_out,
            thinned,
        })
    }

    fn can_show(&self, point: (f64, f64)) -> bool {
        self.x.can_show(point.0) && self.y.can_show(point.1)
    }

    /// Returns the uninterrupted runs of points of a series that can be shown.
    fn runs(&self, series: &Series) -> Vec<Run> {
        series
            .points
            .split(|point| !self.can_show(*point))
            .filter(|run| !run.is_empty())
            .map(<[_]>::to_vec)
            .collect()
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for series in &self.series {
            let entry = LegendEntry { label: series.label.clone(), swatch: svg::swatch(series) };
            if !series.points.is_empty() && !entries.contains(&entry) {
                entries.push(entry);
            }
        }
        entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<(f64, f64)>) -> Plot {
        Plot {
            x: Axis::linear("step"),
            y: Axis::log("loss"),
            series: vec![Series { label: "one".into(), hue: Hue::Estimate, mark: Mark::Line, points }],
            shaded: vec![],
        }
    }

    #[test]
    fn nothing_to_show_is_no_drawing() {
        assert!(plot(vec![]).draw("").is_none());
        assert!(plot(vec![(0.0, f64::NAN), (1.0, -1.0)]).draw("").is_none());
    }

    #[test]
    fn what_cannot_be_shown_interrupts_the_line_and_is_counted() {
        let drawing = plot(vec![
            (0.0, 1.0),
            (1.0, 0.1),
            (2.0, f64::NAN),
            (3.0, f64::INFINITY),
            (4.0, 0.0),
            (5.0, 0.01),
            (6.0, 1e-30),
        ])
        .draw("a plot")
        .unwrap();
        assert_eq!(drawing.left_out, 3);
        assert_eq!(drawing.wide.matches("<path").count(), 2);
        assert!(!drawing.wide.contains("NaN") && !drawing.wide.contains("inf"));
    }

    #[test]
    fn a_single_point_is_seen() {
        let drawing = plot(vec![(0.0, 1.0)]).draw("").unwrap();
        assert!(drawing.narrow.contains("<circle"));
    }

    #[test]
    fn long_lines_are_thinned() {
        let points = (0..100_000).map(|i| (f64::from(i), 1.0 + f64::from(i % 7)));
        let drawing = plot(points.collect()).draw("").unwrap();
        assert!(drawing.thinned);
        assert!(drawing.wide.len() < 60_000, "{}", drawing.wide.len());
    }

    #[test]
    fn many_short_runs_are_thinned_together() {
        let points = (0..100_000).map(|i| {
            let height = if i % 1_000 == 0 { f64::NAN } else { f64::from(1 + i % 7) };
            (f64::from(i), height)
        });
        let drawing = plot(points.collect()).draw("").unwrap();
        assert!(drawing.thinned);
        assert!(drawing.wide.len() < 100_000, "{}", drawing.wide.len());
    }

    #[test]
    fn drawings_of_one_plot_are_equal() {
        let plot = plot(vec![(0.0, 1.0), (1.0, 2.0)]);
        assert_eq!(plot.draw("x"), plot.draw("x"));
    }

    #[test]
    fn series_of_one_kind_share_a_legend_entry() {
        let mut plot = plot(vec![(0.0, 1.0), (1.0, 2.0)]);
        plot.series.push(plot.series[0].clone());
        assert_eq!(plot.draw("").unwrap().legend.len(), 1);
    }

    #[test]
    fn labels_are_escaped() {
        let mut plot = plot(vec![(0.0, 1.0), (1.0, 2.0)]);
        plot.y.label = "<script>$x$</script>".into();
        let drawing = plot.draw("\"><script>").unwrap();
        assert!(!drawing.wide.contains("<script"));
    }
}
