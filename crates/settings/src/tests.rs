//! Tests of all steps from text to struct.

use crate::{Default, Document, Field, Kind, Resolved, Section, SettingsError};
use serde::Deserialize;

const SECTIONS: &[Section<'static>] = &[
    Section {
        name: "",
        fields: &[Field {
            key: "seed",
            kind: Kind::Integer { min: 0, max: i64::MAX },
            default: Default::Integer(0),
            unit: "",
            meaning: "Root of every random draw.",
            source: "",
        }],
    },
    Section {
        name: "fit",
        fields: &[
            Field {
                key: "hidden",
                kind: Kind::Integers { min: 1, max: 512, at_least: 1, at_most: 8 },
                default: Default::Integers(&[16, 16]),
                unit: "",
                meaning: "Widths of the hidden layers.",
                source: "",
            },
            Field {
                key: "duration",
                kind: Kind::Float { min: 0.0, max: 1e3 },
                default: Default::Required,
                unit: "s",
                meaning: "How long.",
                source: "",
            },
            Field {
                key: "mode",
                kind: Kind::Choice(&["slow", "fast"]),
                default: Default::Text("slow"),
                unit: "",
                meaning: "How.",
                source: "",
            },
            Field {
                key: "note",
                kind: Kind::Text,
                default: Default::Absent,
                unit: "",
                meaning: "Anything.",
                source: "",
            },
        ],
    },
];

#[derive(Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Fit {
    hidden: Vec<usize>,
    duration: f64,
    mode: String,
    note: Option<String>,
}

fn resolve(text: &str, overrides: &[&str]) -> Result<Resolved, SettingsError> {
    let mut document = Document::parse("a.toml", text)?;
    for argument in overrides {
        document.apply_override(argument)?;
    }
    Resolved::new(&document, SECTIONS)
}

fn message(text: &str, overrides: &[&str]) -> String {
    resolve(text, overrides).unwrap_err().to_string()
}

#[test]
fn defaults_file_and_overrides_meet_in_a_struct() {
    let resolved = resolve("[fit]\nduration = 3\n", &["fit.hidden=[64]", "fit.mode=fast"]).unwrap();
    let fit: Fit = resolved.section("fit").unwrap();
    assert_eq!(fit, Fit { hidden: vec![64], duration: 3.0, mode: "fast".into(), note: None });
}

#[test]
fn the_resolved_text_resolves_to_itself() {
    let first = resolve("seed = 7\n[fit]\nduration = 2.5e-3\n", &["fit.note=a \"b\"\n# c"]).unwrap();
    let second = resolve(&first.to_toml(), &[]).unwrap();
    let values = |resolved: &Resolved| -> Vec<_> {
        resolved.settings().iter().map(|setting| setting.value.clone()).collect()
    };
    assert_eq!(values(&first), values(&second), "{}", first.to_toml());
}

#[test]
fn an_unknown_key_names_place_and_nearest() {
    assert_eq!(
        message("[fit]\nduration = 1\nhiden = [3]\n", &[]),
        "a.toml:3:1: unknown key `fit.hiden`; did you mean `fit.hidden`?"
    );
    assert_eq!(
        message("[fit]\nduration = 1\n  zzz = 1\n", &[]),
        "a.toml:3:3: unknown key `fit.zzz`; known are fit.hidden, fit.duration, fit.mode, fit.note"
    );
    assert_eq!(
        message("[fit]\nduration = 1", &["fit.mod=fast"]),
        "command line: `fit.mod=fast`: unknown key `fit.mod`; did you mean `fit.mode`?"
    );
}

#[test]
fn a_bad_value_names_what_was_expected() {
    assert_eq!(
        message("[fit]\nduration = -1\n", &[]),
        "a.toml:2:1: `fit.duration` is -1; expected a finite number from 0 to 1000 (s)"
    );
    assert_eq!(
        message("[fit]\nduration = nan\n", &[]),
        "a.toml:2:1: `fit.duration` is nan; expected a finite number from 0 to 1000 (s)"
    );
    assert_eq!(
        message("[fit]\nduration = 1\nmode = 'quick'", &[]),
        "a.toml:3:1: `fit.mode` is \"quick\"; expected one of \"slow\", \"fast\""
    );
    assert_eq!(message("seed = -1", &[]), "a.toml:1:1: `seed` is -1; expected a whole number from 0 up");
}

#[test]
fn a_bound_that_leaves_out_zero_alone_is_said_in_words() {
    let expected = |max| crate::Kind::Float { min: f64::MIN_POSITIVE, max }.expected();
    assert_eq!(expected(f64::MAX), "a finite number above 0");
    assert_eq!(expected(3.0), "a finite number above 0, up to 3");
}

#[test]
fn a_missing_key_says_what_it_means() {
    assert_eq!(
        message("seed = 1", &[]),
        "a.toml: `fit.duration` is missing: How long. Expected a finite number from 0 to 1000."
    );
}

#[test]
fn broken_toml_has_line_and_column() {
    let message = message("seed = 1\n[fit\n", &[]);
    assert!(message.starts_with("a.toml:2:"), "{message}");
}

/// Keys are written without quotes and split at their dots, so such a name would change.
#[test]
fn a_name_that_needs_quotes_is_refused() {
    for text in ["[fit.\"a b\"]\nx = 1\n", "\"fit.seeds\" = 1\n", "[\"\"]\n"] {
        let message = message(text, &[]);
        assert!(
            message.starts_with("a.toml:1:") && message.contains("letters, digits, _ and -"),
            "{message}"
        );
    }
}

