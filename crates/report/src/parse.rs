//! Parsing of the texts of a run folder into typed values.

use results::{
    ComparisonResult, DIAGNOSIS_SCHEMA, DiagnosisResult, EnvelopeRow, EstimationResult, FLEET_SCHEMA,
    FleetResult, JOINTS_SCHEMA, JointsResult, LearnResult, LearnSeriesRow, LearnTorqueRow, LearnTraceRow,
    PredictionCsvRow, PredictionResult, RESULT_SCHEMA, RIGS_SCHEMA, RigsResult, RunTable, SeriesRow,
    TRIALS_SCHEMA, TraceRow, TrialsResult,
};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::{ReportError, RunTexts};

/// Parsed content of the folder of an estimation.
pub(crate) struct Run {
    pub(crate) result: EstimationResult,
    /// Empty if the method takes no steps.
    pub(crate) trace: Vec<TraceRow>,
    pub(crate) envelope: Vec<EnvelopeRow>,
}

/// Parsed content of the folder of a comparison.
pub(crate) struct Comparison {
    pub(crate) result: ComparisonResult,
    pub(crate) envelope: Vec<EnvelopeRow>,
}

/// Parsed content of the folder of a study of held-out prediction.
pub(crate) struct Prediction {
    pub(crate) result: PredictionResult,
    pub(crate) rows: Vec<PredictionCsvRow>,
}

/// Parsed content of the folder of a diagnosis.
pub(crate) struct Diagnosis {
    pub(crate) result: DiagnosisResult,
    pub(crate) series: Vec<SeriesRow>,
}

/// Parsed content of the folder of a learning study.
pub(crate) struct Learning {
    pub(crate) result: LearnResult,
    pub(crate) runs: Vec<LearnSeriesRow>,
    pub(crate) torques: Vec<LearnTorqueRow>,
    pub(crate) trace: Vec<LearnTraceRow>,
}

/// Task of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Task {
    Estimate,
    Compare,
    Learn,
    Predict,
    Diagnose,
    /// A diagnosis of a robot's joints.
    Joints,
    /// A joint diagnosis of several rigs of one build.
    Rigs,
    /// A fleet: the diagnoses of a batch.
    Fleet,
    Trials,
    /// A table of runs: `"sweep"` or `"runs"`.
    Table,
}

impl Task {
    /// Returns the name used in the field `task`.
    fn name(self) -> &'static str {
        match self {
            Self::Estimate => "estimate",
            Self::Compare => "compare",
            Self::Learn => "learn",
            Self::Predict => "predict",
            Self::Diagnose => "diagnose",
            Self::Joints => "joints",
            Self::Rigs => "rigs",
            Self::Fleet => "fleet",
            Self::Trials => "trials",
            Self::Table => "sweep",
        }
    }
}

/// Fields of every schema.
#[derive(Deserialize)]
struct Tag {
    schema: String,
    /// Only read if the schema is one of this program's.
    #[serde(default)]
    task: String,
}

pub(crate) fn parse(texts: &RunTexts<'_>) -> Result<Run, ReportError> {
    Ok(Run {
        envelope: envelope(texts.envelope)?,
        result: result(texts.result, Task::Estimate)?,
        // A trace without rows is valid: a closed-form method takes no steps.
        trace: table("trace.csv", texts.trace)?,
    })
}

pub(crate) fn parse_comparison(texts: &RunTexts<'_>) -> Result<Comparison, ReportError> {
    Ok(Comparison { envelope: envelope(texts.envelope)?, result: comparison_result(texts.result)? })
}

pub(crate) fn comparison_result(text: &str) -> Result<ComparisonResult, ReportError> {
    result(text, Task::Compare)
}

pub(crate) fn parse_prediction(texts: &RunTexts<'_>) -> Result<Prediction, ReportError> {
    // A table without rows is valid: perhaps no method predicted anything.
    Ok(Prediction {
        result: prediction_result(texts.result)?,
        rows: table("predictions.csv", texts.predictions)?,
    })
}

pub(crate) fn parse_learning(texts: &RunTexts<'_>) -> Result<Learning, ReportError> {
    // Tables without rows are valid: perhaps no method learned anything.
    Ok(Learning {
        result: result(texts.result, Task::Learn)?,
        runs: table("predictions.csv", texts.predictions)?,
        torques: table("series.csv", texts.series)?,
        trace: table("trace.csv", texts.trace)?,
    })
}

