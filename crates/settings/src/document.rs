//! Configuration as written: its leaves, each with its origin.

use crate::error::SettingsError;
use crate::origin::Origin;
use std::path::Path;
use toml::Value;
use toml::de::{DeTable, DeValue};

/// A value that is not a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Leaf {
    /// Dotted key, such as `estimator.hidden`.
    pub key: String,
    /// Value as written.
    pub value: Value,
    /// Place where the value was written.
    pub origin: Origin,
    /// Folder that a relative path in the value starts from; empty for the working directory.
    pub folder: String,
}

/// Top-level key that sets the start of a file's relative paths: [`FROM_FILE`] or [`FROM_WORKING_DIRECTORY`].
pub(crate) const PATHS: &str = "paths";
pub(crate) const FROM_FILE: &str = "file";
/// Used in a run's own copy of its configuration.
pub(crate) const FROM_WORKING_DIRECTORY: &str = "working-directory";

/// Configuration as written, including overrides: an ordered list of leaves with unique keys.
///
/// An array of tables is stored as numbered tables: the second `[[effects]]` is `[effects.2]`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    file: String,
    leaves: Vec<Leaf>,
    /// Dotted names of the tables that the file opens, including empty ones.
    tables: Vec<String>,
    /// Dotted names of the lists of tables.
    lists: Vec<String>,
}

impl Document {
    /// Parses TOML text; `file` is the name used in messages.
    ///
    /// # Errors
    /// [`SettingsError::Syntax`] with line and column if the text is not TOML, or if a name in it needs
    /// quotes.
    pub fn parse(file: &str, text: &str) -> Result<Self, SettingsError> {
        let table = DeTable::parse(text).map_err(|error| {
            let (line, column) = place(text, error.span().map_or(0, |span| span.start));
            let problem = error.message().trim().replace('\n', ", ");
            SettingsError::Syntax { file: file.to_owned(), line, column, problem }
        })?;
        let mut document = Self { file: file.to_owned(), ..Self::default() };
        document.collect(text, "", table.get_ref())?;
        document.place_paths()?;
        Ok(document)
    }