#[test]
fn an_override_without_a_key_is_refused() {
    for argument in ["seed", "=3", "a..b=1", "a b=1"] {
        assert!(message("", &[argument]).contains("is no override"), "{argument}");
    }
}

#[test]
fn a_section_given_as_a_number_is_an_unknown_key() {
    assert_eq!(message("fit = 3", &[]), "a.toml:1:1: unknown key `fit`; known are seed");
}

#[test]
fn tables_below_a_name_are_found_in_the_order_written() {
    let text = "[problem.b]\nkind = 1\n[other]\nx = 1\n[problem.empty]\n[problem.a]\nkind = 2\n";
    let mut document = Document::parse("a.toml", text).unwrap();
    document.apply_override("problem.c.kind=3").unwrap();
    document.apply_override("problem.a.kind=4").unwrap();
    assert_eq!(document.tables_below("problem"), ["b", "empty", "a", "c"]);
    assert_eq!(document.tables_below("prob"), [] as [&str; 0]);
}

#[test]
fn a_table_that_the_configuration_names_is_checked_like_any_other() {
    let document = Document::parse("a.toml", "[problem.mine]\nduration = -1\n").unwrap();
    let name = "problem.mine".to_owned();
    let fields = [Field {
        key: "duration",
        kind: Kind::Float { min: 0.0, max: 1e3 },
        default: Default::Required,
        unit: "s",
        meaning: "How long.",
        source: "",
    }];
    let sections = [Section { name: &name, fields: &fields }];
    let refused = Resolved::new(&document, &sections).unwrap_err().to_string();
    assert_eq!(
        refused,
        "a.toml:2:1: `problem.mine.duration` is -1; expected a finite number from 0 to 1000 (s)"
    );
    let document = Document::parse("a.toml", "[problem.mine]\nduration = 2\n").unwrap();
    let resolved = Resolved::new(&document, &sections).unwrap();
    assert!(resolved.to_toml().contains("\n[problem.mine]\nduration = 2.0"), "{}", resolved.to_toml());
}

#[test]
fn an_array_of_tables_is_a_table_of_numbered_ones() {
    let text = "[[part]]\nsize = 1\n[[part]]\nsize = 2\ninner = { a = 3 }\n[inline]\nof = [{ x = 1 }]\n";
    let mut document = Document::parse("a.toml", text).unwrap();
    document.apply_override("part.2.size=5").unwrap();
    assert_eq!(document.tables_below("part"), ["1", "2"]);
    let keys: Vec<&str> = document.leaves().iter().map(|leaf| leaf.key.as_str()).collect();
    assert_eq!(keys, ["part.1.size", "part.2.size", "part.2.inner.a", "inline.of.1.x"]);
    assert_eq!(document.get("part.1.size").unwrap().origin.to_string(), "a.toml:2:1");
    assert_eq!(document.get("part.2.size").unwrap().value, toml::Value::Integer(5));
    let mixed = Document::parse("a.toml", "list = [1, { x = 1 }]").unwrap_err().to_string();
    assert!(mixed.contains("a table inside a list"), "{mixed}");
}

#[test]
fn an_override_displaces_what_it_contradicts() {
    let text = "[a]\nb = { from = 1, to = 2 }\nc = 3\n";
    let keys = |argument: &str| -> Vec<String> {
        let mut document = Document::parse("a.toml", text).unwrap();
        document.apply_override(argument).unwrap();
        document.leaves().iter().map(|leaf| leaf.key.clone()).collect()
    };
    assert_eq!(keys("a.b=7"), ["a.c", "a.b"]);
    assert_eq!(keys("a.c.from=7"), ["a.b.from", "a.b.to", "a.c.from"]);
    assert_eq!(keys("a.bb=7"), ["a.b.from", "a.b.to", "a.c", "a.bb"]);
}

#[test]
fn a_table_is_cleared_of_what_the_file_says_only() {
    let mut document =
        Document::parse("a.toml", "[a]\nb = 1\nc = 2\n[ab]\nx = 1\n[a.inner]\ny = 1\n").unwrap();
    document.apply_override("a.c=3").unwrap();
    document.clear_table("a");
    let keys: Vec<&str> = document.leaves().iter().map(|leaf| leaf.key.as_str()).collect();
    assert_eq!(keys, ["a.c", "ab.x"]);
    assert_eq!(document.tables_below("a"), [] as [&str; 0]);
}

#[test]
fn equal_values_have_equal_texts_wherever_they_were_written() {
    let one = resolve("seed = 7\n[fit]\nduration = 2\n", &[]).unwrap();
    let other = resolve("", &["fit.duration=2.0", "seed=7"]).unwrap();
    assert_ne!(one.to_toml(), other.to_toml());
    assert_eq!(one.values_text(), other.values_text());
    assert_eq!(
        one.values_text(),
        "fit.duration = 2.0\nfit.hidden = [16, 16]\nfit.mode = \"slow\"\nseed = 7\n"
    );
}

#[test]
fn a_number_is_read_by_its_key_and_nothing_else_passes_for_one() {
    let document = Document::parse("exp.toml", "[fit]\nduration = 2.5\n").unwrap();
    let resolved = Resolved::new(&document, SECTIONS).unwrap();
    assert_eq!(resolved.float("fit.duration").unwrap(), 2.5);
    assert!(matches!(resolved.float("fit.duratoin"), Err(SettingsError::UnknownKey { .. })));
    let text = resolved.float("fit.mode").unwrap_err();
    assert!(text.to_string().contains("`fit.mode` is no number"), "{text}");
}
