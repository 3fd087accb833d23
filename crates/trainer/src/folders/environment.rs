//! Environment of a run: versions, machine, digests.

use serde::Serialize;
use serde_json::Value;
use std::process::Command;
use std::sync::OnceLock;

/// Content of `environment.json`.
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

#[derive(Debug, Clone, Serialize)]
struct Library {
    name: &'static str,
    version: String,
}

#[derive(Debug, Clone, Serialize)]
struct Git {
    commit: String,
    dirty: bool,
}

const LOCK_FILE: &str = include_str!("../../../../Cargo.lock");
/// Libraries on whose arithmetic or random numbers a result depends.
const LIBRARIES: &[&str] = &[
    "burn",
    "linfa",
    "linfa-linear",
    "nalgebra",
    "ndarray",
    "rand",
    "rand_chacha",
    "rand_distr",
    "rayon",
    "statrs",
];

impl Environment {
    pub(crate) fn new(threads: usize, data_digest: &str) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            profile: if cfg!(debug_assertions) { "debug" } else { "release" },
            libraries: libraries(),
            git: git(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            cpu: cpu_model(),
            threads,
            data_digest: data_digest.to_owned(),
        }
    }
}

/// Lists the differences between a run's `environment.json` and the present environment that may change
/// digits, one sentence for each.
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

/// Returns the libraries with their versions; determined only once.
fn libraries() -> Vec<Library> {
    static ANSWER: OnceLock<Vec<Library>> = OnceLock::new();
    let work_out = || {
        let lock = toml::from_str(LOCK_FILE).unwrap_or_default();
        let version = |name| direct_version(&lock, name).unwrap_or_default();
        LIBRARIES.iter().map(|&name| Library { name, version: version(name) }).collect()
    };
    ANSWER.get_or_init(work_out).clone()
}

/// Returns the version of a package that the workspace itself depends on. The lock file may contain other
/// versions for the sake of some library; the entry of a workspace package, which has no source, then states
/// the version meant.
fn direct_version(lock: &toml::Table, name: &str) -> Option<String> {
    let packages = || lock.get("package").and_then(toml::Value::as_array).into_iter().flatten();
    let text = |package: &toml::Value, key: &str| package.get(key)?.as_str().map(str::to_owned);
    let mut asked = packages()
        .filter(|package| package.get("source").is_none())
        .filter_map(|package| package.get("dependencies")?.as_array())
        .flatten()
        .filter_map(toml::Value::as_str);
    let meant = asked.find(|entry| entry.split(' ').next() == Some(name))?;
    match meant.split(' ').nth(1) {
        Some(version) => Some(version.to_owned()),
        None => {
            packages().find(|p| text(p, "name").as_deref() == Some(name)).and_then(|p| text(p, "version"))
        }
    }
}

/// Returns the commit of the folder in which the program runs; `None` without git or a repository. Determined
/// only once: a sweep of a thousand short runs would wait for git longer than for the fits.
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
    use super::{LIBRARIES, direct_version, libraries};

    /// Of several versions of a library in the lock file, the one that the workspace manifest asks for is
    /// found.
    #[test]
    fn a_library_has_the_version_that_the_workspace_asks_for() {
        let manifest: toml::Table = toml::from_str(include_str!("../../../../Cargo.toml")).unwrap();
        let asked = &manifest["workspace"]["dependencies"];
        let found = libraries();
        assert_eq!(found.len(), LIBRARIES.len());
        for library in found {
            let entry = &asked[library.name];
            let version =
                entry.as_str().or_else(|| entry["version"].as_str()).unwrap().trim_start_matches('=');
            let is_it = library.version == version || library.version.starts_with(&format!("{version}."));
            assert!(is_it, "{}: {} for {version}", library.name, library.version);
        }
    }

    #[test]
    fn of_two_versions_the_one_is_meant_that_a_package_of_the_workspace_names() {
        let lock = |dependency: &str| {
            let package = |name: &str, version: &str| {
                format!("[[package]]\nname = \"{name}\"\nversion = \"{version}\"\nsource = \"registry\"\n")
            };
            let own = format!(
                "[[package]]\nname = \"own\"\nversion = \"1.0.0\"\ndependencies = [\"{dependency}\"]\n"
            );
            let text =
                package("rand", "0.8.8") + &package("rand", "0.10.3") + &package("random", "7.0.0") + &own;
            toml::from_str(&text).unwrap()
        };
        assert_eq!(direct_version(&lock("rand 0.10.3"), "rand").as_deref(), Some("0.10.3"));
        assert_eq!(direct_version(&lock("random"), "random").as_deref(), Some("7.0.0"));
        assert_eq!(direct_version(&lock("random"), "rand"), None);
    }
}
