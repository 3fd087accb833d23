//! Outliers: numbers that lie far from those of the other cases of a fleet.

use results::{FleetCase, FleetNumber, FleetOutlier};
use scoring::median;
use std::collections::BTreeMap;

/// Minimum number of cases whose spread is meaningful.
const FEWEST: usize = 8;
/// Robust z-score above which a number is an outlier: Iglewicz and Hoaglin, How to Detect and Handle Outliers
/// (1993).
const FARTHEST: f64 = 3.5;
/// Median absolute deviation of a normal distribution, in standard deviations.
const NORMAL: f64 = 0.6745;

/// Label within which cases are compared: coefficients of different joints are not comparable.
const ALIKE: &str = "joint";

/// Key of numbers that are compared with each other: name, unit and joint.
type Key<'a> = (&'a str, &'a str, Option<&'a str>);

/// Returns the outliers among the cases' numbers, the farthest first.
pub(super) fn outliers(cases: &[FleetCase]) -> Vec<FleetOutlier> {
    let mut groups: BTreeMap<Key<'_>, Vec<(&FleetCase, f64)>> = BTreeMap::new();
    for case in cases {
        let joint = case.labels.get(ALIKE).map(String::as_str);
        for (name, FleetNumber { value, unit }) in &case.numbers {
            groups.entry((name, unit, joint)).or_default().push((case, *value));
        }
    }
    let mut found: Vec<FleetOutlier> =
        groups.iter().flat_map(|(key, values)| of_group(key, values)).collect();
    found.sort_by(|one, other| {
        other.score.abs().total_cmp(&one.score.abs()).then_with(|| one.case.cmp(&other.case))
    });
    found
}

fn of_group(&(name, unit, _): &Key<'_>, values: &[(&FleetCase, f64)]) -> Vec<FleetOutlier> {
    let middle = median(values.iter().map(|(_, value)| *value));
    let deviation = median(values.iter().map(|(_, value)| (value - middle).abs()));
    // If half of the values are equal, every other value would be infinitely far away.
    if values.len() < FEWEST || deviation <= 0.0 {
        return Vec::new();
    }
    let outlier = |(case, value): &(&FleetCase, f64)| {
        let score = NORMAL * (value - middle) / deviation;
        (score.abs() > FARTHEST).then(|| FleetOutlier {
            case: case.id.clone(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            value: *value,
            median: middle,
            of: values.len(),
            score,
        })
    };
    values.iter().filter_map(outlier).collect()
}

#[cfg(test)]
mod tests {
    use super::outliers;
    use results::{FleetCase, FleetNumber, VerdictStatus};

    fn case(id: &str, joint: &str, value: f64) -> FleetCase {
        FleetCase {
            id: id.to_owned(),
            labels: [("joint".to_owned(), joint.to_owned())].into(),
            origin: record::Origin::Simulated,
            status: VerdictStatus::Effect,
            classes: [].into(),
            summary: String::new(),
            numbers: [("x".to_owned(), FleetNumber { value, unit: "N m".to_owned() })].into(),
        }
    }

    #[test]
    fn a_number_far_from_those_of_the_same_joint_is_an_outlier() {
        let mut cases: Vec<FleetCase> =
            (0..9).map(|i| case(&format!("e{i}"), "elbow", f64::from(i))).collect();
        // The added wrists are far from the elbows, but each is one of several.
        cases.extend((0..9).map(|i| case(&format!("w{i}"), "wrist", 100.0 + f64::from(i))));
        assert_eq!(outliers(&cases), []);
        cases.push(case("odd", "elbow", 40.0));
        let found = outliers(&cases);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].case.as_str(), found[0].median, found[0].of), ("odd", 4.5, 10));
        // Distances from 4.5: 0.5 twice, 1.5 twice, 2.5, 2.5, …: their median is 2.5.
        assert!((found[0].score - 0.6745 * 35.5 / 2.5).abs() < 1e-12);
    }

    #[test]
    fn few_or_equal_numbers_have_no_outliers() {
        let few: Vec<FleetCase> =
            (0..6).map(|i| case(&i.to_string(), "a", if i == 0 { 1e6 } else { f64::from(i) })).collect();
        assert_eq!(outliers(&few), []);
        let equal: Vec<FleetCase> =
            (0..20).map(|i| case(&i.to_string(), "a", if i == 0 { 1e6 } else { 1.0 })).collect();
        assert_eq!(outliers(&equal), []);
    }
}
