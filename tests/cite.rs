//! Tests of `trainer cite`: the literature of a run's methods as BibTeX.

use crate::support::{result, trainer};
use std::collections::BTreeMap;

/// Parses entries by key: kind and fields. This parser is independent of the program and strict about braces,
/// fields and commas.
fn read(text: &str) -> BTreeMap<String, (String, BTreeMap<String, String>)> {
    let text: String =
        text.lines().filter(|line| !line.starts_with('%')).map(|line| format!("{line}\n")).collect();
    let mut found = BTreeMap::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (kind, after) = rest.strip_prefix('@').unwrap().split_once('{').unwrap();
        assert!(["article", "book", "inproceedings", "techreport", "misc"].contains(&kind), "{kind}");
        let (key, mut body) = after.split_once(',').unwrap();
        let mut fields = BTreeMap::new();
        loop {
            body = body.trim_start();
            if let Some(after) = body.strip_prefix('}') {
                rest = after.trim_start();
                break;
            }
            let (name, value) = body.split_once(" = {").unwrap();
            assert!(name.chars().all(|c| c.is_ascii_lowercase()), "{key}: {name}");
            let mut depth = 1;
            let end = value
                .char_indices()
                .find(|(_, c)| {
                    depth += match c {
                        '{' => 1,
                        '}' => -1,
                        _ => 0,
                    };
                    depth == 0
                })
                .unwrap_or_else(|| panic!("{key}: {name} is not closed"))
                .0;
            let content = value[..end].to_owned();
            assert!(content.is_ascii() && !content.is_empty(), "{key}: {content}");
            assert!(!content.contains(['%', '#']) && !content.replace("\\&", "").contains('&'), "{content}");
            assert!(fields.insert(name.to_owned(), content).is_none(), "{key}: {name} twice");
            body = value[end + 1..]
                .strip_prefix(',')
                .unwrap_or_else(|| panic!("{key}: {name} ends without a comma"));
        }
        assert!(found.insert(key.to_owned(), (kind.to_owned(), fields)).is_none(), "{key} twice");
    }
    found
}

fn cited(arguments: &[&str]) -> BTreeMap<String, (String, BTreeMap<String, String>)> {
    let output = trainer(&[&["cite"], arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    read(&String::from_utf8(output.stdout).unwrap())
}

#[test]
fn every_entry_is_well_formed_and_complete() {
    let all = cited(&["--all"]);
    assert!(all.len() > 60, "{}", all.len());
    for (key, (kind, fields)) in &all {
        let needed: &[&str] = match kind.as_str() {
            "article" => &["author", "title", "journal", "year", "volume", "pages"],
            "book" => &["title", "publisher", "year"],
            "inproceedings" => &["author", "title", "booktitle", "year"],
            "techreport" => &["author", "title", "institution", "year"],
            _ => &["author", "title"],
        };
        for field in needed {
            assert!(fields.contains_key(*field), "{key} has no {field}");
        }
        assert!(fields.contains_key("author") || fields.contains_key("editor"), "{key} has no author");
        if let Some(doi) = fields.get("doi") {
            assert!(doi.starts_with("10.") && doi.contains('/') && !doi.contains(' '), "{key}: {doi}");
        }
        if let Some(year) = fields.get("year") {
            assert!((1900..2030).contains(&year.parse::<i32>().unwrap()), "{key}: {year}");
            assert!(key.contains(year.as_str()), "{key}: {year}");
        }
    }
}

#[test]
fn a_run_cites_what_it_used_and_no_more() {
    let (_, _, run) = result(&["configs/compare.toml", "compare.methods=sindy,qr"]);
    let keys: Vec<String> = cited(&[run.path().to_str().unwrap()]).into_keys().collect();
    assert_eq!(
        keys,
        ["boninsegna2018", "brunton2016", "golub1965", "householder1958", "mangan2017", "schaeffer2017"]
    );
    let (_, _, simulated) = result(&["simulate", "configs/default-record.toml"]);
    let simulated = cited(&[simulated.path().to_str().unwrap()]);
    assert!(simulated.contains_key("feeny1996"), "{:?}", simulated.keys());
    assert!(!simulated.contains_key("brunton2016"));
}

#[test]
fn estimators_are_cited_by_name() {
    let works = cited(&["--estimator", "pinn,ols"]);
    let keys: Vec<&str> = works.keys().map(String::as_str).collect();
    assert_eq!(keys, ["chan1983", "draper1998", "golub1973", "marquardt1963", "raissi2019"]);
    assert_eq!(works["raissi2019"].1["doi"], "10.1016/j.jcp.2018.10.045");
}

#[test]
fn what_cannot_be_cited_is_refused() {
    for (arguments, expected) in [
        (&["cite", "--estimator", "pin"][..], "unknown estimator \"pin\"; did you mean `pinn`?"),
        (
            &["cite", "configs"],
            "configs: is not a finished run: neither result.json nor diagnosis.json is there",
        ),
    ] {
        let output = trainer(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(message.contains(expected), "{message}");
    }
    assert_eq!(trainer(&["cite"]).status.code(), Some(2));
}