    /// Returns the name of the file that the document was read from.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns every leaf, in the order written.
    #[must_use]
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// Returns the leaf with a dotted key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Leaf> {
        self.leaves.iter().find(|leaf| leaf.key == key)
    }

    /// Returns the names of the tables directly below a table, such as `one` of `[prefix.one]`: in the order
    /// written, with those that only an override opens at the end.
    #[must_use]
    pub fn tables_below(&self, prefix: &str) -> Vec<String> {
        let below = |key: &str| {
            let rest = key.strip_prefix(prefix)?.strip_prefix('.')?;
            Some(rest.split('.').next().unwrap_or(rest).to_owned())
        };
        // A leaf directly below the prefix is a key, not a table.
        let is_inside = |leaf: &&Leaf| {
            leaf.key.strip_prefix(prefix).is_some_and(|rest| rest.trim_start_matches('.').contains('.'))
        };
        let leaves = self.leaves.iter().filter(is_inside).map(|leaf| leaf.key.as_str());
        let mut names: Vec<String> = Vec::new();
        for name in self.tables.iter().map(String::as_str).chain(leaves).filter_map(below) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Applies one `key=value` argument. The value is parsed as TOML, and is plain text if it is not TOML.
    ///
    /// # Errors
    /// [`SettingsError::BadOverride`] if there is no `=` or the key is not a dotted name.
    pub fn apply_override(&mut self, argument: &str) -> Result<(), SettingsError> {
        let bad = || SettingsError::BadOverride { argument: argument.to_owned() };
        let (key, text) = argument.split_once('=').ok_or_else(bad)?;
        let key = key.trim();
        if !key.split('.').all(is_name) {
            return Err(bad());
        }
        let value = text
            .trim()
            .parse::<Value>()
            .ok()
            .filter(|value| !matches!(value, Value::Table(_)))
            .unwrap_or_else(|| Value::String(text.to_owned()));
        let origin = Origin::Override(argument.to_owned());
        self.set(Leaf { key: key.to_owned(), value, origin, folder: String::new() });
        Ok(())
    }

    /// Removes the file's leaves in a table and below it; leaves from overrides stay.
    pub fn clear_table(&mut self, table: &str) {
        self.leaves
            .retain(|leaf| !lies_below(&leaf.key, table) || !matches!(leaf.origin, Origin::File { .. }));
        self.tables.retain(|known| !lies_below(known, table));
    }

    /// Removes a leaf and returns it.
    pub(crate) fn take(&mut self, key: &str) -> Option<Leaf> {
        let place = self.leaves.iter().position(|leaf| leaf.key == key)?;
        Some(self.leaves.remove(place))
    }

    /// Merges this document over another one: its leaves replace those of `below`, and its lists of tables
    /// replace whole lists.
    pub(crate) fn over(self, below: Self) -> Self {
        let mut merged = Self { file: self.file, ..below };
        for list in &self.lists {
            merged.leaves.retain(|leaf| !lies_below(&leaf.key, list));
            merged.tables.retain(|table| !lies_below(table, list));
        }
        for table in self.tables {
            merged.leaves.retain(|leaf| leaf.key != table);
            if !merged.tables.contains(&table) {
                merged.tables.push(table);
            }
        }
        for list in self.lists {
            merged.leaves.retain(|leaf| leaf.key != list);
            if !merged.lists.contains(&list) {
                merged.lists.push(list);
            }
        }
        for leaf in self.leaves {
            merged.set(leaf);
        }
        merged
    }

    /// Sets a leaf. It replaces the leaf of that key, a table of that name with everything below it, or a
    /// value in a place where the key needs a table.
    fn set(&mut self, leaf: Leaf) {
        self.leaves.retain(|known| !lies_below(&known.key, &leaf.key) && !lies_below(&leaf.key, &known.key));
        self.tables.retain(|table| *table != leaf.key && !lies_below(table, &leaf.key));
        match self.leaves.iter_mut().find(|known| known.key == leaf.key) {
            Some(known) => *known = leaf,
            None => self.leaves.push(leaf),
        }
    }

    /// Makes relative paths start from the file's folder, unless the file sets the working directory.
    fn place_paths(&mut self) -> Result<(), SettingsError> {
        let folder =
            Path::new(&self.file).parent().map_or_else(String::new, |path| path.display().to_string());
        match self.take(PATHS) {
            Some(leaf) if leaf.value.as_str() == Some(FROM_WORKING_DIRECTORY) => return Ok(()),
            Some(leaf) if leaf.value.as_str() != Some(FROM_FILE) => {
                return Err(SettingsError::BadValue {
                    origin: leaf.origin,
                    key: leaf.key,
                    found: leaf.value.to_string(),
                    expected: format!("\"{FROM_FILE}\" or \"{FROM_WORKING_DIRECTORY}\""),
                    unit: String::new(),
                });
            }
            _ => {}
        }
        for leaf in &mut self.leaves {
            leaf.folder.clone_from(&folder);
        }
        Ok(())
    }

    fn collect(&mut self, text: &str, prefix: &str, table: &DeTable<'_>) -> Result<(), SettingsError> {
        for (name, value) in table {
            let key = if prefix.is_empty() {
                name.get_ref().to_string()
            } else {
                format!("{prefix}.{}", name.get_ref())
            };
            let (line, column) = place(text, name.span().start);
            // A dotted key is split at its dots later, and written without quotes.
            if !is_name(name.get_ref()) {
                return Err(SettingsError::Syntax {
                    file: self.file.clone(),
                    line,
                    column,
                    problem: format!(
                        "the name {:?} has characters other than letters, digits, _ and -",
                        name.get_ref()
                    ),
                });
            }
            let origin = Origin::File { file: self.file.clone(), line, column };
            if let DeValue::Table(inner) = value.get_ref() {
                self.tables.push(key.clone());
                self.collect(text, &key, inner)?;
            } else if let Some(inner) = tables(value.get_ref()) {
                self.lists.push(key.clone());
                for (number, inner) in inner.into_iter().enumerate() {
                    let key = format!("{key}.{}", number + 1);
                    self.tables.push(key.clone());
                    self.collect(text, &key, inner)?;
                }
            } else {
                let value = plain(value.get_ref()).map_err(|problem| SettingsError::Syntax {
                    file: self.file.clone(),
                    line,
                    column,
                    problem,
                })?;
                self.leaves.push(Leaf { key, value, origin, folder: String::new() });
            }
        }
        Ok(())
    }
}

/// Returns `true` if a dotted key lies in a table or below it.
fn lies_below(key: &str, table: &str) -> bool {
    key.strip_prefix(table).is_some_and(|rest| rest.starts_with('.'))
}

/// Returns the tables of a list that holds only tables; `None` for other values and for an empty list.
fn tables<'a, 'i>(value: &'a DeValue<'i>) -> Option<Vec<&'a DeTable<'i>>> {
    let DeValue::Array(entries) = value else { return None };
    let inner = entries.iter().map(|entry| match entry.get_ref() {
        DeValue::Table(inner) => Some(inner),
        _ => None,
    });
    inner.collect::<Option<Vec<_>>>().filter(|tables| !tables.is_empty())
}

/// Returns a parsed value without its spans. The parser keeps numbers as text; they are decoded here.
fn plain(value: &DeValue<'_>) -> Result<Value, String> {
    Ok(match value {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Boolean(flag) => Value::Boolean(*flag),
        DeValue::Datetime(time) => Value::Datetime(*time),
        DeValue::Integer(number) => Value::Integer(
            i64::from_str_radix(number.as_str(), number.radix())
                .map_err(|_| format!("`{number}` is no 64-bit whole number"))?,
        ),
        DeValue::Float(number) => {
            Value::Float(number.as_str().parse().map_err(|_| format!("`{number}` is not a number"))?)
        }
        DeValue::Array(entries) => {
            Value::Array(entries.iter().map(|entry| plain(entry.get_ref())).collect::<Result<_, _>>()?)
        }
        DeValue::Table(_) => return Err("a table inside a list has no meaning here".to_owned()),
    })
}

/// Returns `true` if a name can be part of a dotted key.
fn is_name(part: &str) -> bool {
    !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c))
}

/// Returns line and column of a byte offset, both counted from 1; columns count characters.
fn place(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
    (line, column)
}
