//! The estimators there are: one line each.

use estimator::Entry;

/// Every estimator, in the paper's order, the null estimator first.
pub(crate) const ESTIMATORS: &[Entry] = &[estimator_baseline::ENTRY, estimator_pinn::ENTRY];

#[cfg(test)]
mod tests {
    use super::ESTIMATORS;
    use settings::{Document, Resolved, Section};
    use std::collections::BTreeSet;

    #[test]
    fn no_two_share_an_identifier() {
        let ids: BTreeSet<&str> = ESTIMATORS.iter().map(|entry| entry.id).collect();
        assert_eq!(ids.len(), ESTIMATORS.len());
    }

    #[test]
    fn every_one_builds_from_its_defaults() {
        for entry in ESTIMATORS {
            let section = [Section { name: "estimator", fields: entry.fields }];
            let resolved = Resolved::new(&Document::default(), &section).unwrap();
            assert!((entry.build)(&resolved).is_ok(), "{}", entry.id);
        }
    }
}
