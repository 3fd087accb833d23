//! Measure by which trials are judged: a number of a run's `result.json`, named by its dotted path.

use crate::error::SweepCommandError;
use experiment::sweep::SweptTask;
use results::{SweepLine, SweepSearch, SweepState};
use runs::SweepFolder;
use serde_json::Value;
use settings::nearest;

/// Returns the default measure of a task: never one of the test part.
pub(super) fn default_measure(task: SweptTask) -> &'static str {
    match task {
        SweptTask::Learn => "validation.over_noise",
        SweptTask::Compare => "max_error_percent",
        SweptTask::Estimate => "error_percent",
    }
}

/// Returns a warning that readers need with a measure.
pub(crate) fn warning(measure: &str) -> Option<String> {
    let is_test = measure.split('.').any(|part| part == "test");
    is_test.then(|| {
        format!(
            "The best trial was chosen on the test part ({measure}), so its error there is no longer an \
             error on unseen records: judge it on other records, or search by validation.over_noise."
        )
    })
}

/// Returns the measure of a result: `None` if the result has no number there, as after a training that
/// failed.
///
/// In a learning study, a path that does not start at the top is looked up in the rows of the learners. The
/// measure is then the mean over these rows, so that several data sets have equal weight. Each part of a path
/// is a key or, in a list, a position or an `id`.
///
/// # Errors
/// [`SweepCommandError::NoMeasure`] for a path that the result does not have.
pub(crate) fn measured(search: &SweepSearch, result: &Value) -> Result<Option<f64>, SweepCommandError> {
    let path = search.measure.as_str();
    if let Some(found) = walk(result, path) {
        return Ok(number(found));
    }
    let rows = result.get("results").and_then(Value::as_array).into_iter().flatten();
    let learners: Vec<&Value> =
        rows.filter(|row| row.get("kind").and_then(Value::as_str) == Some("learner")).collect();
    let found: Vec<&Value> = learners.iter().filter_map(|row| walk(row, path)).collect();
    if !found.is_empty() && found.len() == learners.len() {
        let sum: Option<f64> = found.iter().map(|value| number(value)).sum();
        return Ok(sum.map(|sum| sum / found.len() as f64));
    }
    let mut known = Vec::new();
    numbers(result, "", &mut known);
    learners.iter().for_each(|row| numbers(row, "", &mut known));
    known.sort();
    known.dedup();
    Err(SweepCommandError::NoMeasure {
        measure: path.to_owned(),
        nearest: nearest(path, &known).map_or_else(String::new, |near| format!(" (did you mean {near}?)")),
        known: known.into_iter().filter(|name| name.split('.').count() <= 2).collect::<Vec<_>>().join(", "),
    })
}

/// Returns a finite number; `true` counts as 1, so that `pass` can be a measure.
fn number(value: &Value) -> Option<f64> {
    value.as_f64().or_else(|| value.as_bool().map(f64::from)).filter(|number| number.is_finite())
}

/// Returns the value at a path. Any path below a `null` leads to that `null`, which counts as a missing
/// number.
fn walk<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.').try_fold(value, |value, part| match value {
        Value::Object(fields) => fields.get(part),
        Value::Array(entries) => {
            let named = |entry: &&Value| entry.get("id").and_then(Value::as_str) == Some(part);
            part.parse().ok().and_then(|at: usize| entries.get(at)).or_else(|| entries.iter().find(named))
        }
        Value::Null => Some(value),
        _ => None,
    })
}

/// Collects the paths of the numbers in an object; lists are skipped.
fn numbers(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (name, field) in fields {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                numbers(field, &path, found);
            }
        }
        Value::Number(_) | Value::Bool(_) => found.push(path.to_owned()),
        _ => (),
    }
}

/// Returns the measure of a run so far, including a run that was stopped on a rung; `None` for a failed run.
pub(crate) fn value_of(
    folder: &SweepFolder,
    search: &SweepSearch,
    line: &SweepLine,
) -> Result<Option<f64>, SweepCommandError> {
    let Some(run) = line.run.as_ref().filter(|_| line.state != SweepState::Failed) else { return Ok(None) };
    let text = std::fs::read_to_string(folder.path().join(run).join("result.json")).unwrap_or_default();
    match serde_json::from_str::<Value>(&text) {
        Ok(result) => measured(search, &result),
        Err(_) => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::{measured, warning};
    use results::SweepSearch;
    use serde_json::{Value, json};

    fn of(measure: &str, result: &Value) -> Result<Option<f64>, String> {
        let search = SweepSearch {
            sampler: results::SweepSampler::Random,
            trials: 1,
            batch: 1,
            seed: 0,
            measure: measure.to_owned(),
            maximize: false,
            halving: None,
        };
        measured(&search, result).map_err(|error| error.to_string())
    }

    #[test]
    fn a_measure_is_any_number_by_its_path() {
        let result = json!({ "error_percent": 0.5, "pass": true, "estimate": { "zeta": 0.01, "std_error": null },
                             "seeds": [{ "zeta": 1.0 }, { "zeta": 2.0 }] });
        assert_eq!(of("error_percent", &result), Ok(Some(0.5)));
        assert_eq!(of("pass", &result), Ok(Some(1.0)));
        assert_eq!(of("estimate.zeta", &result), Ok(Some(0.01)));
        assert_eq!(of("estimate.std_error", &result), Ok(None));
        assert_eq!(of("seeds.1.zeta", &result), Ok(Some(2.0)));
        let refused = of("eror_percent", &result).unwrap_err();
        assert!(
            refused.contains("did you mean error_percent") && refused.contains("estimate.zeta"),
            "{refused}"
        );
    }

    #[test]
    fn learners_are_averaged_over_their_data_sets_and_baselines_left_out() {
        let row = |id: &str, kind: &str, error: Value| json!({ "id": id, "kind": kind, "test": error.clone(), "validation": { "over_noise": error } });
        let result = json!({ "results": [row("lstm", "learner", json!(1.0)), row("arx", "baseline", json!(9.0)),
                                         row("lstm", "learner", json!(2.0))] });
        assert_eq!(of("validation.over_noise", &result), Ok(Some(1.5)));
        assert_eq!(of("results.arx.validation.over_noise", &result), Ok(Some(9.0)));
        let failed = json!({ "results": [{ "id": "lstm", "kind": "learner", "validation": null },
                                         row("lstm", "learner", json!(1.0))] });
        assert_eq!(of("validation.over_noise", &failed), Ok(None));
        assert!(warning("test.free_run_rmse").is_some() && warning("results.lstm.test.over_noise").is_some());
        assert!(warning("validation.over_noise").is_none());
    }
}
