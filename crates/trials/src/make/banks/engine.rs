//! Cases from records of a physics engine.

use crate::make::case::Case;
use crate::make::error::TrialError;
use crate::make::job::Job;
use crate::make::plan::TrialPlan;
use crate::{Bank, HIDDEN_SCHEMA, Hidden};
use record::{ReadOptions, read_file};
use simulator::{csv_text, nominal_text};

/// Makes a case of the bank. Its files are rewritten, so that their number format reveals nothing.
pub(crate) fn make(plan: &TrialPlan, job: Job, id: String) -> Result<Case, TrialError> {
    let Some(case) = plan.engine.get(job.number) else {
        return Err(TrialError::NoSuchCase { index: job.number, cases: plan.engine.len() });
    };
    let written = |path| {
        let (record, _) = read_file(path, &ReadOptions::default())?;
        Ok(csv_text(&record, plan.sampling.stamp_decimals, plan.sampling.value_decimals))
    };
    let records = case.records()?.iter().map(|path| written(path)).collect::<Result<_, TrialError>>()?;
    let nominal = case.nominal()?;
    let mut hidden: Hidden =
        serde_json::from_str(&case.text(&case.truth)?).map_err(|error| TrialError::Outside {
            path: case.truth.display().to_string(),
            problem: error.to_string(),
            remedy: "write a hidden truth (ringdown.trial/1)",
        })?;
    if hidden.schema != HIDDEN_SCHEMA {
        return Err(TrialError::Outside {
            path: case.truth.display().to_string(),
            problem: format!("its schema is {}", hidden.schema),
            remedy: "make the records again with this version's script",
        });
    }
    hidden.bank = Bank::Engine;
    Ok(Case { id, without: hidden.without.clone(), records, nominal: nominal_text(&nominal), hidden })
}
