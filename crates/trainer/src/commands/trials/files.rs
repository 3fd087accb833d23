//! Names of the files of trials, and their texts.

use crate::error::TrialsError;
use runs::RunFolder;

/// Begins the name of the groups that it is told to leave an effect out for.
pub(crate) const WITHOUT: &str = "without-";

/// Name of the manifest in the folder.
pub(crate) const MANIFEST: &str = "manifest.json";

/// The group of cases that the diagnosis considers every effect for.
pub(crate) const FULL: &str = "full";

/// Folder of the truths.
pub(crate) const TRUTHS: &str = "truth";

/// The file of an answer.
pub(crate) const ANSWER: &str = "diagnosis.json";

pub(crate) fn truth_name(id: &str) -> String {
    format!("{TRUTHS}/{id}.json")
}

pub(crate) fn case_name(group: &str, id: &str, file: &str) -> String {
    format!("cases/{group}/{id}/{file}")
}

pub(crate) fn answer_name(group: &str, id: &str) -> String {
    format!("answers/{group}/{id}/{ANSWER}")
}

/// The file of what was said of cases without an answer.
pub(crate) const FAILED: &str = "failed.json";

/// The text of a file of the trials.
pub(crate) fn text(folder: &RunFolder, name: &str) -> Result<String, TrialsError> {
    let path = folder.path().join(name);
    std::fs::read_to_string(&path).map_err(|error| TrialsError::Unreadable {
        file: path.display().to_string(),
        problem: error.to_string(),
    })
}
