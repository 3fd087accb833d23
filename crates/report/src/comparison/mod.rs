//! Page of a comparison of many methods, and its tables as Markdown.

mod figures;
mod guidelines;
pub(crate) mod markdown;
mod methods;
mod oscillation;
mod parts;
mod verdict;

#[cfg(test)]
mod sample;
#[cfg(test)]
mod tests;

use askama::Template;

use results::Caution;

use crate::figures::{Figure, lead};
use crate::frame::{Frame, finish};
use crate::modes::{ModeView, mode_views};
use crate::parse::Comparison;
use crate::remarks::is_believed;
use crate::tables::Fact;
use crate::{ReportError, RunTexts};

pub(crate) use markdown::{latex, markdown};
use methods::MethodTable;
pub use methods::{ABLATION_READING, ablation_cell};
use parts::WordTable;
pub use verdict::beside_least_squares;

#[derive(Template)]
#[template(path = "comparison.html")]
struct ComparisonPage<'a> {
    frame: Frame<'a>,
    oscillation: [WordTable; 2],
    modes: Vec<ModeView>,
    methods: Vec<MethodTable>,
    reading: &'static str,
    guidelines: WordTable,
    /// The plot below the verdict, if there is one.
    lead: Vec<Figure>,
    figures: Vec<Figure>,
    summary: Vec<Fact>,
    cautions: &'a [Caution],
}

pub(crate) fn render(texts: &RunTexts<'_>, comparison: &Comparison) -> Result<String, ReportError> {
    let result = &comparison.result;
    let mut figures = figures::figures(comparison);
    let page = ComparisonPage {
        frame: Frame::new(
            texts,
            "many methods for one damping ratio",
            verdict::verdict(result),
            &result.data,
            &result.oracle,
            &result.pipelines,
        )
        .disagreeing(result.disagreement.as_ref(), is_believed(&result.pipelines, &result.data)),
        oscillation: [oscillation::parameters(result), oscillation::derived(result)],
        modes: mode_views(&result.modes),
        methods: methods::tables(result),
        reading: methods::READING,
        guidelines: guidelines::guidelines(result),
        lead: lead(&mut figures),
        figures,
        summary: oscillation::summary(result),
        cautions: &result.cautions,
    };
    finish(&page)
}
