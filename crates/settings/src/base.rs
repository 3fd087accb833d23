//! Base files of a configuration: `base = "rig.toml"`, or a list of files.
//!
//! A file replaces values of its base files and changes none of them in another way, and every value records where it
//! was written. Required keys are asked of the merged configuration, so that a file may state only what differs from
//! its base; a misspelled key is refused in any file.

use crate::document::{Document, Leaf};
use crate::error::SettingsError;
use std::path::{Component, Path, PathBuf};
use toml::Value;

/// Top-level key that names the base files.
const KEY: &str = "base";

/// Longest chain of base files. No configuration needs so many; links on the disk can hide a cycle from the
/// file names.
const DEEPEST: usize = 32;

impl Document {
    /// Merges the document with the files that its key `base` names, and each of them with its own base
    /// files.
    ///
    /// Values of a file override those of its base files, key by key, and a later file of a list overrides an
    /// earlier one. A list of tables (`[[effects]]`) replaces the list in a base file as a whole. A relative
    /// name starts from the folder of the file that contains it. Every leaf keeps its origin. `read` returns
    /// the text of a file, or says in words why it cannot.
    ///
    /// # Errors
    /// [`SettingsError::Base`] if a file cannot be read, [`SettingsError::BaseCircle`] if a file is a base of
    /// itself, directly or through others, [`SettingsError::BadValue`] if `base` is neither a name nor a list
    /// of names, and [`SettingsError::Syntax`].
    pub fn on_its_bases(
        self,
        read: &mut dyn FnMut(&Path) -> Result<String, String>,
    ) -> Result<Self, SettingsError> {
        let way = vec![PathBuf::from(self.file())];
        on_bases(self, &way, read)
    }
}

fn on_bases(
    mut document: Document,
    way: &[PathBuf],
    read: &mut dyn FnMut(&Path) -> Result<String, String>,
) -> Result<Document, SettingsError> {
    let Some(leaf) = document.take(KEY) else { return Ok(document) };
    let mut below: Option<Document> = None;
    for name in names(&leaf)? {
        let folder = Path::new(document.file()).parent().unwrap_or_else(|| Path::new(""));
        let path = folder.join(&name);
        let file = path.display().to_string();
        let known = way.iter().any(|passed| simplified(passed) == simplified(&path));
        if known || way.len() >= DEEPEST {
            let files = way.iter().map(|passed| passed.display().to_string()).chain([file]).collect();
            return Err(SettingsError::BaseCircle { origin: leaf.origin, files });
        }
        let text = read(&path).map_err(|problem| SettingsError::Base {
            origin: leaf.origin.clone(),
            file: file.clone(),
            problem,
        })?;
        let longer: Vec<PathBuf> = way.iter().cloned().chain([path]).collect();
        let base = on_bases(Document::parse(&file, &text)?, &longer, read)?;
        below = Some(match below {
            Some(earlier) => base.over(earlier),
            None => base,
        });
    }
    Ok(match below {
        Some(below) => document.over(below),
        None => document,
    })
}

fn names(leaf: &Leaf) -> Result<Vec<String>, SettingsError> {
    let texts = match &leaf.value {
        Value::String(name) => Some(vec![name.clone()]),
        Value::Array(entries) => entries.iter().map(|entry| entry.as_str().map(str::to_owned)).collect(),
        _ => None,
    };
    texts.ok_or_else(|| SettingsError::BadValue {
        origin: leaf.origin.clone(),
        key: leaf.key.clone(),
        found: leaf.value.to_string(),
        expected: "the name of a file, or a list of names".to_owned(),
        unit: String::new(),
    })
}

/// Returns a path without `.` and `name/..`.
pub(crate) fn simplified(path: &Path) -> PathBuf {
    let mut simple = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(simple.components().next_back(), Some(Component::Normal(_))) => {
                simple.pop();
            }
            other => simple.push(other),
        }
    }
    simple
}

#[cfg(test)]
mod tests {
    use crate::{Document, SettingsError};
    use std::path::Path;

