//! User interface on the terminal: output, progress, interruption.

pub(crate) mod console;
pub(crate) mod interrupt;
pub(crate) mod progress;
pub(crate) mod quit;
pub(crate) mod table;
pub(crate) mod wrap;
