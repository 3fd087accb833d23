//! Parts of every page: head, origin, verdict, warnings, pipelines, data and files.

use askama::Template;
use results::{DataSummary, OracleSummary, PipelineRow};

use crate::glossary;
use crate::plot::Hue;
use crate::remarks;
use crate::scripts;
use crate::tables::{self, Fact, PipelineView};
use crate::verdict::{self, Origin, Verdict};
use crate::{ReportError, RunTexts};

/// Values for `base.html` and for the templates that pages include.
pub(crate) struct Frame<'a> {
    pub(crate) hues: &'static [Hue],
    /// Name of the run.
    pub(crate) name: &'a str,
    /// Kind of the run, in a few words.
    pub(crate) kicker: &'static str,
    pub(crate) verdict: Verdict,
    pub(crate) origin: Origin,
    /// Reason not to believe the verdict, before it.
    pub(crate) doubt: Option<&'a str>,
    /// Remark on the table of pipelines.
    pub(crate) differing: Option<&'a str>,
    pub(crate) warnings: Vec<String>,
    /// Next steps, a sentence or two each, directly below the verdict.
    pub(crate) next: Vec<String>,
    pub(crate) pipelines: Vec<PipelineView<'a>>,
    pub(crate) data: Vec<Fact>,
    pub(crate) findings: Vec<String>,
    /// Descriptions of the files, with their texts.
    pub(crate) files: [(&'static str, &'a str); 3],
}

impl<'a> Frame<'a> {
    /// Returns the frame with a sentence on pipelines or clocks that give another answer: before the verdict
    /// if one of them is to be believed, else beside the table of pipelines.
    pub(crate) fn disagreeing(self, disagreement: Option<&'a String>, is_believed: bool) -> Self {
        let said = disagreement.map(String::as_str);
        let (doubt, differing) = if is_believed { (None, said) } else { (said, None) };
        Self { doubt, differing, ..self }
    }

    /// Creates a frame without warnings, next steps, pipelines, data and findings; its files are those of a
    /// run's folder.
    pub(crate) fn bare(texts: &RunTexts<'a>, kicker: &'static str, verdict: Verdict, origin: Origin) -> Self {
        Self {
            hues: &Hue::ALL,
            name: texts.name,
            kicker,
            verdict,
            origin,
            doubt: None,
            differing: None,
            warnings: Vec::new(),
            next: Vec::new(),
            pipelines: Vec::new(),
            data: Vec::new(),
            findings: Vec::new(),
            files: [
                ("Resolved configuration (config.toml)", texts.config),
                ("Environment (environment.json)", texts.environment),
                ("Every number, unrounded (result.json)", texts.result),
            ],
        }
    }

    pub(crate) fn new(
        texts: &RunTexts<'a>,
        kicker: &'static str,
        verdict: Verdict,
        data: &'a DataSummary,
        oracle: &OracleSummary,
        pipelines: &'a [PipelineRow],
    ) -> Self {
        Self {
            warnings: remarks::warnings(oracle),
            pipelines: tables::pipelines(pipelines),
            data: tables::data(data),
            findings: remarks::noticed(data),
            ..Self::bare(texts, kicker, verdict, verdict::origin(data.origin))
        }
    }
}

impl Frame<'_> {
    pub(crate) fn policy(&self) -> String {
        scripts::policy()
    }

    pub(crate) fn plot_style(&self) -> &'static str {
        scripts::STYLE
    }

    pub(crate) fn scripts(&self) -> [&'static str; 2] {
        scripts::SCRIPTS
    }
}

/// Renders the page of a template, with its table of contents at the top and its glossary at the end.
pub(crate) fn finish(page: &impl Template) -> Result<String, ReportError> {
    let html = glossary::explained(&page.render()?, "<!-- terms -->");
    let contents = contents(&html);
    Ok(html.replacen("<!-- contents -->\n", &contents, 1))
}

/// Returns links to the sections: all second-level headings with an id. Texts from files are escaped, so they
/// cannot look like one. Empty for a page of few sections.
fn contents(html: &str) -> String {
    const FEWEST: usize = 3;
    let headings: Vec<(&str, &str)> = html
        .split("<h2 id=\"")
        .skip(1)
        .filter_map(|rest| {
            let (id, rest) = rest.split_once("\">")?;
            Some((id, rest.split_once("</h2>")?.0))
        })
        .collect();
    if headings.len() < FEWEST {
        return String::new();
    }
    let items: String =
        headings.iter().map(|(id, title)| format!("<li><a href=\"#{id}\">{title}</a></li>\n")).collect();
    format!("<nav class=\"contents\" aria-label=\"Contents\">\n<p>Contents</p>\n<ul>\n{items}</ul>\n</nav>\n")
}

#[cfg(test)]
mod tests {
    use super::contents;

    #[test]
    fn every_section_is_in_the_contents_of_a_long_page() {
        let section =
            |id: &str| format!("<section><h2 id=\"{id}\">On {id}</h2><h3 id=\"x\">no</h3></section>");
        let page: String = ["a", "b", "c"].map(section).concat();
        let found = contents(&page);
        assert_eq!(found.matches("<li>").count(), 3);
        assert!(found.contains("<a href=\"#b\">On b</a>"));
        assert!(contents(&section("a")).is_empty());
    }
}
