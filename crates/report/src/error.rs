//! What can go wrong between the texts of a run folder and its report.

/// Why no report could be made: which file, where in it, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file that the report cannot do without is missing or empty.
    #[error(
        "{file} is missing or empty: the run may have ended before it was written; run the \
         experiment again, or report on another run folder"
    )]
    Empty {
        /// Name of the file in the run folder.
        file: &'static str,
    },
    /// The result is not JSON, or lacks a field, or has one of another type.
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
        /// What was found there, naming the field where one is missing.
        reason: String,
    },
    /// The result was written to another schema than this program reads.
    #[error(
        "result.json, field `schema`: this program reads \"{expected}\", the file says \
         \"{found}\"; make the report with the program that made the run"
    )]
    Schema {
        /// The schema this program reads.
        expected: &'static str,
        /// What the file says.
        found: String,
    },
    /// The run was asked for something that this report is not about.
    #[error(
        "result.json, field `task`: this report reads {expected}, the file says \"{found}\"; \
         report on a run of that kind, or make the report with the program that made the run"
    )]
    Task {
        /// The tasks that the report reads, in quotation marks.
        expected: String,
        /// What the file says.
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
        /// Line and, where known, column.
        place: String,
        /// What was found there.
        reason: String,
    },
    /// The page could not be put together. This is a defect of this program, not of the files.
    #[error("the page could not be put together, which is a defect of the report: {0}")]
    Page(#[from] askama::Error),
}
