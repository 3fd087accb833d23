//! Differences between configurations.

use settings::{Document, Leaf};
use std::collections::BTreeMap;

/// Returns the first value in which two configurations differ, in words; `None` if all values are equal.
#[must_use]
pub fn first_difference(then: &Document, now: &Document) -> Option<String> {
    let says = |leaf: &Leaf| format!("`{} = {}`", leaf.key, leaf.value);
    for leaf in then.leaves() {
        match now.get(&leaf.key) {
            Some(other) if other.value == leaf.value => (),
            Some(other) => return Some(format!("{} then, {} now", says(leaf), says(other))),
            None => return Some(format!("{} then, nothing now", says(leaf))),
        }
    }
    let added = now.leaves().iter().find(|leaf| then.get(&leaf.key).is_none())?;
    Some(format!("nothing then, {} now", says(added)))
}

/// Returns the keys in which configurations differ, in the order of their first occurrence.
///
/// Settings of an estimator are compared only among configurations of that estimator: a key that another
/// estimator lacks is no difference. `estimator.name` is left out, because every table has a column for it.
#[must_use]
pub fn differing_keys(configurations: &[&Document]) -> Vec<String> {
    let mut keys: Vec<&str> = Vec::new();
    for leaf in configurations.iter().flat_map(|document| document.leaves()) {
        if leaf.key != "estimator.name" && !keys.contains(&leaf.key.as_str()) {
            keys.push(&leaf.key);
        }
    }
    let differs = |key: &&str| {
        // The first value found for each estimator, or for all configurations if the key belongs to none.
        let mut first: BTreeMap<Option<&str>, Option<&toml::Value>> = BTreeMap::new();
        configurations.iter().any(|document| {
            let own = key.starts_with("estimator.").then(|| value(document, "estimator.name")?.as_str());
            let found = value(document, key);
            *first.entry(own.flatten()).or_insert(found) != found
        })
    };
    keys.into_iter().filter(differs).map(str::to_owned).collect()
}

fn value<'a>(document: &'a Document, key: &str) -> Option<&'a toml::Value> {
    document.get(key).map(|leaf| &leaf.value)
}

#[cfg(test)]
mod tests {
    use super::{differing_keys, first_difference};
    use settings::Document;

    fn document(text: &str) -> Document {
        Document::parse("a.toml", text).unwrap()
    }

    #[test]
    fn the_first_difference_is_said() {
        let of = |then: &str, now: &str| first_difference(&document(then), &document(now));
        assert_eq!(of("a = 1\nb = 2", "b = 2\na = 1"), None);
        assert_eq!(of("a = 1", "a = 2").unwrap(), "`a = 1` then, `a = 2` now");
        assert_eq!(of("a = 1", "").unwrap(), "`a = 1` then, nothing now");
        assert_eq!(of("", "a = 1").unwrap(), "nothing then, `a = 1` now");
    }

    #[test]
    fn what_another_estimator_does_not_have_is_no_difference() {
        let all = [
            "seed = 0\n[fit]\nseeds = 1\n[estimator]\nname = 'pinn'\nhidden = [3]\n",
            "seed = 1\n[fit]\nseeds = 1\n[estimator]\nname = 'pinn'\nhidden = [3]\n",
            "seed = 0\n[fit]\nseeds = 1\nmax_steps = 3\n[estimator]\nname = 'lstm'\ncells = 2\n",
        ]
        .map(document);
        let all: Vec<&Document> = all.iter().collect();
        assert_eq!(differing_keys(&all), ["seed", "fit.max_steps"]);
        assert_eq!(differing_keys(&all[..1]), [] as [&str; 0]);
        assert_eq!(differing_keys(&[]), [] as [&str; 0]);
    }
}