pub(crate) fn prediction_result(text: &str) -> Result<PredictionResult, ReportError> {
    result(text, Task::Predict)
}

pub(crate) fn parse_diagnosis(texts: &RunTexts<'_>) -> Result<Diagnosis, ReportError> {
    Ok(Diagnosis {
        result: result(texts.result, Task::Diagnose)?,
        // Without its series, a diagnosis has fewer plots.
        series: table("series.csv", texts.series)?,
    })
}

pub(crate) fn run_table(text: &str) -> Result<RunTable, ReportError> {
    result(text, Task::Table)
}

pub(crate) fn joints_result(text: &str) -> Result<JointsResult, ReportError> {
    result(text, Task::Joints)
}

pub(crate) fn rigs_result(text: &str) -> Result<RigsResult, ReportError> {
    result(text, Task::Rigs)
}

pub(crate) fn fleet_result(text: &str) -> Result<FleetResult, ReportError> {
    result(text, Task::Fleet)
}

pub(crate) fn trials_result(text: &str) -> Result<TrialsResult, ReportError> {
    result(text, Task::Trials)
}

fn envelope(text: &str) -> Result<Vec<EnvelopeRow>, ReportError> {
    let rows: Vec<EnvelopeRow> = table("envelope.csv", text)?;
    if rows.is_empty() { Err(ReportError::Empty { file: "envelope.csv" }) } else { Ok(rows) }
}

fn result<Content: DeserializeOwned>(text: &str, expected: Task) -> Result<Content, ReportError> {
    let found = task(text)?;
    if found != expected {
        return Err(ReportError::Task {
            expected: format!("\"{}\"", expected.name()),
            found: found.name().to_owned(),
        });
    }
    serde_json::from_str(text).map_err(json_error)
}

/// Returns the task of the run, from its `result.json`.
pub(crate) fn task(text: &str) -> Result<Task, ReportError> {
    if text.trim().is_empty() {
        return Err(ReportError::Empty { file: "result.json" });
    }
    // The tag is read first, so that a result of another schema is reported as such, and not by the first
    // field that it happens to lack.
    let tag: Tag = serde_json::from_str(text).map_err(json_error)?;
    if tag.schema == DIAGNOSIS_SCHEMA {
        return Ok(Task::Diagnose);
    }
    if tag.schema == JOINTS_SCHEMA {
        return Ok(Task::Joints);
    }
    if tag.schema == RIGS_SCHEMA {
        return Ok(Task::Rigs);
    }
    if tag.schema == FLEET_SCHEMA {
        return Ok(Task::Fleet);
    }
    if tag.schema == TRIALS_SCHEMA {
        return Ok(Task::Trials);
    }
    if tag.schema != RESULT_SCHEMA {
        return Err(ReportError::Schema { expected: RESULT_SCHEMA, found: tag.schema });
    }
    if tag.task == "runs" {
        return Ok(Task::Table);
    }
    [Task::Estimate, Task::Compare, Task::Learn, Task::Predict, Task::Table]
        .into_iter()
        .find(|task| task.name() == tag.task)
        .ok_or_else(|| ReportError::Task {
            expected: "\"estimate\", \"sweep\", \"runs\", \"compare\", \"learn\" or \"predict\"".to_owned(),
            found: tag.task,
        })
}

fn json_error(error: serde_json::Error) -> ReportError {
    let full = error.to_string();
    let suffix = format!(" at line {} column {}", error.line(), error.column());
    ReportError::Json {
        line: error.line(),
        column: error.column(),
        reason: full.strip_suffix(&suffix).unwrap_or(&full).to_owned(),
    }
}

fn table<Row: DeserializeOwned>(file: &'static str, text: &str) -> Result<Vec<Row>, ReportError> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let headers = reader.headers().cloned().unwrap_or_default();
    reader.deserialize().map(|row| row.map_err(|error| table_error(file, &headers, &error))).collect()
}

fn table_error(file: &'static str, headers: &csv::StringRecord, error: &csv::Error) -> ReportError {
    let line = error.position().map(csv::Position::line);
    let (column, reason) = match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => (
            err.field().and_then(|field| usize::try_from(field).ok()).and_then(|field| headers.get(field)),
            err.kind().to_string(),
        ),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            (None, format!("the row has {len} fields, the header {expected_len}"))
        }
        _ => (None, error.to_string()),
    };
    let place = match (line, column) {
        (Some(line), Some(column)) => format!("line {line}, column `{column}`"),
        (Some(line), None) => format!("line {line}"),
        _ => "somewhere".to_owned(),
    };
    ReportError::Table { file, place, reason }
}

