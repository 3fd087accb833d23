//! `trainer cite`: the literature behind a run, as BibTeX.

mod cited;
mod used;

use crate::error::TrainerError;
use crate::fits::method::Method;
use crate::options::Output;
use crate::outcome::Outcome;
use cited::{DIAGNOSIS, entries, keys};
use clap::Args;
use dynamics::REGISTRY;
use serde::Serialize;
use settings::{Origin, SettingsError};
use std::collections::BTreeMap;
use std::path::PathBuf;
use used::Used;

/// Arguments of citing the literature of runs or methods.
#[derive(Debug, Args)]
pub(crate) struct CiteArguments {
    /// Folders of finished runs
    #[arg(value_name = "RUN", required_unless_present_any = ["estimator", "all"])]
    runs: Vec<PathBuf>,
    /// Estimators, learned or classical, by name
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    estimator: Vec<String>,
    /// Everything there is: estimators, effects, the diagnosis
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    output: Output,
}

/// Cited work with the methods and effects that follow it.
#[derive(Debug, Serialize)]
struct Work {
    key: &'static str,
    followed_by: Vec<String>,
    bibtex: &'static str,
}

/// Prints the entries of the works that the given runs or methods follow, each with its followers.
pub(crate) fn command(arguments: &CiteArguments) -> Result<Outcome, TrainerError> {
    let methods = Method::all()?;
    let mut used = Used { estimators: arguments.estimator.clone(), ..Used::default() };
    for run in &arguments.runs {
        used.add(run)?;
    }
    if arguments.all {
        used.estimators = methods.iter().map(|method| method.id().to_owned()).collect();
        used.effects = REGISTRY.iter().map(|effect| effect.id().to_owned()).collect();
        used.diagnosis = true;
    }
    let works = works(&methods, &used)?;
    arguments.output.print(&works, || {
        let entries: Vec<String> =
            works.iter().map(|work| format!("% {}\n{}", work.followed_by.join(", "), work.bibtex)).collect();
        if entries.is_empty() {
            "% nothing that was used follows a publication".to_owned()
        } else {
            entries.join("\n\n")
        }
    })?;
    Ok(Outcome::Done)
}

fn works(methods: &[Method], used: &Used) -> Result<Vec<Work>, SettingsError> {
    // Keyed by work, so that each work is listed once and in a fixed order.
    let mut followers: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut follow = |citation: &str, who: &str| {
        for key in keys(citation) {
            let followers = followers.entry(key).or_default();
            if !followers.iter().any(|known| known == who) {
                followers.push(who.to_owned());
            }
        }
    };
    for id in &used.estimators {
        let Some(method) = methods.iter().find(|method| method.id() == id) else {
            let known = methods.iter().map(|method| method.id().to_owned()).collect();
            let origin = Origin::Override(format!("--estimator {id}"));
            return Err(SettingsError::unknown_name(origin, "estimator", id, known));
        };
        method.citations().iter().for_each(|citation| follow(citation, id));
    }
    for effect in REGISTRY.iter().filter(|effect| used.effects.iter().any(|id| id == effect.id())) {
        follow(effect.description().reference, effect.id());
    }
    if used.diagnosis {
        for key in DIAGNOSIS {
            followers.entry(key).or_default().push("diagnosis".to_owned());
        }
    }
    let entries = entries();
    let work = |entry: &(&'static str, &'static str)| {
        let followed_by = followers.get(entry.0)?.clone();
        Some(Work { key: entry.0, followed_by, bibtex: entry.1 })
    };
    Ok(entries.iter().filter_map(work).collect())
}

#[cfg(test)]
mod tests {
    use super::{DIAGNOSIS, Method, entries, keys};
    use dynamics::REGISTRY;
    use std::collections::BTreeSet;

    /// Returns the citations of all methods and effects.
    fn citations() -> BTreeSet<&'static str> {
        let methods = Method::all().unwrap();
        let of_methods = methods.iter().flat_map(|method| method.citations()).copied();
        of_methods.chain(REGISTRY.iter().map(|effect| effect.description().reference)).collect()
    }

    #[test]
    fn every_citation_has_an_entry_and_every_entry_is_cited() {
        let known: BTreeSet<&str> = entries().iter().map(|(key, _)| *key).collect();
        let mut used: BTreeSet<&str> = DIAGNOSIS.iter().copied().collect();
        for citation in citations() {
            let keys = keys(citation);
            let expected = if citation.contains("Dahl") { 2 } else { 1 };
            assert_eq!(
                keys.len(),
                expected,
                "{citation}: {keys:?}; literature.bib needs one entry, as smith1990"
            );
            used.extend(keys);
        }
        assert_eq!(used, known);
    }

    /// The entry has the names and the year of the short citation.
    #[test]
    fn an_entry_is_the_work_that_the_citation_names() {
        let entries = entries();
        for citation in citations() {
            let keys = keys(citation);
            let first = keys[0];
            let entry = plain(entries.iter().find(|(key, _)| *key == first).unwrap().1);
            let name = citation.split([',', ' ']).next().unwrap();
            assert!(entry.contains(&plain(name)), "{citation}: {entry}");
            for number in citation.split(|c: char| !c.is_ascii_digit()).filter(|number| number.len() == 4) {
                let year = number.starts_with("19") || number.starts_with("20");
                let is_page =
                    entry.contains(&format!("{number}--")) || entry.contains(&format!("--{number}"));
                let second = keys.len() > 1 && entries.iter().any(|(key, _)| key.ends_with(number));
                assert!(!year || is_page || second || entry.contains(number), "{citation}: {entry}");
            }
        }
    }

    /// Replaces accented letters, in either notation, by plain ones.
    fn plain(text: &str) -> String {
        let text = text
            .replace("{\\AA}", "A")
            .replace('Å', "A")
            .replace("{\\L}", "L")
            .replace("\\v s", "s")
            .replace(['ö', 'ü', 'é', 'ć', 'á'], "?");
        let mut plain = String::new();
        let mut rest = text.as_str();
        while let Some(at) = rest.find("{\\") {
            plain.push_str(&rest[..at]);
            plain.push('?');
            rest = rest[at..].split_once('}').unwrap().1;
        }
        plain.push_str(rest);
        plain.replace(['{', '}'], "")
    }
}
