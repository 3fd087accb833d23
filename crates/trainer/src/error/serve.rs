//! Errors of `trainer serve`.

use thiserror::Error;

/// Reason why the page is not offered, with its remedy.
#[derive(Debug, Error)]
pub(crate) enum ServeError {
    #[error(
        "{folder}: the page is not built there: ringdown.wasm is missing; run crates/web/build in a checkout, or name its \
         folder with --page DIR"
    )]
    NotBuilt { folder: String },
    #[error(
        "port {port} of 127.0.0.1 cannot be opened: {problem}; choose another with --port N, or leave --port out"
    )]
    Port { port: u16, problem: String },
}
