//! A plot as an SVG file of its own, to be put into a document: with its legend beneath it, and in the reader's color
//! scheme where the program that shows it knows one.

use super::svg::{self, WIDE};
use super::{Hue, LegendEntry};

/// Entries of a legend, beyond which the rest is counted.
const MOST_ENTRIES: usize = 20;
const ROW: f64 = 22.0;
/// Where the legend's swatches and words begin.
const SWATCHES: f64 = 64.0;
const WORDS: f64 = 102.0;
/// Of the page, as in `templates/style.css`.
const LIGHT_PAGE: &str = "#ffffff";
const DARK_PAGE: &str = "#17181c";

/// `wide` is the drawing, `height` its own in SVG units.
pub(super) fn file(wide: &str, height: f64, legend: &[LegendEntry], description: &str) -> String {
    let width = WIDE.width;
    let left_out = legend.len().saturating_sub(MOST_ENTRIES);
    let rows = legend.len().min(MOST_ENTRIES) + usize::from(left_out > 0);
    let whole = height + ROW * rows as f64 + 8.0;
    let words = |row: usize, words: &str| {
        let baseline = height + ROW * row as f64 + 16.0;
        format!(
            "<text x=\"{WORDS}\" y=\"{baseline}\" font-size=\"{}\">{}</text>",
            WIDE.label_size,
            svg::escape(words)
        )
    };
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{whole}\" viewBox=\"0 0 {width} {whole}\" \
         font-family=\"sans-serif\" fill=\"{}\">\n<title>{}</title>\n<style>{}</style>\n",
        Hue::Ink.light(),
        svg::escape(description),
        style(),
    );
    text.push_str(&placed(wide, 0.0, 0.0, width, height));
    for (row, entry) in legend.iter().take(MOST_ENTRIES).enumerate() {
        let top = height + ROW * row as f64 + 5.0;
        text.push('\n');
        text.push_str(&placed(&entry.swatch, SWATCHES, top, 28.0, 12.0));
        text.push_str(&words(row, &entry.label));
    }
    if left_out > 0 {
        text.push_str(&words(MOST_ENTRIES, &format!("and {left_out} more")));
    }
    text.push_str("\n</svg>\n");
    text
}

/// An SVG within another one.
fn placed(svg: &str, x: f64, y: f64, width: f64, height: f64) -> String {
    svg.replacen("<svg ", &format!("<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" "), 1)
}

/// A program that knows no style sheets shows the light colors, on no background.
fn style() -> String {
    let dark: String = Hue::ALL
        .iter()
        .flat_map(|hue| ["fill", "stroke"].map(|attribute| (attribute, hue.light(), hue.dark())))
        .map(|(attribute, light, dark)| format!(" [{attribute}=\"{light}\"] {{ {attribute}: {dark}; }}"))
        .collect();
    format!(
        "svg:root {{ background: {LIGHT_PAGE}; }} @media (prefers-color-scheme: dark) {{ \
         svg:root {{ background: {DARK_PAGE}; }}{dark} }}"
    )
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Mark, Plot, Series};
    use super::*;

    fn plot(series: usize) -> Plot {
        Plot {
            x: Axis::linear("time (s)"),
            y: Axis::linear("angle"),
            series: (0..series)
                .map(|index| Series {
                    label: format!("<series> & {index}"),
                    hue: Hue::of_series(index),
                    mark: Mark::Line,
                    points: vec![(0.0, 1.0), (1.0, index as f64)],
                })
                .collect(),
            shaded: vec![],
        }
    }

    #[test]
    fn a_file_has_the_legend_and_escapes_it() {
        let file = plot(2).draw("<plot>").unwrap().file;
        assert!(file.starts_with("<svg ") && file.ends_with("</svg>\n"));
        assert_eq!(file.matches("<svg ").count(), file.matches("</svg>").count());
        assert!(file.contains("<title>&lt;plot&gt;</title>"));
        assert!(
            file.contains(">&lt;series&gt; &amp; 0</text>")
                && file.contains(">&lt;series&gt; &amp; 1</text>")
        );
        assert!(file.contains(&format!("height=\"{}\"", 400.0 + 2.0 * ROW + 8.0)));
    }

    #[test]
    fn a_long_legend_is_counted() {
        let file = plot(MOST_ENTRIES + 3).draw("").unwrap().file;
        assert!(file.contains(">and 3 more</text>"));
        assert!(!file.contains(&format!("&amp; {MOST_ENTRIES}</text>")));
    }

    #[test]
    fn every_hue_follows_the_color_scheme() {
        let style = style();
        for hue in Hue::ALL {
            assert!(style.contains(&format!("[stroke=\"{}\"] {{ stroke: {}; }}", hue.light(), hue.dark())));
        }
        let css = include_str!("../../templates/style.css");
        assert!(
            css.contains(&format!("--page: {LIGHT_PAGE};")) && css.contains(&format!("--page: {DARK_PAGE};"))
        );
    }
}