    const FILES: &[(&str, &str)] = &[
        ("a/rig.toml", "seed = 1\n[data]\nrate = 2\nunit = \"deg\"\n[[effects]]\nid = \"x\"\nsize = 3\n"),
        ("a/method.toml", "base = \"../a/./rig.toml\"\nseed = 4\n"),
        ("a/one.toml", "base = \"two.toml\""),
        ("a/two.toml", "seed = 1\nbase = [\"../a/one.toml\"]"),
        ("a/broken.toml", "[data\n"),
    ];

    fn compose(text: &str) -> Result<Document, SettingsError> {
        let mut read = |path: &Path| {
            let name = path.to_str().unwrap().replace("a/../", "").replace("./", "");
            let found = FILES.iter().find(|(file, _)| *file == name);
            found.map(|(_, text)| (*text).to_owned()).ok_or_else(|| "no such file".to_owned())
        };
        Document::parse("a/main.toml", text)?.on_its_bases(&mut read)
    }

    fn shown(document: &Document) -> Vec<String> {
        let leaves = document.leaves().iter();
        leaves.map(|leaf| format!("{}={} {}", leaf.key, leaf.value, leaf.origin)).collect()
    }

    #[test]
    fn what_a_file_says_goes_before_what_is_below_and_keeps_its_place() {
        let document = compose("base = \"rig.toml\"\n[data]\nrate = 7\n").unwrap();
        assert_eq!(
            shown(&document),
            [
                "seed=1 a/rig.toml:1:1",
                "data.rate=7 a/main.toml:3:1",
                "data.unit=\"deg\" a/rig.toml:4:1",
                "effects.1.id=\"x\" a/rig.toml:6:1",
                "effects.1.size=3 a/rig.toml:7:1",
            ]
        );
        assert_eq!(document.file(), "a/main.toml");
        assert!(document.get("base").is_none());
    }

    #[test]
    fn a_later_file_goes_before_an_earlier_one_and_bases_have_bases() {
        let document = compose("base = [\"rig.toml\", \"method.toml\"]").unwrap();
        assert_eq!(document.get("seed").unwrap().origin.to_string(), "a/method.toml:2:1");
        let document = compose("base = [\"method.toml\", \"rig.toml\"]").unwrap();
        assert_eq!(document.get("seed").unwrap().origin.to_string(), "a/rig.toml:1:1");
    }

    #[test]
    fn a_list_of_tables_replaces_the_one_below_and_a_numbered_table_does_not() {
        let document = compose("base = \"rig.toml\"\n[[effects]]\nid = \"y\"\n").unwrap();
        assert!(document.get("effects.1.size").is_none());
        assert_eq!(document.get("effects.1.id").unwrap().value.as_str(), Some("y"));
        let document = compose("base = \"rig.toml\"\n[effects.1]\nid = \"y\"\n").unwrap();
        assert!(document.get("effects.1.size").is_some());
    }

    #[test]
    fn a_table_takes_the_place_of_a_value_and_the_other_way_round() {
        let document = compose("base = \"rig.toml\"\n[data.rate]\nfrom = 1\n").unwrap();
        assert!(document.get("data.rate").is_none() && document.get("data.rate.from").is_some());
        let document = compose("base = \"rig.toml\"\ndata = 3\n").unwrap();
        assert!(document.get("data.rate").is_none() && document.get("data").is_some());
    }

    #[test]
    fn circles_absences_and_nonsense_are_refused_with_their_place() {
        let message = |text: &str| compose(text).unwrap_err().to_string();
        assert_eq!(
            message("base = \"one.toml\""),
            "a/two.toml:2:1: `base` leads back to where it started: a/main.toml, a/one.toml, a/two.toml, \
             a/../a/one.toml"
        );
        assert!(message("seed = 1\nbase = \"main.toml\"").starts_with("a/main.toml:2:1: `base` leads back"));
        assert_eq!(
            message("base = \"absent.toml\""),
            "a/main.toml:1:1: the base a/absent.toml cannot be read: no such file"
        );
        assert_eq!(
            message("base = 3"),
            "a/main.toml:1:1: `base` is 3; expected the name of a file, or a list of names"
        );
        assert!(message("base = \"broken.toml\"").starts_with("a/broken.toml:1:"));
    }
}
