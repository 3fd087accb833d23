//! Errors of resuming and verifying runs.

use thiserror::Error;

/// Reason why a run cannot be resumed or verified.
#[derive(Debug, Error)]
pub(crate) enum ResumeError {
    #[error(
        "{folder}: there is no run in it to resume or to run again: its events.jsonl does not state how a \
         run started; name the folder of a run"
    )]
    NoRun { folder: String },
    #[error(
        "{folder}: was made by `trainer {command}`, which cannot be repeated from its folder alone; `trainer {command} … --out {folder} \
         --resume` checks that it answers the same question"
    )]
    OfAnotherCommand { folder: String, command: &'static str },
    #[error(
        "{file}: has been changed since the run began: its digest is not that in events.jsonl; restore it, \
         or start again in another folder"
    )]
    ConfigTouched { file: String },
    #[error(
        "{folder}: this run was started with other settings: {differences}; resume with those it was started with \
         (`trainer {folder}/config.toml --out {folder} --resume`), or name another folder with --out"
    )]
    OtherConfig { folder: String, differences: String },
    #[error(
        "{folder}: this run was started by version {begun} of the program; this is {version}, whose digits may differ. \
         Resume with the version that started it, or start again in another folder"
    )]
    OtherVersion { folder: String, begun: String, version: &'static str },
    #[error(
        "{file}: the record is not the one that the run was made with: expected the digest {expected}, found {found}; put the \
         old record back, or start again in another folder"
    )]
    OtherData { file: String, expected: String, found: String },
    #[error(
        "{file}: the record that the run was made with is not there; a relative path starts from the folder in which the \
         program runs: change to the folder in which the run was made, or put the record back"
    )]
    NoData { file: String },
    #[error("{file}: the checkpoint belongs to another run; remove it and resume")]
    ForeignCheckpoint { file: String },
    #[error("{folder}: this run is not finished, so there is nothing to verify; finish it with --resume")]
    Unfinished { folder: String },
}
