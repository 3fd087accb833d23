//! Graph of a crate's modules, from its sources: an edge means that the code of one module names an item of
//! another.
//!
//! A re-export (`pub use`) is no edge, and a name that is used through one counts for the module that it
//! leads to.

use super::source::{code_only, functions, without_tests};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Path of a module within its crate; empty for the root.
type Name = Vec<String>;

/// Module, as parsed from its file.
struct Module {
    code: String,
    /// Imported names with the paths that they stand for; a path without `crate`, `self` or `super` starts in
    /// this module.
    aliases: BTreeMap<String, Name>,
    /// Modules whose names are all imported.
    globs: Vec<Name>,
    /// Paths of imports that are not re-exports.
    imports: Vec<Name>,
}

/// Modules of a crate, from which the edges follow.
pub(super) struct Graph {
    modules: BTreeMap<Name, Module>,
}

impl Graph {
    /// Reads a crate from its `lib.rs` or `main.rs`.
    pub(super) fn read(root: &Path) -> Self {
        let mut modules = BTreeMap::new();
        read_module(root, root.parent().unwrap(), &Vec::new(), &mut modules);
        Self { modules }
    }

    /// Returns every function with its module and its number of lines.
    pub(super) fn functions(&self) -> impl Iterator<Item = (String, String, usize)> {
        self.modules.iter().flat_map(|(name, module)| {
            functions(&module.code).into_iter().map(|(function, lines)| (shown(name), function, lines))
        })
    }

    /// Returns groups of modules that all reach each other, with names in alphabetical order.
    pub(super) fn circles(&self) -> Vec<Vec<String>> {
        groups(&self.modules.keys().map(|module| (module.clone(), self.named_by(module))).collect())
    }

    /// Returns the same for the folders at the root of the crate: an edge means that a module of one names an item of
    /// a module of another.
    pub(super) fn folder_circles(&self) -> Vec<Vec<String>> {
        let inner = |module: &&Name| module.len() > 1;
        let folder = |module: &Name| module[..1].to_vec();
        let folders: BTreeSet<Name> = self.modules.keys().filter(inner).map(folder).collect();
        let mut edges: BTreeMap<Name, BTreeSet<Name>> =
            folders.iter().map(|own| (own.clone(), BTreeSet::new())).collect();
        for module in self.modules.keys().filter(|module| !module.is_empty()) {
            let Some(named) = edges.get_mut(&folder(module)) else { continue };
            let others = self.named_by(module).into_iter().filter(|other| !other.is_empty());
            let others = others.map(|other| folder(&other)).filter(|other| *other != folder(module));
            named.extend(others.filter(|other| folders.contains(other)));
        }
        groups(&edges)
    }

    /// Returns the modules that the code of one names, except itself.
    fn named_by(&self, module: &Name) -> BTreeSet<Name> {
        let own = &self.modules[module];
        let imports = own.imports.iter().map(|path| self.owner(path, 0));
        let paths = paths_in(&own.code).into_iter().filter_map(|path| {
            let absolute = self.absolute(module, &path)?;
            Some(self.owner(&absolute, 0))
        });
        imports.chain(paths).filter(|other| other != module).collect()
    }

    /// Returns a path from the crate's root; `None` if its first word is not a module of this crate.
    fn absolute(&self, module: &Name, path: &[String]) -> Option<Name> {
        let first = path.first()?;
        let child: Name = module.iter().chain([first]).cloned().collect();
        if ["crate", "$crate", "self", "super"].contains(&first.as_str()) || self.modules.contains_key(&child)
        {
            return Some(from_root(module, path));
        }
        let alias = self.modules[module].aliases.get(first)?;
        // Only an alias of a module can start a path to another item.
        self.modules.contains_key(alias).then(|| alias.iter().chain(&path[1..]).cloned().collect())
    }

    /// Returns the module that owns the item of a path.
    fn owner(&self, path: &[String], depth: usize) -> Name {
        let known = (0..=path.len()).rev().find(|&count| self.modules.contains_key(&path[..count]));
        let count = known.unwrap_or(0);
        let module = path[..count].to_vec();
        let (Some(word), true) = (path.get(count), depth < 16) else { return module };
        if let Some(alias) = self.modules[&module].aliases.get(word) {
            let longer: Name = alias.iter().chain(&path[count + 1..]).cloned().collect();
            return self.owner(&longer, depth + 1);
        }
        let defines = |name: &Name| self.modules.get(name).is_some_and(|module| defines(&module.code, word));
        let through = self.modules[&module].globs.iter().find(|glob| defines(glob));
        through.filter(|_| !defines(&module)).cloned().unwrap_or(module)
    }
}

/// Returns groups of nodes of a graph that all reach each other, with names in alphabetical order.
fn groups(edges: &BTreeMap<Name, BTreeSet<Name>>) -> Vec<Vec<String>> {
    let reached = |from: &Name| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(next) = open.pop() {
            open.extend(edges[&next].iter().filter(|other| seen.insert((*other).clone())).cloned());
        }
        seen
    };
    let reach: BTreeMap<&Name, BTreeSet<Name>> = edges.keys().map(|node| (node, reached(node))).collect();
    let together = |one: &Name, other: &Name| reach[one].contains(other) && reach[other].contains(one);
    let groups: BTreeSet<Vec<String>> = (edges.keys())
        .filter(|node| reach[node].contains(*node))
        .map(|one| edges.keys().filter(|other| together(one, other)).map(shown).collect())
        .collect();
    groups.into_iter().collect()
}

