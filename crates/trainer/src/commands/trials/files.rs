//! Names of the files of trials, and their texts.

use crate::error::TrialsError;
use runs::RunFolder;

/// Start of the names of groups for which the diagnosis excludes an effect.
pub(crate) const WITHOUT: &str = "without-";

/// Name of the manifest in the folder.
pub(crate) const MANIFEST: &str = "manifest.json";

/// Name of the group for which the diagnosis considers every effect.
pub(crate) const FULL: &str = "full";

/// Folder of the truths.
pub(crate) const TRUTHS: &str = "truth";

/// Name of the file with an answer.
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

/// Name of the file with the messages of cases without an answer.
pub(crate) const FAILED: &str = "failed.json";

/// Reads a text file of the trials.
pub(crate) fn text(folder: &RunFolder, name: &str) -> Result<String, TrialsError> {
    let path = folder.path().join(name);
    std::fs::read_to_string(&path).map_err(|error| TrialsError::Unreadable {
        file: path.display().to_string(),
        problem: error.to_string(),
    })
}
