//! Errors of `trainer new`.

use thiserror::Error;

/// Reason why no skeleton was written, with its remedy.
#[derive(Debug, Error)]
pub(crate) enum NewError {
    #[error(
        "`{name}` is not an identifier; expected lowercase letters, digits and hyphens, each word beginning with a letter, as in \
         `echo-state`, and not a reserved word of Rust"
    )]
    Name { name: String },
    #[error("there is {what} `{name}` already, or a file of its name; choose another name")]
    Taken { what: &'static str, name: String },
    #[error(
        "{folder} is not in a checkout of Ringdown, to which the skeleton is added; change into one, or \
         name it with --workspace DIR"
    )]
    NoCheckout { folder: String },
    #[error("{folder}: cannot be created: {reason}")]
    NoFolder { folder: String, reason: String },
    #[error("{file}: cannot be read: {reason}")]
    Unreadable { file: String, reason: String },
    #[error(
        "{file}: the registry does not have the form that this version of trainer expects; add the module and its ENTRY by hand"
    )]
    Registry { file: String },
}
