//! Differences between two resolved configurations, by key.

use settings::{Document, SettingsError};

/// Returns a sentence for each key whose value differs: `fit.seeds was 10, now 5`. Comments are ignored.
pub(super) fn differences(before: &str, now: &str) -> Result<Vec<String>, SettingsError> {
    let (before, now) = (Document::parse("config.toml", before)?, Document::parse("configuration", now)?);
    let shown = |document: &Document, key: &str| {
        document.get(key).map_or_else(|| "absent".to_owned(), |leaf| leaf.value.to_string())
    };
    let mut keys: Vec<&str> = before.leaves().iter().map(|leaf| leaf.key.as_str()).collect();
    keys.extend(now.leaves().iter().map(|leaf| leaf.key.as_str()).filter(|key| before.get(key).is_none()));
    Ok(keys
        .into_iter()
        .map(|key| (key, shown(&before, key), shown(&now, key)))
        .filter(|(_, before, now)| before != now)
        .map(|(key, before, now)| format!("{key} was {before}, now {now}"))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::differences;

    #[test]
    fn every_key_that_differs_is_told_with_both_values() {
        let before = "seed = 1\n[fit]\nseeds = 10 # from a.toml:3:1\nmax_steps = 7\n";
        let now = "seed = 1 # from elsewhere\n[fit]\nseeds = 5\n[estimator]\nhidden = [4, 4]\n";
        let found = differences(before, now).unwrap();
        let expected = [
            "fit.seeds was 10, now 5",
            "fit.max_steps was 7, now absent",
            "estimator.hidden was absent, now [4, 4]",
        ];
        assert_eq!(found, expected);
        assert!(differences(before, before).unwrap().is_empty());
    }
}
