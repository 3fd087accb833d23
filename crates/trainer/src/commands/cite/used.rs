//! Methods and effects that a finished run used, read from its folder.

use crate::error::TrainerError;
use serde_json::Value;
use std::path::Path;

/// Names of the estimators and effects used.
#[derive(Debug, Default)]
pub(super) struct Used {
    pub(super) estimators: Vec<String>,
    pub(super) effects: Vec<String>,
    /// `true` if a gap was diagnosed.
    pub(super) diagnosis: bool,
}

impl Used {
    /// Adds the methods and effects used by the run in a folder.
    pub(super) fn add(&mut self, run: &Path) -> Result<(), TrainerError> {
        let refused = |problem: String| TrainerError::NoRun { folder: run.display().to_string(), problem };
        let result = ["result.json", "diagnosis.json"].into_iter().find(|name| run.join(name).exists());
        let name =
            result.ok_or_else(|| refused("neither result.json nor diagnosis.json is there".to_owned()))?;
        let text = std::fs::read_to_string(run.join(name)).map_err(|error| refused(error.to_string()))?;
        let result: Value =
            serde_json::from_str(&text).map_err(|error| refused(format!("{name}: {error}")))?;
        let schema = result.get("schema").and_then(Value::as_str).unwrap_or_default();
        let task = result.get("task").and_then(Value::as_str).unwrap_or_default();
        match (schema.split('/').next().unwrap_or_default(), task) {
            ("ringdown.diagnosis", _) => {
                self.diagnosis = true;
                let effects = result.pointer("/verdict/effects").and_then(Value::as_array);
                self.effects.extend(effects.into_iter().flatten().filter_map(text_of));
            }
            ("ringdown.trials", _) => {
                self.diagnosis = true;
                self.effects.extend(dynamics::REGISTRY.iter().map(|effect| effect.id().to_owned()));
            }
            (_, "estimate") => self.estimators.extend(result.get("estimator").and_then(text_of)),
            (_, "compare") => self.estimators.extend(ids(result.get("results"))),
            (_, "predict") => {
                for problem in result.get("problems").and_then(Value::as_array).into_iter().flatten() {
                    for id in ids(problem.pointer("/outcome/studied/methods")) {
                        if !self.estimators.contains(&id) {
                            self.estimators.push(id);
                        }
                    }
                }
            }
            // A learner of dynamics is not an estimator; the registry of learners names its works.
            (_, "learn") => {}
            (_, "simulate") => self.effects.extend(ids(result.get("effects"))),
            _ => return Err(refused(format!("{name} is of no task that is known here"))),
        }
        Ok(())
    }
}

fn text_of(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

/// Returns the `id` of every row of a list.
fn ids(rows: Option<&Value>) -> Vec<String> {
    let rows = rows.and_then(Value::as_array).into_iter().flatten();
    rows.filter_map(|row| row.get("id").and_then(text_of)).collect()
}
