//! Stated parts of a learning problem: ranges of rows that train, validate and test, as benchmarks publish them.

use serde::Deserialize;
use settings::{Default, Document, Field, Kind, Resolved, SettingsError};

/// Use of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PartUse {
    /// Models are fitted to it.
    Training,
    /// It chooses among models.
    Validation,
    /// It scores models.
    Test,
}

/// Section `problem.NAME.part.PART`: a range of rows of a file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct StatedPart {
    /// The PART.
    #[serde(default)]
    pub id: String,
    /// Use of the part.
    #[serde(rename = "use")]
    pub usage: PartUse,
    /// Name of the file in the problem's folder.
    pub file: String,
    /// First row, counted from 0.
    pub from_row: usize,
    /// Row after the last one; `None` for the end of the file.
    pub to_row: Option<usize>,
    /// Name of the observed column, in place of the problem's.
    pub value: Option<String>,
    /// Name of the input's column, in place of the problem's.
    pub input: Option<String>,
    /// Errors that others published for this part, as "NAME = ERROR".
    pub published: Vec<String>,
}

/// Error of a method that others published, in the unit of the positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Published {
    /// Name of the method, with its source.
    pub name: String,
    /// Root mean square error of the free run.
    pub error: f64,
}

impl StatedPart {
    /// Returns the published errors of the part.
    #[must_use]
    pub fn published(&self) -> Vec<Published> {
        self.published.iter().filter_map(|text| published(text)).collect()
    }
}

fn published(text: &str) -> Option<Published> {
    let (name, error) = text.rsplit_once('=')?;
    let error: f64 = error.trim().parse().ok()?;
    (error.is_finite() && error > 0.0).then(|| Published { name: name.trim().to_owned(), error })
}

/// Keys of a part.
pub(crate) const PART: &[Field] = &[
    Field::new("use", Kind::Choice(&["training", "validation", "test"]), Default::Required)
        .meaning("What the part is for: models are fitted to it, it chooses among them, or it scores them."),
    Field::new("file", Kind::Text, Default::Required)
        .meaning("Name of the record file in the problem's folder."),
    Field::new("from_row", Kind::Integer { min: 0, max: i64::MAX }, Default::Integer(0))
        .meaning("First row of the part, counted from 0."),
    Field::new("to_row", Kind::Integer { min: 1, max: i64::MAX }, Default::Absent)
        .meaning("The row after its last one; left open, the end of the file."),
    Field::new("value", Kind::Text, Default::Absent)
        .meaning("The observed column, where it differs from the problem's."),
    Field::new("input", Kind::Text, Default::Absent)
        .meaning("The input's column, where it differs from the problem's."),
    Field::new("published", Kind::Texts { at_least: 0, at_most: 100 }, Default::Texts(&[])).meaning(
        "Errors that others published for a test part, as \"NAME = ERROR\" in the unit of the positions; shown \
                beside the learners' own.",
    ),
];

/// Returns the dotted names of a problem's parts, in the order of the document.
pub(crate) fn sections(document: &Document, problem: &str) -> Vec<String> {
    let prefix = format!("{problem}.part");
    document.tables_below(&prefix).into_iter().map(|part| format!("{prefix}.{part}")).collect()
}

/// Reads the parts of a problem.
///
/// # Errors
/// [`SettingsError::BadValue`] for a published error of another form.
pub(crate) fn read(
    document: &Document,
    resolved: &Resolved,
    problem: &str,
) -> Result<Vec<StatedPart>, SettingsError> {
    let one = |section: String| {
        let part: StatedPart = resolved.section(&section)?;
        if let Some(wrong) = part.published.iter().find(|text| published(text).is_none()) {
            let setting = resolved.setting(&format!("{section}.published"))?;
            return Err(SettingsError::BadValue {
                origin: setting.origin.clone(),
                key: setting.key(),
                found: format!("\"{wrong}\""),
                expected: "\"NAME = ERROR\" with a positive number, such as \"SUBNET = 3.6e-4\"".to_owned(),
                unit: String::new(),
            });
        }
        let id = section.rsplit('.').next().unwrap_or(&section).to_owned();
        Ok(StatedPart { id, ..part })
    };
    sections(document, problem).into_iter().map(one).collect()
}
