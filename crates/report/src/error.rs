//! Errors of making a report from the texts of a run folder.

/// Reason why no report could be made: the file, the place in it, and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A required file is missing or empty.
    #[error(
        "{file} is missing or empty: the run may have ended before it was written; run the \
         experiment again, or report on another run folder"
    )]
    Empty {
        /// Name of the file in the run folder.
        file: &'static str,
    },
    /// The result is not JSON, or a field is missing or has the wrong type.
    #[error(
        "result.json, line {line}, column {column}: {reason}; the file must be as the run left \
         it: restore it, or run the experiment again (a null where a number is expected stands \
         for a number that was not finite)"
    )]
    Json {
        /// Line, counted from 1.
        line: usize,
        /// Column, counted from 1.
        column: usize,
        /// The problem at that place; for a missing field, its name.
        reason: String,
    },
    /// The result has a different schema than this program reads.
    #[error(
        "result.json, field `schema`: this program reads \"{expected}\", the file says \
         \"{found}\"; make the report with the program that made the run"
    )]
    Schema {
        /// Schema that this program reads.
        expected: &'static str,
        /// Schema stated in the file.
        found: String,
    },
    /// The run has a task that this report does not cover.
    #[error(
        "result.json, field `task`: this report reads {expected}, the file says \"{found}\"; \
         report on a run of that kind, or make the report with the program that made the run"
    )]
    Task {
        /// Tasks that the report reads, in quotation marks.
        expected: String,
        /// Task stated in the file.
        found: String,
    },
    /// A table has a row that does not fit its columns.
    #[error(
        "{file}, {place}: {reason}; the table must be as the run left it: restore it, or run the \
         experiment again"
    )]
    Table {
        /// Name of the file in the run folder.
        file: &'static str,
        /// Line and, if known, column.
        place: String,
        /// The problem at that place.
        reason: String,
    },
    /// The page could not be rendered. This is a defect of this program, not of the files.
    #[error("the page could not be put together, which is a defect of the report: {0}")]
    Page(#[from] askama::Error),
}
