//! Colors of all plots, in a light and a dark version.
//!
//! SVG attributes hold fixed colors. Each hue has one such color that nothing else uses. The page's style
//! sheet, generated from the same table, turns it into a variable that follows the reader's color scheme. A
//! plot taken out of the page keeps its light colors.

/// A color with a meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Hue {
    /// Text.
    Ink,
    /// Axis lines and ticks.
    Axis,
    /// Grid lines.
    Grid,
    /// Shading of every other phase.
    Shade,
    /// Measured data.
    Data,
    /// Closed-form least squares.
    Oracle,
    /// Result of an estimator.
    Estimate,
    /// A second series of equal rank.
    Second,
    /// A third series of equal rank.
    Third,
    /// A fourth series of equal rank.
    Fourth,
}

impl Hue {
    /// All hues, in the order of the style sheet.
    pub const ALL: [Self; 10] = [
        Self::Ink,
        Self::Axis,
        Self::Grid,
        Self::Shade,
        Self::Data,
        Self::Oracle,
        Self::Estimate,
        Self::Second,
        Self::Third,
        Self::Fourth,
    ];

    /// Returns the hue of the `index`-th of several series of equal rank; the four hues repeat.
    #[must_use]
    pub fn of_series(index: usize) -> Self {
        match index % 4 {
            0 => Self::Estimate,
            1 => Self::Second,
            2 => Self::Third,
            _ => Self::Fourth,
        }
    }

    /// Returns the name of the style sheet's variable, without its leading dashes.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// Returns the color on a light page and in the SVG's attributes: `#rrggbb`.
    #[must_use]
    pub fn light(self) -> &'static str {
        self.row().1
    }

    /// Returns the color on a dark page: `#rrggbb`.
    #[must_use]
    pub fn dark(self) -> &'static str {
        self.row().2
    }

    /// Returns the name and the two colors of the hue. The series have Okabe and Ito's hues, which stay
    /// distinct under the common color deficiencies; they are darkened or lightened until they also stand out
    /// from the page.
    fn row(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Ink => ("plot-ink", "#1b1c20", "#ecedf1"),
            Self::Axis => ("plot-axis", "#6c6e78", "#9a9ca8"),
            Self::Grid => ("plot-grid", "#dfe0e6", "#33353d"),
            Self::Shade => ("plot-shade", "#8b8d9a", "#a7a9b8"),
            Self::Data => ("plot-data", "#55575f", "#b4b6c0"),
            Self::Oracle => ("plot-oracle", "#0072b2", "#56b4e9"),
            Self::Estimate => ("plot-estimate", "#c55000", "#f58b4c"),
            Self::Second => ("plot-second", "#008561", "#2fc79c"),
            Self::Third => ("plot-third", "#a8487f", "#e297c4"),
            Self::Fourth => ("plot-fourth", "#8a6a00", "#e6c34a"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Hue;

    /// Background of the page, as in `templates/style.css`.
    const LIGHT_PAGE: &str = "#ffffff";
    const DARK_PAGE: &str = "#17181c";

    /// Returns the relative luminance by WCAG 2.
    fn luminance(color: &str) -> f64 {
        let channel = |at: usize| {
            let value = f64::from(u8::from_str_radix(&color[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    fn contrast(one: &str, other: &str) -> f64 {
        let (a, b) = (luminance(one), luminance(other));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn what_carries_meaning_stands_out_from_both_pages() {
        for hue in Hue::ALL {
            let least = match hue {
                Hue::Ink => 7.0,
                // Decoration: the plot can be read without it.
                Hue::Grid | Hue::Shade => 1.1,
                // Requirement for text of this size; text in the page's own color is written on some of these
                // hues.
                _ => 4.5,
            };
            for (color, page) in [(hue.light(), LIGHT_PAGE), (hue.dark(), DARK_PAGE)] {
                let found = contrast(color, page);
                assert!(found >= least, "{hue:?} {color} on {page}: {found:.2}");
            }
        }
    }

    #[test]
    fn the_pages_are_those_of_the_style_sheet() {
        let css = include_str!("../../templates/style.css");
        assert!(css.contains(&format!("--page: {LIGHT_PAGE};")));
        assert!(css.contains(&format!("--page: {DARK_PAGE};")));
    }

    #[test]
    fn no_two_hues_share_a_color_or_a_name() {
        for (index, hue) in Hue::ALL.iter().enumerate() {
            for other in &Hue::ALL[index + 1..] {
                assert_ne!(hue.light(), other.light());
                assert_ne!(hue.name(), other.name());
            }
        }
    }
}
