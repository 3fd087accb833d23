//! Scripts of a page: uPlot, and the scripts that connect plots, buttons and tables to it.
//!
//! The scripts are part of the page, and its content security policy names each by its digest: no other
//! script in a page could run.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

/// Texts of the scripts, in the order in which they run.
pub(crate) const SCRIPTS: [&str; 2] = [
    include_str!("../assets/uPlot.iife.min.js"),
    concat!(
        include_str!("../assets/plots.js"),
        include_str!("../assets/save.js"),
        include_str!("../assets/tables.js")
    ),
];

/// Style sheet of uPlot.
pub(crate) const STYLE: &str = include_str!("../assets/uPlot.min.css");

/// Returns the script sources that the content security policy of a page allows.
#[must_use]
pub fn policy() -> String {
    let source = |script: &&str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(script.as_bytes())));
    SCRIPTS.iter().map(source).collect::<Vec<_>>().join(" ")
}

/// Returns a page without its scripts, after checking them to the byte that the policy names.
#[cfg(test)]
pub(crate) fn stripped(html: &str) -> String {
    assert!(html.contains(&format!("script-src {}\"", policy())));
    let mut rest = html.to_owned();
    for script in SCRIPTS {
        let element = format!("<script>{script}</script>");
        assert!(rest.contains(&element));
        rest = rest.replace(&element, "");
    }
    rest.replace("<script type=\"application/json\"", "").replace("http://www.w3.org/2000/svg", "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uplot_is_the_one_that_the_note_names() {
        let note = include_str!("../assets/README.md");
        for text in [SCRIPTS[0], STYLE] {
            let digest: String =
                Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect();
            assert!(note.contains(&digest), "{digest}");
        }
    }

    #[test]
    fn no_script_ends_its_element_early() {
        assert!(SCRIPTS.iter().all(|script| !script.contains("</script") && !script.contains("<!--")));
    }
}
