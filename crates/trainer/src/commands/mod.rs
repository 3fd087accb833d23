//! Subcommands, each in a file or folder of its own; `run` is the one without a name.

pub(crate) mod check;
pub(crate) mod cite;
pub(crate) mod compare;
pub(crate) mod diagnose;
pub(crate) mod explain;
pub(crate) mod export;
pub(crate) mod init;
pub(crate) mod learn;
pub(crate) mod list;
pub(crate) mod manual;
pub(crate) mod new;
pub(crate) mod predict;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod schema;
pub(crate) mod serve;
pub(crate) mod simulate;
pub(crate) mod sweep;
pub(crate) mod trials;
pub(crate) mod verify;