#[cfg(test)]
mod tests {
    use crate::ReportError;
    use crate::sample::Sample;

    fn message(change: impl FnOnce(&mut Sample)) -> String {
        let mut sample = Sample::new();
        change(&mut sample);
        sample.render().unwrap_err().to_string()
    }

    #[test]
    fn a_missing_result_is_named() {
        assert_eq!(
            message(|s| s.result_text = Some(String::new())),
            "result.json is missing or empty: the run may have ended before it was written; run \
             the experiment again, or report on another run folder"
        );
    }

    #[test]
    fn a_missing_envelope_is_named() {
        assert!(message(|s| s.envelope_text = Some("\n".into())).starts_with("envelope.csv is missing"));
        assert!(
            message(|s| s.envelope_text = Some("time_s,log_amplitude,oracle,estimate\n".into()))
                .starts_with("envelope.csv is missing or empty")
        );
    }

    #[test]
    fn garbled_json_is_located() {
        let text = message(|s| s.result_text = Some("{\n  \"schema\": oops\n}".into()));
        assert!(text.starts_with("result.json, line 2, column 13: expected value; "), "{text}");
    }

    #[test]
    fn a_missing_field_is_named() {
        let text = message(|s| {
            s.result_text = Some(s.json().replace("\"tolerance_percent\"", "\"tolerance\""));
        });
        assert!(text.contains("missing field `tolerance_percent`"), "{text}");
    }

    #[test]
    fn a_number_that_was_not_finite_is_explained() {
        let text = message(|s| s.result.oracle.decay_rate = f64::NAN);
        assert!(text.contains("invalid type: null, expected f64"), "{text}");
        assert!(text.contains("not finite"), "{text}");
    }

    #[test]
    fn an_error_without_a_finite_value_is_no_obstacle() {
        let mut sample = Sample::new();
        sample.result.error_percent = f64::INFINITY;
        let page = crate::glossary::unexplained(&sample.render().unwrap());
        assert!(page.contains("cannot be compared with closed-form least squares"));
    }

    #[test]
    fn another_schema_is_named_before_any_field() {
        assert_eq!(
            message(|s| s.result_text = Some("{\"schema\": \"ringdown.result/9\"}".into())),
            "result.json, field `schema`: this program reads \"ringdown.result/1\", the file says \
             \"ringdown.result/9\"; make the report with the program that made the run"
        );
    }

    #[test]
    fn another_task_is_named() {
        let mut sample = Sample::new();
        sample.result.task = "dream".into();
        let text = sample.render().unwrap_err().to_string();
        assert!(text.starts_with("result.json, field `task`: this report reads \"estimate\", "), "{text}");
        assert!(text.contains("\"compare\", \"learn\" or \"predict\", the file says \"dream\""), "{text}");
        sample.result.task = "compare".into();
        let text = sample.render().unwrap_err().to_string();
        assert!(text.contains("reads \"estimate\", the file says \"compare\""), "{text}");
    }

    #[test]
    fn a_garbled_table_is_located() {
        let text = message(|s| {
            s.trace_text = Some("step,phase,loss,decay_rate\n0,a,1.0,0.1\n1,a,one,0.1\n".into());
        });
        assert!(text.starts_with("trace.csv, line 3, column `loss`: invalid float literal; "), "{text}");
        let text = message(|s| {
            s.envelope_text = Some("time_s,log_amplitude,oracle,estimate\n0,1,2\n".into());
        });
        assert!(text.starts_with("envelope.csv, line 2: the row has 3 fields, the header 4; "), "{text}");
    }

    #[test]
    fn a_table_without_a_column_is_located() {
        let text = message(|s| s.trace_text = Some("step,phase,loss\n0,a,1.0\n".into()));
        assert!(text.contains("trace.csv, line 2: missing field `decay_rate`"), "{text}");
    }

    #[test]
    fn errors_are_of_their_kind() {
        let mut sample = Sample::new();
        sample.result_text = Some("[]".into());
        assert!(matches!(sample.render(), Err(ReportError::Json { .. })));
    }
}
