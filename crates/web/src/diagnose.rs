//! The diagnosis of the dropped logs.

use crate::host::{Answered, Host};
use crate::reading::reading;
use diagnosis::{Settings, Stage};
use report::{Reader, RunTexts};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use workflow::{Log, Question, after, nominal};

/// Request for a diagnosis.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DiagnoseRequest {
    /// Options of the form.
    reading: Map<String, Value>,
    /// Name of the nominal simulator's file.
    nominal_name: String,
    /// Text of the nominal simulator.
    nominal: String,
    /// Name of the report.
    name: String,
}

/// Diagnoses the logs as records of one system. The answer has the files that the program would write.
pub(crate) fn diagnose(logs: &[Log], request: &DiagnoseRequest, host: &dyn Host) -> Answered {
    let reading = reading(&request.reading)?;
    let said = |error: workflow::WorkflowError| error.to_string();
    host.stage(after(None));
    let stated = nominal::parse(&request.nominal_name, &request.nominal).map_err(said)?;
    let question = Question::of_logs(logs, stated, request.nominal_name.clone(), &reading).map_err(said)?;
    let goes_on = |done: Stage| {
        host.stage(after(Some(done)));
        true
    };
    let answer =
        question.answer_timed(&Settings::default(), 0, &|| host.seconds(), &goes_on).map_err(said)?;
    let environment = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "profile": "web",
        "system": "a browser, wasm32",
        "threads": 1,
        "data_digest": question.digests(),
    });
    let environment = format!("{environment:#}\n");
    let mut files = answer.files().map_err(|error| error.to_string())?;
    files.push(("nominal.toml", export::nominal_text(&question.stated.simulator)));
    let text = |name: &str| files.iter().find(|(own, _)| *own == name).map_or("", |(_, text)| text.as_str());
    let texts = RunTexts {
        name: &request.name,
        config: text("repaired.toml"),
        result: text("diagnosis.json"),
        series: text("series.csv"),
        environment: &environment,
        reader: Reader::Page,
        ..RunTexts::default()
    };
    let page = report::render_diagnosis(&texts).map_err(|error| error.to_string())?;
    files.push(("environment.json", environment));
    files.push(("report.html", page));
    let files: Vec<Value> =
        files.into_iter().map(|(name, text)| json!({ "name": name, "text": text })).collect();
    Ok(json!({
        "summary": answer.result.verdict.summary,
        "seconds": answer.result.seconds,
        "files": files,
    }))
}
