//! What a run was made with: versions, machine, digests.

use serde::Serialize;
use serde_json::Value;
use std::process::Command;
use std::sync::OnceLock;

/// The content of `environment.json`.
#[derive(Debug, Serialize)]
pub(crate) struct Environment {
    version: &'static str,
    profile: &'static str,
    libraries: Vec<Library>,
    git: Option<Git>,
    system: String,
    cpu: Option<String>,
    threads: usize,
    data_digest: String,
}

#[derive(Debug, Serialize)]
struct Library {
    name: &'static str,
    version: String,
}

#[derive(Debug, Clone, Serialize)]
struct Git {
    commit: String,
    dirty: bool,
}

const LOCK_FILE: &str = include_str!("../../../Cargo.lock");
const LIBRARIES: &[&str] = &["burn", "linfa-linear", "nalgebra", "ndarray", "rand", "statrs"];

impl Environment {
    pub(crate) fn new(threads: usize, data_digest: &str) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            profile: if cfg!(debug_assertions) { "debug" } else { "release" },
            libraries: LIBRARIES
                .iter()
                .map(|&name| Library { name, version: locked_version(LOCK_FILE, name).unwrap_or_default() })
                .collect(),
            git: git(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            cpu: cpu_model(),
            threads,
            data_digest: data_digest.to_owned(),
        }
    }
}

/// In what a run's `environment.json` differs from an environment, of what digits can depend on: a sentence for each.
pub(crate) fn changes(begun: &[u8], now: &Environment) -> Vec<String> {
    let begun: Value = serde_json::from_slice(begun).unwrap_or_default();
    let now = serde_json::to_value(now).unwrap_or_default();
    ["/profile", "/libraries", "/git/commit", "/system", "/cpu"]
        .into_iter()
        .map(|path| (path, begun.pointer(path), now.pointer(path)))
        .filter(|(_, begun, now)| begun != now)
        .map(|(path, begun, now)| {
            let shown = |value: Option<&Value>| value.map_or_else(|| "unknown".to_owned(), Value::to_string);
            format!(
                "{} was {}, now {}",
                path.trim_start_matches('/').replace('/', "."),
                shown(begun),
                shown(now)
            )
        })
        .collect()
}

/// The version of a package in the text of a lock file.
fn locked_version(lock: &str, name: &str) -> Option<String> {
    let quoted = format!("name = \"{name}\"");
    let mut lines = lock.lines().skip_while(|line| *line != quoted);
    lines.nth(1)?.strip_prefix("version = \"")?.strip_suffix('"').map(str::to_owned)
}

/// The commit of the folder the program runs in. No answer where there is no git or no repository. Asked once: a sweep
/// of a thousand short runs would wait for git longer than for the fits.
fn git() -> Option<Git> {
    static ANSWER: OnceLock<Option<Git>> = OnceLock::new();
    ANSWER.get_or_init(ask_git).clone()
}

fn ask_git() -> Option<Git> {
    let ask = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    Some(Git {
        commit: ask(&["rev-parse", "HEAD"])?,
        dirty: !ask(&["--no-optional-locks", "status", "--porcelain"])?.is_empty(),
    })
}

fn cpu_model() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, model)| model.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::{LIBRARIES, LOCK_FILE, locked_version};

    #[test]
    fn every_library_has_a_version() {
        for name in LIBRARIES {
            assert!(locked_version(LOCK_FILE, name).is_some(), "{name}");
        }
    }
}
