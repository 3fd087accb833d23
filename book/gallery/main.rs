//! Writes the book's gallery of effects from the registry: what each adds, how it shows, and a plot.
//!
//!     cargo run -p ringdown-lab --example gallery -- --write
//!
//! Without `--write`, as `cargo test` runs it, the pages that are there are compared with what the registry says now.

#![allow(clippy::print_stdout, reason = "a program of its own, which says what it did")]

mod pages;
mod plot;
mod shown;

use ringdown_lab::Error;
use std::path::Path;

/// Where the pages are.
const PAGES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../book/src/effects");

fn main() -> Result<(), Error> {
    let writes = std::env::args().any(|argument| argument == "--write");
    let mut outdated = Vec::new();
    for (name, text) in pages::pages()? {
        let path = Path::new(PAGES).join(&name);
        if writes {
            runs::write_file(&path, text.as_bytes())?;
        } else if std::fs::read_to_string(&path).ok().as_ref() != Some(&text) {
            outdated.push(name);
        }
    }
    if outdated.is_empty() {
        println!(
            "the gallery of effects {}",
            if writes { "is written" } else { "is what the registry says" }
        );
        return Ok(());
    }
    Err(Error::Config(format!(
        "the gallery of effects differs from the registry in {}; write it again with `cargo run -p ringdown-lab --example \
         gallery -- --write`",
        outdated.join(", ")
    )))
}