fn shown(name: &Name) -> String {
    if name.is_empty() { "(root)".to_owned() } else { name.join("::") }
}

/// Returns `true` if code defines an item of this name.
fn defines(code: &str, name: &str) -> bool {
    ["fn ", "struct ", "enum ", "trait ", "const ", "static ", "type "].iter().any(|kind| {
        let item = format!("{kind}{name}");
        let ends = |at: usize| {
            code[at + item.len()..].chars().next().is_none_or(|next| !next.is_alphanumeric() && next != '_')
        };
        code.match_indices(&item).any(|(at, _)| ends(at))
    })
}

fn read_module(file: &Path, folder: &Path, name: &Name, modules: &mut BTreeMap<Name, Module>) {
    let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let code = without_tests(&code_only(&text));
    for child in children(&code) {
        let beside = folder.join(format!("{child}.rs"));
        let inside = folder.join(&child).join("mod.rs");
        let place: PathBuf = if beside.exists() { beside } else { inside };
        let below: Name = name.iter().chain([&child]).cloned().collect();
        if place.exists() {
            read_module(&place, &folder.join(&child), &below, modules);
        }
    }
    let mut module =
        Module { code: String::new(), aliases: BTreeMap::new(), globs: Vec::new(), imports: Vec::new() };
    let mut rest = String::new();
    let mut from = 0;
    for (start, end, is_public) in use_items(&code) {
        rest.push_str(&code[from..start]);
        from = end;
        for (path, alias) in tree(code[start..end].trim_end_matches(';').split_once("use ").unwrap().1) {
            let absolute = from_root(name, &path);
            match alias.as_str() {
                "*" => module.globs.push(absolute.clone()),
                _ => drop(module.aliases.insert(alias, absolute.clone())),
            }
            if !is_public {
                module.imports.push(absolute);
            }
        }
    }
    rest.push_str(&code[from..]);
    module.code = rest;
    modules.insert(name.clone(), module);
}

/// Returns the names of the modules that have their own files.
fn children(code: &str) -> Vec<String> {
    let words: Vec<&str> = code.split_whitespace().collect();
    let declared =
        words.windows(2).filter(|pair| pair[0] == "mod").filter_map(|pair| pair[1].strip_suffix(';'));
    declared.map(str::to_owned).collect()
}

/// Returns the positions of `use` items, each with `true` for a re-export.
fn use_items(code: &str) -> Vec<(usize, usize, bool)> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("use ") {
        let line = code[..at].rfind('\n').map_or(0, |line| line + 1);
        let before = code[line..at].trim();
        let is_visibility = before == "pub" || before.starts_with("pub(") && before.ends_with(')');
        let is_word = code[..at].chars().next_back().is_none_or(char::is_whitespace);
        if !(is_word && (before.is_empty() || is_visibility)) {
            continue;
        }
        let end = code[at..].find(';').map_or(code.len(), |end| at + end + 1);
        found.push((line, end, !before.is_empty()));
    }
    found
}

/// Converts a tree of imports to paths with the names that they get.
fn tree(text: &str) -> Vec<(Name, String)> {
    let text = text.trim();
    if let Some(open) = text.find('{') {
        let prefix = text[..open].trim().trim_end_matches("::");
        let inner = &text[open + 1..text.rfind('}').unwrap()];
        let below = parts(inner).into_iter().flat_map(|part| tree(&part));
        let start: Name = prefix.split("::").filter(|word| !word.is_empty()).map(str::to_owned).collect();
        let joined = below.map(|(path, alias)| {
            let path: Name =
                start.iter().chain(path.iter().filter(|word| *word != "self")).cloned().collect();
            let alias = if alias == "self" { path.last().cloned().unwrap_or_default() } else { alias };
            (path, alias)
        });
        return joined.collect();
    }
    let (path, alias) = text.split_once(" as ").unwrap_or((text, ""));
    let mut words: Name = path.trim().split("::").map(|word| word.trim().to_owned()).collect();
    let last = words.last().cloned().unwrap_or_default();
    if last == "*" {
        words.pop();
    }
    vec![(words, if alias.is_empty() { last } else { alias.trim().to_owned() })]
}

/// Splits a list at the commas outside of inner braces.
fn parts(text: &str) -> Vec<String> {
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for letter in text.chars() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        parts.last_mut().unwrap().push(letter);
    }
    parts.into_iter().filter(|part| !part.trim().is_empty()).collect()
}

/// Returns a path from the crate's root with `crate`, `self` and `super` resolved; other first words are
/// children.
fn from_root(module: &Name, path: &[String]) -> Name {
    let mut place = module.clone();
    let mut words = path.iter();
    for word in words.by_ref() {
        match word.as_str() {
            "crate" | "$crate" => place.clear(),
            "self" => {}
            "super" => drop(place.pop()),
            _ => {
                place.push(word.clone());
                break;
            }
        }
    }
    place.extend(words.cloned());
    place
}

/// Returns every path of two or more words in the code.
fn paths_in(code: &str) -> BTreeSet<Name> {
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_' || letter == ':' || letter == '$';
    let words = code.split(|letter| !is_part(letter)).filter(|word| word.contains("::"));
    let path = |word: &str| -> Name {
        let word = word.trim_start_matches("::").trim_end_matches(':');
        word.split("::").take_while(|part| !part.contains(':')).map(str::to_owned).collect()
    };
    words.map(path).filter(|path: &Name| path.len() > 1).collect()
}
